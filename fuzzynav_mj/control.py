"""Next position -> speeds under the robot's limits -> wheel speeds.

The axle lies `axle_offset` behind the footprint's centre, so a forward speed v and a yaw rate
omega move the centre with (v, axle_offset * omega) in the robot frame: every small displacement
of the centre, sideways too, belongs to one pair of speeds. Planner and task use the same ramp,
so what a planner rolls out is what the wheels are told.
"""

from dataclasses import dataclass
from math import copysign, cos, hypot, sin, sqrt

import numpy as np

from fuzzynav_mj.compiled import compiled
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


@compiled
def final_speed(mean: float, start: float, reach: float) -> float:
    """Speed that a ramp of limited slope must end at to have the given mean over a period.

    The ramp is as steep as allowed and then constant. `reach` is the largest change in one
    period; a mean that cannot be had gives the nearest ramp.
    """
    missing = mean - start
    change = reach
    if abs(missing) < reach / 2:
        change = reach * (1.0 - sqrt(1.0 - 2.0 * abs(missing) / reach))
    return start + (change if missing >= 0 else -change)


@compiled
def ramp(start: float, end: float, slope: float, period: float, steps: int) -> FloatArray:
    """(steps,) speeds that lead from `start` to `end` with the given slope (per second)."""
    span = min(abs(end - start), slope * period)
    direction = 1.0 if end >= start else -1.0
    speeds = np.empty(steps)
    for k in range(steps):
        speeds[k] = start + direction * min(slope * ((k + 1) * (period / steps)), span)
    return speeds


def centre_displacement(yaw: float, profile: SpeedProfile, spec: RobotSpec) -> tuple[float, float]:
    """World-frame displacement of the footprint's centre over one period of the profile."""
    return _displacement(
        float(yaw), profile.v, profile.omega, spec.physics_period, spec.axle_offset
    )


@compiled
def ramped_displacement(
    yaw: float,
    twist: tuple[float, float],
    ends: tuple[float, float],
    slopes: tuple[float, float],
    period: float,
    steps: int,
    axle_offset: float,
) -> tuple[float, float]:
    """World-frame displacement of the centre over one period, m, in which forward speed and yaw
    rate are ramped from `twist` to `ends` with these slopes."""
    v = ramp(twist[0], ends[0], slopes[0], period, steps)
    omega = ramp(twist[1], ends[1], slopes[1], period, steps)
    return _displacement(yaw, v, omega, period / steps, axle_offset)


@compiled
def _displacement(
    yaw: float, v: FloatArray, omega: FloatArray, dt: float, axle_offset: float
) -> tuple[float, float]:
    """World-frame displacement of the centre, m, for speeds (k,) held for `dt` each, with the yaw
    taken half-way through each step."""
    x = y = turned = 0.0
    for k in range(len(v)):
        turned += omega[k]
        middle = yaw + turned * dt - omega[k] * (dt / 2)
        c, s = cos(middle), sin(middle)
        side = axle_offset * omega[k]
        x += c * v[k] - s * side
        y += s * v[k] + c * side
    return x * dt, y * dt


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
    speeds = _speeds_towards(
        float(next_position[0] - pose.x),
        float(next_position[1] - pose.y),
        float(pose.yaw),
        float(twist.v),
        float(twist.omega),
        spec.max_speed,
        spec.max_acceleration,
        spec.max_yaw_rate,
        spec.max_yaw_acceleration,
        spec.decision_period,
        spec.substeps,
        spec.axle_offset,
    )
    return SpeedProfile(speeds[0], speeds[1])


@compiled
def _speeds_towards(
    dx: float,
    dy: float,
    yaw: float,
    v: float,
    omega: float,
    max_speed: float,
    max_acceleration: float,
    max_yaw_rate: float,
    max_yaw_acceleration: float,
    period: float,
    steps: int,
    axle_offset: float,
) -> FloatArray:
    """(2, steps) forward speeds and yaw rates for a displacement of the centre (world frame, m)
    from the present yaw and speeds, within the limits."""
    limits = (max_speed, max_acceleration, max_yaw_rate, max_yaw_acceleration)
    speeds, miss = _ramps_towards(dx, dy, yaw, v, omega, limits, period, steps, axle_offset)
    if miss <= REACHED:
        return speeds
    forward = dx * cos(yaw) + dy * sin(yaw)
    left = dy * cos(yaw) - dx * sin(yaw)
    largest_forward = max_speed * period
    largest_left = axle_offset * max_yaw_rate * period
    scale = max(abs(forward) / largest_forward, abs(left) / largest_left, 1.0)
    dx, dy = dx / scale, dy / scale
    return _ramps_towards(dx, dy, yaw, v, omega, limits, period, steps, axle_offset)[0]


@compiled
def _ramps_towards(
    dx: float,
    dy: float,
    yaw: float,
    v_now: float,
    omega_now: float,
    limits: tuple[float, float, float, float],
    period: float,
    steps: int,
    axle_offset: float,
) -> tuple[FloatArray, float]:
    """(2, steps) ramps for a displacement of the centre, and by how much they miss it, m."""
    max_speed, max_acceleration, max_yaw_rate, max_yaw_acceleration = limits
    dt = period / steps
    reach_v, reach_omega = max_acceleration * period, max_yaw_acceleration * period
    lowest_v, highest_v = max(v_now - reach_v, -max_speed), min(v_now + reach_v, max_speed)
    lowest = max(omega_now - reach_omega, -max_yaw_rate)
    highest = min(omega_now + reach_omega, max_yaw_rate)
    best = np.empty((2, steps))
    v, omega, turned = v_now, omega_now, 0.0
    for _ in range(_TURN_PASSES):
        c, s = cos(yaw + turned), sin(yaw + turned)
        forward, left = dx * c + dy * s, dy * c - dx * s
        v = final_speed(forward / period, v_now, reach_v)
        v = min(max(v, lowest_v), highest_v)
        omega = final_speed(left / (period * axle_offset), omega_now, reach_omega)
        omega = min(max(omega, lowest), highest)
        best[1] = ramp(omega_now, omega, max_yaw_acceleration, period, steps)
        turned = best[1].cumsum().sum() / steps * dt  # the period's mean of the angle turned
    best[0] = ramp(v_now, v, max_acceleration, period, steps)
    x, y = _displacement(yaw, best[0], best[1], dt, axle_offset)
    ex, ey = x - dx, y - dy
    best_miss = hypot(ex, ey)
    speeds, rates = best[0].copy(), best[1].copy()
    for _ in range(_NEWTON_STEPS):
        # A miss that is not small is no matter of precision: the target is out of reach, and
        # pursuing it would only turn the motion away from its direction.
        if not _EXACT < hypot(ex, ey) < _WITHIN_REACH:
            break
        dv, dw = copysign(_PROBE, v_now - v), copysign(_PROBE, omega_now - omega)  # inwards
        faster = ramp(v_now, v + dv, max_acceleration, period, steps)
        x, y = _displacement(yaw, faster, rates, dt, axle_offset)
        xv, yv = (x - dx - ex) / dv, (y - dy - ey) / dv
        sharper = ramp(omega_now, omega + dw, max_yaw_acceleration, period, steps)
        x, y = _displacement(yaw, speeds, sharper, dt, axle_offset)
        xw, yw = (x - dx - ex) / dw, (y - dy - ey) / dw
        determinant = xv * yw - xw * yv
        if determinant == 0.0:
            break
        v = min(max(v - (yw * ex - xw * ey) / determinant, lowest_v), highest_v)
        omega = min(max(omega - (xv * ey - yv * ex) / determinant, lowest), highest)
        speeds = ramp(v_now, v, max_acceleration, period, steps)
        rates = ramp(omega_now, omega, max_yaw_acceleration, period, steps)
        x, y = _displacement(yaw, speeds, rates, dt, axle_offset)
        ex, ey = x - dx, y - dy
        if hypot(ex, ey) < best_miss:
            best[0], best[1], best_miss = speeds, rates, hypot(ex, ey)
    return best, best_miss


def wheel_speeds(v: float, omega: float, spec: RobotSpec) -> WheelSpeeds:
    """Inverse of the differential drive's kinematics, Eqs. (1)-(3)."""
    half = omega * spec.track / 2
    return WheelSpeeds((v - half) / spec.wheel_radius, (v + half) / spec.wheel_radius)


def wheel_table(profile: SpeedProfile, spec: RobotSpec) -> FloatArray:
    """(k, 2) left and right wheel speeds for each physics step, rad/s."""
    return _wheel_table(profile.v, profile.omega, spec.track, spec.wheel_radius)


@compiled
def _wheel_table(v: FloatArray, omega: FloatArray, track: float, wheel_radius: float) -> FloatArray:
    """See `wheel_table`."""
    table = np.empty((len(v), 2))
    for k in range(len(v)):
        half = omega[k] * (track / 2)
        table[k, 0] = (v[k] - half) / wheel_radius
        table[k, 1] = (v[k] + half) / wheel_radius
    return table
