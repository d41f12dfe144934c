"""How episodes end other than by contact."""

from math import cos, hypot, pi, sin

import numpy as np
import pytest
from scenes import scenario

from fuzzynav_mj.geometry import wrap_angle
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.tasks.environment import NavigationEnvironment
from fuzzynav_mj.tasks.navigation import GOAL_YAW_TOLERANCE, NavigateToGoal
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.types import Outcome


def outcome_at(made: Scenario) -> Outcome | None:
    return EpisodeSimulation(made, 0).outcome


@pytest.mark.parametrize(("distance", "expected"), [(0.099, Outcome.GOAL_REACHED), (0.101, None)])
def test_goal_is_reached_within_its_tolerance(distance: float, expected: Outcome | None) -> None:
    goal = (distance * cos(1.0), distance * sin(1.0))
    assert outcome_at(scenario(goal=goal)) is expected


@pytest.mark.parametrize(
    ("yaw", "goal_yaw", "reached"),
    [(0.0, 0.09, True), (0.0, 0.11, False), (0.0, pi, False), (pi - 0.03, 0.05 - pi, True)],
)
def test_goal_yaw_counts_and_wraps(yaw: float, goal_yaw: float, reached: bool) -> None:
    made = scenario(start=(1.0, 1.0, yaw), goal=(1.0, 1.0), goal_yaw=goal_yaw)
    assert (outcome_at(made) is Outcome.GOAL_REACHED) is reached


def test_turning_at_the_goal_ends_the_episode() -> None:
    made = scenario(goal=(0.0, 0.0), goal_yaw=2.0)
    simulation = EpisodeSimulation(made, 0)
    d = DEFAULT_ROBOT.axle_offset
    axle = (-d, 0.0)
    while simulation.outcome is None:
        yaw = simulation.pose.yaw + 0.15
        simulation.drive((axle[0] + d * cos(yaw), axle[1] + d * sin(yaw)))
    assert simulation.outcome is Outcome.GOAL_REACHED
    assert abs(wrap_angle(simulation.pose.yaw - 2.0)) <= GOAL_YAW_TOLERANCE
    assert hypot(simulation.pose.x, simulation.pose.y) <= made.goal_tolerance


def test_time_is_up_exactly_at_the_limit() -> None:
    environment = NavigationEnvironment(NavigateToGoal(scenario(time_limit=1.5), 0))
    timestep = environment.reset()
    steps = 0
    while not timestep.last():
        timestep = environment.step(np.zeros(2))
        steps += 1
    assert steps == 15
    assert environment.task.outcome is Outcome.TIMEOUT
    assert environment.task.time == pytest.approx(1.5)
    assert timestep.reward == 0.0 and timestep.discount == 1.0


def test_goal_after_the_limit_does_not_count() -> None:
    simulation = EpisodeSimulation(scenario(goal=(3.0, 0.0), time_limit=2.0), 0)
    while simulation.outcome is None:
        simulation.drive((simulation.pose.x + 0.05, 0.0))
    assert simulation.outcome is Outcome.TIMEOUT
    assert simulation.pose.x < 1.0
