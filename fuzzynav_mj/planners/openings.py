"""What a look promises of the ways on both sides of what is in the way to the goal."""

from math import cos, hypot, inf, sin

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.sight import range_jumps
from fuzzynav_mj.types import BoolArray, FloatArray


@compiled
def promises(
    ranges: FloatArray,
    bearings: FloatArray,
    max_range: float,
    width: float,
    is_open: BoolArray,
    length: FloatArray,
    end: FloatArray,
    goal: FloatArray,
) -> tuple[float, float]:
    """Shortest way to the goal, m, by ground that a ray sees free and no straight way reaches; and
    by the ways that there are. Each inf where there is none."""
    promised = have = inf
    free = _sees_on(ranges, max_range, width)
    for i in range(len(ranges)):
        have = min(have, length[i] + hypot(end[i, 0] - goal[0], end[i, 1] - goal[1]))
        if not is_open[i] and free[i]:
            x, y = max_range * cos(bearings[i]), max_range * sin(bearings[i])
            promised = min(promised, max_range + hypot(x - goal[0], y - goal[1]))
    return promised, have


@compiled
def blind_ways(
    goal_ray: int, ranges: FloatArray, max_range: float, is_open: BoolArray
) -> BoolArray:
    """(n,) True for the ways on a side of the goal's direction on which the obstacle in the way
    runs on beyond sight: there may be no end to it.

    Args:
        goal_ray: the ray towards the goal.
        ranges: (n,) m.
        max_range: m.
        is_open: (n,) where ways lead on.
    """
    count = len(ranges)
    blind = np.zeros(count, dtype=np.bool_)
    if is_open[goal_ray]:
        return blind
    for side in (1, -1):
        hits = np.empty(count // 2, dtype=np.intp)  # how far from the goal's ray
        found = 0
        for step in range(count // 2):
            ray = (goal_ray + side * step) % count
            if is_open[ray]:
                break
            if ranges[ray] < max_range - 1e-9:
                hits[found] = step
                found += 1
        else:
            found = 0  # no way at all on this side
        if found == 0:
            continue
        last, before = hits[found - 1], hits[max(found - 4, 0)]
        farthest = ranges[(goal_ray + side * last) % count]
        rise = farthest - ranges[(goal_ray + side * before) % count]
        if found < 4 or farthest + 2.0 * rise / max(last - before, 1) > max_range:
            for step in range(count // 2):
                blind[(goal_ray + side * step) % count] = True
    return blind


@compiled
def shortest_way(
    goal_ray: int,
    ranges: FloatArray,
    max_range: float,
    is_open: BoolArray,
    length: FloatArray,
    end: FloatArray,
    goal: FloatArray,
    penalty: float,
) -> tuple[int, float]:
    """The open way that makes the shortest one to the goal, blind ways burdened with a penalty
    (m); and what is left from its end, m."""
    blind = blind_ways(goal_ray, ranges, max_range, is_open)
    best, shortest, remains = -1, inf, inf
    for i in range(len(length)):
        left_over = hypot(end[i, 0] - goal[0], end[i, 1] - goal[1])
        total = length[i] + left_over + penalty * blind[i]
        if total < shortest:
            best, shortest, remains = i, total, left_over
    return best, remains


@compiled
def gaining_way(
    wanted: BoolArray, length: FloatArray, end: FloatArray, goal: FloatArray, to_beat: float
) -> int:
    """Of the ways wanted (n,) that end nearer to the goal than `to_beat` (m) the one that makes the
    shortest way to it; -1 where there is none."""
    best, shortest = -1, inf
    for i in range(len(wanted)):
        left_over = hypot(end[i, 0] - goal[0], end[i, 1] - goal[1])
        if wanted[i] and left_over < to_beat and length[i] + left_over < shortest:
            best, shortest = i, length[i] + left_over
    return best


@compiled
def unreached_rays(
    beside: int,
    side: int,
    ranges: FloatArray,
    max_range: float,
    width: float,
    is_open: BoolArray,
) -> int:
    """By how many rays free ground that no straight way reaches comes before the first way, turning
    away from a boundary; all rays where there is no way.

    Args:
        beside: the ray on which the boundary is nearest.
        side: +1 or -1, on which the rays turn away from it.
        ranges: (n,) m.
        max_range: m.
        width: that the robot needs, m.
        is_open: (n,) where straight ways lead on.
    """
    count, seen = len(ranges), -1
    free = _sees_on(ranges, max_range, width)
    for k in range(count):
        ray = (beside + side * k) % count
        if is_open[ray]:
            return k - seen if seen >= 0 else 0
        if seen < 0 and free[ray]:
            seen = k
    return count if seen >= 0 else 0


@compiled
def _sees_on(ranges: FloatArray, max_range: float, width: float) -> BoolArray:
    """(n,) True for rays on which ground leads on: past an obstacle's end, or to the edge of
    sight."""
    jump, _ = range_jumps(ranges, width)
    sees: BoolArray = jump | (ranges >= max_range - 1e-9)
    return sees
