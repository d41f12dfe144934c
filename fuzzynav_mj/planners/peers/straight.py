"""Straight at the goal, whatever is in the way: the floor of what a world asks."""

from math import atan2
from typing import ClassVar

import numpy as np

from fuzzynav_mj.planners.arrival import docking
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Requirements
from fuzzynav_mj.planners.steering import position_after, twist_towards
from fuzzynav_mj.types import Behaviour, Decision


class StraightPlanner:
    """Turns to the goal on the spot and drives there at full speed. It sees nothing."""

    requires: ClassVar[Requirements] = Requirements(scan=False, obstacles=False)

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode. The planner draws nothing at random."""
        del rng
        self._problem = problem

    def decide(self, observation: Observation) -> Decision:
        """The next position on the straight line."""
        pose, spec = observation.pose, self._problem.spec
        dock = docking(self._problem, pose)
        target = self._problem.goal if dock is None else dock.target
        direction, speed = atan2(target[1] - pose.y, target[0] - pose.x), spec.max_speed
        behaviour = Behaviour.GOAL_SEEKING
        if dock is not None and dock.turn_to is not None:
            direction, speed = dock.turn_to, 0.0
            behaviour = Behaviour.TURNING_ON_GOAL
        aim = twist_towards(direction, speed, pose, spec)
        return Decision(
            next_position=position_after(aim.v, aim.omega, pose, observation.twist, spec),
            behaviour=behaviour,
            subgoal=target,
        )
