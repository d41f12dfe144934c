"""Which ways lead on, as far as one scan shows: free directions and the ways to the edge of sight.

Only standing obstacles count here; what moves is left to the roll-outs.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import pi

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

SPACING = 0.05  # hits are thinned out to this spacing along an outline, per metre of distance
CELL = 0.05  # m: cell of the local search


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """One scan's standing surroundings, robot-centred, axes parallel to the world's.

    Attributes:
        points: (k, 2) thinned hits of standing obstacles, m.
        bearings: (n,) directions of the rays, rad, world frame.
        ranges: (n,) m to the first standing obstacle; the sensor's range where there is none.
        max_range: m.
    """

    points: FloatArray
    bearings: FloatArray
    ranges: FloatArray
    max_range: float


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

    grid: "_Grid"
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


def free_distance(points: FloatArray, bearings: FloatArray, width: float) -> FloatArray:
    """(n,) how far a disc of radius `width` can move on each bearing before it meets a point.

    A point that the disc already overlaps stops only motion towards it.
    """
    if len(points) == 0:
        return np.full(len(bearings), np.inf)
    c, s = np.cos(bearings)[:, None], np.sin(bearings)[:, None]
    along = c * points[:, 0] + s * points[:, 1]
    across = c * points[:, 1] - s * points[:, 0]
    inside = width**2 - across**2
    distance = along - np.sqrt(np.maximum(inside, 0.0))
    blocked = (inside > 0.0) & (along > 0.0)
    free: FloatArray = np.where(blocked, np.maximum(distance, 0.0), np.inf).min(axis=1)
    return free


def direct_ways(sight: Sight, width: float) -> Ways:
    """Straight ways to the edge of sight, and to where one obstacle hides what is behind it."""
    reach = np.where(
        sight.ranges >= sight.max_range - 1e-9, sight.max_range, _hidden_reach(sight, width)
    )
    free = free_distance(sight.points, sight.bearings, width)
    is_open = (reach > 0.0) & (free >= np.minimum(reach, sight.max_range - width))
    end = _unit(sight.bearings) * np.maximum(reach, 0.0)[:, None]
    nowhere = np.zeros(len(end), dtype=bool)
    return Ways(is_open, np.where(is_open, reach, np.inf), end, is_open, nowhere)


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


def _hidden_reach(sight: Sight, width: float) -> FloatArray:
    """(n,) how far a ray leads past the nearer one beside it into what that one's obstacle hides.

    Zero where the ranges do not jump by at least the width that the robot needs.
    """
    nearer = np.minimum(np.roll(sight.ranges, 1), np.roll(sight.ranges, -1))
    jump = sight.ranges - nearer >= 2 * width
    return np.where(jump, np.minimum(nearer + width, sight.ranges - width), 0.0)


def searched_ways(sight: Sight, width: float, comfortable: float) -> Ways:
    """Ways found by a shortest-path search on a grid of the visible, unobstructed ground.

    No way comes closer than `width` to an obstacle, and the ground nearer than `comfortable`
    costs up to three times its length.
    """
    grid = _grid(sight.max_range)
    bearing = np.arctan2(grid.y, grid.x)
    count = len(sight.bearings)
    ray = np.floor((bearing - sight.bearings[0]) * (count / (2 * pi)) + 0.5).astype(int) % count
    distance = np.hypot(grid.x, grid.y)
    gap = np.sqrt(np.maximum(_nearest_squared(grid, sight.points), 0.0))
    visible = distance <= sight.ranges[ray] + 1e-9
    passable = visible & (gap >= width)
    passable |= distance < 1.5 * CELL  # where the robot stands it may stand
    kept = passable[grid.tail] & passable[grid.head]
    toll = 1.0 + 2.0 * np.clip((comfortable - gap) / (comfortable - width), 0.0, 1.0)
    tail, head = grid.tail[kept], grid.head[kept]
    graph = csr_matrix((grid.cost[kept] * toll[head], (tail, head)), shape=(len(grid.x),) * 2)
    cost, before = dijkstra(graph, indices=grid.origin, return_predecessors=True)
    # The edge of sight: the cheapest cell near it on each ray's bearing.
    rim = np.flatnonzero((distance > sight.max_range - 1.5 * CELL) & np.isfinite(cost))
    target = np.full(count, -1)
    for cell in rim[np.argsort(-cost[rim], kind="stable")]:
        target[ray[cell]] = cell
    is_open = (target >= 0) & (sight.ranges >= sight.max_range - 1e-9)
    length = np.where(is_open, grid.lengths(before, target), np.inf)
    end = np.stack((grid.x[target], grid.y[target]), axis=1)
    search = Search(grid, before, target, sight.points, width)
    return Ways(is_open, length, end, np.zeros(count, dtype=bool), is_open, search)


def _unit(bearings: FloatArray) -> FloatArray:
    return np.stack((np.cos(bearings), np.sin(bearings)), axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class _Grid:
    x: FloatArray
    y: FloatArray
    origin: int
    tail: IntArray
    head: IntArray
    cost: FloatArray

    def chain(self, before: IntArray, cell: int) -> list[int]:
        """The cells of the way to `cell`, from there back to the robot's own, without that."""
        cells = []
        while cell not in (self.origin, -1):
            cells.append(cell)
            cell = int(before[cell])
        return cells

    def lengths(self, before: IntArray, cells: IntArray) -> FloatArray:
        """(n,) lengths of the ways to `cells` (n,); 0 for no cell (-1)."""
        here = np.where(cells < 0, self.origin, cells)
        total = np.zeros(len(here))
        while (here != self.origin).any():
            there = np.where(here == self.origin, here, before[here])
            total += np.hypot(self.x[here] - self.x[there], self.y[here] - self.y[there])
            here = there
        return total


@lru_cache(maxsize=4)
def _grid(radius: float) -> _Grid:
    """Cells within `radius` and the edges between neighbours; made once per radius."""
    half = int(radius / CELL)
    axis = np.arange(-half, half + 1)
    i, j = (a.ravel() for a in np.meshgrid(axis, axis, indexing="ij"))
    inside = i**2 + j**2 <= half**2
    i, j = i[inside], j[inside]
    border = half + 2
    number = np.full((2 * border + 1, 2 * border + 1), -1)
    number[i + border, j + border] = np.arange(len(i))
    steps = [(1, 0), (0, 1), (1, 1), (1, -1), (2, 1), (1, 2), (2, -1), (1, -2)]
    tails, heads, costs = [], [], []
    for di, dj in steps + [(-a, -b) for a, b in steps]:
        head = number[i + di + border, j + dj + border]
        tail = np.flatnonzero(head >= 0)
        tails.append(tail)
        heads.append(head[tail])
        costs.append(np.full(len(tail), CELL * float(np.hypot(di, dj))))
    return _Grid(
        i.astype(np.float64) * CELL,
        j.astype(np.float64) * CELL,
        int(number[border, border]),
        np.concatenate(tails),
        np.concatenate(heads),
        np.concatenate(costs),
    )


def _nearest_squared(grid: _Grid, points: FloatArray) -> FloatArray:
    if len(points) == 0:
        return np.full(len(grid.x), np.inf)
    cells = np.stack((grid.x, grid.y), axis=1).astype(np.float32)
    spots = points.astype(np.float32)
    cross = cells @ spots.T
    squared = (cells**2).sum(axis=1)[:, None] + (spots**2).sum(axis=1)[None] - 2 * cross
    nearest: FloatArray = squared.min(axis=1).astype(np.float64)
    return nearest


def thin(points: FloatArray, spacing: float = SPACING) -> FloatArray:
    """Thins out hits (k, 2), robot-centred and in ray order: densely kept near the robot, where a
    missing corner would matter, and ever more sparsely farther away."""
    if len(points) < 3:
        return points
    steps = np.diff(points, axis=0)
    distance = np.sqrt(points[1:, 0] ** 2 + points[1:, 1] ** 2)
    length = np.sqrt(steps[:, 0] ** 2 + steps[:, 1] ** 2)
    bins = np.floor(np.cumsum(length / (spacing * np.maximum(distance, 0.1))))
    keep = np.concatenate(([True], bins[1:] != bins[:-1], [True]))
    return points[keep]
