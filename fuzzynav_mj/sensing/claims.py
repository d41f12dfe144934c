"""Which hits known movers claim: those that lie on their outlines, carried on to this look; and
which ones that were given to them, beside those, cannot be theirs."""

from math import hypot

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.expected import Expected
from fuzzynav_mj.sensing.looks import Look, depth_behind
from fuzzynav_mj.sensing.registration import FEWEST_STRAYS
from fuzzynav_mj.sensing.segmentation import MOVING, NEW, STANDS, STATIC, Hits, run_bounds
from fuzzynav_mj.types import BoolArray, IntArray


@compiled
def claimed(
    hits: Hits, flags: IntArray, expected: Expected, elapsed: float, still: float
) -> IntArray:
    """(m,) number of the mover that claims each hit; `STANDS` where none does.

    Args:
        hits: m of them.
        flags: (m,) whether each one moves.
        expected: the movers.
        elapsed: s that `flags` look back.
        still: a surface that moved less than this in that time seems to stand, m.
    """
    owners = np.full(len(flags), STANDS)
    for i in range(len(flags)):
        best = 1.0
        for k in range(len(expected.owner)):
            mover = expected.owner[k]
            dx = hits.points[0, i] - expected.points[0, k]
            dy = hits.points[1, i] - expected.points[1, k]
            if expected.joined[k]:
                along_x = expected.points[0, k + 1] - expected.points[0, k]
                along_y = expected.points[1, k + 1] - expected.points[1, k]
                squared = max(along_x * along_x + along_y * along_y, 1e-12)
                share = min(max((dx * along_x + dy * along_y) / squared, 0.0), 1.0)
                dx, dy = dx - share * along_x, dy - share * along_y
            off = hypot(dx, dy) / expected.reach[mover]
            if off >= best:
                continue
            if flags[i] == STATIC and expected.joined[k]:
                # Had this piece been there, it would have been seen to move.
                speed = (
                    expected.normals[0, k] * expected.velocity[mover, 0]
                    + expected.normals[1, k] * expected.velocity[mover, 1]
                )
                if abs(speed) * elapsed > 2.0 * still:
                    continue
            best, owners[i] = off, mover
    return owners


@compiled
def without_strangers(
    hits: Hits,
    flags: IntArray,
    claims: IntArray,
    owners: IntArray,
    expected: Expected,
    before: Look,
    elapsed: float,
) -> IntArray:
    """(m,) the owners, without hits that came into view beside a mover and are not of it: had they
    been there in the look before, rays that went by would have met them.

    Args:
        hits: m of them.
        flags: (m,) MOVING, STATIC or UNKNOWN for each hit.
        claims: (m,) number of the mover on whose expected outline it lies; `STANDS` for none.
        owners: (m,) number of the mover that it was given to, `NEW` or `STANDS`.
        expected: the movers.
        before: the look before.
        elapsed: s since then.
    """
    if elapsed <= 0.0:
        return owners
    kept = owners.copy()
    strange = _were_free(hits, claims, owners, expected, before, elapsed)
    bounds = run_bounds(hits.first, strange)
    for k in range(len(bounds) - 1):
        begin, end = bounds[k], bounds[k + 1]
        if strange[begin] and end - begin >= FEWEST_STRAYS:
            moves = (flags[begin:end] == MOVING).any()
            kept[begin:end] = NEW if moves else STANDS
    return kept


@compiled
def _were_free(
    hits: Hits,
    claims: IntArray,
    owners: IntArray,
    expected: Expected,
    before: Look,
    elapsed: float,
) -> BoolArray:
    """(m,) True for hits beside what a mover claims whose places, carried back by its motion, were
    seen to be free; the arguments are those of `without_strangers`."""
    free = np.zeros(len(owners), dtype=np.bool_)
    for i in range(len(owners)):
        mover = owners[i]
        if mover < 0 or claims[i] == mover:
            continue
        x = hits.points[0, i] - elapsed * expected.velocity[mover, 0]
        y = hits.points[1, i] - elapsed * expected.velocity[mover, 1]
        free[i] = depth_behind(x, y, before) > expected.reach[mover]
    return free
