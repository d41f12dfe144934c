"""The paper's visibility matrix and intersection counts, Eqs. (9)-(11)."""

from math import cos, hypot, pi, sin

import numpy as np

from fuzzynav_mj.bearings import nearest_ray
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
    seen = now if before is None else before
    occupied, counts, previous = _counted(
        now.ranges, now.hit, seen.points, seen.hit, now.x, now.y, now.yaw, bearings, rings
    )
    return VisibilityMatrix(occupied, counts, counts if before is None else previous)


@compiled
def _counted(
    ranges: FloatArray,
    hit: BoolArray,
    points: FloatArray,
    hit_before: BoolArray,
    x: float,
    y: float,
    yaw: float,
    bearings: FloatArray,
    rings: tuple[float, ...],
) -> tuple[BoolArray, IntArray, IntArray]:
    """The matrix (rings, n) and the counts (4,) of two looks, see `visibility_matrix`, from the
    ranges and the pose of this one and the end points (2, n) of the other; `Look` has the rest."""
    count = len(ranges)
    occupied = np.empty((len(rings), count), dtype=np.bool_)
    counts, previous = np.zeros(4, dtype=np.intp), np.zeros(4, dtype=np.intp)
    seen = _ranges_from(points, hit_before, x, y, yaw)
    for i in range(count):
        quarter = 3  # rear right; a border counts to its left
        for number, border in enumerate((-pi / 2, 0.0, pi / 2)):
            if bearings[i] >= border:
                quarter = number
        for ring in range(len(rings)):
            occupied[ring, i] = hit[i] and ranges[i] <= rings[ring]
            counts[quarter] += occupied[ring, i]
            previous[quarter] += seen[i] <= rings[ring]
    return occupied, counts, previous


@compiled
def _ranges_from(points: FloatArray, hit: BoolArray, x: float, y: float, yaw: float) -> FloatArray:
    """(n,) smallest distance of a look's hits in each bearing's sector around a pose."""
    count, c, s = len(hit), cos(yaw), sin(yaw)
    ranges = np.full(count, np.inf)
    for i in range(count):
        if hit[i]:
            dx, dy = points[0, i] - x, points[1, i] - y
            forward, left = c * dx + s * dy, c * dy - s * dx
            ray = nearest_ray(forward, left, -pi, count)
            ranges[ray] = min(ranges[ray], hypot(forward, left))
    return ranges
