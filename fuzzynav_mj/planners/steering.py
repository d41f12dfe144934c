"""From speeds, or a direction of travel, to the next position of the footprint's centre."""

from math import cos, pi

from fuzzynav_mj.control import ramped_displacement
from fuzzynav_mj.geometry import wrap_angle
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import Pose2D, Twist2D

TURN_TIME = 0.2  # s: time constant of the turn towards a direction


def position_after(
    v: float, omega: float, pose: Pose2D, twist: Twist2D, spec: RobotSpec
) -> tuple[float, float]:
    """Where the footprint's centre is one decision period later if the speeds become these.

    The speeds are first brought within the robot's limits and then ramped to, exactly as
    `control.drive_towards` does; given the position found here it drives there to within a
    millimetre, and but for rare cases at the limits with these very speeds.

    Args:
        v: forward speed at the period's end, m/s, negative in reverse.
        omega: yaw rate at the period's end, rad/s.
        pose: present pose, world frame.
        twist: present speeds.
        spec: the robot's limits.

    Returns:
        (x, y), world frame, m.
    """
    dx, dy = ramped_displacement(
        float(pose.yaw),
        (float(twist.v), float(twist.omega)),
        (float(_clip(v, spec.max_speed)), float(_clip(omega, spec.max_yaw_rate))),
        (spec.max_acceleration, spec.max_yaw_acceleration),
        spec.decision_period,
        spec.substeps,
        spec.axle_offset,
    )
    return (pose.x + dx, pose.y + dy)


def twist_towards(direction: float, speed: float, pose: Pose2D, spec: RobotSpec) -> Twist2D:
    """Speeds to aim at for travelling in a direction: turn to it, and drive once nearly on it.

    A right angle or more off course the robot turns on the spot.

    Args:
        direction: of travel, world frame, rad.
        speed: once on course, m/s.
        pose: present pose, world frame.
        spec: the robot's limits.
    """
    error = wrap_angle(direction - pose.yaw)
    share = cos(error) ** 2 if abs(error) < pi / 2 else 0.0
    return Twist2D(speed * share, _clip(error / TURN_TIME, spec.max_yaw_rate))


def _clip(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)
