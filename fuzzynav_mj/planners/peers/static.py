"""Greedy around what the scan shows, as if it all stood still: the floor of what sight gives."""

from math import atan2, hypot
from typing import ClassVar

import numpy as np

from fuzzynav_mj.planners.arrival import docking
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Requirements
from fuzzynav_mj.planners.peers.clear_motion import hits_around, step_towards
from fuzzynav_mj.planners.reach import free_distance
from fuzzynav_mj.types import Behaviour, Decision, FloatArray

WIDTH = 0.15  # m: radius of the disc that must fit through a way


class StaticPlanner:
    """Heads for the point in free sight from which the goal is nearest.

    That is the motion towards the goal of TangentBug (Kamon, Rimon, Rivlin 1998) alone: no
    boundary is followed and nothing is remembered, so a pocket deeper than sight holds the robot
    for good. Hits that move are taken for standing ones.
    """

    requires: ClassVar[Requirements] = Requirements(scan=True, obstacles=False)

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode. The planner draws nothing at random."""
        del rng
        self._problem = problem

    def decide(self, observation: Observation) -> Decision:
        """The next position on the way to the point nearest to the goal."""
        pose, scan = observation.pose, observation.scan
        assert scan is not None
        hits = hits_around(scan, pose)
        dock = docking(self._problem, pose)
        goal = self._problem.goal if dock is None else dock.target
        to_goal = (goal[0] - pose.x, goal[1] - pose.y)
        x, y = _nearest_in_sight(to_goal, hits, scan.bearings + pose.yaw, scan.max_range)
        step = step_towards(
            (pose.x + x, pose.y + y),
            hits,
            pose,
            observation.twist,
            self._problem.spec,
            None if dock is None else dock.turn_to,
        )
        return Decision(
            next_position=step.next_position,
            behaviour=_behaviour((x, y), to_goal, step.clear),
            subgoal=(pose.x + x, pose.y + y),
        )


def _nearest_in_sight(
    goal: tuple[float, float], hits: FloatArray, bearings: FloatArray, reach: float
) -> tuple[float, float]:
    """The point, robot-centred, that a disc can reach straight on and that is nearest the goal."""
    distance = hypot(*goal)
    bearings = np.append(bearings, atan2(goal[1], goal[0]))
    length = np.minimum(free_distance(hits, bearings, WIDTH), min(reach, distance))
    x, y = length * np.cos(bearings), length * np.sin(bearings)
    best = int(np.hypot(x - goal[0], y - goal[1]).argmin())
    return (float(x[best]), float(y[best]))


def _behaviour(way: tuple[float, float], goal: tuple[float, float], clear: bool) -> Behaviour:
    if not clear:
        return Behaviour.EVASION
    across = way[0] * goal[1] - way[1] * goal[0]
    on_course = abs(across) < 1e-6 * hypot(*goal)
    return Behaviour.GOAL_SEEKING if on_course else Behaviour.STATIC_AVOIDANCE
