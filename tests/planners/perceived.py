"""What a perception of hand-made obstacles would be."""

import numpy as np
import numpy.typing as npt

from fuzzynav_mj.types import PerceivedObstacle


def standing(points: npt.ArrayLike) -> PerceivedObstacle:
    """An obstacle that stands at `points` (k, 2), seen by a robot at the origin that faces +x."""
    return mover(points, (0.0, 0.0), dynamic=False)


def mover(
    points: npt.ArrayLike,
    velocity: npt.ArrayLike,
    turn_rate: float = 0.0,
    closing_sigma: float = 0.0,
    dynamic: bool = True,
    drift_sigma: float = 0.0,
    unsure: npt.ArrayLike = (0.0, 0.0),
) -> PerceivedObstacle:
    """An obstacle that moves, seen by a robot at the origin that faces +x."""
    spots, speed = np.array(points, dtype=float), np.array(velocity, dtype=float)
    nearest = spots[np.hypot(*spots.T).argmin()]
    return PerceivedObstacle(
        points=spots,
        nearest_point=nearest,
        distance=float(np.hypot(*nearest)),
        bearing=float(np.arctan2(nearest[1], nearest[0])),
        dynamic=dynamic,
        approaching=dynamic and bool(speed @ nearest < 0.0),
        velocity=speed,
        turn_rate=turn_rate,
        closing_sigma=closing_sigma,
        drift_sigma=drift_sigma,
        unsure=np.array(unsure, dtype=float),
    )
