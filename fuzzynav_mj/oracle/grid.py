"""A grid of places, flattened so that every shift of the plane is a shift of one array."""

import math
from dataclasses import dataclass

import numpy as np

from fuzzynav_mj.scenarios.schema import Bounds
from fuzzynav_mj.types import BoolArray, FloatArray

BORDER = 5  # nodes around the plane that are always blocked, so that no shift leaves the array
LARGEST = 1_000_000  # nodes


@dataclass(frozen=True, slots=True)
class Grid:
    """Square grid with a node exactly at the robot's start; row-major, x fastest.

    Attributes:
        x: of the first column, m.
        y: of the first row, m.
        cell: distance between neighbouring nodes, m.
        columns: nodes in a row, the border included.
        rows: nodes in a column, the border included.
        start: flat index of the node at the robot's start.
    """

    x: float
    y: float
    cell: float
    columns: int
    rows: int
    start: int

    @property
    def size(self) -> int:
        """Number of nodes."""
        return self.rows * self.columns

    def places(self) -> tuple[FloatArray, FloatArray]:
        """Return x and y of all nodes, (size,) each, m."""
        x = self.x + self.cell * np.arange(self.columns)
        y = self.y + self.cell * np.arange(self.rows)
        return np.tile(x, self.rows), np.repeat(y, self.columns)

    def inner(self) -> BoolArray:
        """Return (size,) False on the border."""
        inner = np.zeros((self.rows, self.columns), dtype=np.bool_)
        inner[BORDER:-BORDER, BORDER:-BORDER] = True
        return inner.ravel()


def grid_over(bounds: Bounds, start: tuple[float, float], cell: float) -> Grid:
    """Return the grid whose inner nodes are those within `bounds`.

    Raises:
        ValueError: the grid would be too large.
    """
    x_min, y_min, x_max, y_max = bounds
    left, below = (int((s - low) // cell) for s, low in ((start[0], x_min), (start[1], y_min)))
    right, above = (int((high - s) // cell) for s, high in ((start[0], x_max), (start[1], y_max)))
    columns, rows = left + right + 1 + 2 * BORDER, below + above + 1 + 2 * BORDER
    if columns * rows > LARGEST:
        side = math.sqrt((x_max - x_min) * (y_max - y_min) / LARGEST)
        raise ValueError(f"cell must be at least {side:.2g} m in an arena this large, not {cell}")
    return Grid(
        x=start[0] - cell * (left + BORDER),
        y=start[1] - cell * (below + BORDER),
        cell=cell,
        columns=columns,
        rows=rows,
        start=(below + BORDER) * columns + left + BORDER,
    )
