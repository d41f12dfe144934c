"""Arriving with a given yaw: bring the axle to where it belongs, then turn on the spot.

The robot turns about its axle, which lies behind the footprint's centre; with the axle in its
final place the centre comes to lie on the goal.
"""

from dataclasses import dataclass
from math import cos, hypot, sin

from fuzzynav_mj.planners.base import NavigationProblem
from fuzzynav_mj.types import Pose2D

DOCKING_DISTANCE = 0.5  # m from the goal at which the axle's place begins to matter
AXLE_SHARE = 0.7  # of the goal's tolerance within which the axle must lie before the turn


@dataclass(frozen=True, slots=True)
class Docking:
    """What to do near a goal with a yaw.

    Attributes:
        target: (x, y) for the footprint's centre to head for, world frame.
        turn_to: yaw to turn to on the spot, rad; None while driving.
    """

    target: tuple[float, float]
    turn_to: float | None


def docking(problem: NavigationProblem, pose: Pose2D) -> Docking | None:
    """The docking move; None where the goal has no yaw or is still far."""
    yaw, offset = problem.goal_yaw, problem.spec.axle_offset
    goal_x, goal_y = problem.goal
    if yaw is None or hypot(pose.x - goal_x, pose.y - goal_y) > DOCKING_DISTANCE:
        return None
    wanted_x, wanted_y = goal_x - offset * cos(yaw), goal_y - offset * sin(yaw)
    axle_x, axle_y = pose.x - offset * cos(pose.yaw), pose.y - offset * sin(pose.yaw)
    dx, dy = wanted_x - axle_x, wanted_y - axle_y
    away = hypot(dx, dy)
    if away <= AXLE_SHARE * problem.goal_tolerance:
        return Docking((pose.x, pose.y), yaw)
    # Arriving in the direction of travel, the centre is ahead of the axle by its offset.
    reach = offset / away
    return Docking((wanted_x + reach * dx, wanted_y + reach * dy), None)
