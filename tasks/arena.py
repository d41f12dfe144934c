"""The arena: floor, walls, static obstacles and the moving ones as mocap bodies."""

import numpy as np
from dm_control import composer, mjcf

from fuzzynav_mj.assets import model_path
from fuzzynav_mj.geometry import convex_parts
from fuzzynav_mj.scenarios.world import Mover, Shape, World
from fuzzynav_mj.types import FloatArray

OBSTACLE_HEIGHT = 0.3
WALL_THICKNESS = 0.1
STATIC_COLOUR = (0.55, 0.57, 0.60, 1.0)
WALL_COLOUR = (0.45, 0.47, 0.50, 1.0)
MOVER_COLOUR = (0.84, 0.37, 0.0, 1.0)
GOAL_COLOUR = (0.0, 0.62, 0.45, 0.6)


class NavigationArena(composer.Arena):
    """One world. Geoms are named by what they belong to: "wall", "static_3", "moving_1"."""

    def _build(self, world: World, name: str = "arena") -> None:
        with model_path("arenas/room.xml") as path:
            self._mjcf_root = mjcf.from_path(str(path))
        self._mjcf_root.model = name
        self._movers: list[mjcf.Element] = []
        self._mover_meshes: list[mjcf.Element] = []
        scenario = world.scenario
        if scenario.walls:
            self._add_walls(scenario.bounds)
        for index, shape in enumerate(world.static):
            # Static geoms stand directly in the world body: bodies of their own double the cost.
            add_shape(self._mjcf_root, self._mjcf_root.worldbody, shape, f"static_{index}")
        self._mjcf_root.worldbody.add(
            "site",
            name="goal",
            type="cylinder",
            pos=(*scenario.goal, 0.002),
            size=(scenario.goal_tolerance, 0.002),
            rgba=GOAL_COLOUR,
        )
        self.set_movers(world.movers)

    @property
    def mover_bodies(self) -> list[mjcf.Element]:
        """The mocap bodies, in the world's order."""
        return self._movers

    def set_movers(self, movers: tuple[Mover, ...]) -> None:
        """Replaces the moving obstacles; the model must be compiled afterwards."""
        for element in (*self._movers, *self._mover_meshes):
            element.remove()
        self._movers, self._mover_meshes = [], []
        for index, mover in enumerate(movers):
            x, y = mover.motion.positions(np.zeros(1))[0]
            body = self._mjcf_root.worldbody.add(
                "body", name=f"moving_{index}", mocap=True, pos=(x, y, 0.0)
            )
            # Moved by command, a body's inertia plays no part; but MuJoCo places the sphere around
            # a body, outside which it tests no ray, as if the inertia's axes were the world's.
            # Left to itself it would turn them with the meshes, and rays would miss corners.
            body.add("inertial", pos=(0.0, 0.0, 0.0), mass=1.0, diaginertia=(1.0, 1.0, 1.0))
            self._movers.append(body)
            self._mover_meshes += add_shape(
                self._mjcf_root, body, mover.shape, f"moving_{index}", MOVER_COLOUR
            )

    def _add_walls(self, bounds: tuple[float, float, float, float]) -> None:
        x_min, y_min, x_max, y_max = bounds
        t = WALL_THICKNESS / 2
        width, depth = (x_max - x_min) / 2, (y_max - y_min) / 2
        x, y = (x_max + x_min) / 2, (y_max + y_min) / 2
        sides = {
            "west": ((x_min - t, y), (t, depth + 2 * t)),
            "east": ((x_max + t, y), (t, depth + 2 * t)),
            "south": ((x, y_min - t), (width, t)),
            "north": ((x, y_max + t), (width, t)),
        }
        for side, (centre, half) in sides.items():
            self._mjcf_root.worldbody.add(
                "geom",
                name=f"wall_{side}",
                dclass="obstacle",
                type="box",
                pos=(*centre, OBSTACLE_HEIGHT / 2),
                size=(*half, OBSTACLE_HEIGHT / 2),
                rgba=WALL_COLOUR,
            )


def add_shape(
    root: mjcf.RootElement,
    body: mjcf.Element,
    shape: Shape,
    name: str,
    colour: tuple[float, float, float, float] = STATIC_COLOUR,
) -> list[mjcf.Element]:
    """Adds a shape's geoms to a body and returns the meshes made for it.

    Concave polygons become several convex prisms, since MuJoCo lets rays see a mesh's triangles
    but lets contacts see its convex hull. Rectangles become boxes, which are cheaper for rays.
    """
    common = {"dclass": "obstacle", "rgba": colour}
    half = OBSTACLE_HEIGHT / 2
    if shape.circle is not None:
        x, y, radius = shape.circle
        body.add(
            "geom",
            name=f"{name}_0",
            type="cylinder",
            pos=(x, y, half),
            size=(radius, half),
            **common,
        )
        return []
    assert shape.polygon is not None
    box = as_rectangle(shape.polygon)
    if box is not None:
        (x, y), (half_x, half_y), yaw = box
        body.add(
            "geom",
            name=f"{name}_0",
            type="box",
            pos=(x, y, half),
            size=(half_x, half_y, half),
            euler=(0.0, 0.0, yaw),
            **common,
        )
        return []
    meshes = []
    for part, corners in enumerate(convex_parts(shape.polygon)):
        rim = np.repeat(corners, 2, axis=0)
        height = np.tile([0.0, OBSTACLE_HEIGHT], len(corners))
        mesh = root.asset.add(
            "mesh",
            name=f"{name}_{part}",
            vertex=np.column_stack((rim, height)).ravel(),
            inertia="convex",
        )
        body.add("geom", name=f"{name}_{part}", type="mesh", mesh=mesh, **common)
        meshes.append(mesh)
    return meshes


def as_rectangle(
    polygon: FloatArray,
) -> tuple[tuple[float, float], tuple[float, float], float] | None:
    """Centre, half sizes and yaw of a rectangle; None for any other polygon."""
    if len(polygon) != 4:
        return None
    first, second = polygon[1] - polygon[0], polygon[2] - polygon[1]
    lengths = np.hypot(*first), np.hypot(*second)
    closed = np.allclose(polygon[0] + polygon[2], polygon[1] + polygon[3], atol=1e-9)
    if not closed or abs(float(first @ second)) > 1e-9 * lengths[0] * lengths[1]:
        return None
    x, y = polygon.mean(axis=0)
    yaw = float(np.arctan2(first[1], first[0]))
    return (float(x), float(y)), (float(lengths[0]) / 2, float(lengths[1]) / 2), yaw
