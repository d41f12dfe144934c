"""The shortest path among static obstacles in hindsight: the lower bound of every planner."""

from collections.abc import Sequence

import numpy as np
import shapely
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra
from shapely.geometry.base import BaseGeometry

from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

ARC_SEGMENTS = 16  # per quarter turn of an inflated corner
TOUCH = 1e-7  # m; paths may run along what they must not enter
ROUNDING = 1e-15  # m4, of the product of two cross products


def shortest_path(
    static: Sequence[Shape],
    bounds: tuple[float, float, float, float] | None,
    start: tuple[float, float],
    goal: tuple[float, float],
    clearance: float = DEFAULT_ROBOT.half_side,
) -> tuple[float, FloatArray]:
    """Find the shortest path of the robot's centre by an exact visibility graph.

    The obstacles are inflated by a disc of radius `clearance` and the walls moved inwards by it:
    with half a side, the square robot can be no closer in any direction of yaw, so that the length
    is a lower bound for it. The disc's arcs are polygons inscribed in them, which shortens a
    quarter turn around a corner by less than 0.05 % of its arc, under 0.1 mm at 0.10 m.

    Args:
        static: obstacles in the world frame.
        bounds: x_min, y_min, x_max, y_max of the walls, m; None without walls.
        start: (x, y), m.
        goal: (x, y), m.
        clearance: distance that the centre keeps from obstacles and walls, m.

    Returns:
        The length, m, and the (k, 2) corners of the path; `inf` and no corners without a path.
    """
    blocked = shapely.union_all([shape.inflated(clearance, ARC_SEGMENTS) for shape in static])
    nodes, before, after = _convex_corners(blocked)
    if bounds is not None:
        inside = _inside(nodes, bounds, clearance)
        nodes, before, after = nodes[inside], before[inside], after[inside]
        if not _inside(np.array([start, goal]), bounds, clearance).all():
            return float("inf"), np.empty((0, 2))
    ends = np.array([start, goal])
    nodes = np.vstack([ends, nodes])
    edges = _edges(nodes, np.vstack([ends, before]), np.vstack([ends, after]))
    shrunk = blocked.buffer(-TOUCH)
    shapely.prepare(shrunk)
    edges = edges[~shapely.intersects(shrunk, shapely.linestrings(nodes[edges]))]
    lengths = np.hypot(*(nodes[edges[:, 0]] - nodes[edges[:, 1]]).T)
    graph = csr_matrix((lengths, edges.T), shape=(len(nodes), len(nodes)))
    distances, predecessors = dijkstra(graph, directed=False, indices=0, return_predecessors=True)
    if not np.isfinite(distances[1]):
        return float("inf"), np.empty((0, 2))
    path = [1]
    while path[-1] != 0:
        path.append(int(predecessors[path[-1]]))
    return float(distances[1]), nodes[path[::-1]]


def _inside(
    points: FloatArray, bounds: tuple[float, float, float, float], clearance: float
) -> BoolArray:
    low = np.array(bounds[:2]) + clearance - TOUCH
    high = np.array(bounds[2:]) - clearance + TOUCH
    inside: BoolArray = np.all((points >= low) & (points <= high), axis=1)
    return inside


def _convex_corners(blocked: BaseGeometry) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the corners that a taut path can bend at, and their two neighbours, each (n, 2)."""
    corners, befores, afters = [np.empty((0, 2))], [np.empty((0, 2))], [np.empty((0, 2))]
    for polygon in shapely.get_parts(shapely.orient_polygons(blocked)):  # covered on the left
        for ring in [polygon.exterior, *polygon.interiors]:
            points = shapely.get_coordinates(ring)[:-1]
            before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
            convex = _cross(points - before, after - points) > 0.0
            corners.append(points[convex])
            befores.append(before[convex])
            afters.append(after[convex])
    return np.vstack(corners), np.vstack(befores), np.vstack(afters)


def _edges(nodes: FloatArray, before: FloatArray, after: FloatArray) -> IntArray:
    """Return the (m, 2) pairs of nodes whose join touches the obstacles at both without entering.

    A taut path bends around a corner, so its legs leave both of the corner's sides on one hand.
    A node that is its own neighbour, start or goal, admits every direction.
    """
    product = np.ones((len(nodes), len(nodes)))
    for neighbour in (before, after):
        side = neighbour - nodes
        at_node = _cross(nodes, side)
        # [i, j]: on which hand of node i's side the leg from i to j leaves
        product *= nodes[:, 0] * side[:, 1:] - nodes[:, 1] * side[:, :1] - at_node[:, None]
    taut = product >= -ROUNDING
    pairs: IntArray = np.argwhere(np.triu(taut & taut.T, k=1))
    return pairs


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
