"""The bug algorithm DistBug with the shared motion layer; it knows nothing of motion."""

from typing import ClassVar

import numpy as np

from fuzzynav_mj.planners.arrival import docking
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Requirements
from fuzzynav_mj.planners.peers.clear_motion import hits_around, step_towards
from fuzzynav_mj.planners.peers.distbug import DistBug
from fuzzynav_mj.types import Behaviour, Decision


class BugPlanner:
    """Drives as `DistBug` says, in steps that keep the footprint clear of the scan.

    Among standing obstacles it reaches the goal or, after a closed loop, gives up with `no_path`
    (see `DistBug` for the argument and the reference). Hits that move are taken for standing ones.
    """

    requires: ClassVar[Requirements] = Requirements(scan=True, obstacles=False)

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode. The planner draws nothing at random."""
        del rng
        self._problem = problem
        self._bug = DistBug(problem.goal, problem.goal_tolerance)

    def decide(self, observation: Observation) -> Decision:
        """The next position towards the goal or along a boundary."""
        pose, scan = observation.pose, observation.scan
        assert scan is not None
        hits = hits_around(scan, pose)
        course = self._bug.course((pose.x, pose.y), hits, scan.max_range)
        dock = None if course.following else docking(self._problem, pose)
        target = course.target if dock is None else dock.target
        turn_to = None if dock is None else dock.turn_to
        step = step_towards(target, hits, pose, observation.twist, self._problem.spec, turn_to)
        behaviour = Behaviour.BOUNDARY_FOLLOWING if course.following else Behaviour.GOAL_SEEKING
        return Decision(
            next_position=step.next_position,
            behaviour=behaviour if step.clear else Behaviour.EVASION,
            subgoal=target,
            give_up="no_path" if course.closed else None,
        )
