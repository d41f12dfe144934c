"""What the planner does where it gets nowhere."""

import numpy as np
import pytest

from fuzzynav_mj.planners import make_planner
from fuzzynav_mj.planners.base import NavigationProblem, Observation
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.sensing.perception import Perceiver
from fuzzynav_mj.types import LaserScan, Pose2D, Twist2D

GOAL = (9.0, 0.0)
WAY_IN, STUCK = (0.0, 0.0), (0.5, 0.0)


def subgoals(moving_until: float, seconds: float) -> dict[float, tuple[float, float]]:
    """Subgoals by time of a robot that came from `WAY_IN` and is held at `STUCK`, among nothing
    but a mover that passes by behind it until some time."""
    planner, perceiver = make_planner("multilayer"), Perceiver(DEFAULT_ROBOT)
    planner.reset(NavigationProblem(GOAL, None, 0.1, DEFAULT_ROBOT), np.random.default_rng(0))
    found = {}
    for tick in range(round(seconds * 10)):
        stamp = tick / 10
        ranges = np.full(180, 0.8)
        if stamp < moving_until:
            first = tick % 12
            ranges[first : first + 9] = 0.6
        scan = LaserScan(stamp, ray_bearings(180), ranges, ranges < 0.8, 0.8)
        pose = Pose2D(*(STUCK if tick else WAY_IN), 0.0)
        perception = perceiver.perceive(scan, pose)
        decision = planner.decide(Observation(stamp, pose, Twist2D(0.0, 0.0), scan, perception))
        assert decision.subgoal is not None
        found[stamp] = decision.subgoal
    return found


def test_getting_nowhere_though_nothing_moves_it_goes_back_to_where_it_came_from() -> None:
    wedged = DecisionSettings().wedged_time
    for stamp, subgoal in subgoals(0.0, wedged + 2.0).items():
        expected = WAY_IN if stamp > wedged + 0.1 else GOAL
        assert subgoal == pytest.approx(expected, abs=1e-9), stamp


def test_while_something_moves_it_keeps_to_its_way() -> None:
    wedged = DecisionSettings().wedged_time
    for stamp, subgoal in subgoals(wedged + 2.0, wedged + 2.0).items():
        assert subgoal != pytest.approx(WAY_IN, abs=1e-9), stamp
