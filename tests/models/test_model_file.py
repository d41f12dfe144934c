"""What the model file says against what the rest of the product believes of the robot."""

import mujoco
import numpy as np
import pytest
from rigs import place, scene

from fuzzynav_mj.assets import model_path
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.sensing.lidar import OBSTACLE_GROUP, Lidar, ray_bearings
from fuzzynav_mj.types import FloatArray

SIDES = ("left", "right")


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return scene()


def rays(model: mujoco.MjModel) -> list[int]:
    """The range sensors of the model, in order."""
    kind = mujoco.mjtSensor.mjSENS_RANGEFINDER
    return [index for index in range(model.nsensor) if model.sensor_type[index] == kind]


def test_physics_period(model: mujoco.MjModel) -> None:
    assert model.opt.timestep == DEFAULT_ROBOT.physics_period
    ratio = DEFAULT_ROBOT.decision_period / DEFAULT_ROBOT.physics_period
    assert DEFAULT_ROBOT.substeps == pytest.approx(ratio, abs=1e-9)


def test_footprint_is_the_hulls_square(model: mujoco.MjModel) -> None:
    hull = model.geom("hull")
    assert hull.type[0] == mujoco.mjtGeom.mjGEOM_BOX
    assert hull.pos[:2].tolist() == [0.0, 0.0]
    assert hull.size[:2] == pytest.approx(DEFAULT_ROBOT.half_side)


def test_wheels(model: mujoco.MjModel) -> None:
    left, right = (model.body(f"wheel_{side}").pos for side in SIDES)
    assert left[1] - right[1] == pytest.approx(DEFAULT_ROBOT.track)
    for side, middle in zip(SIDES, (left, right), strict=True):
        assert middle[0] == pytest.approx(-DEFAULT_ROBOT.axle_offset)
        assert middle[2] == pytest.approx(DEFAULT_ROBOT.wheel_radius)
        assert model.geom(f"wheel_{side}").size[:2] == pytest.approx(DEFAULT_ROBOT.wheel_radius)


def test_every_commanded_wheel_speed_is_within_the_servos_range(model: mujoco.MjModel) -> None:
    spec = DEFAULT_ROBOT
    fastest = (spec.max_speed + spec.max_yaw_rate * spec.track / 2) / spec.wheel_radius
    for side in SIDES:
        low, high = model.actuator(f"drive_{side}").ctrlrange
        assert low <= -fastest and fastest <= high


def test_servos_can_give_the_accelerations_that_are_commanded(model: mujoco.MjModel) -> None:
    spec = DEFAULT_ROBOT
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    dof = model.joint("wheel_left").dofadr[0]
    wheel_inertia = mass_matrix(model, data)[dof, dof]
    mass = float(model.body_mass.sum())
    force = float(model.actuator("drive_left").forcerange[1])
    wheels = 2.0 * wheel_inertia / spec.wheel_radius**2
    assert 2.0 * force / spec.wheel_radius / (mass + wheels) >= spec.max_acceleration


def test_wheel_servos_keep_the_body_from_running_ahead(model: mujoco.MjModel) -> None:
    """implicitfast solves contacts without the servo's damping: kv dt / I must stay small."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    inertia = mass_matrix(model, data)
    for side in SIDES:
        dof = model.joint(f"wheel_{side}").dofadr[0]
        kv = model.actuator(f"drive_{side}").gainprm[0]
        assert kv * model.opt.timestep / inertia[dof, dof] <= 0.5


def mass_matrix(model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full


def test_ray_sensors(model: mujoco.MjModel) -> None:
    sensors = rays(model)
    assert len(sensors) == DEFAULT_ROBOT.ray_count
    assert set(model.sensor_cutoff[sensors].tolist()) == {DEFAULT_ROBOT.sensor_range}
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    sites = model.sensor_objid[sensors]
    origin = data.site("lidar").xpos
    assert np.abs(data.site_xpos[sites] - origin).max() < 1e-12
    assert origin[:2].tolist() == [0.0, 0.0]
    directions = data.site_xmat[sites].reshape(-1, 3, 3)[:, :, 2]
    bearings = np.sort(np.arctan2(directions[:, 1], directions[:, 0]))
    assert np.abs(directions[:, 2]).max() < 1e-12
    step = 2 * np.pi / DEFAULT_ROBOT.ray_count
    assert np.diff(bearings) == pytest.approx(step, abs=1e-9)
    expected = ray_bearings(DEFAULT_ROBOT.ray_count)
    offset = (bearings[:, None] - expected + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(offset).min(axis=1).max() < 1e-9


def lidar(model: mujoco.MjModel) -> Lidar:
    return Lidar(model, "lidar", DEFAULT_ROBOT.ray_count, DEFAULT_ROBOT.sensor_range)


def test_in_an_empty_room_no_ray_hits_the_robot_or_the_floor(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    for yaw in np.linspace(-np.pi, np.pi, 9):
        place(data, 0.3, -0.2, float(yaw))
        assert data.sensordata[model.sensor_adr[rays(model)]].max() < 0.0
        scan = lidar(model).scan(data)
        assert not scan.hit.any()
        assert (scan.ranges == DEFAULT_ROBOT.sensor_range).all()


def test_obstacles_are_what_the_lidar_looks_for(model: mujoco.MjModel) -> None:
    with model_path("showroom.xml") as path:
        shown = mujoco.MjModel.from_xml_path(str(path))
    seen = {shown.geom(name).group[0] for name in ("box", "post")}
    assert seen == {OBSTACLE_GROUP}
    robot = shown.body("chassis").id
    own = [g for g in range(shown.ngeom) if shown.body_rootid[shown.geom_bodyid[g]] == robot]
    assert OBSTACLE_GROUP not in shown.geom_group[own]


def test_ray_sensors_of_the_model_file_agree_with_the_lidar() -> None:
    rng = np.random.default_rng(7)
    geoms = "".join(
        f'<geom class="obstacle" type="{kind}" size="{a} {b} 0.15" pos="{x} {y} 0.15" '
        f'euler="0 0 {turn}"/>'
        for kind, a, b, x, y, turn in (
            (
                "box" if rng.random() < 0.5 else "cylinder",
                rng.uniform(0.05, 0.3),
                0.15 if rng.random() < 0.5 else rng.uniform(0.05, 0.3),
                *rng.uniform(-1.5, 1.5, 2),
                rng.uniform(-3, 3),
            )
            for _ in range(25)
        )
    )
    model = scene(geoms)
    with model_path("showroom.xml") as path:
        showroom = mujoco.MjModel.from_xml_path(str(path))
    for compiled in (model, showroom):
        data, eyes, sensors = mujoco.MjData(compiled), lidar(compiled), rays(compiled)
        order = sensor_order(compiled, sensors)
        for _ in range(60):
            place(data, *rng.uniform(-1.5, 1.5, 2), float(rng.uniform(-np.pi, np.pi)))
            scan = eyes.scan(data)
            readings = data.sensordata[compiled.sensor_adr[sensors]][order]
            reach = DEFAULT_ROBOT.sensor_range
            seen = np.where((readings < 0.0) | (readings > reach), reach, readings)
            assert np.abs(seen - scan.ranges).max() < 1e-6
            assert np.array_equal((readings >= 0.0) & (readings < reach), scan.hit)


def sensor_order(model: mujoco.MjModel, sensors: list[int]) -> list[int]:
    """For each of the lidar's bearings the index of the sensor that looks there."""
    data = mujoco.MjData(model)
    place(data, 0.0, 0.0, 0.0)
    directions = data.site_xmat[model.sensor_objid[sensors]].reshape(-1, 3, 3)[:, :, 2]
    own = np.arctan2(directions[:, 1], directions[:, 0])
    wanted = ray_bearings(len(sensors))
    apart = np.abs((own[None] - wanted[:, None] + np.pi) % (2 * np.pi) - np.pi)
    order: list[int] = apart.argmin(axis=1).tolist()
    return order
