"""The environment as any dm_env agent finds it."""

from math import hypot, pi
from pathlib import Path

import numpy as np
import pytest
from absl.testing import absltest
from dm_env import StepType, specs, test_utils
from scenes import circle, mover, polygon, scenario

from fuzzynav_mj.errors import FuzzyNavError, UnknownNameError
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.tasks import load
from fuzzynav_mj.tasks.environment import NavigationEnvironment
from fuzzynav_mj.tasks.navigation import NavigateToGoal

OPEN_ARENA = """
schema = 1
name = "open"
description = "Nothing in the way but the walls."
bounds = [0.0, 0.0, 4.0, 4.0]
time_limit = 30.0
[robot]
start = [0.5, 0.5, 2.0]
goal = [3.4, 2.8]
"""


class LibraryEnvironmentTest(test_utils.EnvironmentTestMixin, absltest.TestCase):  # type: ignore[misc]
    """dm_env's own checks, on a library world."""

    def make_object_under_test(self) -> NavigationEnvironment:
        return load("convex", seed=3)


class ShortEpisodesTest(test_utils.EnvironmentTestMixin, absltest.TestCase):  # type: ignore[misc]
    """dm_env's own checks across episodes' ends: a mover runs into the robot."""

    def make_object_under_test(self) -> NavigationEnvironment:
        pusher = mover(circle(0.0, 0.0, 0.2), (0.6, 0.0), (0.0, 0.0), 0.5)
        pillar = polygon((0.0, 1.0), (0.3, 1.0), (0.0, 1.4))
        world = scenario(moving=(pusher,), static=(pillar,))
        return NavigationEnvironment(NavigateToGoal(world, 0))


def test_specs() -> None:
    environment = load("convex", seed=0)
    action = environment.action_spec()
    assert isinstance(action, specs.BoundedArray)
    assert action.shape == (2,) and action.dtype == np.float64
    assert action.minimum.tolist() == [0.0, 0.0] and action.maximum.tolist() == [10.0, 10.0]
    shapes = {name: spec.shape for name, spec in environment.observation_spec().items()}
    rays = (DEFAULT_ROBOT.ray_count,)
    assert shapes == {"ranges": rays, "pose": (3,), "twist": (2,), "goal": (2,)}
    assert environment.reward_spec().shape == () and environment.discount_spec().maximum == 1.0


def test_first_observation() -> None:
    observation = load("convex", seed=0).reset().observation
    assert observation["pose"] == pytest.approx((0.8, 0.8, 0.785), abs=1e-9)
    assert observation["twist"].tolist() == [0.0, 0.0]
    assert observation["goal"].tolist() == [9.2, 9.2]
    # Walls 0.8 m to the left and below are as far as the sensor sees.
    assert (observation["ranges"] == DEFAULT_ROBOT.sensor_range).mean() > 0.95


def test_ten_line_agent_reaches_its_goal(tmp_path: Path) -> None:
    file = tmp_path / "open.toml"
    file.write_text(OPEN_ARENA)

    environment = load(str(file), seed=0)
    timestep = environment.reset()
    while not timestep.last():
        x, y, _ = timestep.observation["pose"]
        dx, dy = timestep.observation["goal"] - (x, y)
        step = 0.05 / max(hypot(dx, dy), 0.05)
        timestep = environment.step(np.array([x + step * dx, y + step * dy]))

    assert timestep.reward == 1.0 and timestep.discount == 0.0
    x, y, _ = timestep.observation["pose"]
    assert hypot(3.4 - x, 2.8 - y) <= 0.10
    # The straight way at full speed, and a second to turn and speed up.
    shortest = (hypot(3.4 - 0.5, 2.8 - 0.5) - 0.1) / DEFAULT_ROBOT.max_speed
    assert shortest < environment.physics.time() < shortest + 1.0


def test_mapless_agent_ends_at_an_obstacle() -> None:
    """The straight line of the library's worlds is blocked."""
    environment = load("convex", seed=1)
    timestep = environment.reset()
    while not timestep.last():
        x, y, _ = timestep.observation["pose"]
        timestep = environment.step(np.array([x + 0.04, y + 0.04]))
    assert timestep.reward == -1.0 and timestep.discount == 0.0


def test_observations_are_those_of_the_simulated_robot() -> None:
    environment = load("concave", seed=0)
    environment.reset()
    for _ in range(15):
        timestep = environment.step(np.array([2.0, 2.0]))
    task, observation = environment.task, timestep.observation
    pose, twist = task.pose, task.twist
    assert observation["pose"].tolist() == [pose.x, pose.y, pose.yaw]
    assert observation["twist"].tolist() == [twist.v, twist.omega]
    assert np.array_equal(observation["ranges"], task.scan.ranges)
    assert -pi <= pose.yaw < pi
    assert environment.physics.time() == pytest.approx(1.5)
    assert twist.v == pytest.approx(DEFAULT_ROBOT.max_speed, rel=0.02)


def test_action_that_is_not_finite_is_refused() -> None:
    environment = load("convex")
    environment.reset()
    with pytest.raises(FuzzyNavError) as caught:
        environment.step(np.array([np.nan, 1.0]))
    assert str(caught.value) == "action: given (nan, 1.0); allowed is a finite next position, m"


def test_unknown_scenario() -> None:
    with pytest.raises(UnknownNameError, match=r"unknown scenario 'conveks'.*Did you mean"):
        load("conveks")


def test_diverged_physics_ends_the_episode() -> None:
    environment = load("convex")
    environment.reset()
    environment.physics.data.ptr.qvel[0] = np.nan
    timestep = environment.step(np.array([1.0, 1.0]))
    assert timestep.step_type is StepType.LAST
    assert environment.task.outcome == "diverged"
    assert timestep.reward == 0.0
    fresh = environment.reset()
    assert np.isfinite(fresh.observation["pose"]).all() and environment.task.outcome is None
