"""Predicted gaps between the rolled-out footprint and the points of obstacles."""

from math import cos, sin, sqrt

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import FloatArray

FAR = 9.0  # m: clearance where there is nothing in sight


def static_clearance(poses: np.ndarray, points: FloatArray, half_side: float) -> FloatArray:
    """(m, T) gaps between the square at `poses` (m, T, 3) and the nearest point (k, 2)."""
    return _standing_gaps(_plain(poses), _plain(points), half_side)


def moving_clearance(poses: np.ndarray, places: FloatArray, half_side: float) -> FloatArray:
    """(m, T) gaps between the square at `poses` (m, T, 3) and the nearest of the moving points,
    which at the time of column j are at `places[j]` (T, 2, k)."""
    return _moving_gaps(_plain(poses), _plain(places.transpose(1, 2, 0)), half_side)


def _plain(values: np.ndarray) -> FloatArray:
    """As the compiled function takes them: it is made anew for every layout and precision."""
    return np.ascontiguousarray(values, dtype=np.float64)


@compiled
def _standing_gaps(poses: FloatArray, points: FloatArray, half: float) -> FloatArray:
    """(m, T) of `static_clearance`."""
    count, columns = poses.shape[:2]
    gaps, placed, facing = np.empty((count, columns)), np.empty((4, columns)), facings(poses)
    for i in range(count):
        place(placed, poses[i], facing[i])
        gaps_to_standing(gaps[i], placed, points, half, FAR)
    return gaps


@compiled
def _moving_gaps(poses: FloatArray, points: FloatArray, half: float) -> FloatArray:
    """(m, T) of `moving_clearance`, whose points are here (2, k, T)."""
    count, columns = poses.shape[:2]
    gaps, placed, facing = np.empty((count, columns)), np.empty((4, columns)), facings(poses)
    for i in range(count):
        place(placed, poses[i], facing[i])
        gaps_on_the_way(gaps[i], placed, points, 0, points.shape[1], half)
    return gaps


@compiled
def facings(poses: FloatArray) -> FloatArray:
    """(m, T, 2) cosines and sines of the yaw of poses (m, T, 3)."""
    facing = np.empty((poses.shape[0], poses.shape[1], 2))
    for i in range(poses.shape[0]):
        for j in range(poses.shape[1]):
            facing[i, j, 0], facing[i, j, 1] = cos(poses[i, j, 2]), sin(poses[i, j, 2])
    return facing


@compiled
def place(placed: FloatArray, poses: FloatArray, facing: FloatArray) -> None:
    """Fills in `placed` (4, T), as `gaps_on_the_way` takes it, from poses (T, 3) and the cosines
    and sines (T, 2) of their yaw."""
    for j in range(len(poses)):
        placed[0, j], placed[1, j] = poses[j, 0], poses[j, 1]
        placed[2, j], placed[3, j] = facing[j, 0], facing[j, 1]


@compiled
def gaps_on_the_way(
    gaps: FloatArray, placed: FloatArray, points: FloatArray, first: int, end: int, half: float
) -> None:
    """Fills in the gaps (T,) between a square on its way and the nearest point at each time.

    Args:
        gaps: m; `FAR` where no point is nearer.
        placed: (4, T) the square's centre, x and y, m, and cosine and sine of its yaw.
        points: (2, k, T) x and y, of which those from number `first` to before `end` count.
        half: half of the square's side, m.
    """
    gaps[:] = FAR * FAR
    # Times lie side by side: the compiler takes several of them at once. With `min` it would write
    # only those that are smaller, one by one, which takes three times as long.
    for k in range(first, end):
        for j in range(len(gaps)):
            gaps[j] = np.minimum(
                gaps[j], _squared_gap(placed, j, points[0, k, j], points[1, k, j], half)
            )
    for j in range(len(gaps)):
        gaps[j] = sqrt(gaps[j])


@compiled
def gaps_to_standing(
    gaps: FloatArray, placed: FloatArray, points: FloatArray, half: float, near: float
) -> None:
    """Fills in the gaps (T,) between a square on its way and the nearest point (k, 2) of what
    stands, up to `near`, m: more is as good as that. `placed` and `half` are those of
    `gaps_on_the_way`."""
    gaps[:] = near * near
    around = half * sqrt(2.0) + near
    left, right = placed[0].min() - around, placed[0].max() + around
    low, high = placed[1].min() - around, placed[1].max() + around
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        if x < left or x > right or y < low or y > high:
            continue
        for j in range(len(gaps)):
            gaps[j] = np.minimum(gaps[j], _squared_gap(placed, j, x, y, half))
    for j in range(len(gaps)):
        gaps[j] = sqrt(gaps[j])


@compiled
def _squared_gap(placed: FloatArray, j: int, x: float, y: float, half: float) -> float:
    """m2, between the square at time `j` of its way and the point (x, y)."""
    dx, dy = x - placed[0, j], y - placed[1, j]
    c, s = placed[2, j], placed[3, j]
    ahead = max(abs(c * dx + s * dy) - half, 0.0)
    aside = max(abs(c * dy - s * dx) - half, 0.0)
    squared: float = ahead * ahead + aside * aside
    return squared
