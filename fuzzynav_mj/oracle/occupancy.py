"""Which nodes of the grid the obstacles leave free, layer of time by layer."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import Polygon

from fuzzynav_mj.oracle.grid import Grid
from fuzzynav_mj.scenarios.world import Mover, World
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

ARC_SEGMENTS = 24  # per quarter turn of an inflated corner
FINE = 8  # looks at a mover's course within a layer
BEND = 0.001  # m; a course that bends by more within a layer is looked at in between
CHUNK = 32  # layers that are drawn at a time


@dataclass(frozen=True, slots=True)
class Clearance:
    """How far the nodes must be from obstacles.

    Attributes:
        radius: of the disc that stands for the robot, m.
        speed: of the robot, m/s.
        cell: of the grid, m.
        safe: True to keep the disc free wherever it goes between the nodes and the layers; False
            to look at nodes and layers alone, with `radius` as it is.
    """

    radius: float
    speed: float
    cell: float
    safe: bool

    @property
    def layer(self) -> float:
        """Time in which the robot travels one cell, s."""
        return self.cell / self.speed

    def static(self) -> float:
        """Distance from obstacles that stand still, m."""
        return self.moving(0.0, 0.0)

    def moving(self, speed: float, bend: float) -> float:
        """Distance from an obstacle, m, at most `speed` fast and `bend` off its course."""
        if not self.safe:
            return self.radius
        # A point as far from the corners of a cell as `keep` is nearest to the cell half-way along
        # one of its sides: within the cell, where slanting moves are, keep^2 falls by cell^2 / 4.
        # On a straight relative way between two layers it falls by half that way, squared.
        off_node = self.cell**2 / 4
        off_layer = ((self.speed + speed) * self.layer / 2) ** 2
        arcs = math.cos(math.pi / (4 * ARC_SEGMENTS))  # inscribed polygons fall short by this
        return math.sqrt((self.radius + bend) ** 2 + off_node + off_layer) / arcs


def free_layers(world: World, grid: Grid, clearance: Clearance, layers: int) -> Iterator[BoolArray]:
    """Yield (grid.size,) of what is free at the layers 0 .. `layers` - 1.

    In a safe clearance every straight move at constant speed between nodes that this leaves free
    at adjacent layers is free, and so are slanting moves through cells whose corners are.
    """
    always = _static_free(world, grid, clearance)
    for first in range(0, layers, CHUNK):
        chunk = np.repeat(always[None], min(CHUNK, layers - first), axis=0)
        for mover in world.movers:
            _clear(chunk, first, mover, grid, clearance)
        yield from chunk


def _static_free(world: World, grid: Grid, clearance: Clearance) -> BoolArray:
    keep = clearance.static()
    x, y = grid.places()
    free = grid.inner()
    if world.scenario.walls:  # straight walls: what lies between free nodes is as far from them
        x_min, y_min, x_max, y_max = world.scenario.bounds
        gap = np.minimum.reduce([x - x_min, x_max - x, y - y_min, y_max - y])
        free &= gap >= clearance.radius
    for shape in world.static:
        solid = shape.inflated(keep, ARC_SEGMENTS)
        shapely.prepare(solid)
        low_x, low_y, high_x, high_y = solid.bounds
        near = free & (x >= low_x) & (x <= high_x) & (y >= low_y) & (y <= high_y)
        free[near] = ~shapely.intersects_xy(solid, x[near], y[near])
    return free


def _clear(chunk: BoolArray, first: int, mover: Mover, grid: Grid, clearance: Clearance) -> None:
    """Set False what `mover` blocks in the (n, size) layers from number `first` on."""
    count = len(chunk)
    look = clearance.layer / FINE
    # one layer more at either end: what a mover does just before and after counts
    numbers = np.arange((first - 1) * FINE, (first + count) * FINE + 1, dtype=np.float64)
    course = mover.motion.positions(look * numbers)
    speed = float(np.hypot(*np.diff(course, axis=0).T).max()) / look
    rows, places = np.arange(count), course[FINE:-1:FINE]
    bend = 0.0
    if clearance.safe and speed > 0.0:
        # Between two looks a mover strays from the straight by half the way between them at most.
        bend = BEND + speed * look / 2
        bent_rows, bent_places = _bends(course)
        known = (bent_rows >= 0) & (bent_rows < count)
        rows = np.concatenate([rows, bent_rows[known]])
        places = np.concatenate([places, bent_places[known]])
    _draw(
        chunk, rows, places, mover.shape.inflated(clearance.moving(speed, bend), ARC_SEGMENTS), grid
    )


def _bends(course: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the looks within layers on which the mover does not go straight on.

    Args:
        course: (k * FINE + 1, 2) looks, from one layer before row 0 on.

    Returns:
        (m,) rows before and after each look, and (m, 2) places.
    """
    ends = course[::FINE]
    within = course[:-1].reshape(-1, FINE, 2)[:, 1:]
    part = np.arange(1, FINE)[:, None] / FINE
    straight = ends[:-1, None] + part * np.diff(ends, axis=0)[:, None]
    astray = np.hypot(*np.moveaxis(within - straight, 2, 0)).max(axis=1)
    bent = np.flatnonzero(astray > BEND)
    places = within[bent].reshape(-1, 2)
    after = np.repeat(bent, FINE - 1)
    return np.concatenate([after - 1, after]), np.concatenate([places, places])


def _draw(chunk: BoolArray, rows: IntArray, places: FloatArray, solid: Polygon, grid: Grid) -> None:
    """Set False the nodes that `solid` covers in the (k,) `rows` with its origin at `places`."""
    shapely.prepare(solid)
    low, high = np.array(solid.bounds).reshape(2, 2)
    lowest = np.ceil((places + low - (grid.x, grid.y)) / grid.cell).astype(np.intp)
    across, up = ((high - low) / grid.cell).astype(np.intp) + 1
    column = lowest[:, :1] + np.arange(across)
    row = lowest[:, 1:] + np.arange(up)
    x = grid.x + grid.cell * column - places[:, :1]
    y = grid.y + grid.cell * row - places[:, 1:]
    covered = shapely.intersects_xy(solid, x[:, None, :], y[:, :, None])
    covered &= ((column >= 0) & (column < grid.columns))[:, None, :]
    covered &= ((row >= 0) & (row < grid.rows))[:, :, None]
    node = row[:, :, None] * grid.columns + column[:, None, :]
    layer = np.broadcast_to(rows[:, None, None], node.shape)
    chunk[layer[covered], node[covered]] = False
