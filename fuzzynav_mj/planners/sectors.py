"""The six fuzzy inputs at a next position: distances to the nearest obstacle in each sector.

Every obstacle counts once, in the sector of its nearest point. Sectors are taken about the
direction of travel: front within 45 degrees of it, left and right the rest up to straight behind.
Of more than three static (or dynamic) obstacles the nearest three count, as in the paper.
"""

from math import pi

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
    ranked = sorted(obstacles, key=lambda o: o.distance)
    chosen = [o for o in ranked if not o.dynamic][:3] + [o for o in ranked if o.dynamic][:3]
    if not chosen:
        return inputs
    offsets = np.array([_nearest_offset(places, o, ahead) for o in chosen])
    dx, dy = offsets.T  # (m, obstacles) each
    distance = np.sqrt(dx**2 + dy**2)
    bearing = (np.arctan2(dy, dx) - travel[:, None] + pi) % (2 * pi) - pi
    side = np.where(np.abs(bearing) <= FRONT, 1, np.where(bearing > 0, 0, 2))
    column = side + np.array([3 if o.dynamic else 0 for o in chosen])
    seen = np.where(distance < max_range, distance, CLEAR)
    np.minimum.at(inputs, (np.arange(len(places))[:, None], column), seen)
    return inputs


def _nearest_offset(places: FloatArray, obstacle: PerceivedObstacle, ahead: float) -> FloatArray:
    """(m, 2) from each place to the obstacle's point nearest to it, `ahead` seconds on."""
    x, y = obstacle.points.T
    if obstacle.dynamic:
        vx, vy = obstacle.velocity.tolist()
        x, y = x + vx * ahead, y + vy * ahead
    dx, dy = x - places[:, :1], y - places[:, 1:]
    nearest = (dx**2 + dy**2).argmin(axis=1)
    return np.array((x.take(nearest), y.take(nearest))).T - places


def as_fuzzy_inputs(row: FloatArray) -> FuzzyInputs:
    """The record of one row of `sector_distances`."""
    return FuzzyInputs(*(float(value) for value in row))
