"""Steps taken by compiled code against MuJoCo's own, called one by one."""

import mujoco
import numpy as np
from scenes import circle, mover, scenario

from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.tasks.stepping import native, take_steps, true_motion
from fuzzynav_mj.types import FloatArray


def simulated() -> tuple[mujoco.MjModel, mujoco.MjData]:
    made = scenario(moving=(mover(circle(0.0, 0.0, 0.1), (0.5, 0.0), (0.5, 1.0), speed=0.1),))
    return EpisodeSimulation(made, 0).physics


BODY = (0, np.array([6, 7]), 0.17, 0.0375, 0.05)  # first degree of freedom, wheels', lengths


def steps(
    data: mujoco.MjData, model: mujoco.MjModel, wheels: FloatArray, movers: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    return take_steps(
        native("mj_step2"), native("mj_step1"), model._address, data._address,
        data.ctrl, wheels, np.arange(2), data.mocap_pos, movers, np.arange(1), data.sensordata[:1],
        data.qpos[:7], data.qvel, *BODY,
    )  # fmt: skip


def test_the_steps_are_those_of_mujoco_bit_for_bit() -> None:
    wheels = np.random.default_rng(0).uniform(-8.0, 8.0, (40, 2))
    movers = np.linspace((0.6, 0.0), (0.6, 0.4), 40)[:, None]
    model, data = simulated()
    found = steps(data, model, wheels, movers)
    model, data = simulated()
    places, speeds = np.empty((40, 7)), np.empty((40, model.nv))
    for k in range(40):
        data.ctrl[:] = wheels[k]
        mujoco.mj_step2(model, data)
        data.mocap_pos[0, :2] = movers[k, 0]
        mujoco.mj_step1(model, data)
        places[k], speeds[k] = data.qpos[:7], data.qvel
    for one, other in zip(found, true_motion(places, speeds, *BODY), strict=True):
        np.testing.assert_array_equal(one, other)


def test_contact_ends_them_at_the_step_that_brings_it() -> None:
    model, data = simulated()
    movers = np.full((20, 1, 2), 5.0)
    movers[6:, 0] = (0.19, 0.0)  # 1 cm into the hull
    assert [len(told) for told in steps(data, model, np.zeros((20, 2)), movers)] == [7, 7, 7]
    assert data.sensordata[0] > 0.0
