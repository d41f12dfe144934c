"""Which ways lead on, as far as one scan shows: free directions and the ways to the edge of sight.

Only standing obstacles count here; what moves is left to the roll-outs.
"""

from dataclasses import dataclass
from math import floor, pi, sqrt

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.grid import CELL, Grid, grid_around, note_nearest
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
        hidden: (n,) True for rays that a mover stops; None where there is none.
    """

    points: FloatArray
    bearings: FloatArray
    ranges: FloatArray
    max_range: float
    hidden: BoolArray | None = None


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


def straight_ways(sight: Sight, widths: tuple[float, ...]) -> list[Ways]:
    """Straight ways to the edge of sight, and to where one obstacle hides what is behind it, for
    each of several widths."""
    is_open, length, end = _straight(
        sight.points, sight.bearings, sight.ranges, sight.max_range, np.array(widths)
    )
    nowhere = np.zeros(len(sight.bearings), dtype=bool)
    return [Ways(is_open[w], length[w], end[w], is_open[w], nowhere) for w in range(len(widths))]


@compiled
def _straight(
    points: FloatArray,
    bearings: FloatArray,
    ranges: FloatArray,
    max_range: float,
    widths: FloatArray,
) -> tuple[BoolArray, FloatArray, FloatArray]:
    """(w, n), (w, n) and (w, n, 2): `Ways.open`, `Ways.length` and `Ways.end` for each width."""
    count = len(bearings)
    c, s = np.cos(bearings), np.sin(bearings)
    free = free_on_rays(points, c, s, bearings[0], widths)
    is_open = np.zeros((len(widths), count), dtype=np.bool_)
    length = np.full((len(widths), count), np.inf)
    end = np.zeros((len(widths), count, 2))
    for w in range(len(widths)):
        width = widths[w]
        jump, nearer = range_jumps(ranges, width)
        for i in range(count):
            reach = 0.0
            if ranges[i] >= max_range - 1e-9:
                reach = max_range
            elif jump[i]:
                # Past the nearer ray beside it into what that one's obstacle hides.
                reach = max(min(nearer[i] + width, ranges[i] - width), 0.0)
            end[w, i] = reach * c[i], reach * s[i]
            if reach > 0.0 and free[w, i] >= min(reach, max_range - width):
                is_open[w, i] = True
                length[w, i] = reach
    return is_open, length, end


def either(first: Ways, second: Ways, penalty: float) -> Ways:
    """For each bearing the shorter way, the second one burdened with a penalty."""
    better = second.length + penalty < first.length
    return Ways(
        first.open | second.open,
        np.where(better, second.length + penalty, first.length),
        np.where(better[:, None], second.end, first.end),
        first.comfortable & ~better,
        np.where(better, second.searched, first.searched),
        second.search or first.search,
    )


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


def searched_ways(sight: Sight, width: float, comfortable: float) -> Ways:
    """Ways found by a shortest-path search on a grid of the visible, unobstructed ground.

    No way comes closer than `width` to an obstacle, and the ground nearer than `comfortable`
    costs up to three times its length.
    """
    grid = grid_around(sight.max_range)
    turn = float(sight.bearings[0])
    toll, ray = _tolls(
        grid.axis, grid.distance, grid.bearing, sight.points, sight.ranges, turn, width, comfortable
    )
    cost, before = grid.cheapest(toll)
    target = _targets(
        cost, ray, grid.distance, sight.ranges, width, sight.max_range, sight.max_range - 1.5 * CELL
    )
    is_open = target >= 0
    length = np.full(len(target), np.inf)
    length[is_open] = grid.lengths(before, target[is_open])
    end = np.stack((grid.x.take(target), grid.y.take(target)), axis=1)
    search = Search(grid, before, target, sight.points, width)
    return Ways(is_open, length, end, np.zeros(len(target), dtype=bool), is_open, search)


@compiled
def _tolls(
    axis: FloatArray,
    distance: FloatArray,
    bearing: FloatArray,
    points: FloatArray,
    ranges: FloatArray,
    turn: float,
    width: float,
    comfortable: float,
) -> tuple[FloatArray, IntArray]:
    """(cells,) cost per metre of ground, inf where none may go, and (cells,) the ray to each cell.

    Args:
        axis: (n,) coordinates of the cells in a row of the grid, m.
        distance, bearing: (cells,) of each from the robot's own.
        points: (k, 2) of what stands.
        ranges: (rays,) evenly spaced, the first one at the bearing `turn`.
        width: that must be kept clear, m.
        comfortable: up to here ground costs more, m.
    """
    size, count = len(axis), len(ranges)
    squared = np.full((size, size), comfortable**2)
    reach = int(comfortable / CELL) + 1
    for k in range(len(points)):
        note_nearest(squared, axis, points[k, 0], points[k, 1], reach)
    gap = np.sqrt(squared).ravel()
    toll, ray = np.full(size * size, np.inf), np.empty(size * size, dtype=np.intp)
    for cell in range(size * size):
        ray[cell] = floor((bearing[cell] - turn) * (count / (2 * pi)) + 0.5) % count
        room = gap[cell]
        free = distance[cell] <= ranges[ray[cell]] + 1e-9 and room >= width
        if free or distance[cell] < 1.5 * CELL:  # where the robot stands it may stand
            toll[cell] = 1.0 + 2.0 * min((comfortable - room) / (comfortable - width), 1.0)
    return toll, ray


@compiled
def _targets(
    cost: FloatArray,
    ray: IntArray,
    distance: FloatArray,
    ranges: FloatArray,
    width: float,
    max_range: float,
    rim: float,
) -> IntArray:
    """(rays,) the cell where the way at each ray ends, -1 for none.

    At the edge of sight, farther than `rim`, that is the cheapest cell on the ray's bearing; past
    an obstacle's end the nearest one behind it, from which more may be seen.

    Args:
        cost: (cells,) of the way to each cell, inf where there is none.
        ray: (cells,) the ray to each cell.
        distance: (cells,) from the robot's own, m.
        ranges: (rays,).
        width: that the robot needs, m.
        max_range: m.
        rim: m.
    """
    at_rim, behind = np.full(len(ranges), -1), np.full(len(ranges), -1)
    jump, nearer = range_jumps(ranges, width)
    for cell in range(len(cost)):
        i = ray[cell]
        if cost[cell] == np.inf:
            continue
        ends = ranges[i] >= max_range - 1e-9 and distance[cell] > rim
        if ends and (at_rim[i] < 0 or cost[cell] <= cost[at_rim[i]]):
            at_rim[i] = cell
        reveals = jump[i] and distance[cell] >= nearer[i] + width
        if reveals and (behind[i] < 0 or distance[cell] <= distance[behind[i]]):
            behind[i] = cell
    return np.where(at_rim < 0, behind, at_rim)


def thin(points: FloatArray, spacing: float = SPACING) -> FloatArray:
    """Thins out hits (k, 2), robot-centred and in ray order: densely kept near the robot, where a
    missing corner would matter, and ever more sparsely farther away."""
    return _thin(np.ascontiguousarray(points), spacing)


@compiled
def _thin(points: FloatArray, spacing: float) -> FloatArray:
    """See `thin`. The first and the last point stay, and the last before each whole spacing."""
    kept = np.empty_like(points)
    count, last, way, before = 0, len(points) - 1, 0.0, 0.0
    for k in range(len(points)):
        after = before
        if k < last:
            x, y = points[k + 1, 0], points[k + 1, 1]
            dx, dy = x - points[k, 0], y - points[k, 1]
            way += sqrt(dx**2 + dy**2) / (spacing * max(sqrt(x**2 + y**2), 0.1))
            after = floor(way)
        if k == 0 or k == last or after != before:
            kept[count] = points[k]
            count += 1
        before = after
    return kept[:count].copy()
