"""Optimal reciprocal collision avoidance, where nobody else reciprocates.

J. van den Berg, S. J. Guy, M. Lin, D. Manocha, "Reciprocal n-Body Collision Avoidance", Robotics
Research, 2011. The movers do not avoid the robot, so it takes the whole of every change of
velocity upon itself instead of half. Its wheels are dealt with as by J. Snape et al., "Smooth and
collision-free navigation for multiple robots under differential-drive constraints", IROS 2010: a
point ahead of the axle, here the footprint's centre, can move in every direction at once.
"""

from dataclasses import dataclass
from math import hypot, sqrt
from typing import ClassVar

import numpy as np

from fuzzynav_mj.planners.base import NavigationProblem, Observation, Requirements
from fuzzynav_mj.planners.peers.arrival import point_to_reach, turn_on_goal
from fuzzynav_mj.planners.peers.half_planes import HalfPlanes, box, least_violating, nearest
from fuzzynav_mj.planners.peers.rollout import to_robot_frame
from fuzzynav_mj.planners.sight import thin
from fuzzynav_mj.planners.steering import position_after
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import (
    Behaviour,
    Decision,
    FloatArray,
    PerceivedObstacle,
    Perception,
    Pose2D,
    Twist2D,
)

STANDING = 0.02  # m/s


@dataclass(frozen=True, slots=True)
class OrcaSettings:
    """Horizons and margins.

    Attributes:
        horizon: for so long the velocity must keep clear of movers, s.
        static_horizon: and of what stands, s.
        margin: added to the robot's circle against movers: their unseen far side, and what the
            robot's motion misses of the velocity, m.
        static_margin: the same against what stands, m.
    """

    horizon: float = 2.0
    static_horizon: float = 1.0
    margin: float = 0.1
    static_margin: float = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Disc:
    """A mover as a disc: centre (2,) m and velocity (2,) m/s in the robot frame, radius m."""

    centre: FloatArray
    velocity: FloatArray
    radius: float


class OrcaPlanner:
    """Van den Berg et al.'s method with full responsibility, towards the goal."""

    requires: ClassVar[Requirements] = Requirements(scan=True, obstacles=True)

    def __init__(self, settings: OrcaSettings | None = None) -> None:
        self._settings = settings or OrcaSettings()

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode. The planner draws nothing at random."""
        del rng
        self._problem = problem

    def decide(self, observation: Observation) -> Decision:
        """The next position, and why."""
        turn = turn_on_goal(self._problem, observation)
        if turn is not None:
            return turn
        pose, twist, perception = observation.pose, observation.twist, observation.perception
        assert perception is not None
        spec = self._problem.spec
        goal = point_to_reach(self._problem, pose)
        wanted = preferred_velocity(to_robot_frame(np.array([goal]), pose)[0], spec)
        within_reach = reachable(twist, spec)
        standing = static_half_planes(perception, pose, spec, self._settings)
        moving = mover_half_planes(perception, pose, twist, spec, self._settings)
        chosen = choose_velocity(wanted, within_reach, standing, moving)
        vx, vy = chosen.velocity.tolist()
        behaviour = _behaviour(chosen, wanted, standing, moving, within_reach)
        return Decision(
            position_after(vx, vy / spec.axle_offset, pose, twist, spec),
            behaviour,
            subgoal=goal,
            note=chosen.note,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """A velocity (2,) of the footprint's centre, robot frame, m/s, and what had to be given up."""

    velocity: FloatArray
    note: str = ""


def choose_velocity(
    wanted: FloatArray, within_reach: HalfPlanes, standing: HalfPlanes, moving: HalfPlanes
) -> Choice:
    """The velocity nearest to the wanted one (2,) that all half-planes allow; if there is none, the
    one that violates the movers' least; if what stands allows none either, any of them least."""
    firm = within_reach.and_(standing)
    velocity = nearest(wanted, firm.and_(moving))
    if velocity is not None:
        return Choice(velocity)
    velocity = least_violating(firm, moving)
    if velocity is not None:
        return Choice(velocity, "no velocity keeps clear of the movers")
    velocity = least_violating(within_reach, standing.and_(moving))
    assert velocity is not None  # within reach is at least the present velocity
    return Choice(velocity, "no velocity keeps clear of what stands")


def preferred_velocity(target: FloatArray, spec: RobotSpec) -> FloatArray:
    """(2,) top speed towards a target (2,), robot frame; slower if that would go past it."""
    away = hypot(*target.tolist())
    speed = min(spec.max_speed, away / spec.decision_period)
    velocity: FloatArray = target * (speed / max(away, 1e-9))
    return velocity


def reachable(twist: Twist2D, spec: RobotSpec) -> HalfPlanes:
    """The centre's velocities (forwards, to the left) at the end of the next period: forward speed
    and yaw rate times the axle's distance, within the limits of speed and acceleration."""
    period = spec.decision_period
    top = np.array([spec.max_speed, spec.max_yaw_rate])
    reach = np.array([spec.max_acceleration, spec.max_yaw_acceleration]) * period
    now = np.clip(np.array([twist.v, twist.omega]), -top, top)
    to_velocity = np.array([1.0, spec.axle_offset])
    return box(
        np.maximum(now - reach, -top) * to_velocity, np.minimum(now + reach, top) * to_velocity
    )


def static_half_planes(
    perception: Perception, pose: Pose2D, spec: RobotSpec, settings: OrcaSettings
) -> HalfPlanes:
    """What each hit of standing obstacles allows.

    As van den Berg et al. advise, the velocity optimised about is zero here, so that standing
    still is always allowed: the speed towards a hit is at most its distance over the horizon.
    """
    hits = [thin(to_robot_frame(o.points, pose)) for o in perception.obstacles if not o.dynamic]
    points = np.concatenate(hits) if hits else np.empty((0, 2))
    distance = np.hypot(*points.T)
    normals = points / np.maximum(distance, 1e-9)[:, None]
    gap = distance - spec.half_diagonal - settings.static_margin
    # Where the gap is gone the robot need not flee, which would be as bad as to approach.
    offsets = np.maximum(gap, 0.0) / settings.static_horizon
    matter = offsets < spec.max_speed + spec.max_yaw_rate * spec.axle_offset
    return HalfPlanes(normals[matter], offsets[matter])


def mover_half_planes(
    perception: Perception, pose: Pose2D, twist: Twist2D, spec: RobotSpec, settings: OrcaSettings
) -> HalfPlanes:
    """What each moving obstacle allows."""
    velocity = np.array([twist.v, twist.omega * spec.axle_offset])
    radius = spec.half_diagonal + settings.margin
    planes = HalfPlanes(np.empty((0, 2)), np.empty(0))
    for obstacle in perception.obstacles:
        if obstacle.dynamic:
            disc = enclosing_disc(obstacle, pose)
            planes = planes.and_(
                half_plane(disc, velocity, radius, settings.horizon, spec.decision_period)
            )
    return planes


def enclosing_disc(obstacle: PerceivedObstacle, pose: Pose2D) -> Disc:
    """The disc about the two ends of the visible outline, or larger to hold all of it."""
    points = to_robot_frame(obstacle.points, pose)
    centre = (points[0] + points[-1]) / 2
    radius = float(np.hypot(*(points - centre).T).max())
    ahead = Pose2D(0.0, 0.0, pose.yaw)
    return Disc(centre, to_robot_frame(obstacle.velocity[None], ahead)[0], radius)


def half_plane(
    disc: Disc, velocity: FloatArray, radius: float, horizon: float, period: float
) -> HalfPlanes:
    """The velocities that ORCA allows a robot at the origin because of one mover: beyond the
    tangent to the velocity obstacle at the point of its border next to the present velocity.

    Args:
        disc: the mover.
        velocity: (2,) of the robot, m/s.
        radius: of the robot, m.
        horizon: tau, s.
        period: time within which an overlap is to be left, s.
    """
    place, reach = disc.centre, disc.radius + radius
    relative = velocity - disc.velocity
    squared = float(place @ place) - reach**2
    time = horizon if squared > 0.0 else period
    from_cap = relative - place / time  # from the centre of the disc that ends the cone
    along = float(from_cap @ place)
    length = hypot(*from_cap.tolist())
    if squared <= 0.0 or (along < 0.0 and along**2 > reach**2 * length**2):
        outward = from_cap / length if length > 1e-9 else -place / max(hypot(*place.tolist()), 1e-9)
        change = (reach / time - length) * outward
    else:
        x, y = place.tolist()
        leg = sqrt(squared)
        side = 1.0 if x * from_cap[1] - y * from_cap[0] > 0.0 else -1.0
        edge = np.array([x * leg - side * y * reach, side * x * reach + y * leg])
        edge /= float(place @ place)
        outward = side * np.array([-edge[1], edge[0]])
        change = float(relative @ edge) * edge - relative
    return HalfPlanes(-outward[None], np.array([-outward @ (velocity + change)]))


def _behaviour(
    choice: Choice,
    wanted: FloatArray,
    standing: HalfPlanes,
    moving: HalfPlanes,
    within_reach: HalfPlanes,
) -> Behaviour:
    """The name of what the robot does, for the record: what keeps it from the best within reach."""
    if choice.note:
        return Behaviour.EVASION
    if hypot(*choice.velocity.tolist()) < STANDING:
        return Behaviour.WAITING
    unhindered = nearest(wanted, within_reach)
    assert unhindered is not None
    if (moving.excess(unhindered) > 0.0).any():
        return Behaviour.DYNAMIC_AVOIDANCE
    if (standing.excess(unhindered) > 0.0).any():
        return Behaviour.STATIC_AVOIDANCE
    return Behaviour.GOAL_SEEKING
