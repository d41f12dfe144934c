"""Predicted gaps between the rolled-out footprint and the points of obstacles."""

import numpy as np

from fuzzynav_mj.types import FloatArray

FAR = np.float32(9.0)  # m: clearance where there is nothing in sight


def static_clearance(poses: np.ndarray, points: FloatArray, half_side: float) -> np.ndarray:
    """(m, T) float32 gaps between the square at `poses` (m, T, 3) and the nearest point (k, 2)."""
    if len(points) == 0:
        return np.full(poses.shape[:2], FAR)
    x, y, yaw = poses.T  # (T, m) each
    gaps = _nearest_gaps(x.ravel(), y.ravel(), yaw.ravel(), points, half_side)
    return gaps.reshape(x.shape).T


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
    """(..., n) gaps between squares at x, y, yaw (..., n) and the nearest of points (..., k, 2)."""
    c, s = np.cos(yaw), np.sin(yaw)
    half = np.float32(half_side)
    spots = np.ones((*points.shape[:-1], 3), dtype=np.float32)  # homogeneous
    spots[..., :2] = points
    # The largest arrays of a decision, (..., k, n): as few passes over them as possible.
    forward = spots @ np.stack((c, s, -(c * x + s * y)), axis=-2)
    within = np.clip(forward, -half, half)
    forward -= within
    forward *= forward
    left = spots @ np.stack((-s, c, s * x - c * y), axis=-2)
    np.clip(left, -half, half, out=within)
    left -= within
    left *= left
    forward += left
    nearest: np.ndarray = np.sqrt(forward.min(axis=-2))
    return nearest
