"""The last half metre of a peer's way to a goal that has a yaw, which its method leaves open."""

from fuzzynav_mj.geometry import wrap_angle
from fuzzynav_mj.planners.arrival import docking
from fuzzynav_mj.planners.base import NavigationProblem, Observation
from fuzzynav_mj.planners.steering import position_after, twist_towards
from fuzzynav_mj.types import Behaviour, Decision, Pose2D


def point_to_reach(problem: NavigationProblem, pose: Pose2D) -> tuple[float, float]:
    """(x, y) that the footprint's centre should head for, world frame: the goal, or the place to
    come to before turning to the goal's yaw."""
    dock = docking(problem, pose)
    return problem.goal if dock is None else dock.target


def turn_on_goal(problem: NavigationProblem, observation: Observation) -> Decision | None:
    """The turn on the spot to the goal's yaw; None while there is still way to go."""
    pose, spec = observation.pose, problem.spec
    dock = docking(problem, pose)
    if dock is None or dock.turn_to is None:
        return None
    turn = twist_towards(dock.turn_to, 0.0, pose, spec)
    return Decision(
        position_after(0.0, turn.omega, pose, observation.twist, spec),
        Behaviour.TURNING_ON_GOAL,
        subgoal=problem.goal,
        note=f"{abs(wrap_angle(dock.turn_to - pose.yaw)):.2f} rad to turn",
    )
