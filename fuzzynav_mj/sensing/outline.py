"""The visible outline of an obstacle: where its two ends are, and how fast they move."""

import numpy as np

from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.segmentation import Hits
from fuzzynav_mj.types import FloatArray

END_DEPTH = 0.05  # m: an outline ends where the next ray reaches this much farther ...
RANGE_END_DEPTH = 0.15  # m: ... or this much, where the next ray hits nothing


def outline_ends(hits: Hits, span: slice, look: Look) -> FloatArray:
    """(2, 2) first and last hit of an obstacle; nan where something nearer may hide its end."""
    count = len(look.ranges)
    ends = hits.points[[span.start, span.stop - 1]]
    for row, (index, step) in enumerate(((span.start, -1), (span.stop - 1, 1))):
        ray = int(hits.rays[index])
        beside = (ray + step) % count
        # Where nothing was hit beside it, the obstacle may go on just out of range.
        depth = END_DEPTH if look.hit[beside] else RANGE_END_DEPTH
        if look.ranges[beside] < look.ranges[ray] + depth:
            ends[row] = np.nan
    return ends


def end_rates(
    ends: FloatArray, before: FloatArray, elapsed: float, look: Look
) -> tuple[FloatArray, FloatArray]:
    """(k, 2) directions across the lines of sight to the ends known in both looks, and (k,) how
    fast each moved in its direction, m/s."""
    seen = ~np.isnan(ends[:, 0] + before[:, 0])
    sight = ends[seen] - np.array([look.pose.x, look.pose.y])
    length = np.maximum(np.hypot(sight[:, 0], sight[:, 1]), 1e-9)
    across = np.stack((-sight[:, 1], sight[:, 0]), axis=1) / length[:, None]
    return across, (across * (ends[seen] - before[seen])).sum(axis=1) / elapsed
