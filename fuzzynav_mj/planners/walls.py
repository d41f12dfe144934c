"""Straight walls in sight, and how they are thought to go on beyond it.

A wall that is straight up to the edge of sight seldom ends just there. Where it would cut off the
line to the goal, the way is taken to lead along it: a robot in a corridor then drives on in it, and
not across it to the wall on the goal's side. And where two walls would soon meet, they are taken
to: a corner need not be seen to the last ray to be known as closed.
"""

from dataclasses import replace
from math import atan2, cos, hypot, pi, sin
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.reach import range_of_line
from fuzzynav_mj.planners.sight import Sight
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

STRAIGHT = 0.015  # m: largest deviation of a hit from the line through a wall's ends
SHORTEST = 0.15  # m of a wall that tell its direction
FEWEST = 4  # hits that do
PARTED = 0.26  # m: a larger difference between neighbouring ranges parts walls
LARGEST_TURN = pi / 3  # rad: by which a wall may change the direction of a way
LEAST_ALONG = 0.5  # cosine of the largest angle between the goal and a wall that leads to it
SLANT = 0.5  # sine of the smallest angle at which walls make a corner
JUST_BEYOND = 0.02  # m: nearer to the edge of sight a wall's end may well be missed by the rays


class Walls(NamedTuple):
    """k straight walls, each from one end to the other in the order of the rays.

    Attributes:
        ends: (k, 4) x and y of the first and the last hit, robot-centred, m.
        rays: (k, 2) the rays of those hits.
        runs_on: (k, 2) True for ends that are not seen: the wall leaves sight there, or something
            hides the rest of it.
    """

    ends: FloatArray
    rays: IntArray
    runs_on: BoolArray


def walls_in_sight(sight: Sight) -> Walls:
    """The walls that are long enough to tell their direction."""
    return _walls(sight.ranges, sight.bearings, sight.max_range, sight.hidden)


@compiled
def _walls(ranges: FloatArray, bearings: FloatArray, max_range: float, hidden: BoolArray) -> Walls:
    """See `walls_in_sight`; ranges, bearings and `hidden` (n,) as in `Sight`."""
    count = len(ranges)
    x, y = ranges * np.cos(bearings), ranges * np.sin(bearings)
    hit = ranges < max_range - 1e-9
    found = 0
    ends, rays = np.empty((count, 4)), np.empty((count, 2), dtype=np.intp)
    runs_on = np.empty((count, 2), dtype=np.bool_)
    start = 0  # where no wall goes through the first ray
    while start < count and hit[start] and abs(ranges[start] - ranges[start - 1]) <= PARTED:
        start += 1
    k = 0
    while k < count:
        first = (start + k) % count
        if not hit[first]:
            k += 1
            continue
        steps = 0
        while k + steps + 1 < count:
            there = (first + steps + 1) % count
            if not hit[there] or abs(ranges[there] - ranges[there - 1]) > PARTED:
                break
            if not _is_straight(x, y, first, steps + 1):
                break
            steps += 1
        last = (first + steps) % count
        if steps + 1 >= FEWEST and hypot(x[last] - x[first], y[last] - y[first]) >= SHORTEST:
            ends[found] = x[first], y[first], x[last], y[last]
            rays[found] = first, last
            for end in range(2):
                ray = (last + 1) % count if end else first - 1
                meets = _range_on(ends[found], bearings[ray])
                seen_beyond = ranges[ray] < max_range - 1e-9 or meets < max_range - JUST_BEYOND
                runs_on[found, end] = hidden[ray] or not seen_beyond
            found += 1
        k += max(steps, 1)
    return Walls(ends[:found].copy(), rays[:found].copy(), runs_on[:found].copy())


@compiled
def _is_straight(x: FloatArray, y: FloatArray, first: int, steps: int) -> bool:
    """True if the hits (n,) from `first` on, so many steps far, lie on the line through both
    ends."""
    count = len(x)
    last = (first + steps) % count
    along_x, along_y = x[last] - x[first], y[last] - y[first]
    most = STRAIGHT * hypot(along_x, along_y)
    for k in range(1, steps):
        i = (first + k) % count
        if abs(along_x * (y[i] - y[first]) - along_y * (x[i] - x[first])) > most:
            return False
    return True


@compiled
def _range_on(wall: FloatArray, bearing: float) -> float:
    """Range at which a ray meets the line through a wall's ends (4,), m; inf if it does not."""
    x, y = wall[0], wall[1]
    meets = range_of_line(x, y, wall[2] - x, wall[3] - y, cos(bearing), sin(bearing))
    return meets if meets > 0.0 else np.inf


def corners_closed(sight: Sight, walls: Walls, reach: float) -> Sight:
    """The sight with the corners of walls that would meet, each within `reach` (m) of its end."""
    ranges, points = _closed(walls, sight.ranges, sight.bearings, sight.max_range, reach)
    if len(points) == 0:
        return sight
    return replace(sight, ranges=ranges, points=np.concatenate((sight.points, points)))


@compiled
def _closed(
    walls: Walls, ranges: FloatArray, bearings: FloatArray, max_range: float, reach: float
) -> tuple[FloatArray, FloatArray]:
    """(n,) ranges that end at the corners found, still within sight, and (j, 2) their points."""
    count, closed = len(ranges), ranges.copy()
    points, found = np.empty((count, 2)), 0
    for k in range(len(walls.ends)):
        after = (k + 1) % len(walls.ends)
        one, other = walls.ends[k], walls.ends[after]
        first = walls.rays[k, 1] + 1
        between = (walls.rays[after, 0] - first) % count
        if not walls.runs_on[k, 1] or not walls.runs_on[after, 0]:
            continue
        if not _meet(one, other, reach):
            continue
        all_open = True
        for step in range(between):
            all_open = all_open and ranges[(first + step) % count] >= max_range - 1e-9
        if not all_open:
            continue
        for step in range(between):
            ray = (first + step) % count
            far = min(_range_on(one, bearings[ray]), _range_on(other, bearings[ray]))
            points[found] = far * cos(bearings[ray]), far * sin(bearings[ray])
            closed[ray] = max_range - 1e-6
            found += 1
    return closed, points[:found].copy()


@compiled
def _meet(one: FloatArray, other: FloatArray, reach: float) -> bool:
    """True if the last end of a wall (4,) and the first one of the next, each carried on by no more
    than `reach`, meet at an angle."""
    along_x, along_y = one[2] - one[0], one[3] - one[1]
    back_x, back_y = other[0] - other[2], other[1] - other[3]
    span, length = hypot(along_x, along_y), hypot(back_x, back_y)
    cross = (along_x * back_y - along_y * back_x) / (span * length)
    if abs(cross) < SLANT:
        return False
    gap_x, gap_y = other[0] - one[2], other[1] - one[3]
    by_one = (gap_x * back_y - gap_y * back_x) / (length * cross)
    by_other = (gap_x * along_y - gap_y * along_x) / (span * cross)
    meet: bool = min(by_one, by_other) >= 0.0 and max(by_one, by_other) <= reach
    return meet


@compiled
def led_along(
    chosen: int,
    bearings: FloatArray,
    is_open: BoolArray,
    end: FloatArray,
    goal: FloatArray,
    walls: Walls,
    onward: float,
    berth: float,
) -> int:
    """The way to take for the one chosen: where a wall that runs on lies between that one's end and
    the goal, the way beside it that leads to where the wall may end.

    Args:
        chosen: ray of the way chosen.
        bearings, is_open: (n,) of the rays, and whether a straight way leads on there.
        end: (2,) of the way chosen, m.
        goal: (2,) m.
        walls: in sight.
        onward: length by which a wall is thought to go on, m.
        berth: kept to a wall's end, m.
    """
    count, steps = len(bearings), 0
    c, s = cos(bearings[chosen]), sin(bearings[chosen])
    for k in range(len(walls.ends)):
        # The end on whose side of the wall the way leads.
        first_x, first_y, last_x, last_y = walls.ends[k]
        onto = c * (last_x - first_x) + s * (last_y - first_y) > 0.0
        if not walls.runs_on[k, 1 if onto else 0]:
            continue
        x, y = (first_x, first_y) if onto else (last_x, last_y)
        tip_x, tip_y = (last_x, last_y) if onto else (first_x, first_y)
        length = hypot(tip_x - x, tip_y - y)
        along_x, along_y = (tip_x - x) / length, (tip_y - y) / length
        if along_x * goal[0] + along_y * goal[1] < LEAST_ALONG * hypot(goal[0], goal[1]):
            continue
        tip_x, tip_y = tip_x + onward * along_x, tip_y + onward * along_y
        here = along_x * (end[1] - y) - along_y * (end[0] - x)
        there = along_x * (goal[1] - y) - along_y * (goal[0] - x)
        if here * there >= 0.0:
            continue
        # Where the line to the goal meets the wall, as a length along it.
        share = here / (here - there)
        at = along_x * (end[0] - x) + along_y * (end[1] - y)
        at += share * (along_x * (goal[0] - end[0]) + along_y * (goal[1] - end[1]))
        if not 0.0 <= at <= length + onward:
            continue
        aside = berth if here > 0.0 else -berth
        turn = atan2(tip_y + aside * along_x, tip_x - aside * along_y) - bearings[chosen]
        turn = (turn + pi) % (2 * pi) - pi
        if abs(turn) <= LARGEST_TURN and abs(turn) * count / (2 * pi) > abs(steps):
            steps = round(turn * count / (2 * pi))
    ray, way = chosen, 1 if steps > 0 else -1
    for _ in range(abs(steps)):
        if not is_open[(ray + way) % count]:
            break
        ray = (ray + way) % count
    return ray
