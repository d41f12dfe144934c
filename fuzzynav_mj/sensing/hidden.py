"""The part of a known mover that something nearer hides."""

from math import hypot, pi

import numpy as np

from fuzzynav_mj.bearings import nearest_ray
from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.types import FloatArray

IN_FRONT = 0.03  # m: what hides a point of a mover that is partly in sight is nearer by as much
SEEN_THROUGH = 0.05  # m: a ray that reaches this much farther shows that a place is free


@compiled
def hidden_part(
    points: FloatArray, look: Look, max_range: float, unseen: bool
) -> tuple[FloatArray, int]:
    """(k, 2) those of the points (2, n), world frame, that something nearer hides, and the number
    of those whose place is seen to be free.

    Where none of the mover is in sight it may also be inside of what is seen: movers pass through
    each other, and come out again.
    """
    in_front = -SEEN_THROUGH if unseen else IN_FRONT
    rays = len(look.ranges)
    found, count, free = np.empty((points.shape[1], 2)), 0, 0
    for i in range(points.shape[1]):
        dx, dy = points[0, i] - look.x, points[1, i] - look.y
        distance = hypot(dx, dy)
        if distance >= max_range:
            continue
        ray = nearest_ray(dx, dy, look.yaw - pi, rays)
        if look.ranges[ray] < distance - in_front:
            found[count, 0], found[count, 1] = points[0, i], points[1, i]
            count += 1
        elif look.ranges[ray] > distance + SEEN_THROUGH:
            free += 1
    return found[:count].copy(), free
