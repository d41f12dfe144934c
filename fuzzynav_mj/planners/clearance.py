"""Predicted gaps between the rolled-out footprint and the points of obstacles."""

from math import cos, sin, sqrt

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import FloatArray

FAR = 9.0  # m: clearance where there is nothing in sight


def static_clearance(poses: np.ndarray, points: FloatArray, half_side: float) -> FloatArray:
    """(m, T) gaps between the square at `poses` (m, T, 3) and the nearest point (k, 2)."""
    return _nearest_gaps(_plain(poses), at_all_times(points, poses.shape[1]), half_side)


def moving_clearance(poses: np.ndarray, places: FloatArray, half_side: float) -> FloatArray:
    """(m, T) gaps between the square at `poses` (m, T, 3) and the nearest of the moving points,
    which at the time of column j are at `places[j]` (T, 2, k)."""
    return _nearest_gaps(_plain(poses), _plain(places.transpose(1, 2, 0)), half_side)


def at_all_times(points: FloatArray, columns: int) -> FloatArray:
    """(2, k, T) points (k, 2) that stay where they are, as `gaps_on_the_way` takes them."""
    return np.repeat(_plain(points.T)[:, :, None], columns, axis=2)


def _plain(values: np.ndarray) -> FloatArray:
    """As the compiled function takes them: it is made anew for every layout and precision."""
    return np.ascontiguousarray(values, dtype=np.float64)


@compiled
def _nearest_gaps(poses: FloatArray, points: FloatArray, half: float) -> FloatArray:
    """(m, T) gaps between squares at `poses` (m, T, 3) and the nearest of the points (2, k, T) of
    the same column."""
    count, columns = poses.shape[:2]
    gaps, placed = np.empty((count, columns)), np.empty((4, columns))
    for i in range(count):
        place(placed, poses[i])
        gaps_on_the_way(gaps[i], placed, points, half)
    return gaps


@compiled
def place(placed: FloatArray, poses: FloatArray) -> None:
    """Fills in `placed` (4, T), as `gaps_on_the_way` takes it, from poses (T, 3)."""
    for j in range(len(poses)):
        placed[0, j], placed[1, j] = poses[j, 0], poses[j, 1]
        placed[2, j], placed[3, j] = cos(poses[j, 2]), sin(poses[j, 2])


@compiled
def gaps_on_the_way(gaps: FloatArray, placed: FloatArray, points: FloatArray, half: float) -> None:
    """Fills in the gaps (T,) between a square on its way and the nearest point at each time.

    Args:
        gaps: m; `FAR` where no point is nearer.
        placed: (4, T) the square's centre, x and y, m, and cosine and sine of its yaw.
        points: (2, k, T) x and y.
        half: half of the square's side, m.
    """
    gaps[:] = FAR * FAR
    # Times lie side by side: the compiler takes several of them at once.
    for k in range(points.shape[1]):
        for j in range(len(gaps)):
            dx, dy = points[0, k, j] - placed[0, j], points[1, k, j] - placed[1, j]
            c, s = placed[2, j], placed[3, j]
            ahead = max(abs(c * dx + s * dy) - half, 0.0)
            aside = max(abs(c * dy - s * dx) - half, 0.0)
            gaps[j] = min(gaps[j], ahead * ahead + aside * aside)
    for j in range(len(gaps)):
        gaps[j] = sqrt(gaps[j])
