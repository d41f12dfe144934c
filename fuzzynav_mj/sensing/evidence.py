"""What tells motion from noise: the sensor's limits, and what is believed of movers."""

from typing import NamedTuple


class Evidence(NamedTuple):
    """What shows that a hit moves; a named tuple, which compiled functions take as a whole.

    Attributes:
        top_speed: the fastest motion believed, m/s: a hit farther off belongs to another surface.
        margin: how far inside former free space a hit must lie to count as intruding, m.
        max_range: the sensor's, m.
        still: a surface that moved less than this between the compared looks stands still, m.
        certainty: standard deviations of noise beyond `still` that show motion.
        noise: standard deviation of the ranges, m.
        unreliable: True if a single ray may be wrong.
        mover_extent: the largest extent believed of a mover's visible side, m.
    """

    top_speed: float
    margin: float
    max_range: float
    still: float
    certainty: float
    noise: float
    unreliable: bool
    mover_extent: float
