"""The visible outline of an obstacle: where its two ends are, and how fast they move."""

from math import hypot
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.segmentation import Hits
from fuzzynav_mj.types import FloatArray, IntArray

END_DEPTH = 0.05  # m: an outline ends where the next ray reaches this much farther ...
RANGE_END_DEPTH = 0.15  # m: ... or this much, where the next ray hits nothing


class Outlines(NamedTuple):
    """What k obstacles in a look are by their hits.

    Attributes:
        middles: (k, 2) mean of the hits, world frame, m.
        ends: (k, 2, 2) first and last hit, world frame, m; nan where something nearer may hide the
            outline's end.
        nearest: (k,) the hit nearest to the robot.
    """

    middles: FloatArray
    ends: FloatArray
    nearest: IntArray


@compiled
def outlines(hits: Hits, bounds: IntArray, look: Look) -> Outlines:
    """The outlines of k obstacles.

    Args:
        hits: of all obstacles.
        bounds: (k + 1,) first hit of each, and the number of all.
        look: that they belong to.
    """
    count, rays, points = len(bounds) - 1, len(look.ranges), hits.points
    middles, ends = np.zeros((count, 2)), np.full((count, 2, 2), np.nan)
    nearest = np.empty(count, dtype=np.intp)
    for k in range(count):
        first, last, smallest = bounds[k], bounds[k + 1] - 1, np.inf
        for i in range(first, last + 1):
            middles[k, 0] += points[0, i]
            middles[k, 1] += points[1, i]
            dx, dy = points[0, i] - look.x, points[1, i] - look.y
            if dx * dx + dy * dy < smallest:
                smallest, nearest[k] = dx * dx + dy * dy, i
        middles[k, 0] /= last + 1 - first
        middles[k, 1] /= last + 1 - first
        for end, index, step in ((0, first, -1), (1, last, 1)):
            ray = hits.rays[index]
            beside = (ray + step) % rays
            # Where nothing was hit beside it, the obstacle may go on just out of range.
            depth = END_DEPTH if look.hit[beside] else RANGE_END_DEPTH
            if look.ranges[beside] >= look.ranges[ray] + depth:
                ends[k, end, 0], ends[k, end, 1] = points[0, index], points[1, index]
    return Outlines(middles, ends, nearest)


@compiled
def whole_ends(hits: Hits, chosen: IntArray, look: Look) -> FloatArray:
    """(2, 2) ends of the outline of the chosen hits; nan where hidden."""
    ends, rays = np.full((2, 2), np.nan), len(look.ranges)
    for end, index, step in ((0, chosen[0], -1), (1, chosen[-1], 1)):
        ray = hits.rays[index]
        beside = (ray + step) % rays
        depth = END_DEPTH if look.hit[beside] else RANGE_END_DEPTH
        if look.ranges[beside] >= look.ranges[ray] + depth:
            ends[end, 0], ends[end, 1] = hits.points[0, index], hits.points[1, index]
    return ends


@compiled
def end_rates(
    ends: FloatArray, before: FloatArray, elapsed: float, look: Look
) -> tuple[FloatArray, FloatArray]:
    """(2, 2) directions across the lines of sight to the ends, and (2,) how fast each moved in its
    direction, m/s; nan for an end that is not known in both looks, or if no time has passed.

    Args:
        ends: (2, 2) as the look shows them, world frame.
        before: (2, 2) as they were before.
        elapsed: s since then.
        look: the newer one.
    """
    across, rates = np.zeros((2, 2)), np.full(2, np.nan)
    for end in range(2):
        if np.isnan(ends[end, 0] + before[end, 0]) or elapsed <= 0.0:
            continue
        x, y = ends[end, 0] - look.x, ends[end, 1] - look.y
        length = max(hypot(x, y), 1e-9)
        across[end, 0], across[end, 1] = -y / length, x / length
        along_x = across[end, 0] * (ends[end, 0] - before[end, 0])
        along_y = across[end, 1] * (ends[end, 1] - before[end, 1])
        rates[end] = (along_x + along_y) / elapsed
    return across, rates
