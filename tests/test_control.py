"""Laws of the way from a next position to wheel speeds."""

from math import cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav_mj.control import (
    SpeedProfile,
    centre_displacement,
    drive_towards,
    final_speed,
    ramp,
    wheel_speeds,
    wheel_table,
)
from fuzzynav_mj.robot import DEFAULT_ROBOT as SPEC
from fuzzynav_mj.types import FloatArray, Pose2D, Twist2D

PERIOD, STEPS = SPEC.decision_period, SPEC.substeps
REACH_V = SPEC.max_acceleration * PERIOD
REACH_OMEGA = SPEC.max_yaw_acceleration * PERIOD

share = st.floats(-1.0, 1.0)
places = st.floats(-20.0, 20.0)
yaws = st.floats(-pi, pi)


@st.composite
def twists(draw: st.DrawFn) -> Twist2D:
    return Twist2D(draw(share) * SPEC.max_speed, draw(share) * SPEC.max_yaw_rate)


@st.composite
def feasible(draw: st.DrawFn) -> tuple[Twist2D, SpeedProfile]:
    """Present speeds, and ramps of one period that obey every limit."""
    twist = draw(twists())
    v = np.clip(twist.v + draw(share) * REACH_V, -SPEC.max_speed, SPEC.max_speed)
    omega = twist.omega + draw(share) * REACH_OMEGA
    omega = np.clip(omega, -SPEC.max_yaw_rate, SPEC.max_yaw_rate)
    return twist, ramps(twist, float(v), float(omega))


def ramps(twist: Twist2D, v: float, omega: float) -> SpeedProfile:
    return SpeedProfile(
        ramp(twist.v, v, SPEC.max_acceleration, PERIOD, STEPS),
        ramp(twist.omega, omega, SPEC.max_yaw_acceleration, PERIOD, STEPS),
    )


def steady(v: float, omega: float, steps: int = STEPS) -> SpeedProfile:
    return SpeedProfile(np.full(steps, v), np.full(steps, omega))


def carried_on(pose: Pose2D, profile: SpeedProfile) -> Pose2D:
    """The pose after a period of pure rolling."""
    dx, dy = centre_displacement(pose.yaw, profile, SPEC)
    turn = float(profile.omega.sum()) * SPEC.physics_period
    return Pose2D(pose.x + dx, pose.y + dy, pose.yaw + turn)


# Ramps ----------------------------------------------------------------------------------------


@given(start=share, aim=share)
def test_ramp_rises_no_faster_than_its_slope_and_stays_at_its_end(start: float, aim: float) -> None:
    speeds = ramp(start, aim, 2.0, 0.1, 20)
    steps = np.diff(np.concatenate(([start], speeds)))
    assert np.abs(steps).max() <= 2.0 * 0.1 / 20 + 1e-12
    assert (steps * np.sign(aim - start) >= -1e-15).all()
    reachable = min(abs(aim - start), 0.2)
    assert abs(speeds[-1] - start) == pytest.approx(reachable, abs=1e-12)


@given(start=share, missing=st.floats(-0.1, 0.1))
def test_final_speed_gives_the_mean(start: float, missing: float) -> None:
    """The ramp to it, as fine steps show, has the mean that was asked for."""
    end = final_speed(start + missing, start, 0.2)
    speeds = ramp(start, end, 2.0, 0.1, 20_000)
    assert speeds.mean() == pytest.approx(start + missing, abs=1e-5)


@given(start=share, mean=st.floats(-10.0, 10.0))
def test_final_speed_stays_within_reach(start: float, mean: float) -> None:
    assert abs(final_speed(mean, start, 0.2) - start) <= 0.2 + 1e-12


# Where speeds lead ----------------------------------------------------------------------------


def test_straight_on() -> None:
    assert centre_displacement(0.0, steady(0.5, 0.0), SPEC) == pytest.approx((0.05, 0.0))
    assert centre_displacement(pi / 2, steady(-0.5, 0.0), SPEC) == pytest.approx((0.0, -0.05))


def test_spinning_carries_the_centre_round_the_axle() -> None:
    turn, d = SPEC.max_yaw_rate * PERIOD, SPEC.axle_offset
    expected = (d * (cos(turn) - 1.0), d * sin(turn))
    moved = centre_displacement(0.0, steady(0.0, SPEC.max_yaw_rate), SPEC)
    assert moved == pytest.approx(expected, abs=1e-6)


@given(yaw=yaws, v=share, omega=st.floats(0.5, 1.0))
def test_steady_speeds_lead_along_a_circle(yaw: float, v: float, omega: float) -> None:
    v, omega = v * SPEC.max_speed, omega * SPEC.max_yaw_rate
    radius, turn, d = v / omega, omega * PERIOD, SPEC.axle_offset
    expected = (
        radius * (sin(yaw + turn) - sin(yaw)) + d * (cos(yaw + turn) - cos(yaw)),
        -radius * (cos(yaw + turn) - cos(yaw)) + d * (sin(yaw + turn) - sin(yaw)),
    )
    moved = centre_displacement(yaw, steady(v, omega), SPEC)
    assert moved == pytest.approx(expected, abs=1e-6)


# Next position to speeds ----------------------------------------------------------------------


@given(twists(), places, places, places, places, yaws)
def test_no_limit_is_ever_exceeded(
    twist: Twist2D, x: float, y: float, next_x: float, next_y: float, yaw: float
) -> None:
    profile = drive_towards((next_x, next_y), Pose2D(x, y, yaw), twist, SPEC)
    for speeds, start, top, slope in (
        (profile.v, twist.v, SPEC.max_speed, SPEC.max_acceleration),
        (profile.omega, twist.omega, SPEC.max_yaw_rate, SPEC.max_yaw_acceleration),
    ):
        assert len(speeds) == STEPS
        assert np.abs(speeds).max() <= top + 1e-12
        rates = np.diff(np.concatenate(([start], speeds))) / SPEC.physics_period
        assert np.abs(rates).max() <= slope + 1e-9


@given(feasible(), yaws, places, places)
def test_next_position_within_reach_is_reached(
    drawn: tuple[Twist2D, SpeedProfile], yaw: float, x: float, y: float
) -> None:
    twist, possible = drawn
    pose = Pose2D(x, y, yaw)
    there = carried_on(pose, possible)
    after = carried_on(pose, drive_towards((there.x, there.y), pose, twist, SPEC))
    assert hypot(after.x - there.x, after.y - there.y) < 2e-3


def test_most_are_reached_to_a_tenth_of_a_millimetre() -> None:
    rng = np.random.default_rng(2)
    misses = []
    for _ in range(300):
        v, omega = rng.uniform(-1, 1, 2) * (SPEC.max_speed, SPEC.max_yaw_rate)
        end = np.clip((v, omega) + rng.uniform(-1, 1, 2) * (REACH_V, REACH_OMEGA),
                      (-SPEC.max_speed, -SPEC.max_yaw_rate),
                      (SPEC.max_speed, SPEC.max_yaw_rate))  # fmt: skip
        twist, pose = Twist2D(v, omega), Pose2D(0.0, 0.0, 0.7)
        there = carried_on(pose, ramps(twist, *end))
        after = carried_on(pose, drive_towards((there.x, there.y), pose, twist, SPEC))
        misses.append(hypot(after.x - there.x, after.y - there.y))
    assert np.percentile(misses, 98) < 1e-4


@given(yaws, places, places)
def test_staying_is_standing_still(yaw: float, x: float, y: float) -> None:
    profile = drive_towards((x, y), Pose2D(x, y, yaw), Twist2D(0.0, 0.0), SPEC)
    assert not profile.v.any() and not profile.omega.any()


def test_left_and_right_are_alike() -> None:
    rng = np.random.default_rng(4)
    for _ in range(100):
        x, y = rng.uniform(-0.1, 0.1, 2)
        v, omega, yaw = rng.uniform(-1, 1, 3) * (SPEC.max_speed, SPEC.max_yaw_rate, pi)
        one = drive_towards((x, y), Pose2D(0.0, 0.0, yaw), Twist2D(v, omega), SPEC)
        other = drive_towards((x, -y), Pose2D(0.0, 0.0, -yaw), Twist2D(v, -omega), SPEC)
        assert other.v == pytest.approx(one.v, abs=1e-9)
        assert other.omega == pytest.approx(-one.omega, abs=1e-9)


def followed(target: tuple[float, float], periods: int) -> FloatArray:
    """(periods + 1, 2) places on the way from rest at the origin to a far target."""
    pose, twist = Pose2D(0.0, 0.0, 0.0), Twist2D(0.0, 0.0)
    places = [(0.0, 0.0)]
    for _ in range(periods):
        profile = drive_towards(target, pose, twist, SPEC)
        pose, twist = carried_on(pose, profile), profile.final
        places.append((pose.x, pose.y))
    return np.array(places)


@pytest.mark.parametrize("degrees", [0, 10, 25, 45, 70, 90, 120, 150, 180, -30, -100])
def test_far_target_is_approached_on_the_straight_line(degrees: float) -> None:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    way = followed((3.0 * c, 3.0 * s), 62)
    assert np.abs(way @ (-s, c)).max() < 0.03
    # Not much slower than full speed all the way, once it has sped up and turned.
    assert (way @ (c, s)).max() > 2.7


# Speeds to wheels -----------------------------------------------------------------------------


@given(twists())
def test_wheel_speeds_invert_the_kinematics(twist: Twist2D) -> None:
    """Eqs. (1)-(3): v = r (right + left) / 2 and omega = r (right - left) / track."""
    wheels = wheel_speeds(twist.v, twist.omega, SPEC)
    rims = SPEC.wheel_radius * wheels.left, SPEC.wheel_radius * wheels.right
    assert (rims[1] + rims[0]) / 2 == pytest.approx(twist.v, abs=1e-12)
    assert (rims[1] - rims[0]) / SPEC.track == pytest.approx(twist.omega, abs=1e-12)


def test_wheel_table_holds_the_same_speeds() -> None:
    profile = SpeedProfile(np.array([0.1, -0.4, 0.5]), np.array([0.0, 2.0, -3.0]))
    rows = wheel_table(profile, SPEC)
    for row, v, omega in zip(rows, profile.v, profile.omega, strict=True):
        wheels = wheel_speeds(float(v), float(omega), SPEC)
        assert row == pytest.approx((wheels.left, wheels.right), abs=1e-12)
