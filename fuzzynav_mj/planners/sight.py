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
        via: (n, 2) first point to head for in a straight line, robot-centred.
        comfortable: (n,) True where the way keeps the comfortable width all along.
    """

    open: BoolArray
    length: FloatArray
    end: FloatArray
    via: FloatArray
    comfortable: BoolArray


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
    return np.where(blocked, np.maximum(distance, 0.0), np.inf).min(axis=1)


def direct_ways(sight: Sight, width: float) -> Ways:
    """Straight ways to the edge of sight, and to where one obstacle hides what is behind it."""
    reach = np.where(
        sight.ranges >= sight.max_range - 1e-9, sight.max_range, _hidden_reach(sight, width)
    )
    free = free_distance(sight.points, sight.bearings, width)
    is_open = (reach > 0.0) & (free >= np.minimum(reach, sight.max_range - width))
    end = _unit(sight.bearings) * np.maximum(reach, 0.0)[:, None]
    return Ways(is_open, np.where(is_open, reach, np.inf), end, end, is_open)


def either(first: Ways, second: Ways, penalty: float) -> Ways:
    """For each bearing the shorter way, the second one burdened with a penalty."""
    better = second.length + penalty < first.length
    return Ways(
        first.open | second.open,
        np.where(better, second.length + penalty, first.length),
        np.where(better[:, None], second.end, first.end),
        np.where(better[:, None], second.via, first.via),
        first.comfortable & ~better,
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
    gap = np.sqrt(_nearest_squared(grid, sight.points))
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
    length = np.full(count, np.inf)
    end, via = np.zeros((count, 2)), np.zeros((count, 2))
    legs: dict[int, tuple[float, tuple[float, float]]] = {}
    for index in np.flatnonzero(is_open):
        cell = int(target[index])
        if cell not in legs:
            legs[cell] = _legs(grid, before, cell, sight.points, width)
        length[index], via[index] = legs[cell]
        end[index] = grid.x[cell], grid.y[cell]
    return Ways(is_open, length, end, via, np.zeros(count, dtype=bool))


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
        i * CELL,
        j * CELL,
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


def _legs(
    grid: _Grid, before: IntArray, cell: int, points: FloatArray, width: float
) -> tuple[float, tuple[float, float]]:
    """Length of the way to `cell`, and its farthest point that a straight line reaches."""
    chain = []
    while cell != grid.origin:
        chain.append(cell)
        cell = int(before[cell])
    if not chain:
        return 0.0, (0.0, 0.0)
    x, y = grid.x[chain], grid.y[chain]
    steps = np.hypot(np.diff(np.append(x, 0.0)), np.diff(np.append(y, 0.0)))
    free = free_distance(points, np.arctan2(y, x), width - 0.25 * CELL)
    straight = np.flatnonzero(free >= np.hypot(x, y) - width)
    best = int(straight[0]) if len(straight) else len(chain) - 1
    return float(steps.sum()), (float(x[best]), float(y[best]))


def thin(points: FloatArray) -> FloatArray:
    """Thins out hits (k, 2), robot-centred and in ray order: densely kept near the robot, where a
    missing corner would matter, and ever more sparsely farther away."""
    if len(points) < 3:
        return points
    steps = np.diff(points, axis=0)
    distance = np.sqrt(points[1:, 0] ** 2 + points[1:, 1] ** 2)
    length = np.sqrt(steps[:, 0] ** 2 + steps[:, 1] ** 2)
    bins = np.floor(np.cumsum(length / (SPACING * np.maximum(distance, 0.1))))
    keep = np.concatenate(([True], bins[1:] != bins[:-1], [True]))
    return points[keep]
