"""Next position -> speeds under the robot's limits -> wheel speeds.

The axle lies `axle_offset` behind the footprint's centre, so a forward speed v and a yaw rate
omega move the centre with (v, axle_offset * omega) in the robot frame: every small displacement
of the centre, sideways too, belongs to one pair of speeds. Planner and task use the same ramp,
so what a planner rolls out is what the wheels are told.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import copysign, cos, hypot, sin, sqrt

import numpy as np

from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray, Pose2D, Twist2D, WheelSpeeds

REACHED = 2e-3  # m: a next position missed by less than this counts as within reach
_WITHIN_REACH = 5e-3  # m: first guesses that miss by less are made exact
_EXACT = 1e-5  # m
_TURN_PASSES = 3
_NEWTON_STEPS = 3
_PROBE = 1e-4  # m/s and rad/s: step of the numerical derivatives


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
    change = np.minimum(_steepest(slope, period, steps), span)
    speeds: FloatArray = start + change if end >= start else start - change
    return speeds


@lru_cache(maxsize=8)
def _steepest(slope: float, period: float, steps: int) -> FloatArray:
    """(steps,) change of speed since the period's start at the given slope, after each step."""
    change: FloatArray = slope * (np.arange(1, steps + 1, dtype=np.float64) * (period / steps))
    return change


@dataclass(frozen=True, slots=True, eq=False)
class _Turning:
    """What a period's yaw rates do to the centre, whatever the forward speeds.

    Attributes:
        cos: (k,) of the yaw half-way through each physics step.
        sin: (k,) the same.
        aside: (x, y) sum of the speeds that the turning alone gives the centre, world frame, m/s.
    """

    cos: FloatArray
    sin: FloatArray
    aside: tuple[float, float]


def _turning(yaw: float, omega: FloatArray, spec: RobotSpec) -> _Turning:
    dt = spec.physics_period
    turned = yaw + omega.cumsum() * dt - omega * (dt / 2)
    c, s = np.cos(turned), np.sin(turned)
    side = spec.axle_offset * omega
    return _Turning(c, s, (s.dot(side), c.dot(side)))


def _displacement(turning: _Turning, v: FloatArray, spec: RobotSpec) -> tuple[float, float]:
    dt = spec.physics_period
    x, y = turning.cos.dot(v) - turning.aside[0], turning.sin.dot(v) + turning.aside[1]
    return float(x) * dt, float(y) * dt


def centre_displacement(yaw: float, profile: SpeedProfile, spec: RobotSpec) -> tuple[float, float]:
    """World-frame displacement of the footprint's centre over one period of the profile."""
    return _displacement(_turning(yaw, profile.omega, spec), profile.v, spec)


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
    dx, dy = next_position[0] - pose.x, next_position[1] - pose.y
    profile, miss = _ramps_towards((dx, dy), pose.yaw, twist, spec)
    if miss <= REACHED:
        return profile
    forward = dx * cos(pose.yaw) + dy * sin(pose.yaw)
    left = dy * cos(pose.yaw) - dx * sin(pose.yaw)
    largest_forward = spec.max_speed * spec.decision_period
    largest_left = spec.axle_offset * spec.max_yaw_rate * spec.decision_period
    scale = max(abs(forward) / largest_forward, abs(left) / largest_left, 1.0)
    return _ramps_towards((dx / scale, dy / scale), pose.yaw, twist, spec)[0]


def _ramps_towards(
    target: tuple[float, float], yaw: float, twist: Twist2D, spec: RobotSpec
) -> tuple[SpeedProfile, float]:
    """Ramps for a displacement of the centre (world frame, m), and by how much they miss it, m."""
    period = spec.decision_period
    reach_v = spec.max_acceleration * period
    reach_omega = spec.max_yaw_acceleration * period

    def within_limits(v: float, omega: float) -> tuple[float, float]:
        v = min(max(v, twist.v - reach_v, -spec.max_speed), twist.v + reach_v, spec.max_speed)
        lowest, highest = twist.omega - reach_omega, twist.omega + reach_omega
        return v, min(max(omega, lowest, -spec.max_yaw_rate), highest, spec.max_yaw_rate)

    def speeds(v: float) -> FloatArray:
        return ramp(twist.v, v, spec.max_acceleration, period, spec.substeps)

    def rates(omega: float) -> FloatArray:
        return ramp(twist.omega, omega, spec.max_yaw_acceleration, period, spec.substeps)

    def error(turning: _Turning, v: FloatArray) -> tuple[float, float]:
        moved = _displacement(turning, v, spec)
        return moved[0] - target[0], moved[1] - target[1]

    turned = 0.0
    for _ in range(_TURN_PASSES):
        c, s = cos(yaw + turned), sin(yaw + turned)
        forward, left = target[0] * c + target[1] * s, target[1] * c - target[0] * s
        v, omega = within_limits(
            final_speed(forward / period, twist.v, reach_v),
            final_speed(left / (period * spec.axle_offset), twist.omega, reach_omega),
        )
        omegas = rates(omega)
        turned = _mean_turn(omegas, spec)
    profile = SpeedProfile(speeds(v), omegas)
    turning = _turning(yaw, omegas, spec)
    ex, ey = error(turning, profile.v)
    best, best_miss = profile, hypot(ex, ey)
    for _ in range(_NEWTON_STEPS):
        # A miss that is not small is no matter of precision: the target is out of reach, and
        # pursuing it would only turn the motion away from its direction.
        if not _EXACT < hypot(ex, ey) < _WITHIN_REACH:
            break
        dv, dw = copysign(_PROBE, twist.v - v), copysign(_PROBE, twist.omega - omega)  # inwards
        ahead = error(turning, speeds(v + dv))
        aside = error(_turning(yaw, rates(omega + dw), spec), profile.v)
        xv, yv = (ahead[0] - ex) / dv, (ahead[1] - ey) / dv
        xw, yw = (aside[0] - ex) / dw, (aside[1] - ey) / dw
        determinant = xv * yw - xw * yv
        if determinant == 0.0:
            break
        v, omega = within_limits(
            v - (yw * ex - xw * ey) / determinant, omega - (xv * ey - yv * ex) / determinant
        )
        profile = SpeedProfile(speeds(v), rates(omega))
        turning = _turning(yaw, profile.omega, spec)
        ex, ey = error(turning, profile.v)
        if hypot(ex, ey) < best_miss:
            best, best_miss = profile, hypot(ex, ey)
    return best, best_miss


def _mean_turn(omega: FloatArray, spec: RobotSpec) -> float:
    """Mean over the period of the angle turned since its start, rad."""
    return float(omega.cumsum().sum()) / len(omega) * spec.physics_period


def wheel_speeds(v: float, omega: float, spec: RobotSpec) -> WheelSpeeds:
    """Inverse of the differential drive's kinematics, Eqs. (1)-(3)."""
    half = omega * spec.track / 2
    return WheelSpeeds((v - half) / spec.wheel_radius, (v + half) / spec.wheel_radius)


def wheel_table(profile: SpeedProfile, spec: RobotSpec) -> FloatArray:
    """(k, 2) left and right wheel speeds for each physics step, rad/s."""
    half = profile.omega * (spec.track / 2)
    table: FloatArray = np.empty((len(half), 2))
    table[:, 0], table[:, 1] = profile.v - half, profile.v + half
    table /= spec.wheel_radius
    return table
