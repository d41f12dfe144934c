"""Next position -> speeds under the robot's limits -> wheel speeds.

The axle lies `axle_offset` behind the footprint's centre, so a forward speed v and a yaw rate
omega move the centre with (v, axle_offset * omega) in the robot frame: every small displacement
of the centre, sideways too, belongs to one pair of speeds. Planner and task use the same ramp,
so what a planner rolls out is what the wheels are told.
"""

from dataclasses import dataclass
from math import cos, hypot, sin, sqrt

import numpy as np

from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray, Pose2D, Twist2D, WheelSpeeds


@dataclass(frozen=True, slots=True, eq=False)
class SpeedProfile:
    """Speeds for each physics step of one decision period.

    Attributes:
        v: (k,) forward speed, m/s.
        omega: (k,) yaw rate, rad/s.
    """

    v: FloatArray
    omega: FloatArray

    @property
    def final(self) -> Twist2D:
        """Speeds at the end of the period."""
        return Twist2D(float(self.v[-1]), float(self.omega[-1]))


def final_speed(mean: float, start: float, reach: float) -> float:
    """Speed that a ramp of limited slope must end at to have the given mean over a period.

    The ramp is as steep as allowed and then constant. `reach` is the largest change in one
    period; a mean that cannot be had gives the nearest ramp.
    """
    missing = mean - start
    if abs(missing) >= reach / 2:
        change = reach
    else:
        change = reach * (1.0 - sqrt(1.0 - 2.0 * abs(missing) / reach))
    return start + (change if missing >= 0 else -change)


def ramp(start: float, end: float, slope: float, period: float, steps: int) -> FloatArray:
    """(steps,) speeds that lead from `start` to `end` with the given slope (per second)."""
    span = min(abs(end - start), slope * period)
    elapsed = (np.arange(steps) + 1.0) * (period / steps)
    change = np.minimum(slope * elapsed, span)
    speeds: FloatArray = start + (change if end >= start else -change)
    return speeds


def centre_displacement(yaw: float, profile: SpeedProfile, spec: RobotSpec) -> tuple[float, float]:
    """World-frame displacement of the footprint's centre over one period of the profile."""
    dt = spec.physics_period
    turned = yaw + np.cumsum(profile.omega) * dt - profile.omega * (dt / 2)
    c, s = np.cos(turned), np.sin(turned)
    side = spec.axle_offset * profile.omega
    return (
        float(np.dot(c, profile.v) - np.dot(s, side)) * dt,
        float(np.dot(s, profile.v) + np.dot(c, side)) * dt,
    )


def drive_towards(
    next_position: tuple[float, float], pose: Pose2D, twist: Twist2D, spec: RobotSpec
) -> SpeedProfile:
    """Speeds that bring the footprint's centre to the next position one period later.

    A next position out of reach is approached on the straight line, as far as the limits allow.

    Args:
        next_position: (x, y) of the centre in the world frame, m.
        pose: present pose.
        twist: speeds commanded at the end of the last period.
        spec: the robot's limits.
    """
    period, steps = spec.decision_period, spec.substeps
    dx, dy = next_position[0] - pose.x, next_position[1] - pose.y
    forward = dx * cos(pose.yaw) + dy * sin(pose.yaw)
    left = dy * cos(pose.yaw) - dx * sin(pose.yaw)
    largest_forward = spec.max_speed * period
    largest_left = spec.axle_offset * spec.max_yaw_rate * period
    scale = max(abs(forward) / largest_forward, abs(left) / largest_left, 1.0)
    target = (dx / scale, dy / scale)
    aim = target
    profile = None
    for _ in range(3):  # each pass removes most of what the turn during the period displaced
        mean_yaw = pose.yaw if profile is None else pose.yaw + _mean_turn(profile, spec)
        c, s = cos(mean_yaw), sin(mean_yaw)
        mean_v = (aim[0] * c + aim[1] * s) / period
        mean_omega = (aim[1] * c - aim[0] * s) / (period * spec.axle_offset)
        v = final_speed(mean_v, twist.v, spec.max_acceleration * period)
        omega = final_speed(mean_omega, twist.omega, spec.max_yaw_acceleration * period)
        v = min(max(v, -spec.max_speed), spec.max_speed)
        omega = min(max(omega, -spec.max_yaw_rate), spec.max_yaw_rate)
        profile = SpeedProfile(
            v=ramp(twist.v, v, spec.max_acceleration, period, steps),
            omega=ramp(twist.omega, omega, spec.max_yaw_acceleration, period, steps),
        )
        moved = centre_displacement(pose.yaw, profile, spec)
        error = (target[0] - moved[0], target[1] - moved[1])
        if hypot(*error) < 1e-5:
            break
        aim = (aim[0] + error[0], aim[1] + error[1])
    assert profile is not None
    return profile


def _mean_turn(profile: SpeedProfile, spec: RobotSpec) -> float:
    """Mean over the period of the angle turned since its start, rad."""
    return float(np.cumsum(profile.omega).mean()) * spec.physics_period


def wheel_speeds(v: float, omega: float, spec: RobotSpec) -> WheelSpeeds:
    """Inverse of the differential drive's kinematics, Eqs. (1)-(3)."""
    half = omega * spec.track / 2
    return WheelSpeeds((v - half) / spec.wheel_radius, (v + half) / spec.wheel_radius)


def wheel_table(profile: SpeedProfile, spec: RobotSpec) -> FloatArray:
    """(k, 2) left and right wheel speeds for each physics step, rad/s."""
    half = profile.omega * (spec.track / 2)
    return np.stack((profile.v - half, profile.v + half), axis=1) / spec.wheel_radius
