"""The parts of what is seen that belong to one body each, as far as its outline tells."""

from math import hypot

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

POCKET = 0.35  # sine of the turn in a corner that points away from the sensor, and parts an outline


@compiled
def convex_parts(points: FloatArray, joined: BoolArray) -> IntArray:
    """(k,) the number of the part of an outline that each of its hits is of: one ends where it is
    not joined, and in a corner that points away from the sensor, as between two bodies."""
    count = len(joined)
    turn = np.zeros(count + 2)  # the sine of the turn at each hit
    for k in range(1, count - 1):
        if joined[k - 1] and joined[k]:
            x, y = points[0, k] - points[0, k - 1], points[1, k] - points[1, k - 1]
            on_x, on_y = points[0, k + 1] - points[0, k], points[1, k + 1] - points[1, k]
            turn[k] = (x * on_y - y * on_x) / max(hypot(x, y) * hypot(on_x, on_y), 1e-12)
    part, number = np.zeros(count, dtype=np.intp), 0
    for k in range(count):
        part[k] = number
        # A corner lies between two hits, and both turn a little.
        here = turn[k] + turn[k + 1]
        before = turn[k - 1] + turn[k] if k > 0 else 0.0
        pocket = here > max(POCKET, before) and here >= turn[k + 1] + turn[k + 2]
        number += pocket or not joined[k]
    return part
