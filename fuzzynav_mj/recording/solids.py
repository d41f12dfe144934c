"""Triangle meshes of upright solids, and outlines."""

import math
from dataclasses import dataclass

import numpy as np
import shapely

from fuzzynav_mj.types import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles that do not share vertices, so that each is lit as a plane.

    Attributes:
        vertices: (3 t, 3) m; three rows per triangle, counter-clockwise seen from outside.
        normals: (3 t, 3) unit vectors outwards.
    """

    vertices: FloatArray
    normals: FloatArray


def prism(footprint: shapely.Polygon, bottom: float, top: float) -> Mesh:
    """The upright solid over `footprint`, which may be concave and have holes, in m."""
    parts = shapely.get_parts(shapely.constrained_delaunay_triangles(footprint))
    corners = shapely.get_coordinates(shapely.orient_polygons(parts)).reshape(-1, 4, 2)[:, :3]
    lid = _faces(corners, np.full(3, top))
    base = _faces(corners[:, ::-1], np.full(3, bottom))

    # The solid lies to the left of every ring: holes run clockwise.
    rings = [
        shapely.get_coordinates(r) for r in shapely.get_rings(shapely.orient_polygons(footprint))
    ]
    start = np.concatenate([ring[:-1] for ring in rings])
    end = np.concatenate([ring[1:] for ring in rings])
    lower = _faces(np.stack([start, end, end], axis=1), np.array([bottom, bottom, top]))
    upper = _faces(np.stack([start, end, start], axis=1), np.array([bottom, top, top]))
    return _mesh(np.concatenate([lid, base, lower, upper]))


def lying(mesh: Mesh) -> Mesh:
    """The upright `mesh` laid on its side: its height becomes y, and its y becomes z."""
    return _mesh(mesh.vertices[:, [0, 2, 1]].reshape(-1, 3, 3)[:, ::-1])


def _faces(corners: FloatArray, heights: FloatArray) -> FloatArray:
    """(t, 3, 3) triangles with (t, 3, 2) places at (3,) heights."""
    return np.concatenate(
        [corners, np.broadcast_to(heights[:, None], (len(corners), 3, 1))], axis=2
    )


def _mesh(faces: FloatArray) -> Mesh:
    """The mesh of triangles (t, 3, 3)."""
    across = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    normals = across / np.linalg.norm(across, axis=1, keepdims=True)
    return Mesh(faces.reshape(-1, 3), np.repeat(normals, 3, axis=0))


def circle_outline(
    centre: tuple[float, float], radius: float, height: float, corners: int = 64
) -> FloatArray:
    """Closed outline (corners + 1, 3) of a level circle, m."""
    angles = np.linspace(0.0, 2.0 * math.pi, corners + 1)
    return np.column_stack(
        [
            centre[0] + radius * np.cos(angles),
            centre[1] + radius * np.sin(angles),
            np.full(corners + 1, height),
        ]
    )


def box_outline(bounds: tuple[float, float, float, float], height: float) -> FloatArray:
    """Closed outline (5, 3) of the level box x_min, y_min, x_max, y_max, m."""
    x_min, y_min, x_max, y_max = bounds
    x = (x_min, x_max, x_max, x_min, x_min)
    y = (y_min, y_min, y_max, y_max, y_min)
    return np.column_stack([x, y, np.full(5, height)])
