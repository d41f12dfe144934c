"""Steering: next positions that stand for speeds, and speeds that stand for a direction."""

from math import cos, hypot, pi, sin

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fuzzynav_mj.control import centre_displacement, drive_towards
from fuzzynav_mj.geometry import wrap_angle
from fuzzynav_mj.planners.steering import position_after, twist_towards
from fuzzynav_mj.robot import DEFAULT_ROBOT as SPEC
from fuzzynav_mj.types import Pose2D, Twist2D

SPEEDS = st.floats(-SPEC.max_speed, SPEC.max_speed)
YAW_RATES = st.floats(-SPEC.max_yaw_rate, SPEC.max_yaw_rate)
YAWS = st.floats(-pi, pi)


@given(SPEEDS, YAW_RATES, SPEEDS, YAW_RATES, YAWS)
@example(0.0, 2.375, -0.25, 1.75, 0.0)
def test_the_position_is_driven_at_the_speeds_it_stands_for(
    v: float, omega: float, now_v: float, now_omega: float, yaw: float
) -> None:
    """Within a millimetre, and where it is exact so are the speeds: at the limits of both of them
    the search may stop at other speeds that lead nearly there."""
    pose, twist = Pose2D(1.0, 2.0, yaw), Twist2D(now_v, now_omega)
    x, y = position_after(v, omega, pose, twist, SPEC)
    profile = drive_towards((x, y), pose, twist, SPEC)
    dx, dy = centre_displacement(yaw, profile, SPEC)
    miss = hypot(pose.x + dx - x, pose.y + dy - y)
    assert miss < 1e-3
    if miss > 1e-5:
        return
    driven = profile.final
    most_v = SPEC.max_acceleration * SPEC.decision_period
    most_omega = SPEC.max_yaw_acceleration * SPEC.decision_period
    wanted_v = min(max(v, now_v - most_v), now_v + most_v)
    wanted_omega = min(max(omega, now_omega - most_omega), now_omega + most_omega)
    # A position tells the mean speed of the period exactly, the speed at its end less so.
    assert driven.v == pytest.approx(wanted_v, abs=0.02)
    assert driven.omega == pytest.approx(wanted_omega, abs=0.1)


def test_straight_on_at_full_speed_is_a_straight_line() -> None:
    """0.1 s at 0.5 m/s: 5 cm ahead; from rest 2 m/s2 for 0.1 s: 1 cm."""
    pose = Pose2D(0.0, 0.0, 0.0)
    assert position_after(0.5, 0.0, pose, Twist2D(0.5, 0.0), SPEC) == pytest.approx((0.05, 0.0))
    x, y = position_after(0.5, 0.0, pose, Twist2D(0.0, 0.0), SPEC)
    assert (x, y) == pytest.approx((0.01, 0.0), abs=6e-4)


def test_speeds_beyond_the_limits_are_cut_to_them() -> None:
    pose, twist = Pose2D(0.0, 0.0, 0.3), Twist2D(0.45, 2.5)
    beyond = position_after(9.0, 99.0, pose, twist, SPEC)
    assert beyond == position_after(SPEC.max_speed, SPEC.max_yaw_rate, pose, twist, SPEC)


@given(YAWS, YAWS)
def test_off_course_it_turns_the_short_way_without_driving_on(direction: float, yaw: float) -> None:
    error = wrap_angle(direction - yaw)
    twist = twist_towards(direction, 0.5, Pose2D(0.0, 0.0, yaw), SPEC)
    assert twist.omega * error >= 0.0
    assert 0.0 <= twist.v <= 0.5
    if abs(error) >= pi / 2:
        assert twist.v == 0.0


@given(YAWS)
def test_it_ends_on_course(direction: float) -> None:
    """Within two seconds of steering the robot travels in the wanted direction at full speed."""
    pose, twist = Pose2D(0.0, 0.0, 0.0), Twist2D(0.0, 0.0)
    for _ in range(20):
        aim = twist_towards(direction, SPEC.max_speed, pose, SPEC)
        x, y = position_after(aim.v, aim.omega, pose, twist, SPEC)
        profile = drive_towards((x, y), pose, twist, SPEC)
        turned = float(profile.omega.sum()) * SPEC.physics_period
        before, pose = pose, Pose2D(x, y, wrap_angle(pose.yaw + turned))
        twist = profile.final
    step = (pose.x - before.x, pose.y - before.y)
    assert hypot(*step) == pytest.approx(0.05, abs=1e-3)
    assert step[0] * cos(direction) + step[1] * sin(direction) == pytest.approx(0.05, abs=1e-3)
