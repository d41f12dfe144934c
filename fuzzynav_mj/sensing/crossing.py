"""Whether a mover's outline, at another time, would lie across rays that went by unhindered."""

from math import ceil, floor, pi, sqrt

import numpy as np

from fuzzynav_mj.bearings import bearing_of
from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.outline import Outline
from fuzzynav_mj.sensing.velocity_filter import gone_since
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray


@compiled
def first_across(
    outline: Outline,
    state: FloatArray,
    tried: FloatArray,
    left_out: BoolArray,
    look: Look,
    margin: float,
    begin: int = 0,
) -> IntArray:
    """(h,) for each motion the hit that begins the first piece of an outline which, at the time
    of a look, would lie across rays that went by; -1 for none.

    Args:
        outline: at its own time.
        state: (6,) of its mover, as in velocity_filter.py, at the later one of the two times.
        tried: (h, 4) velocities, m/s, and accelerations, m/s2, that the mover has in addition.
        left_out: (h,) True for those that are not tried.
        look: what the rays saw.
        margin: by how much farther a ray must have reached, m.
        begin: the hit from which on pieces count.
    """
    points, joined, ranges, count = outline.points, outline.joined, look.ranges, len(look.ranges)
    found = np.full(len(tried), -1)
    elapsed = look.stamp - outline.stamp
    gone_x, gone_y = gone_since(state, abs(elapsed))
    sign = -1.0 if elapsed < 0.0 else 1.0
    x, y = sign * gone_x - look.x, sign * gone_y - look.y
    # Where all of the outline was out of reach, no ray can tell.
    middle_x, middle_y = points[0].mean(), points[1].mean()
    squared = (points[0] - middle_x) ** 2 + (points[1] - middle_y) ** 2
    reach = ranges.max() + sqrt(squared.max())
    per_radian = count / (2 * pi)
    # One loop over all: a call for each would cost more than what it does.
    for h in range(len(tried)):
        if left_out[h]:
            continue
        more_x, more_y = gone_since(tried[h], abs(elapsed))
        at_x, at_y = x + sign * more_x, y + sign * more_y
        if (middle_x + at_x) ** 2 + (middle_y + at_y) ** 2 > reach**2:
            continue
        ax = ay = before = 0.0
        for k in range(begin, len(joined)):
            bx, by = points[0, k] + at_x, points[1, k] + at_y
            after = (bearing_of(bx, by) - look.yaw + pi) * per_radian
            across = False
            if k > begin and joined[k - 1]:
                # A piece spans less than half a turn.
                first = before + count if after - before > count / 2 else before
                last = after + count if before - after > count / 2 else after
                for i in range(ceil(min(first, last)), floor(max(first, last)) + 1):
                    ray = i % count
                    ray_x, ray_y = look.points[0, ray] - look.x, look.points[1, ray] - look.y
                    area = ray_x * (by - ay) - ray_y * (bx - ax)
                    if area != 0.0:
                        share = (ax * by - ay * bx) / area  # of the ray, up to the piece
                        across = across or 0.0 < share < 1.0 - margin / ranges[ray]
            if across:
                found[h] = k - 1
                break
            ax, ay, before = bx, by, after
    return found


@compiled
def pieces_across(outline: Outline, state: FloatArray, look: Look, margin: float) -> BoolArray:
    """(k,) True for the hits of an outline that begin a piece which would lie across rays that went
    by it; the arguments are those of `first_across`."""
    found, tried = np.zeros(len(outline.joined), dtype=np.bool_), np.zeros((1, 4))
    left_out, begin = np.zeros(1, dtype=np.bool_), 0
    while begin < len(found):
        piece = first_across(outline, state, tried, left_out, look, margin, begin)[0]
        if piece < 0:
            break
        found[piece], begin = True, piece + 1
    return found
