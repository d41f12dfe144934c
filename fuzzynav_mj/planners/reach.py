"""How far a disc can move among points, or a ray reaches, before it meets something."""

from math import asin, atan2, cos, floor, hypot, inf, pi, sin, sqrt

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import FloatArray


def free_distance(points: FloatArray, bearings: FloatArray, width: float) -> FloatArray:
    """(n,) how far a disc of radius `width` can move on each bearing before it meets a point.

    A point that the disc already overlaps stops only motion towards it.
    """
    return _free(np.ascontiguousarray(points), np.ascontiguousarray(bearings), width)


@compiled
def _free(points: FloatArray, bearings: FloatArray, width: float) -> FloatArray:
    """See `free_distance`."""
    free = np.empty(len(bearings))
    for i in range(len(bearings)):
        free[i] = free_ahead(points, bearings[i], width)
    return free


@compiled
def free_ahead(points: FloatArray, bearing: float, width: float) -> float:
    """The same on one bearing; points (k, 2) row by row."""
    c, s, free = cos(bearing), sin(bearing), inf
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        free = min(free, _until_met(c * x + s * y, c * y - s * x, width))
    return free


@compiled
def _until_met(along: float, across: float, width: float) -> float:
    """How far a disc moves until it meets a point that lies so far ahead and beside it."""
    if along <= 0.0 or abs(across) >= width:
        return inf
    return max(along - sqrt(width**2 - across**2), 0.0)


@compiled
def free_on_rays(
    points: FloatArray, c: FloatArray, s: FloatArray, first: float, widths: FloatArray
) -> FloatArray:
    """(w, n) free distances of discs of several radii on evenly spaced bearings, given by their
    cosines and sines (n,) and the first of them."""
    count = len(c)
    free = np.full((len(widths), count), np.inf)
    widest, per_radian = widths.max(), count / (2 * pi)
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        # Only the rays within the angle that the widest disc covers as seen from here meet it.
        spread = asin(widest / max(hypot(x, y), widest)) * per_radian
        ray = (atan2(y, x) - first) * per_radian
        i = floor(ray - spread) % count
        for _ in range(int(2 * spread) + 3):
            along, across = c[i] * x + s[i] * y, c[i] * y - s[i] * x
            for w in range(len(widths)):
                if along - widths[w] < free[w, i]:  # else it cannot be met earlier
                    free[w, i] = min(free[w, i], _until_met(along, across, widths[w]))
            i = i + 1 if i + 1 < count else 0
    return free


@compiled
def range_of_line(x: float, y: float, along_x: float, along_y: float, c: float, s: float) -> float:
    """How far a ray of this direction, given by its cosine and sine, goes until it meets the line
    through (x, y) along (along_x, along_y); negative behind it, inf where they are parallel."""
    across = c * along_y - s * along_x
    return inf if across == 0.0 else (x * along_y - y * along_x) / across
