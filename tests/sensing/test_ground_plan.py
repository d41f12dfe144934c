"""The plan's rays against MuJoCo's own, and where the plan must not be used."""

from math import hypot, pi

import mujoco
import numpy as np
import pytest

from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.sensing.ground_plan import GroundPlan, ground_plan
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.types import FloatArray

REACH, RAYS = 0.8, 180
BEARINGS = np.arange(RAYS) * (2 * pi / RAYS)
DIRECTIONS = np.stack((np.cos(BEARINGS), np.sin(BEARINGS)))
SCENE = """
<mujoco>
  <worldbody>
    <body name="robot">
      <freejoint/>
      <geom type="box" size="0.1 0.1 0.1" mass="1"/>
      <site name="eye" pos="0 0 0.1"/>
    </body>
    <geom type="plane" size="0 0 1" group="0"/>
    {geoms}
  </worldbody>
</mujoco>
"""
BOX = '<geom type="box" size="0.1 0.1 0.3" pos="0.5 0 0.3" {more}/>'


def scene(geoms: str) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """A robot that looks from its centre, 0.1 m above the floor, among the geoms."""
    model = mujoco.MjModel.from_xml_string(SCENE.format(geoms=geoms))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def plan_of(model: mujoco.MjModel) -> GroundPlan | None:
    return ground_plan(model, 0, int(model.body("robot").id))


def seen(geoms: str) -> FloatArray:
    """What the plan's rays find among the geoms."""
    model, data = scene(geoms)
    plan = plan_of(model)
    assert plan is not None
    ranges = plan.ranges(data, model.site("eye").id, DIRECTIONS, REACH)
    assert ranges is not None
    return ranges


def cast(
    model: mujoco.MjModel, data: mujoco.MjData, origin: FloatArray, axes: FloatArray, body: int
) -> FloatArray:
    """What MuJoCo's rays find, one by one."""
    group = np.array([1, 0, 0, 0, 0, 0], dtype=np.uint8)
    flat = np.vstack((DIRECTIONS, np.zeros(RAYS)))
    geom = np.zeros(1, dtype=np.int32)
    found = [
        mujoco.mj_ray(model, data, origin, ray, group, 1, body, geom)
        for ray in np.ascontiguousarray((axes @ flat).T)
    ]
    ranges = np.array(found)
    return np.where((ranges < 0.0) | (ranges > REACH), REACH, ranges)


def test_hand_computed_ranges() -> None:
    ranges = seen(BOX.format(more=""))
    assert ranges[0] == pytest.approx(0.4)
    assert ranges[RAYS // 2] == REACH
    assert ranges[5] == pytest.approx(0.4 / np.cos(BEARINGS[5]))
    pillar = seen('<geom type="cylinder" size="0.1 0.3" pos="0 0.5 0.3"/>')
    assert pillar[RAYS // 4] == pytest.approx(0.4)
    assert pillar[: RAYS // 8].tolist() == [REACH] * (RAYS // 8)


def test_from_within_the_way_out_is_found() -> None:
    assert seen('<geom type="cylinder" size="0.3 0.3" pos="0 0 0.3"/>') == pytest.approx(0.3)
    within = seen('<geom type="box" size="0.3 0.3 0.3" pos="0 0 0.3"/>')
    assert within[0] == pytest.approx(0.3)


def test_no_ray_slips_through_the_corners_of_a_closed_outline() -> None:
    for turn in np.linspace(0.0, 0.5, 23):
        turned = f'axisangle="0 0 1 {np.degrees(turn)}"'
        box = f'<geom type="box" size="0.3 0.3 0.3" pos="0 0 0.3" {turned}/>'
        assert seen(box).max() < 0.3 * 2**0.5 + 1e-9


@pytest.mark.parametrize(
    "geoms",
    [
        BOX.format(more='euler="0 10 0"'),
        '<geom type="sphere" size="0.2" pos="0.5 0 0.1"/>',
        '<geom type="cylinder" size="0.1 0.2" pos="0.5 0 0.1" euler="90 0 0"/>',
        '<body><joint type="hinge" axis="0 0 1"/>' + BOX.format(more="") + "</body>",
        BOX.format(more='rgba="1 1 1 0"'),
    ],
    ids=["slanting box", "ball", "lying cylinder", "door", "unseen by rays"],
)
def test_what_is_not_upright_or_can_turn_has_no_plan(geoms: str) -> None:
    assert plan_of(scene(geoms)[0]) is None


def test_a_ray_that_could_leave_the_obstacles_height_is_refused() -> None:
    model, data = scene(BOX.format(more=""))
    plan, eye = plan_of(model), model.site("eye").id
    assert plan is not None
    for tilt, held in ((0.12, True), (0.13, False)):  # 0.1 m of height on 0.8 m: 0.125 rad
        data.qpos[3:7] = (np.cos(tilt / 2), 0.0, np.sin(tilt / 2), 0.0)
        mujoco.mj_kinematics(model, data)
        assert (plan.ranges(data, eye, DIRECTIONS, REACH) is not None) == held


@pytest.mark.parametrize("world", ["convex", "maze"])
def test_agrees_with_the_rays_of_mujoco(world: str) -> None:
    """At random places and beside movers, with the slight pitch and roll of a driving robot."""
    rng = np.random.default_rng(0)
    simulation = EpisodeSimulation(load_scenario(world), 0)
    model, data = simulation.physics
    site = model.site("robot/lidar").id
    body = int(model.site_bodyid[site])
    plan = ground_plan(model, 0, body)
    assert plan is not None
    x_min, y_min, x_max, y_max = simulation.world.scenario.bounds
    met = 0
    for round_number in range(40):
        x, y = rng.uniform((x_min, y_min), (x_max, y_max))
        if round_number % 2 and model.nmocap:
            x, y = data.mocap_pos[rng.integers(model.nmocap), :2] + rng.uniform(-0.5, 0.5, 2)
        yaw, roll, pitch = rng.uniform(-pi, pi), *(1e-3 * rng.standard_normal(2))
        data.qpos[:7] = (x, y, 0.0, np.cos(yaw / 2), roll, pitch, np.sin(yaw / 2))
        data.mocap_pos[:, :2] += rng.uniform(-0.1, 0.1, (model.nmocap, 2))
        mujoco.mj_kinematics(model, data)
        ranges = plan.ranges(data, site, DIRECTIONS, REACH)
        axes = data.site_xmat[site].reshape(3, 3)
        truth = cast(model, data, data.site_xpos[site], axes, body)
        assert ranges == pytest.approx(truth, abs=1e-9)
        met += int((truth < REACH).sum())
    assert met > 40 * RAYS / 10


def test_the_plan_follows_the_movers() -> None:
    mover = '<body name="mover" mocap="true" pos="0.5 0 0">{}</body>'
    model, data = scene(mover.format('<geom type="box" size="0.1 0.1 0.3" pos="0 0 0.3"/>'))
    plan = plan_of(model)
    assert plan is not None
    data.mocap_pos[0, :2] = (0.0, -0.6)
    mujoco.mj_kinematics(model, data)
    ranges = plan.ranges(data, model.site("eye").id, DIRECTIONS, REACH)
    assert ranges is not None
    assert ranges[0] == REACH and ranges[3 * RAYS // 4] == pytest.approx(0.5)
    assert hypot(*plan.circles[0, :2]) == pytest.approx(0.0)
