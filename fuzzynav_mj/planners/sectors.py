"""The six fuzzy inputs at a next position: distances to the nearest obstacle in each sector.

Every obstacle counts once, in the sector of its nearest point. Sectors are taken about the
direction of travel: front within 45 degrees of it, left and right the rest up to straight behind.
Of more than three static (or dynamic) obstacles the nearest three count, as in the paper.
"""

from math import atan2, pi, sqrt

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import FloatArray, FuzzyInputs, IntArray, PerceivedObstacle

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
    ranked = sorted(obstacles, key=lambda o: o.distance)
    standing = [o for o in ranked if not o.dynamic][:3]
    chosen = standing + [o for o in ranked if o.dynamic][:3]
    if not chosen:
        return np.full((len(places), 6), CLEAR)
    points = np.ascontiguousarray(np.concatenate([o.points for o in chosen]))
    velocities = np.concatenate([o.velocity for o in chosen])
    sizes = np.array([len(o.points) for o in chosen])
    return _distances(places, travel, points, sizes, len(standing), velocities, ahead, max_range)


@compiled
def _distances(
    places: FloatArray,
    travel: FloatArray,
    points: FloatArray,
    sizes: IntArray,
    standing: int,
    velocities: FloatArray,
    ahead: float,
    max_range: float,
) -> FloatArray:
    """(m, 6) of `sector_distances`.

    Args:
        places, travel: (m, 2) and (m,).
        points: (k, 2) of all obstacles, one after the other.
        sizes: (obstacles,) number of points of each.
        standing: so many stand; the others, which follow, move.
        velocities: (2 * obstacles,) vx and vy of each, m/s.
        ahead, max_range: s and m.
    """
    inputs = np.full((len(places), 6), CLEAR)
    for m in range(len(places)):
        first = 0
        for o in range(len(sizes)):
            x, y = places[m, 0], places[m, 1]
            moves = o >= standing
            if moves:
                x, y = x - velocities[2 * o] * ahead, y - velocities[2 * o + 1] * ahead
            dx, dy, nearest = 0.0, 0.0, np.inf
            for k in range(first, first + sizes[o]):
                squared = (points[k, 0] - x) ** 2 + (points[k, 1] - y) ** 2
                if squared < nearest:
                    dx, dy, nearest = points[k, 0] - x, points[k, 1] - y, squared
            first += sizes[o]
            bearing = (atan2(dy, dx) - travel[m] + pi) % (2 * pi) - pi
            side = 1 if abs(bearing) <= FRONT else (0 if bearing > 0.0 else 2)
            column = side + (3 if moves else 0)
            if nearest < max_range**2:
                inputs[m, column] = min(inputs[m, column], sqrt(nearest))
    return inputs


def as_fuzzy_inputs(row: FloatArray) -> FuzzyInputs:
    """The record of one row of `sector_distances`."""
    return FuzzyInputs(*row.tolist())
