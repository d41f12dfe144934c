"""Planar shapes of obstacles."""

from dataclasses import dataclass

import numpy as np
import shapely
from shapely import Polygon

from fuzzynav_mj.types import FloatArray

CIRCLE_QUADRANT_SEGMENTS = 32  # a circle's polygon keeps within 0.03 % of its radius


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """A simple polygon or a circle; exactly one of the two is set.

    Static obstacles are in the world frame, moving ones in their own.

    Attributes:
        polygon: (n, 2) corners, m, counter-clockwise, the first not repeated; or None.
        circle: (x, y, radius) in m; or None.
    """

    polygon: FloatArray | None
    circle: tuple[float, float, float] | None

    def __post_init__(self) -> None:
        if (self.polygon is None) == (self.circle is None):
            raise ValueError("a Shape is either a polygon or a circle")

    @property
    def footprint(self) -> Polygon:
        """The area covered; a circle as an inscribed polygon of 128 corners."""
        if self.polygon is not None:
            return Polygon(self.polygon)
        assert self.circle is not None
        x, y, radius = self.circle
        return shapely.buffer(shapely.Point(x, y), radius, quad_segs=CIRCLE_QUADRANT_SEGMENTS)

    def inflated(self, clearance: float, quadrant_segments: int) -> Polygon:
        """The area within `clearance` (m) of the shape, its arcs as polygons inscribed in them."""
        if self.circle is None:
            return shapely.buffer(self.footprint, clearance, quad_segs=quadrant_segments)
        x, y, radius = self.circle
        return shapely.buffer(shapely.Point(x, y), radius + clearance, quad_segs=quadrant_segments)

    @property
    def radius(self) -> float:
        """Radius of the smallest circle about the frame's origin that holds the shape, m."""
        if self.polygon is not None:
            return float(np.hypot(self.polygon[:, 0], self.polygon[:, 1]).max())
        assert self.circle is not None
        x, y, radius = self.circle
        return float(np.hypot(x, y)) + radius
