"""Predicted gaps between the rolled-out footprint and the points of obstacles."""

import numpy as np

from fuzzynav_mj.types import FloatArray

FAR = np.float32(9.0)  # m: clearance where there is nothing in sight


def static_clearance(poses: np.ndarray, points: FloatArray, half_side: float) -> np.ndarray:
    """(m, T) float32 gaps between the square at `poses` (m, T, 3) and the nearest point (k, 2)."""
    if len(points) == 0:
        return np.full(poses.shape[:2], FAR)
    # What stands is met at any time: all poses in one row.
    x, y, yaw = poses.T.reshape(3, 1, -1)
    gaps = _nearest_gaps(x, y, yaw, points[None], half_side)
    return gaps.reshape(poses.shape[1::-1]).T


def moving_clearance(poses: np.ndarray, places: FloatArray, half_side: float) -> np.ndarray:
    """(m, T) float32 gaps between the square at `poses` (m, T, 3) and the nearest of the moving
    points, which at the time of column j are at `places[j]` (T, 2, k)."""
    if places.shape[2] == 0:
        return np.full(poses.shape[:2], FAR)
    x, y, yaw = poses.T
    return _nearest_gaps(x, y, yaw, places.transpose(0, 2, 1), half_side).T


def _nearest_gaps(
    x: np.ndarray, y: np.ndarray, yaw: np.ndarray, points: FloatArray, half_side: float
) -> np.ndarray:
    """(T, n) gaps between squares at x, y, yaw (T, n) and the nearest of points (T, k, 2)."""
    c, s = np.cos(yaw), np.sin(yaw)
    half = np.float32(half_side)
    spots = np.ones((*points.shape[:2], 3), dtype=np.float32)  # homogeneous
    spots[..., :2] = points
    # The largest arrays of a decision, (T, k, n): as few passes over them as possible.
    forward = spots @ np.array((c, s, -(c * x + s * y))).transpose(1, 0, 2)
    within = np.clip(forward, -half, half)
    forward -= within
    forward *= forward
    left = spots @ np.array((-s, c, s * x - c * y)).transpose(1, 0, 2)
    np.clip(left, -half, half, out=within)
    left -= within
    left *= left
    forward += left
    nearest: np.ndarray = np.sqrt(forward.min(axis=1))
    return nearest
