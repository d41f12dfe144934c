"""Where the robot's centre may be on a map: collision checks for planners that are given one."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from fuzzynav_mj.types import BoolArray, FloatArray

ARC_SEGMENTS = 6  # per quarter turn of an inflated corner
OUTSKIRTS = 1.0  # m: how far a world without walls reaches beyond what is known of it
INSIDE = 2e-3  # m: how far inside the free places the nearest one is taken


@dataclass(frozen=True, slots=True, eq=False)
class FreeSpace:
    """The places of a disc's centre that keep it clear of a map and, for a while, of other points.

    Attributes:
        solid: what the map says is solid.
        blocked: where the centre may not be; prepared.
        bounds: x_min, y_min, x_max, y_max around all that is not blocked, m.
        radius: of the disc, m.
    """

    solid: BaseGeometry
    blocked: BaseGeometry
    bounds: tuple[float, float, float, float]
    radius: float

    def without(self, points: FloatArray) -> "FreeSpace":
        """The free space with (k, 2) points, world frame, as further obstacles."""
        if len(points) == 0:
            return self
        discs = shapely.MultiPoint(points).buffer(self.radius, quad_segs=ARC_SEGMENTS)
        blocked = self.blocked | discs
        shapely.prepare(blocked)
        return FreeSpace(self.solid, blocked, self.bounds, self.radius)

    def holds(self, points: FloatArray) -> BoolArray:
        """(n,) True where the disc may stand at (n, 2) points."""
        free: BoolArray = np.logical_not(shapely.intersects_xy(self.blocked, points))
        return free

    def joins(self, starts: FloatArray, ends: FloatArray) -> BoolArray:
        """(n,) True where the disc may move on a straight line from (n, 2) to (n, 2)."""
        lines = shapely.linestrings(np.stack((starts, ends), axis=1))
        free: BoolArray = np.logical_not(shapely.intersects(self.blocked, lines))
        return free

    def nearest(self, point: FloatArray) -> FloatArray:
        """(2,) the free place nearest to `point` (2,): itself where the disc may stand."""
        if self.holds(point[None])[0]:
            return point
        free = shapely.box(*self.bounds) - self.blocked.buffer(INSIDE)
        if free.is_empty:
            return point
        line = shapely.shortest_line(free, shapely.Point(point))
        nearest: FloatArray = shapely.get_coordinates(line)[0]
        return nearest

    def unmapped(self, points: FloatArray, tolerance: float) -> FloatArray:
        """Those of (k, 2) points that lie farther than `tolerance`, m, from all that is solid."""
        near = shapely.dwithin(self.solid, shapely.points(points), tolerance)
        strange: FloatArray = points[~near]
        return strange


def free_space(
    outlines: Sequence[FloatArray], goal: tuple[float, float], radius: float
) -> FreeSpace:
    """The free space of a map.

    The outline around the goal, if there is one, is the arena's: free inside. All others are
    obstacles.

    Args:
        outlines: (k, 2) polygons, world frame, m.
        goal: (x, y), world frame, m.
        radius: of the disc, m.
    """
    polygons = [shapely.Polygon(outline) for outline in outlines]
    around = [polygon.contains(shapely.Point(goal)) for polygon in polygons]
    solid = shapely.union_all([p for p, outer in zip(polygons, around, strict=True) if not outer])
    known = shapely.union(solid, shapely.Point(goal).buffer(radius))
    if any(around):
        known = polygons[around.index(True)]
        solid = solid | (shapely.box(*known.buffer(OUTSKIRTS).bounds) - known)
    else:
        known = known.buffer(OUTSKIRTS)
    blocked = solid.buffer(radius, quad_segs=ARC_SEGMENTS)
    shapely.prepare(solid)
    shapely.prepare(blocked)
    return FreeSpace(solid, blocked, known.bounds, radius)
