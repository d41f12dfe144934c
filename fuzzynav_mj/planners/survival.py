"""How likely a rolled-out candidate stays clear of what moves.

A mover goes on in one of several ways, some likelier than others, and on each of them its place is
known the less the later it is. So every gap counts by what it is worth: a narrow one to an unlikely
place is a small risk, the same one to where a mover is expected a large one.
"""

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.clearance import FAR, gaps_on_the_way
from fuzzynav_mj.planners.scene import Scene
from fuzzynav_mj.types import FloatArray

TOUCH = 0.005  # m: a smaller gap is contact


@compiled
def hold_against_movers(
    alive: FloatArray,
    expected: FloatArray,
    elsewhere: FloatArray,
    placed: FloatArray,
    scene: Scene,
    half_side: float,
    beyond: float,
    least: float,
) -> float:
    """Fills in how a candidate fares through T periods; returns how many without contact can be
    expected, or -1, and leaves the rest out, as soon as they are known to be fewer than `least`.

    Args:
        alive: (T,) likelihood that there was no contact up to the end of each.
        expected: (T,) gap to movers that go on as expected, m ...
        elsewhere: (T,) ... and to wherever else they may be.
        placed: (4, T) of the footprint, as in `gaps_on_the_way`.
        scene: the movers.
        half_side: of the footprint, m.
        beyond: periods that follow these T where they are survived.
        least: periods of interest.
    """
    periods = len(alive)
    gaps, met = np.empty(periods), np.empty(periods)
    alive[:], expected[:], elsewhere[:] = 1.0, FAR, FAR
    first_expected = first_possible = number = 0
    for mover in range(len(scene.outlines)):
        size, ways = scene.outlines[mover, 0], scene.outlines[mover, 1]
        met[:] = 0.0
        for way in range(ways):
            if way == 0:
                end = first_expected + size
                gaps_on_the_way(gaps, placed, scene.expected, first_expected, end, half_side)
                first_expected = end
            else:
                end = first_possible + size
                gaps_on_the_way(gaps, placed, scene.possible, first_possible, end, half_side)
                first_possible = end
            risk = 0.0
            for j in range(periods):
                if way == 0:
                    expected[j] = min(expected[j], gaps[j])
                else:
                    elsewhere[j] = min(elsewhere[j], gaps[j])
                share = min(max(1.0 - (gaps[j] - TOUCH) / scene.risky[j], 0.0), 1.0)
                risk = max(risk, share * share)
                met[j] += scene.shares[number] * risk
            number += 1
            # Whatever else is met can only make it fewer.
            if least > 0.0 and _expected_periods(alive, met, beyond) < least:
                return -1.0
        for j in range(periods):
            alive[j] *= max(1.0 - met[j], 0.0)
    met[:] = 0.0
    return _expected_periods(alive, met, beyond)


@compiled
def _expected_periods(alive: FloatArray, met: FloatArray, beyond: float) -> float:
    """Periods without contact, and `beyond` after them, where these T are survived as likely as
    `alive` (T,) says but for one more mover, which is met as likely as `met` (T,)."""
    lasts: float = beyond * alive[-1] * max(1.0 - met[-1], 0.0)
    for j in range(len(alive)):
        lasts += alive[j] * max(1.0 - met[j], 0.0)
    return lasts
