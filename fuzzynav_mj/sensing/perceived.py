"""What is told of an obstacle, from its points and its track."""

from math import atan2, hypot, pi

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.tracking import Track
from fuzzynav_mj.types import FloatArray, PerceivedObstacle


def perceived(
    points: FloatArray, now: Look, track: Track | None, noise: float
) -> PerceivedObstacle:
    """An obstacle of these points (k, 2), seen with ranges of this much noise, m."""
    nearest = points[_nearest(points, now.x, now.y)]
    x, y = nearest.tolist()
    x, y = x - now.x, y - now.y
    distance = hypot(x, y)
    bearing = (atan2(y, x) - now.yaw + pi) % (2 * pi) - pi
    if track is None:
        return PerceivedObstacle(
            points=points,
            nearest_point=nearest,
            distance=distance,
            bearing=bearing,
            dynamic=False,
            approaching=False,
            velocity=np.zeros(2),
        )
    velocity, reach = track.velocity, max(distance, 1e-9)
    return PerceivedObstacle(
        points=points,
        nearest_point=nearest,
        distance=distance,
        bearing=bearing,
        dynamic=True,
        approaching=float(velocity[0] * x + velocity[1] * y) < 0.0,
        velocity=velocity,
        turn_rate=track.turn_rate,
        closing_sigma=track.sigma_along(x / reach, y / reach),
        drift_sigma=_across(track) if noise > 0.0 else 0.0,
        unsure=track.least_known if noise > 0.0 else np.zeros(2),
    )


def _across(track: Track) -> float:
    """Uncertainty of a mover's speed across its direction, m/s."""
    vx, vy = track.velocity.tolist()
    speed = max(hypot(vx, vy), 1e-9)
    return track.sigma_along(-vy / speed, vx / speed)


@compiled
def _nearest(points: FloatArray, x: float, y: float) -> int:
    """Number of the point (k, 2) nearest to a place."""
    found, smallest = 0, np.inf
    for k in range(len(points)):
        dx, dy = points[k, 0] - x, points[k, 1] - y
        if dx * dx + dy * dy < smallest:
            found, smallest = k, dx * dx + dy * dy
    return found
