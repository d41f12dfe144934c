"""Which ways lead on, as far as one scan shows: straight ones here, others in `search`.

Only standing obstacles count here; what moves is left to the roll-outs.
"""

from dataclasses import dataclass
from math import cos, floor, sqrt

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.grid import CELL, Grid
from fuzzynav_mj.planners.reach import free_distance, free_on_rays
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

SPACING = 0.05  # hits are thinned out to this spacing along an outline, per metre of distance


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """One scan's standing surroundings, robot-centred, axes parallel to the world's.

    Attributes:
        points: (k, 2) thinned hits of standing obstacles, m.
        bearings: (n,) directions of the rays, rad, world frame.
        ranges: (n,) m to the first standing obstacle; the sensor's range where there is none.
        max_range: m.
        hidden: (n,) True for rays that a mover stops.
    """

    points: FloatArray
    bearings: FloatArray
    ranges: FloatArray
    max_range: float
    hidden: BoolArray

    def is_hidden(self, bearing: float, beside: float) -> bool:
        """True if a mover stops a ray less than `beside` off a bearing, both rad."""
        off = np.cos(self.bearings[self.hidden] - bearing)
        return bool((off > cos(beside)).any())


@dataclass(frozen=True, slots=True, eq=False)
class Ways:
    """Ways to the edge of sight, one for each ray direction.

    Attributes:
        open: (n,) True where a way leads on at that bearing.
        length: (n,) length of the way to `end`, m; inf where not open.
        end: (n, 2) where the way leaves what is seen, robot-centred.
        comfortable: (n,) True where the way keeps the comfortable width all along.
        searched: (n,) True where the way is not straight but found by `search`.
        search: the search, if one was made.
    """

    open: BoolArray
    length: FloatArray
    end: FloatArray
    comfortable: BoolArray
    searched: BoolArray
    search: "Search | None" = None

    def first_point(self, ray: int) -> FloatArray:
        """(2,) the point to head for first, in a straight line, on the way at this ray."""
        if self.search is not None and self.searched[ray]:
            return self.search.first_point(ray)
        point: FloatArray = self.end[ray]
        return point


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """A shortest-path search over the cells in sight.

    Attributes:
        grid: its cells.
        before: (cells,) the cell before each on its way from the robot.
        target: (n,) the cell at the edge of sight for each ray, -1 where there is none.
        points: (k, 2) the obstacles' points that it kept clear of.
        width: by this much, m.
    """

    grid: Grid
    before: IntArray
    target: IntArray
    points: FloatArray
    width: float

    def first_point(self, ray: int) -> FloatArray:
        """(2,) the farthest point of the way to the ray's cell that a straight line reaches."""
        chain = self.grid.chain(self.before, int(self.target[ray]))
        if not chain:
            return np.zeros(2)
        x, y = self.grid.x[chain], self.grid.y[chain]
        free = free_distance(self.points, np.arctan2(y, x), self.width - 0.25 * CELL)
        straight = np.flatnonzero(free >= np.hypot(x, y) - self.width)
        best = int(straight[0]) if len(straight) else len(chain) - 1
        return np.array([x[best], y[best]])


def straight_ways(sight: Sight, comfortable: float, tight: float, penalty: float) -> Ways:
    """Straight ways to the edge of sight, and to where one obstacle hides what is behind it.

    For each bearing the shorter one of two: of comfortable half width, or of a tight one, burdened
    with a penalty (m).
    """
    is_open, length, end, roomy = _straight(
        sight.points,
        sight.bearings,
        sight.ranges,
        sight.max_range,
        np.array([comfortable, tight]),
        penalty,
    )
    return Ways(is_open, length, end, roomy, np.zeros(len(is_open), dtype=bool))


@compiled
def _straight(
    points: FloatArray,
    bearings: FloatArray,
    ranges: FloatArray,
    max_range: float,
    widths: FloatArray,
    penalty: float,
) -> tuple[BoolArray, FloatArray, FloatArray, BoolArray]:
    """(n,), (n,), (n, 2) and (n,): `open`, `length`, `end` and `comfortable` of `Ways`; `widths`
    (2,) are the comfortable one and the tight one."""
    count = len(bearings)
    c, s = np.cos(bearings), np.sin(bearings)
    free = free_on_rays(points, c, s, bearings[0], widths)
    is_open, roomy = np.zeros(count, dtype=np.bool_), np.zeros(count, dtype=np.bool_)
    length, end = np.full(count, np.inf), np.empty((count, 2))
    for i in range(count):
        nearer = min(ranges[i - 1], ranges[i + 1 - count])
        for w in range(2):
            width, burden = widths[w], w * penalty
            reach = 0.0
            if ranges[i] >= max_range - 1e-9:
                reach = max_range
            elif ranges[i] - nearer >= 2 * width:
                # Past the nearer ray beside it into what that one's obstacle hides.
                reach = max(min(nearer + width, ranges[i] - width), 0.0)
            leads_on = reach > 0.0 and free[w, i] >= min(reach, max_range - width)
            if leads_on:
                is_open[i] = True
            better = leads_on and reach + burden < length[i]
            if better:
                length[i] = reach + burden
                roomy[i] = w == 0
            if better or w == 0:
                end[i] = reach * c[i], reach * s[i]
    return is_open, length, end, roomy


def either(first: Ways, second: Ways, penalty: float) -> Ways:
    """For each bearing the shorter way, the second one burdened with a penalty (m)."""
    is_open, length, end, comfortable, searched = _either(
        first.open, first.length, first.end, first.comfortable, first.searched,
        second.open, second.length, second.end, second.searched, penalty,
    )  # fmt: skip
    return Ways(is_open, length, end, comfortable, searched, second.search or first.search)


@compiled
def _either(
    first_open: BoolArray,
    first_length: FloatArray,
    first_end: FloatArray,
    first_comfortable: BoolArray,
    first_searched: BoolArray,
    second_open: BoolArray,
    second_length: FloatArray,
    second_end: FloatArray,
    second_searched: BoolArray,
    penalty: float,
) -> tuple[BoolArray, FloatArray, FloatArray, BoolArray, BoolArray]:
    """The fields of `either`'s ways, (n,) or (n, 2) each, from those of the two."""
    length, end = first_length.copy(), first_end.copy()
    comfortable, searched = first_comfortable.copy(), first_searched.copy()
    for i in range(len(length)):
        if second_length[i] + penalty < length[i]:
            length[i], end[i] = second_length[i] + penalty, second_end[i]
            comfortable[i], searched[i] = False, second_searched[i]
    return first_open | second_open, length, end, comfortable, searched


@compiled
def range_jumps(ranges: FloatArray, width: float) -> tuple[BoolArray, FloatArray]:
    """(n,) True for rays that pass an obstacle's end: one beside them is shorter by the width that
    the robot needs; and (n,) the range of that one, m."""
    count = len(ranges)
    jump, nearer = np.empty(count, dtype=np.bool_), np.empty(count)
    for i in range(count):
        nearer[i] = min(ranges[i - 1], ranges[i + 1 - count])
        jump[i] = ranges[i] - nearer[i] >= 2 * width
    return jump, nearer


def thin(
    points: FloatArray, spacing: float = SPACING, place: tuple[float, float] = (0.0, 0.0)
) -> FloatArray:
    """Thins out hits (k, 2), in ray order, and centres them on the robot at `place`: densely kept
    near the robot, where a missing corner would matter, and ever more sparsely farther away."""
    return thin_around(np.ascontiguousarray(points), spacing, place)


@compiled
def thin_around(points: FloatArray, spacing: float, place: tuple[float, float]) -> FloatArray:
    """See `thin`. The first and the last point stay, and the last before each whole spacing."""
    kept = np.empty_like(points)
    count, last, way, before = 0, len(points) - 1, 0.0, 0.0
    for k in range(len(points)):
        x, y = points[k, 0] - place[0], points[k, 1] - place[1]
        after = before
        if k < last:
            next_x, next_y = points[k + 1, 0] - place[0], points[k + 1, 1] - place[1]
            step = sqrt((next_x - x) ** 2 + (next_y - y) ** 2)
            way += step / (spacing * max(sqrt(next_x**2 + next_y**2), 0.1))
            after = floor(way)
        if k == 0 or k == last or after != before:
            kept[count] = x, y
            count += 1
        before = after
    return kept[:count].copy()
