"""Which ways lead on, as far as one scan shows: free directions and the ways to the edge of sight.

Only standing obstacles count here; what moves is left to the roll-outs.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from fuzzynav_mj.planners.grid import CELL, Grid, grid_around
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


def free_distance(points: FloatArray, bearings: FloatArray, width: float) -> FloatArray:
    """(n,) how far a disc of radius `width` can move on each bearing before it meets a point.

    A point that the disc already overlaps stops only motion towards it.
    """
    if len(points) == 0:
        return np.full(len(bearings), np.inf)
    x, y = points.T
    c, s = np.cos(bearings)[:, None], np.sin(bearings)[:, None]
    free: FloatArray = _until_met(c * x + s * y, c * y - s * x, width).min(axis=1)
    return free


def _free_distances(sight: Sight, widths: tuple[float, ...]) -> FloatArray:
    """(widths, n) the same on the bearings of the rays, which are evenly spaced."""
    count, points = len(sight.bearings), sight.points
    free = np.full((len(widths), count), np.inf)
    if len(points) == 0:
        return free
    x, y = points.T
    # Only the rays within the angle that the widest disc covers as seen from here meet a point.
    widest, per_radian = max(widths), count / (2 * pi)
    spread = np.arcsin(widest / np.maximum(np.hypot(x, y), widest)) * per_radian
    first = np.floor((np.arctan2(y, x) - sight.bearings[0]) * per_radian - spread).astype(np.intp)
    number = (2 * spread).astype(np.intp) + 3
    past = number.cumsum()
    ray = (np.arange(past[-1]) + (first - past + number).repeat(number)) % count
    x, y = x.repeat(number), y.repeat(number)
    c, s = np.cos(sight.bearings).take(ray), np.sin(sight.bearings).take(ray)
    along, across = c * x + s * y, c * y - s * x
    for nearest, width in zip(free, widths, strict=True):
        np.minimum.at(nearest, ray, _until_met(along, across, width))
    return free


def _until_met(along: FloatArray, across: FloatArray, width: float) -> FloatArray:
    """How far a disc moves until it meets a point that lies so far ahead and beside it."""
    inside = width**2 - across**2
    distance = np.maximum(along - np.sqrt(np.maximum(inside, 0.0)), 0.0)
    return np.where((inside > 0.0) & (along > 0.0), distance, np.inf)


def straight_ways(sight: Sight, widths: tuple[float, ...]) -> list[Ways]:
    """Straight ways to the edge of sight, and to where one obstacle hides what is behind it, for
    each of several widths."""
    unit = np.array((np.cos(sight.bearings), np.sin(sight.bearings)))
    nowhere = np.zeros(len(sight.bearings), dtype=bool)
    to_edge = sight.ranges >= sight.max_range - 1e-9
    free = _free_distances(sight, widths)
    ways = []
    for width, reachable in zip(widths, free, strict=True):
        reach = np.where(to_edge, sight.max_range, _hidden_reach(sight, width))
        is_open = (reach > 0.0) & (reachable >= np.minimum(reach, sight.max_range - width))
        end = (unit * np.maximum(reach, 0.0)).T
        ways.append(Ways(is_open, np.where(is_open, reach, np.inf), end, is_open, nowhere))
    return ways


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
    jump, nearer = range_jumps(sight, width)
    return np.where(jump, np.minimum(nearer + width, sight.ranges - width), 0.0)


def range_jumps(sight: Sight, width: float) -> tuple[BoolArray, FloatArray]:
    """(n,) True for rays that pass an obstacle's end: one beside them is shorter by the width that
    the robot needs; and (n,) the range of that one, m."""
    ring = np.concatenate((sight.ranges[-1:], sight.ranges, sight.ranges[:1]))
    nearer = np.minimum(ring[:-2], ring[2:])
    return sight.ranges - nearer >= 2 * width, nearer


def searched_ways(sight: Sight, width: float, comfortable: float) -> Ways:
    """Ways found by a shortest-path search on a grid of the visible, unobstructed ground.

    No way comes closer than `width` to an obstacle, and the ground nearer than `comfortable`
    costs up to three times its length.
    """
    grid = grid_around(sight.max_range)
    count = len(sight.bearings)
    turn = (grid.bearing - sight.bearings[0]) * (count / (2 * pi))
    ray = np.floor(turn + 0.5).astype(np.intp) % count
    gap = grid.nearest(sight.points)
    passable = (grid.distance <= sight.ranges.take(ray) + 1e-9) & (gap >= width)
    passable |= grid.distance < 1.5 * CELL  # where the robot stands it may stand
    toll = 1.0 + 2.0 * np.clip((comfortable - gap) / (comfortable - width), 0.0, 1.0)
    cost, before = grid.cheapest(np.where(passable, toll, np.inf))
    # The edge of sight: the cheapest cell near it on each ray's bearing.
    rim = grid.rim[np.isfinite(cost.take(grid.rim))]
    rim = rim[np.argsort(-cost.take(rim), kind="stable")]
    target = np.full(count, -1)
    target[ray.take(rim)] = rim  # of several the last, which is the cheapest
    target[sight.ranges < sight.max_range - 1e-9] = -1
    # And past an obstacle's end: the nearest cell behind it from which more may be seen.
    jump, nearer = range_jumps(sight, width)
    behind = np.flatnonzero(jump.take(ray) & (target.take(ray) < 0) & np.isfinite(cost))
    behind = behind[grid.distance.take(behind) >= (nearer + width).take(ray.take(behind))]
    behind = behind[np.argsort(-grid.distance.take(behind), kind="stable")]
    target[ray.take(behind)] = behind
    is_open = target >= 0
    length = np.full(count, np.inf)
    length[is_open] = grid.lengths(before, target[is_open])
    end = np.array((grid.x.take(target), grid.y.take(target))).T
    search = Search(grid, before, target, sight.points, width)
    return Ways(is_open, length, end, np.zeros(count, dtype=bool), is_open, search)


def thin(points: FloatArray, spacing: float = SPACING) -> FloatArray:
    """Thins out hits (k, 2), robot-centred and in ray order: densely kept near the robot, where a
    missing corner would matter, and ever more sparsely farther away."""
    if len(points) < 3:
        return points
    x, y = points.T
    dx, dy = x[1:] - x[:-1], y[1:] - y[:-1]
    distance = np.sqrt(x[1:] ** 2 + y[1:] ** 2)
    length = np.sqrt(dx**2 + dy**2)
    bins = np.floor((length / (spacing * np.maximum(distance, 0.1))).cumsum())
    keep = np.ones(len(points), dtype=bool)
    keep[1:-1] = bins[1:] != bins[:-1]
    return points.T.compress(keep, axis=1).T
