"""Plane geometry that several stages share: angles, polygons and the robot's footprint."""

from typing import overload

import numpy as np
import numpy.typing as npt
import shapely
from shapely import Polygon

from fuzzynav_mj.types import FloatArray, Pose2D

SMALLEST_AREA = 1e-6  # m2; physics meshes need some volume


@overload
def wrap_angle(angle: float) -> float: ...
@overload
def wrap_angle(angle: FloatArray) -> FloatArray: ...
def wrap_angle(angle: float | FloatArray) -> float | FloatArray:
    """Return `angle` (rad, any shape) plus the multiple of 2 pi that puts it in [-pi, pi)."""
    wrapped: FloatArray = np.mod(np.asarray(angle) + np.pi, 2 * np.pi) - np.pi
    return float(wrapped) if wrapped.ndim == 0 else wrapped


def rotation(angle: npt.ArrayLike) -> FloatArray:
    """Return the (..., 2, 2) matrices that turn column vectors by `angle` (...), rad."""
    angles = np.asarray(angle, dtype=float)
    cos, sin = np.cos(angles), np.sin(angles)
    return np.stack([np.stack([cos, -sin], -1), np.stack([sin, cos], -1)], -2)


def signed_area(polygon: FloatArray) -> float:
    """Return the area of the (n, 2) `polygon`, m2; positive if it runs counter-clockwise."""
    x, y = (polygon - polygon[0]).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def counter_clockwise(polygon: FloatArray) -> FloatArray:
    """Return the (n, 2) `polygon`, reversed if it runs clockwise."""
    return polygon if signed_area(polygon) >= 0 else polygon[::-1].copy()


def is_simple_polygon(polygon: FloatArray) -> bool:
    """Tell whether the (n, 2) corners differ, span an area, and edges meet only at corners."""
    if len(polygon) < 3 or len(np.unique(polygon, axis=0)) < len(polygon):
        return False
    return bool(Polygon(polygon).is_valid) and abs(signed_area(polygon)) >= SMALLEST_AREA


def is_convex(polygon: FloatArray, tolerance: float = 1e-12) -> bool:
    """Tell whether no corner of the counter-clockwise (n, 2) `polygon` is reflex.

    A corner counts as reflex if its turn's cross product is below `-tolerance`, m2.
    """
    edges = np.roll(polygon, -1, axis=0) - polygon
    before = np.roll(edges, 1, axis=0)
    return bool(np.all(before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0] >= -tolerance))


def footprint_corners(pose: Pose2D, half_side: float) -> FloatArray:
    """Return the (4, 2) corners of the robot's square at `pose`, world frame, counter-clockwise."""
    square = half_side * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    return square @ rotation(pose.yaw).T + (pose.x, pose.y)


def footprint(pose: Pose2D, half_side: float) -> Polygon:
    """Return the robot's square at `pose`, world frame."""
    return Polygon(footprint_corners(pose, half_side))


def footprints(poses: FloatArray, half_side: float) -> npt.NDArray[np.object_]:
    """Return the (n,) squares at (n, 3) `poses` (x, y, yaw), world frame."""
    square = half_side * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    corners = square @ np.swapaxes(rotation(poses[:, 2]), 1, 2) + poses[:, None, :2]
    squares: npt.NDArray[np.object_] = np.asarray(shapely.polygons(corners))
    return squares


def convex_parts(polygon: FloatArray) -> list[FloatArray]:
    """Cut a simple (n, 2) `polygon` into convex parts without gaps or overlaps.

    Triangles of the constrained Delaunay triangulation are merged as long as the union stays
    convex. Every part is counter-clockwise and uses the polygon's own corners only, so the parts'
    areas add up to the polygon's.
    """
    outline = counter_clockwise(polygon)
    if is_convex(outline):
        return [outline]
    return _merge_convex(_triangles(outline), outline)


Part = list[int]  # indices of the outline's corners, counter-clockwise


def _triangles(outline: FloatArray) -> list[Part]:
    index = {(x, y): i for i, (x, y) in enumerate(outline.tolist())}
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(Polygon(outline)))
    parts = []
    for corners in shapely.get_coordinates(triangles).reshape(-1, 4, 2):  # first repeated last
        a, b, c = (index[x, y] for x, y in corners[:3].tolist())
        parts.append([a, b, c] if signed_area(outline[[a, b, c]]) > 0 else [a, c, b])
    return parts


def _merge_convex(parts: list[Part], outline: FloatArray) -> list[FloatArray]:
    """Remove each diagonal whose removal leaves a convex part (Hertel and Mehlhorn's rule)."""
    owner = {edge: part for part in parts for edge in _edges(part)}
    for edge in list(owner):
        left, right = owner.get(edge), owner.get(edge[::-1])
        if left is None or right is None or left is right:
            continue
        merged = _joined(left, right, edge)
        if is_convex(outline[merged]):
            del owner[edge], owner[edge[::-1]]
            owner.update((kept, merged) for kept in _edges(merged))
    unique = {id(part): part for part in owner.values()}
    return [outline[part] for part in unique.values()]


def _edges(part: Part) -> list[tuple[int, int]]:
    return list(zip(part, part[1:] + part[:1], strict=True))


def _joined(left: Part, right: Part, edge: tuple[int, int]) -> Part:
    """Return the cycle around two parts that share `edge`, which runs a-b in left, b-a in right."""
    a, b = edge
    from_b = left.index(b)
    from_a = right.index(a)
    around_left = left[from_b:] + left[:from_b]  # b ... a
    around_right = right[from_a:] + right[:from_a]  # a ... b
    return around_left + around_right[1:-1]
