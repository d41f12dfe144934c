"""The paper's visibility matrix and intersection counts, Eqs. (9)-(11)."""

from math import cos, pi, sin

import numpy as np

from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.types import FloatArray, IntArray, Pose2D, VisibilityMatrix


def visibility_matrix(
    now: Look, before: Look | None, bearings: FloatArray, rings: tuple[float, ...]
) -> VisibilityMatrix:
    """The matrix of this look and the counts of both.

    A ring's point on a bearing lies in an obstacle when the ray on that bearing was stopped at or
    before the ring. The previous look's hits are seen from the present pose, so that the robot's
    own motion does not change the counts and it need not stop to look twice.
    """
    radii = np.asarray(rings)[:, None]
    occupied = now.hit & (now.ranges <= radii)
    counts = _per_quarter(occupied, bearings)
    if before is None:
        return VisibilityMatrix(occupied, counts, counts)
    seen = _ranges_from(before, now.pose, len(bearings))
    previous = _per_quarter(seen <= radii, bearings)
    return VisibilityMatrix(occupied, counts, previous)


def _per_quarter(occupied: np.ndarray, bearings: FloatArray) -> IntArray:
    """(4,) counts in q1 (front right), q2 (front left), q3 (rear left), q4 (rear right)."""
    per_ray = occupied.sum(axis=0)
    quarter = np.floor(bearings / (pi / 2)).astype(int)  # -2, -1, 0, 1
    totals = np.bincount(quarter + 2, weights=per_ray, minlength=4).astype(np.intp)
    rear_right, front_right, front_left, rear_left = totals[:4]
    return np.array([front_right, front_left, rear_left, rear_right], dtype=np.intp)


def _ranges_from(look: Look, pose: Pose2D, count: int) -> FloatArray:
    """(count,) smallest distance of the look's hits in each bearing's sector around `pose`."""
    offset = look.points[look.hit] - np.array([pose.x, pose.y])
    c, s = cos(pose.yaw), sin(pose.yaw)
    x = c * offset[:, 0] + s * offset[:, 1]
    y = c * offset[:, 1] - s * offset[:, 0]
    ray = np.rint((np.arctan2(y, x) + pi) * (count / (2 * pi))).astype(int) % count
    ranges = np.full(count, np.inf)
    np.minimum.at(ranges, ray, np.hypot(x, y))
    return ranges
