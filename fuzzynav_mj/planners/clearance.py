"""Predicted gaps between the rolled-out footprint and the points of obstacles."""

from math import cos, sin, sqrt

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import FloatArray

FAR = 9.0  # m: clearance where there is nothing in sight


def static_clearance(poses: np.ndarray, points: FloatArray, half_side: float) -> FloatArray:
    """(m, T) gaps between the square at `poses` (m, T, 3) and the nearest point (k, 2)."""
    return _nearest_gaps(_plain(poses), _plain(points[None]), half_side)


def moving_clearance(poses: np.ndarray, places: FloatArray, half_side: float) -> FloatArray:
    """(m, T) gaps between the square at `poses` (m, T, 3) and the nearest of the moving points,
    which at the time of column j are at `places[j]` (T, 2, k)."""
    return _nearest_gaps(_plain(poses), _plain(places.transpose(0, 2, 1)), half_side)


def _plain(values: np.ndarray) -> FloatArray:
    """As the compiled function takes them: it is made anew for every layout and precision."""
    return np.ascontiguousarray(values, dtype=np.float64)


@compiled
def _nearest_gaps(poses: FloatArray, points: FloatArray, half: float) -> FloatArray:
    """(m, T) gaps between squares at `poses` (m, T, 3) and the nearest of the points (T, k, 2) of
    the same column, or (1, k, 2) of all columns."""
    count, columns = poses.shape[:2]
    gaps = np.empty((count, columns))
    for i in range(count):
        likely = 0  # the point nearest to the pose before
        for j in range(columns):
            x, y = poses[i, j, 0], poses[i, j, 1]
            c, s = cos(poses[i, j, 2]), sin(poses[i, j, 2])
            row = j if len(points) > 1 else 0
            gaps[i, j], likely = nearest_gap(x, y, c, s, points[row], likely, half)
    return gaps


@compiled
def nearest_gap(
    x: float, y: float, c: float, s: float, points: FloatArray, likely: int, half: float
) -> tuple[float, int]:
    """The gap between a square and the nearest point, and the number of that point.

    Args:
        x, y: the square's centre, m.
        c, s: cosine and sine of its yaw.
        points: (k, 2).
        likely: the number of a point that may be the nearest: it is tried first, which rules most
            others out.
        half: half of the square's side, m.
    """
    nearest, found, reach = FAR * FAR, 0, half * sqrt(2.0)
    worth_a_look = (FAR + reach) ** 2
    for number in range(-1, len(points)):
        k = number if number >= 0 else min(likely, len(points) - 1)
        if k < 0:
            break
        dx, dy = points[k, 0] - x, points[k, 1] - y
        if dx * dx + dy * dy >= worth_a_look:
            continue
        ahead = max(abs(c * dx + s * dy) - half, 0.0)
        aside = max(abs(c * dy - s * dx) - half, 0.0)
        squared = ahead * ahead + aside * aside
        if squared < nearest:
            nearest, found = squared, k
            worth_a_look = (sqrt(nearest) + reach) ** 2
    return sqrt(nearest), found
