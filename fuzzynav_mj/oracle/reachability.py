"""Where a point can be, layer of time by layer, on a grid whose nodes are free or not."""

from collections import deque
from collections.abc import Iterable

import numpy as np

from fuzzynav_mj.oracle.grid import Grid
from fuzzynav_mj.types import BoolArray, IntArray

LONG = 5  # layers that a slanting move takes: its vectors are 5 cells long
SLANTING = tuple(
    (sign_x * dx, sign_y * dy)
    for dx, dy in ((3, 4), (4, 3))
    for sign_x in (1, -1)
    for sign_y in (1, -1)
)
SLOWEST = 0.9**0.5  # share of the speed that is left half-way between an axis and a slanting move


def earliest_layer(free: Iterable[BoolArray], grid: Grid, goals: IntArray) -> int | None:
    """Return the first layer at which one of the nodes `goals` can be reached from the start.

    In one layer a point stays or moves to one of four neighbours; in five it moves along a vector
    (3, 4) of whichever signs and order, if at each of the four layers between the corners of the
    cell that it is in are free. So no move is faster than one cell in a layer. Where a way is not
    along the 12 directions of these moves it is made of two kinds; the mean speed falls to
    `SLOWEST` at worst, at a slope of 1 in 3.

    Args:
        free: (grid.size,) for every layer.
        grid: the plane.
        goals: flat indices.
    """
    moves = [
        ([_floor(dx, dy, j, grid.columns) for j in range(1, LONG)], dy * grid.columns + dx)
        for dx, dy in SLANTING
    ]
    neighbours = (1, -1, grid.columns, -grid.columns)
    pad = 4 * grid.columns + 4
    low, high = pad, grid.size - pad
    passed: deque[tuple[BoolArray, BoolArray]] = deque(maxlen=LONG)  # reached, cells wholly free
    on_way = np.empty(high - low, dtype=np.bool_)
    for layer, nodes in enumerate(free):
        if layer == 0:
            reached = np.zeros(grid.size, dtype=np.bool_)
            reached[grid.start] = nodes[grid.start]
        else:
            before = passed[-1][0]
            reached = before.copy()
            for step in neighbours:
                reached[low + step : high + step] |= before[low:high]
            if layer >= LONG:
                for cells, end in moves:
                    np.copyto(on_way, passed[0][0][low:high])
                    for (_, whole), offset in zip(list(passed)[1:], cells, strict=True):
                        on_way &= whole[low + offset : high + offset]
                    reached[low + end : high + end] |= on_way
            reached &= nodes
        if reached[goals].any():
            return layer
        if not reached.any():
            return None
        passed.append((reached, _whole_cells(nodes, grid.columns)))
    return None


def _floor(dx: int, dy: int, part: int, columns: int) -> int:
    """Offset of the lower left corner of the cell at `part` fifths of the way."""
    return (dy * part // LONG) * columns + dx * part // LONG


def _whole_cells(nodes: BoolArray, columns: int) -> BoolArray:
    """Tell which cells, named by their lower left corner, have four free corners."""
    whole = np.zeros_like(nodes)
    end = len(nodes) - columns - 1
    np.logical_and(nodes[:end], nodes[1 : end + 1], out=whole[:end])
    whole[:end] &= nodes[columns : end + columns]
    whole[:end] &= nodes[columns + 1 :]
    return whole
