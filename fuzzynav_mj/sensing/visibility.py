"""The paper's visibility matrix and intersection counts, Eqs. (9)-(11)."""

from math import cos, pi, sin

import numpy as np

from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray, Pose2D, VisibilityMatrix


def visibility_matrix(
    now: Look, before: Look | None, bearings: FloatArray, rings: tuple[float, ...]
) -> VisibilityMatrix:
    """The matrix of this look and the counts of both.

    A ring's point on a bearing lies in an obstacle when the ray on that bearing was stopped at or
    before the ring. The previous look's hits are seen from the present pose, so that the robot's
    own motion does not change the counts and it need not stop to look twice.
    """
    radii = np.array(rings)[:, None]
    occupied = now.hit & (now.ranges <= radii)
    quarter = np.floor(bearings / (pi / 2)).astype(np.intp) + 2
    counts = _per_quarter(occupied, quarter)
    if before is None:
        return VisibilityMatrix(occupied, counts, counts)
    seen = _ranges_from(before, now.pose, len(bearings))
    return VisibilityMatrix(occupied, counts, _per_quarter(seen <= radii, quarter))


def _per_quarter(occupied: BoolArray, quarter: IntArray) -> IntArray:
    """(4,) counts in q1 (front right), q2 (front left), q3 (rear left), q4 (rear right).

    Args:
        occupied: (rings, n).
        quarter: (n,) of each ray, counted from straight behind counter-clockwise.
    """
    per_ray = np.add.reduce(occupied, axis=0, dtype=np.intp)
    totals = np.bincount(quarter, weights=per_ray, minlength=4)
    return totals.astype(np.intp).take([1, 2, 3, 0])


def _ranges_from(look: Look, pose: Pose2D, count: int) -> FloatArray:
    """(count,) smallest distance of the look's hits in each bearing's sector around `pose`."""
    x, y = look.points.T.take(look.hit.nonzero()[0], axis=1)
    dx, dy = x - pose.x, y - pose.y
    c, s = cos(pose.yaw), sin(pose.yaw)
    forward, left = c * dx + s * dy, c * dy - s * dx
    bearing = np.arctan2(left, forward)
    ray = np.rint((bearing + pi) * (count / (2 * pi))).astype(np.intp) % count
    ranges = np.full(count, np.inf)
    np.minimum.at(ranges, ray, np.hypot(forward, left))
    return ranges
