"""The six fuzzy inputs at a next position: distances to the nearest obstacle in each sector.

Every obstacle counts once, in the sector of its nearest point. Sectors are taken about the
direction of travel: front within 45 degrees of it, left and right the rest up to straight behind.
Of more than three static (or dynamic) obstacles the nearest three count, as in the paper.
"""

from math import hypot, pi

import numpy as np

from fuzzynav_mj.types import FloatArray, FuzzyInputs, PerceivedObstacle

CLEAR = 1.0  # the reading where nothing is in range
FRONT = pi / 4


def sector_distances(
    places: FloatArray,
    travel: FloatArray,
    obstacles: tuple[PerceivedObstacle, ...],
    ahead: float,
    max_range: float,
) -> FloatArray:
    """(m, 6) columns LS, FS, RS, LD, FD, RD, in m.

    Args:
        places: (m, 2) next positions, world frame.
        travel: (m,) direction of travel at each, rad, world frame.
        obstacles: what is perceived now; moving ones are carried `ahead` seconds on.
        ahead: time until the next position is due, s.
        max_range: beyond this an obstacle is out of range.
    """
    inputs = np.full((len(places), 6), CLEAR)
    for first_column, dynamic in ((0, False), (3, True)):
        chosen = sorted((o for o in obstacles if o.dynamic == dynamic), key=lambda o: o.distance)
        for obstacle in chosen[:3]:
            points = obstacle.points + obstacle.velocity * ahead
            offset = points[None] - places[:, None]
            squared = offset[..., 0] ** 2 + offset[..., 1] ** 2
            nearest = squared.argmin(axis=1)
            rows = np.arange(len(places))
            distance = np.sqrt(squared[rows, nearest])
            near = offset[rows, nearest]
            bearing = (np.arctan2(near[:, 1], near[:, 0]) - travel + pi) % (2 * pi) - pi
            side = np.where(np.abs(bearing) <= FRONT, 1, np.where(bearing > 0, 0, 2))
            column = first_column + side
            seen = np.where(distance < max_range, distance, CLEAR)
            inputs[rows, column] = np.minimum(inputs[rows, column], seen)
    return inputs


def as_fuzzy_inputs(row: FloatArray) -> FuzzyInputs:
    """The record of one row of `sector_distances`."""
    return FuzzyInputs(*(float(value) for value in row))


def travel_direction(start: tuple[float, float], end: FloatArray, yaw: float) -> float:
    """Direction from `start` to `end`; the heading where the two coincide."""
    dx, dy = float(end[0]) - start[0], float(end[1]) - start[1]
    return yaw if hypot(dx, dy) < 1e-6 else float(np.arctan2(dy, dx))
