"""Ways to the edge of sight around what stands in the way, by a search over the ground in sight."""

from math import floor, pi

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.grid import CELL, grid_around, note_nearest
from fuzzynav_mj.planners.sight import Search, Sight, Ways, range_jumps
from fuzzynav_mj.types import FloatArray, IntArray


def searched_ways(sight: Sight, width: float, comfortable: float) -> Ways:
    """Ways found by a shortest-path search on a grid of the visible, unobstructed ground.

    No way comes closer than `width` to an obstacle, and the ground nearer than `comfortable`
    costs up to three times its length.
    """
    grid = grid_around(sight.max_range)
    toll, ray = _tolls(
        grid.axis, grid.distance, grid.bearing, sight.points, sight.ranges,
        float(sight.bearings[0]), width, comfortable,
    )  # fmt: skip
    cost, before = grid.cheapest(toll)
    target = _targets(
        cost, ray, grid.distance, sight.ranges, width, sight.max_range, sight.max_range - 1.5 * CELL
    )
    length, end = grid.ways(before, target)
    search = Search(grid, before, target, sight.points, width)
    is_open = target >= 0
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
