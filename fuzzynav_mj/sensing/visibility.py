"""The paper's visibility matrix and intersection counts, Eqs. (9)-(11)."""

from math import atan2, cos, hypot, pi, sin

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray, VisibilityMatrix


def visibility_matrix(
    now: Look, before: Look | None, bearings: FloatArray, rings: tuple[float, ...]
) -> VisibilityMatrix:
    """The matrix of this look and the counts of both.

    A ring's point on a bearing lies in an obstacle when the ray on that bearing was stopped at or
    before the ring. The previous look's hits are seen from the present pose, so that the robot's
    own motion does not change the counts and it need not stop to look twice.
    """
    occupied, counts = _blocked(np.where(now.hit, now.ranges, np.inf), bearings, rings)
    if before is None:
        return VisibilityMatrix(occupied, counts, counts)
    seen = _ranges_from(before, now.x, now.y, now.yaw)
    return VisibilityMatrix(occupied, counts, _blocked(seen, bearings, rings)[1])


@compiled
def _blocked(
    ranges: FloatArray, bearings: FloatArray, rings: tuple[float, ...]
) -> tuple[BoolArray, IntArray]:
    """(rings, n) where rays are stopped at or before a ring, `inf` for those that are not at all;
    (4,) counts in q1 (front right), q2 (front left), q3 (rear left), q4 (rear right)."""
    occupied = np.empty((len(rings), len(ranges)), dtype=np.bool_)
    counts = np.zeros(4, dtype=np.intp)
    for i in range(len(ranges)):
        quarter = 3
        for number, border in enumerate((-pi / 2, 0.0, pi / 2)):
            if bearings[i] >= border:
                quarter = number
        for ring in range(len(rings)):
            occupied[ring, i] = ranges[i] <= rings[ring]
            counts[quarter] += occupied[ring, i]
    return occupied, counts


@compiled
def _ranges_from(look: Look, x: float, y: float, yaw: float) -> FloatArray:
    """(n,) smallest distance of the look's hits in each bearing's sector around a pose."""
    count, c, s = len(look.hit), cos(yaw), sin(yaw)
    ranges = np.full(count, np.inf)
    for i in look.hit.nonzero()[0]:
        dx, dy = look.points[0, i] - x, look.points[1, i] - y
        forward, left = c * dx + s * dy, c * dy - s * dx
        ray = round((atan2(left, forward) + pi) * (count / (2 * pi))) % count
        ranges[ray] = min(ranges[ray], hypot(forward, left))
    return ranges
