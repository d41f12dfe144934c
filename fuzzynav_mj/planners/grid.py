"""The grid of the local search: cells around the robot, and the cheapest ways over them."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from fuzzynav_mj.types import FloatArray, IntArray

CELL = 0.05  # m


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Cells around the robot and the edges between neighbours.

    Attributes:
        x, y: (cells,) m.
        bearing, distance: (cells,) of each from the robot's own cell, rad and m.
        origin: the robot's own cell.
        rim: the cells at the edge of sight.
        first: (cells + 1,) each cell's first edge; its last is the one before the next cell's.
        head: (edges,) the cell that each edge leads to.
        step: (edges,) length of each edge, m.
    """

    x: FloatArray
    y: FloatArray
    bearing: FloatArray
    distance: FloatArray
    origin: int
    rim: IntArray
    first: IntArray
    head: IntArray
    step: FloatArray

    def nearest(self, points: FloatArray) -> FloatArray:
        """(cells,) distance to the nearest of the points (k, 2), m."""
        if len(points) == 0:
            return np.full(len(self.x), np.inf)
        cells = np.array((self.x, self.y), dtype=np.float32)
        spots = points.astype(np.float32)
        squared = (cells[0] ** 2 + cells[1] ** 2) + (spots[:, :1] ** 2 + spots[:, 1:] ** 2)
        squared -= (2.0 * spots) @ cells
        nearest: FloatArray = squared.min(axis=0).astype(np.float64)
        return np.sqrt(np.maximum(nearest, 0.0))

    def cheapest(self, toll: FloatArray) -> tuple[FloatArray, IntArray]:
        """(cells,) cost of the cheapest way from the robot to each cell, and the cell before it.

        Args:
            toll: (cells,) cost per metre of stepping onto each cell; inf where none may.
        """
        cost = self.step * toll.take(self.head)
        graph = csr_matrix((cost, self.head, self.first), shape=(len(self.x),) * 2)
        # Any finite limit keeps the search from steps of infinite cost.
        reached: tuple[FloatArray, IntArray] = dijkstra(
            graph, indices=self.origin, return_predecessors=True, limit=1e9
        )
        return reached

    def chain(self, before: IntArray, cell: int) -> list[int]:
        """The cells of the way to `cell`, from there back to the robot's own, without that."""
        cells = []
        while cell not in (self.origin, -1):
            cells.append(cell)
            cell = int(before[cell])
        return cells

    def lengths(self, before: IntArray, cells: IntArray) -> FloatArray:
        """(n,) lengths of the ways to the reached `cells` (n,), m."""
        there = np.where(before < 0, self.origin, before)
        step = np.hypot(self.x - self.x.take(there), self.y - self.y.take(there))
        total = np.zeros(len(cells))
        while np.count_nonzero(cells != self.origin):
            total += step.take(cells)
            cells = there.take(cells)
        return total


@lru_cache(maxsize=4)
def grid_around(radius: float) -> Grid:
    """Cells within `radius` and the edges between neighbours; made once per radius."""
    half = int(radius / CELL)
    axis = np.arange(-half, half + 1)
    i, j = (a.ravel() for a in np.meshgrid(axis, axis, indexing="ij"))
    inside = i**2 + j**2 <= half**2
    i, j = i[inside], j[inside]
    border = half + 2
    number = np.full((2 * border + 1, 2 * border + 1), -1)
    number[i + border, j + border] = np.arange(len(i))
    moves = [(1, 0), (0, 1), (1, 1), (1, -1), (2, 1), (1, 2), (2, -1), (1, -2)]
    tails, heads, steps = [], [], []
    for di, dj in moves + [(-a, -b) for a, b in moves]:
        head = number[i + di + border, j + dj + border]
        tail = np.flatnonzero(head >= 0)
        tails.append(tail)
        heads.append(head[tail])
        steps.append(np.full(len(tail), CELL * float(np.hypot(di, dj))))
    tail, head, step = (np.concatenate(parts) for parts in (tails, heads, steps))
    order = np.lexsort((head, tail))
    x, y = (a.astype(np.float64) * CELL for a in (i, j))
    distance = np.hypot(x, y)
    return Grid(
        x=x,
        y=y,
        bearing=np.arctan2(y, x),
        distance=distance,
        origin=int(number[border, border]),
        rim=np.flatnonzero(distance > radius - 1.5 * CELL),
        first=np.searchsorted(tail[order], np.arange(len(x) + 1)).astype(np.int32),
        head=head[order].astype(np.int32),
        step=step[order],
    )
