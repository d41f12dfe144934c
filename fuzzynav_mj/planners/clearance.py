"""Predicted gaps between the rolled-out footprint and the points of obstacles."""

import numpy as np

from fuzzynav_mj.types import FloatArray

FAR = np.float32(9.0)  # m: clearance where there is nothing in sight


def static_clearance(poses: np.ndarray, points: FloatArray, half_side: float) -> np.ndarray:
    """(m, T) float32 gaps between the square at `poses` (m, T, 3) and the nearest point (k, 2)."""
    if len(points) == 0:
        return np.full(poses.shape[:2], FAR)
    flat = poses.reshape(-1, 3)
    gaps = _gaps(flat, points.astype(np.float32).T, half_side)
    return gaps.min(axis=1).reshape(poses.shape[:2])


def moving_clearance(poses: np.ndarray, places: FloatArray, half_side: float) -> np.ndarray:
    """(m, T) float32 gaps between the square at `poses` (m, T, 3) and the nearest of the moving
    points, which at the time of column j are at `places[j]` (T, 2, k)."""
    if places.shape[2] == 0:
        return np.full(poses.shape[:2], FAR)
    ordered = np.ascontiguousarray(poses.transpose(1, 0, 2))  # (T, m, 3)
    return _gaps(ordered, places.astype(np.float32), half_side).min(axis=2).T


def _gaps(poses: np.ndarray, points: np.ndarray, half_side: float) -> np.ndarray:
    """(..., k) gaps between squares at poses (..., 3) and points (..., 2, k)."""
    c, s = np.cos(poses[..., 2]), np.sin(poses[..., 2])
    x, y = poses[..., 0], poses[..., 1]
    forward = np.stack((c, s), axis=-1) @ points
    forward -= (c * x + s * y)[..., None]
    left = np.stack((-s, c), axis=-1) @ points
    left -= (c * y - s * x)[..., None]
    np.abs(forward, out=forward)
    np.abs(left, out=left)
    forward -= np.float32(half_side)
    left -= np.float32(half_side)
    np.maximum(forward, 0.0, out=forward)
    np.maximum(left, 0.0, out=left)
    forward *= forward
    left *= left
    forward += left
    return np.sqrt(forward)
