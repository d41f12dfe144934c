"""Obstacles of any shape: contact and rays against plane geometry."""

import mujoco
import numpy as np
import pytest
import shapely
from scenes import circle, mover, polygon, random_polygon, ray_ranges, scenario

from fuzzynav_mj.geometry import convex_parts, footprint, is_convex
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.sensing.lidar import Lidar
from fuzzynav_mj.tasks.arena import as_rectangle
from fuzzynav_mj.tasks.environment import NavigationEnvironment
from fuzzynav_mj.tasks.navigation import NavigateToGoal
from fuzzynav_mj.types import FloatArray, Pose2D

REACH = DEFAULT_ROBOT.sensor_range


def shapes() -> list[Shape]:
    """Concave and convex polygons, rectangles and circles about the origin."""
    rng = np.random.default_rng(11)
    drawn = [random_polygon(rng, float(rng.uniform(0.12, 0.4)), i % 2 == 0) for i in range(36)]
    notch = polygon((-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (0.15, 0.3), (0.15, -0.15),
                    (-0.15, -0.15), (-0.15, 0.3), (-0.3, 0.3))  # fmt: skip
    plate = polygon((-0.4, -0.02), (0.4, -0.02), (0.4, 0.02), (-0.4, 0.02))
    turned = polygon((0.0, -0.2), (0.2, 0.0), (0.0, 0.2), (-0.2, 0.0))
    return [*drawn, notch, plate, turned, circle(0.05, -0.02, 0.2)]


def compiled(environment: NavigationEnvironment) -> tuple[mujoco.MjModel, mujoco.MjData]:
    return environment.physics.model.ptr, environment.physics.data.ptr


def place(data: mujoco.MjData, pose: Pose2D) -> None:
    half = pose.yaw / 2
    start = int(data.model.joint("robot/").qposadr[0])
    data.qpos[start : start + 7] = (pose.x, pose.y, 0, np.cos(half), 0, 0, np.sin(half))


def touched(data: mujoco.MjData) -> bool:
    return bool(data.sensor("robot/hit").data[0] > 0.0)


@pytest.fixture(scope="module")
def environment() -> NavigationEnvironment:
    """Every shape twice: static on a grid to the right, moving and parked far to the left."""
    placed, parked = [], []
    for index, shape in enumerate(shapes()):
        offset = np.array([2.0 * (index % 8), 2.0 * (index // 8)])
        if shape.polygon is not None:
            placed.append(Shape(shape.polygon + offset, None))
        else:
            x, y, radius = shape.circle or (0.0, 0.0, 0.0)
            placed.append(circle(x + offset[0], y + offset[1], radius))
        spot = (-50.0 - 2.0 * index, 0.0)
        parked.append(mover(shape, spot, (spot[0], 1.0), 0.1))
    made = scenario(
        start=(-5.0, -5.0, 0.0), static=tuple(placed), moving=tuple(parked), walls=False
    )
    built = NavigationEnvironment(NavigateToGoal(made, 0))
    built.reset()
    return built


def random_poses(count: int, about: FloatArray, spread: float) -> list[Pose2D]:
    rng = np.random.default_rng(5)
    return [
        Pose2D(*(about + rng.uniform(-spread, spread, 2)).tolist(), rng.uniform(-np.pi, np.pi))
        for _ in range(count)
    ]


def area(shape: Shape) -> shapely.Polygon:
    """The shape's footprint; circles to within a micrometre."""
    if shape.circle is None:
        return shape.footprint
    x, y, radius = shape.circle
    return shapely.Point(x, y).buffer(radius, quad_segs=512)


def gap_with_sign(square: shapely.Polygon, obstacle: shapely.Polygon) -> float:
    """Distance, or minus a measure of the overlap's width where the two overlap."""
    if not square.intersects(obstacle):
        return float(square.distance(obstacle))
    return -(float(shapely.area(square.intersection(obstacle))) ** 0.5)


def test_moving_shapes_touch_exactly_where_they_overlap(
    environment: NavigationEnvironment,
) -> None:
    model, data = compiled(environment)
    disagreed, both = 0, [0, 0]
    for index, shape in enumerate(shapes()):
        slot = int(model.body_mocapid[model.body(f"moving_{index}").id])
        parked = data.mocap_pos[slot].copy()
        data.mocap_pos[slot, :2] = (-5.0, -5.0)
        obstacle = shapely.affinity.translate(shape.footprint, -5.0, -5.0)
        for pose in random_poses(15, np.array([-5.0, -5.0]), 0.45):
            square = footprint(pose, DEFAULT_ROBOT.half_side)
            gap = gap_with_sign(square, obstacle)
            if abs(gap) < 1e-3:
                continue
            place(data, pose)
            mujoco.mj_forward(model, data)
            disagreed += touched(data) != (gap < 0.0)
            both[gap < 0.0] += 1
        data.mocap_pos[slot] = parked
    assert disagreed == 0
    assert min(both) > 100  # neither answer is the only one


def test_static_shapes_touch_exactly_where_they_overlap(
    environment: NavigationEnvironment,
) -> None:
    model, data = compiled(environment)
    disagreed = 0
    for shape in environment.task.world.static:
        obstacle = shape.footprint
        middle = np.array(obstacle.centroid.coords[0])
        for pose in random_poses(15, middle, 0.45):
            gap = gap_with_sign(footprint(pose, DEFAULT_ROBOT.half_side), obstacle)
            if abs(gap) < 1e-3:
                continue
            place(data, pose)
            mujoco.mj_forward(model, data)
            disagreed += touched(data) != (gap < 0.0)
    assert disagreed == 0


def test_rays_measure_the_true_distance(environment: NavigationEnvironment) -> None:
    model, data = compiled(environment)
    lidar = Lidar(model, "robot/lidar", DEFAULT_ROBOT.ray_count, REACH)
    errors = []
    standing = shapely.union_all([area(shape) for shape in environment.task.world.static])
    for index, shape in enumerate(environment.task.world.static):
        slot = int(model.body_mocapid[model.body(f"moving_{index}").id])
        parked = data.mocap_pos[slot].copy()
        moved = np.add(shape.footprint.centroid.coords[0], (0.4, 0.5))
        data.mocap_pos[slot, :2] = moved
        second = shapely.affinity.translate(area(shapes()[index]), *moved)
        obstacles = shapely.union(standing, second)
        for pose in random_poses(12, moved - (0.2, 0.25), 0.8):
            if obstacles.covers(shapely.Point(pose.x, pose.y)):
                continue
            place(data, pose)
            mujoco.mj_forward(model, data)
            scan = lidar.scan(data)
            exact = ray_ranges(obstacles, pose, scan.bearings, REACH)
            errors.append(np.abs(scan.ranges - exact))
            assert np.array_equal(scan.hit, scan.ranges < REACH)
        data.mocap_pos[slot] = parked
    off = np.concatenate(errors)
    assert len(off) > 40_000
    assert off.max() < 1e-4


def test_concave_shapes_stand_as_convex_prisms(environment: NavigationEnvironment) -> None:
    model, _ = compiled(environment)
    names = [model.geom(index).name for index in range(model.ngeom)]
    for index, shape in enumerate(shapes()):
        parts = 1 if shape.polygon is None else len(convex_parts(shape.polygon))
        for kind in ("static", "moving"):
            assert sum(name.startswith(f"{kind}_{index}_") for name in names) == parts
    assert sum(s.polygon is not None and not is_convex(s.polygon) for s in shapes()) >= 12


def test_rectangles_are_recognised() -> None:
    box = as_rectangle(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]))
    assert box == ((1.0, 0.5), (1.0, 0.5), 0.0)
    (x, y), (half_x, half_y), yaw = as_rectangle(
        np.array([[0.0, -1.0], [1.0, 0.0], [-1.0, 2.0], [-2.0, 1.0]])
    ) or ((0.0, 0.0), (0.0, 0.0), 0.0)
    assert (x, y) == pytest.approx((-0.5, 0.5))
    assert (half_x, half_y) == pytest.approx((2**-0.5, 2**0.5))
    assert yaw == pytest.approx(np.pi / 4)


@pytest.mark.parametrize(
    "corners",
    [
        [[0.0, 0.0], [2.0, 0.0], [2.5, 1.0], [0.5, 1.0]],  # parallelogram
        [[0.0, 0.0], [2.0, 0.0], [1.5, 1.0], [0.5, 1.0]],  # trapezium
        [[0.0, 0.0], [2.0, 0.0], [1.0, 1.0]],
    ],
)
def test_other_polygons_are_no_rectangles(corners: list[list[float]]) -> None:
    assert as_rectangle(np.array(corners)) is None
