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
    counts = _per_quarter(occupied, bearings)
    if before is None:
        return VisibilityMatrix(occupied, counts, counts)
    seen = _ranges_from(before, now.pose, len(bearings))
    return VisibilityMatrix(occupied, counts, _per_quarter(seen <= radii, bearings))


def _per_quarter(occupied: BoolArray, bearings: FloatArray) -> IntArray:
    """(4,) counts in q1 (front right), q2 (front left), q3 (rear left), q4 (rear right)."""
    right, ahead, left = bearings.searchsorted((-pi / 2, 0.0, pi / 2)).tolist()
    quarters = ((right, ahead), (ahead, left), (left, len(bearings)), (0, right))
    return np.array([np.count_nonzero(occupied[:, first:end]) for first, end in quarters])


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
