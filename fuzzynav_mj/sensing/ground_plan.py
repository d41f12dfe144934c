"""Where horizontal rays meet upright obstacles: the model's outlines in the plane.

Boxes, cylinders and prisms that stand upright look the same at every height, so a ray that stays
between their lower and upper ends meets their outlines. MuJoCo's own rays give the same distances,
but take the longer the more triangles there are.
"""

from dataclasses import dataclass
from itertools import product
from math import hypot, sqrt

import mujoco
import numpy as np
import shapely

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import FloatArray, IntArray

UPRIGHT = 1e-6  # m, and of a unit vector: larger deviations are not upright


@dataclass(frozen=True, slots=True, eq=False)
class GroundPlan:
    """Outlines of g geoms with e edges in all, in the frames of bodies that never turn.

    Attributes:
        edges: (e, 4) x, y of each edge's ends, m.
        first: (g + 1,) each geom's first edge; its last is the one before the next geom's. A geom
            without edges is a circle.
        circles: (g, 3) x, y and radius of the circle, or of one around the edges, m.
        bodies: (g,) number of the body that each geom belongs to.
        low, high: m; between these heights the plan holds.
    """

    edges: FloatArray
    first: IntArray
    circles: FloatArray
    bodies: IntArray
    low: float
    high: float

    def ranges(
        self, data: mujoco.MjData, site: int, directions: FloatArray, max_range: float
    ) -> FloatArray | None:
        """(n,) distances of the first obstacle on each ray, m; `max_range` where there is none.

        None if the rays are too oblique for the plan.

        Args:
            data: with kinematics up to date.
            site: number of the site that the rays start from.
            directions: (2, n) unit vectors in the site's x-y plane.
            max_range: m.
        """
        origin, axes = data.site_xpos[site], data.site_xmat[site]
        x, y, z = origin.tolist()
        rise = max_range * hypot(axes[6], axes[7])
        if not self.low < z - rise <= z + rise < self.high:
            return None
        return _ranges(
            x, y, axes, directions, self.edges, self.first, self.circles, self.bodies, data.xpos,
            max_range,
        )  # fmt: skip


@compiled
def _ranges(
    x: float,
    y: float,
    axes: FloatArray,
    directions: FloatArray,
    edges: FloatArray,
    first: IntArray,
    circles: FloatArray,
    bodies: IntArray,
    places: FloatArray,
    max_range: float,
) -> FloatArray:
    """(n,) distances; see `GroundPlan.ranges`.

    Args:
        x, y: where the rays start.
        axes: (9,) the site's rotation matrix.
        directions: (2, n).
        edges, first, circles, bodies: the plan's.
        places: (bodies, 3) of the bodies.
        max_range: m.
    """
    count = directions.shape[1]
    ranges = np.full(count, max_range)
    along_x = axes[0] * directions[0] + axes[1] * directions[1]
    along_y = axes[3] * directions[0] + axes[4] * directions[1]
    for g in range(len(circles)):
        left, down = places[bodies[g], 0] - x, places[bodies[g], 1] - y
        cx, cy, radius = circles[g, 0] + left, circles[g, 1] + down, circles[g, 2]
        outside = cx * cx + cy * cy - radius * radius
        if cx * cx + cy * cy > (max_range + radius) ** 2:
            continue
        if first[g] == first[g + 1]:
            for i in range(count):
                dx, dy = along_x[i], along_y[i]
                squared, middle = dx * dx + dy * dy, dx * cx + dy * cy
                root = middle * middle - squared * outside
                if root < 0.0:
                    continue
                distance = (middle - sqrt(root)) / squared
                if distance < 0.0:  # from within, the way out
                    distance = (middle + sqrt(root)) / squared
                if distance >= 0.0:
                    ranges[i] = min(ranges[i], distance)
        for e in range(first[g], first[g + 1]):
            ax, ay = edges[e, 0] + left, edges[e, 1] + down
            bx, by = edges[e, 2] + left, edges[e, 3] + down
            area = ax * by - ay * bx
            for i in range(count):
                dx, dy = along_x[i], along_y[i]
                # Both edges at a corner decide alike on which side of the ray it lies, so no ray
                # slips through between them.
                side_a, side_b = ax * dy - ay * dx, bx * dy - by * dx
                if (side_a >= 0.0) != (side_b >= 0.0):
                    distance = area / (side_a - side_b)
                    if distance >= 0.0:
                        ranges[i] = min(ranges[i], distance)
    return ranges


def ground_plan(model: mujoco.MjModel, group: int, excluded_body: int) -> GroundPlan | None:
    """The plan of the geoms of a group; None if any is neither upright nor the floor.

    Args:
        model: compiled model.
        group: the geoms' group.
        excluded_body: whose geoms are left out.
    """
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    low, high = -np.inf, np.inf
    edges, circles, bodies, first = [np.empty((0, 4))], [], [], [0]
    for geom in np.flatnonzero(model.geom_group == group).tolist():
        body = int(model.geom_bodyid[geom])
        if body == excluded_body:
            continue
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE and _upright(data, geom):
            low = max(low, float(data.geom_xpos[geom, 2]))
            continue
        shape = _shape(model, data, geom)
        if shape is None:
            return None
        low, high = max(low, shape.low), min(high, shape.high)
        place = data.xpos[body, :2]
        corners = shape.corners - place
        edges.append(np.hstack((corners, np.roll(corners, -1, axis=0))))
        first.append(first[-1] + len(corners))
        circles.append((*(shape.centre - place).tolist(), shape.radius))
        bodies.append(body)
    return GroundPlan(
        edges=np.concatenate(edges),
        first=np.array(first, dtype=np.intp),
        circles=np.array(circles, dtype=np.float64).reshape(-1, 3),
        bodies=np.array(bodies, dtype=np.intp),
        low=low,
        high=high,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Shape:
    """An upright geom, world frame.

    Attributes:
        corners: (k, 2) of its outline in turn; none for a circle.
        centre: (2,) of the circle, or of one around the corners.
        radius: of that circle, m.
        low, high: the heights of its ends, m.
    """

    corners: FloatArray
    centre: FloatArray
    radius: float
    low: float
    high: float


def _upright(data: mujoco.MjData, geom: int) -> bool:
    """True if the geom's z axis is the world's, up or down."""
    return abs(float(data.geom_xmat[geom, 8])) > 1.0 - UPRIGHT**2


def _shape(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> _Shape | None:
    """The geom's outline; None if it is not upright, can turn, or is invisible to rays."""
    body = int(model.geom_bodyid[geom])
    if (body != 0 and model.body_mocapid[body] < 0) or model.geom_rgba[geom, 3] == 0.0:
        return None
    kind, size = model.geom_type[geom], model.geom_size[geom]
    place, axes = data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER and _upright(data, geom):
        low, high = place[2] - size[1], place[2] + size[1]
        return _Shape(np.empty((0, 2)), place[:2], float(size[0]), float(low), float(high))
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        spots = np.array(list(product(*zip(-size, size, strict=True))))
    elif kind == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = model.geom_dataid[geom]
        start = model.mesh_vertadr[mesh]
        spots = model.mesh_vert[start : start + model.mesh_vertnum[mesh]].astype(np.float64)
    else:
        return None
    spots = spots @ axes.T + place
    low, high = float(spots[:, 2].min()), float(spots[:, 2].max())
    lower, upper = (spots[np.abs(spots[:, 2] - end) < UPRIGHT, :2] for end in (low, high))
    if len(lower) + len(upper) < len(spots) or not _same_places(lower, upper):
        return None
    # Contacts and, for want of faces of their own, rays see the hull of a mesh's corners.
    outline = shapely.MultiPoint(spots[:, :2]).convex_hull
    corners = shapely.get_coordinates(outline)[:-1]
    centre = corners.mean(axis=0)
    radius = float(np.hypot(*(corners - centre).T).max())
    return _Shape(corners, centre, radius, low, high)


def _same_places(some: FloatArray, others: FloatArray) -> bool:
    """True if each of the one has one of the others on the spot, and each of those one of them."""
    gaps = np.hypot(*(some[:, None] - others).transpose(2, 0, 1))
    return bool((gaps.min(axis=0) < UPRIGHT).all() and (gaps.min(axis=1) < UPRIGHT).all())
