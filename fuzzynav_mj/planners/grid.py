"""The grid of the local search: cells around the robot, and the cheapest ways over them."""

from dataclasses import dataclass
from functools import lru_cache
from math import hypot

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import FloatArray, IntArray

CELL = 0.05  # m
MOVES = ((1, 0), (0, 1), (1, 1), (1, -1), (2, 1), (1, 2), (2, -1), (1, -2))  # and back


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """A square of n x n cells around the robot, row by row.

    Attributes:
        axis: (n,) coordinate of the cells in one row, m.
        x, y: (cells,) m.
        bearing, distance: (cells,) of each from the robot's own cell, rad and m.
        origin: the robot's own cell.
        moves: (k, 2) rows and columns between neighbours.
        steps: (k,) length of each move, m.
    """

    axis: FloatArray
    x: FloatArray
    y: FloatArray
    bearing: FloatArray
    distance: FloatArray
    origin: int
    moves: IntArray
    steps: FloatArray

    def cheapest(self, toll: FloatArray) -> tuple[FloatArray, IntArray]:
        """(cells,) cost of the cheapest way from the robot to each cell, and the cell before it.

        Where no way leads the cost is inf and the cell before -1.

        Args:
            toll: (cells,) cost per metre of stepping onto each cell, inf where none may.
        """
        return _cheapest(toll, self.moves, self.steps)

    def chain(self, before: IntArray, cell: int) -> list[int]:
        """The cells of the way to `cell`, from there back to the robot's own, without that."""
        cells = []
        while cell not in (self.origin, -1):
            cells.append(cell)
            cell = int(before[cell])
        return cells

    def ways(self, before: IntArray, cells: IntArray) -> tuple[FloatArray, FloatArray]:
        """(n,) lengths of the ways to the reached `cells` (n,) and (n, 2) where they lie, m; inf
        and 0 where the cell is -1, for none."""
        return _ways(self.x, self.y, before, cells, self.origin)


@lru_cache(maxsize=4)
def grid_around(radius: float) -> Grid:
    """Cells up to `radius` on every side; made once per radius."""
    half = int(radius / CELL)
    axis = np.arange(-half, half + 1) * np.float64(CELL)
    x, y = (a.ravel() for a in np.meshgrid(axis, axis, indexing="ij"))
    moves = np.array(MOVES, dtype=np.intp)
    moves = np.concatenate((moves, -moves))
    return Grid(
        axis=axis,
        x=x,
        y=y,
        bearing=np.arctan2(y, x),
        distance=np.hypot(x, y),
        origin=len(x) // 2,
        moves=moves,
        steps=CELL * np.hypot(moves[:, 0], moves[:, 1]),
    )


@compiled
def note_nearest(squared: FloatArray, axis: FloatArray, x: float, y: float, reach: int) -> None:
    """Lowers the squared distances (n, n) of the cells to their nearest point, m2, by the point at
    (x, y), up to `reach` rows and columns from it. `axis` (n,) as in `Grid`."""
    size, half = len(axis), len(axis) // 2
    i, j = round(x / CELL) + half, round(y / CELL) + half
    first, end = max(j - reach, 0), min(j + reach + 1, size)
    for a in range(max(i - reach, 0), min(i + reach + 1, size)):
        ahead = (axis[a] - x) ** 2
        # Counted from nought, and not with `min`: the compiler then takes several cells at once.
        for column in range(end - first):
            b = first + column
            squared[a, b] = np.minimum(squared[a, b], ahead + (axis[b] - y) ** 2)


@compiled
def _cheapest(toll: FloatArray, moves: IntArray, steps: FloatArray) -> tuple[FloatArray, IntArray]:
    """See `Grid.cheapest`. Cells to which a cheaper way was found wait in a queue, each once, to
    pass that on (Bellman and Ford's method); on a grid this small it beats a heap."""
    cells = len(toll)
    size, origin = round(cells**0.5), cells // 2
    cost, before = np.full(cells, np.inf), np.full(cells, -1)
    queue, waits = np.empty(cells, dtype=np.intp), np.zeros(cells, dtype=np.bool_)
    cost[origin] = 0.0
    queue[0], first, waiting = origin, 0, 1
    while waiting > 0:
        cell = queue[first]
        first, waiting, waits[cell] = (first + 1) % cells, waiting - 1, False
        a, b = cell // size, cell % size
        for m in range(len(moves)):
            i, j = a + moves[m, 0], b + moves[m, 1]
            if not (0 <= i < size and 0 <= j < size):
                continue
            there = i * size + j
            through = cost[cell] + steps[m] * toll[there]
            if through < cost[there]:
                cost[there], before[there] = through, cell
                if not waits[there]:
                    queue[(first + waiting) % cells] = there
                    waits[there] = True
                    waiting += 1
    return cost, before


@compiled
def _ways(
    x: FloatArray, y: FloatArray, before: IntArray, cells: IntArray, origin: int
) -> tuple[FloatArray, FloatArray]:
    """See `Grid.ways`."""
    length, end = np.full(len(cells), np.inf), np.zeros((len(cells), 2))
    for k in range(len(cells)):
        cell = cells[k]
        if cell < 0:
            continue
        length[k], end[k] = 0.0, (x[cell], y[cell])
        while cell != origin:
            there = before[cell]
            length[k] += hypot(x[cell] - x[there], y[cell] - y[there])
            cell = there
    return length, end
