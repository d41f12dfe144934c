"""The laws that rolled-out candidates obey."""

from functools import lru_cache
from math import cos, pi, sin

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav_mj.control import centre_displacement, drive_towards
from fuzzynav_mj.geometry import wrap_angle
from fuzzynav_mj.planners.headings import HORIZON, TURN_STEP
from fuzzynav_mj.planners.motions import Motions, candidate_motions, places_after
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.types import FloatArray, Pose2D, Twist2D

SPEC = DEFAULT_ROBOT
PERIOD = SPEC.decision_period
AT_REST = Twist2D(0.0, 0.0)
CLASS = 0.05  # rad/s: yaw rates are rounded by up to this much

speeds = st.floats(-SPEC.max_speed, SPEC.max_speed)
rates = st.floats(-SPEC.max_yaw_rate, SPEC.max_yaw_rate)
directions = st.floats(-pi, pi)


def axle_places(motions: Motions) -> FloatArray:
    """(m, HORIZON + 1, 2) places of the axle's middle, the present one first."""
    poses = np.concatenate((np.zeros((len(motions.poses), 1, 3)), motions.poses), axis=1)
    ahead = np.stack((np.cos(poses[..., 2]), np.sin(poses[..., 2])), axis=-1)
    return poses[..., :2] - SPEC.axle_offset * ahead


def mean_rates(motions: Motions) -> FloatArray:
    """(m, HORIZON) mean yaw rate of every period."""
    yaw = motions.poses[..., 2].astype(np.float64)
    rates: FloatArray = np.diff(yaw, axis=1, prepend=0.0) / PERIOD
    return rates


def mean_speeds(motions: Motions) -> FloatArray:
    """(m, HORIZON) mean forward speed of every period: the axle moves along arcs."""
    moved = np.diff(axle_places(motions), axis=1)
    turned = mean_rates(motions) * PERIOD
    half_way = motions.poses[..., 2] - turned / 2
    chord = moved[..., 0] * np.cos(half_way) + moved[..., 1] * np.sin(half_way)
    speeds: FloatArray = chord / np.sinc(turned / (2 * pi)) / PERIOD
    return speeds


@settings(max_examples=25, deadline=None)
@given(directions, speeds, rates)
def test_limits_are_kept(wanted: float, v: float, omega: float) -> None:
    motions = candidate_motions(wanted, Twist2D(v, omega), SPEC)
    speed, rate = mean_speeds(motions), mean_rates(motions)
    assert np.isfinite(motions.poses).all()
    assert np.abs(speed).max() <= SPEC.max_speed * 1.005
    assert np.abs(rate).max() <= SPEC.max_yaw_rate + 1e-4
    # Means over a period follow the start by half a period's change, each other by a whole one's.
    change_v, change_omega = SPEC.max_acceleration * PERIOD, SPEC.max_yaw_acceleration * PERIOD
    assert np.abs(speed[:, 0] - v).max() <= change_v / 2 + 0.004
    assert np.abs(np.diff(speed, axis=1)).max() <= change_v + 0.004
    assert np.abs(rate[:, 0] - omega).max() <= change_omega / 2 + CLASS + 1e-4
    assert np.abs(np.diff(rate, axis=1)).max() <= change_omega + 1e-3


@settings(max_examples=25, deadline=None)
@given(directions, speeds, rates)
def test_axle_never_slips_sideways(wanted: float, v: float, omega: float) -> None:
    """Eq. (6): the axle moves along its own heading only."""
    motions = candidate_motions(wanted, Twist2D(v, omega), SPEC)
    moved = np.diff(axle_places(motions), axis=1)
    half_way = motions.poses[..., 2] - mean_rates(motions) * PERIOD / 2
    aside = moved[..., 1] * np.cos(half_way) - moved[..., 0] * np.sin(half_way)
    assert np.abs(aside).max() < 2e-3


@settings(max_examples=25, deadline=None)
@given(directions, speeds, rates, directions)
def test_first_pose_is_where_the_control_brings_the_robot(
    wanted: float, v: float, omega: float, yaw: float
) -> None:
    start = Pose2D(3.0, -2.0, yaw)
    twist = Twist2D(v, omega)
    motions = candidate_motions(wanted, twist, SPEC)
    c, s = cos(yaw), sin(yaw)
    for x, y, turned in motions.poses[:, 0].astype(np.float64).tolist():
        place = (start.x + c * x - s * y, start.y + s * x + c * y)
        profile = drive_towards(place, start, twist, SPEC)
        dx, dy = centre_displacement(yaw, profile, SPEC)
        assert np.hypot(start.x + dx - place[0], start.y + dy - place[1]) < 2e-3
        reached = float(profile.omega.sum()) * SPEC.physics_period
        assert abs(reached - turned) < 0.02


def test_straight_on_from_rest() -> None:
    """Speeds up at the limit, then keeps on: x = v t - v^2 / 2a once at full speed."""
    motions = candidate_motions(0.0, AT_REST, SPEC)
    first = motions.poses[0].astype(np.float64)
    assert motions.speed[0] == SPEC.max_speed and motions.direction[0] == 0.0
    assert np.abs(first[:, 1:]).max() < 1e-6
    times = (np.arange(HORIZON) + 1) * PERIOD
    ramp = SPEC.max_speed / SPEC.max_acceleration
    x = np.where(
        times < ramp,
        SPEC.max_acceleration * times**2 / 2,
        SPEC.max_speed * (times - ramp / 2),
    )
    np.testing.assert_allclose(first[:, 0], x, atol=3e-3)


def test_straight_back_is_straight_on_the_other_way_round() -> None:
    motions = candidate_motions(0.0, AT_REST, SPEC)
    straight = np.flatnonzero((motions.speed == -SPEC.max_speed) & (motions.direction == pi))
    assert len(straight) == 1
    np.testing.assert_allclose(
        motions.poses[straight[0]], motions.poses[0] * (-1.0, 1.0, 1.0), atol=1e-6
    )


@settings(max_examples=25, deadline=None)
@given(directions, speeds, rates)
def test_last_candidate_stops(wanted: float, v: float, omega: float) -> None:
    motions = candidate_motions(wanted, Twist2D(v, omega), SPEC)
    stop = motions.poses[-1].astype(np.float64)
    assert motions.speed[-1] == 0.0 and not motions.on_the_spot[-1]
    # At rest after the longest braking, and for good.
    longest = max(
        SPEC.max_speed / SPEC.max_acceleration, SPEC.max_yaw_rate / SPEC.max_yaw_acceleration
    )
    rest = stop[int(np.ceil(longest / PERIOD)) :]
    assert np.abs(rest - rest[0]).max() < 1e-6
    # Yaw rate squared over twice the deceleration; the way is the arc's at most.
    braking = abs(omega) ** 2 / (2 * SPEC.max_yaw_acceleration)
    assert abs(abs(stop[-1, 2]) - braking) < 0.05
    assert np.hypot(*axle_places(motions)[-1, -1] + (SPEC.axle_offset, 0.0)) < (
        v**2 / (2 * SPEC.max_acceleration) + 6e-3
    )


def test_braking_way_is_that_of_constant_deceleration() -> None:
    for v in (0.5, 0.3, -0.5):
        end = candidate_motions(0.0, Twist2D(v, 0.0), SPEC).poses[-1, -1]
        assert abs(end[0] - np.copysign(v**2 / (2 * SPEC.max_acceleration), v)) < 4e-3
        assert abs(end[1]) < 1e-6 and abs(end[2]) < 1e-6


def test_brake_steps_are_the_time_to_stop_rounded_up() -> None:
    motions = candidate_motions(0.3, AT_REST, SPEC)
    for speed, steps in zip(motions.speed.tolist(), motions.brake_steps.tolist(), strict=True):
        time = abs(speed) / SPEC.max_acceleration
        assert steps * PERIOD >= time - 1e-9 > (steps - 1) * PERIOD


@settings(max_examples=25, deadline=None)
@given(directions)
def test_turn_on_the_spot_turns_about_the_axle(wanted: float) -> None:
    motions = candidate_motions(wanted, AT_REST, SPEC)
    (index,) = np.flatnonzero(motions.on_the_spot)
    places = axle_places(motions)[index]
    assert np.abs(places - places[0]).max() < 1e-3
    assert abs(wrap_angle(float(motions.poses[index, -1, 2]) - wanted)) < TURN_STEP / 2 + 0.02
    turned = motions.poses[index, :, 2].astype(np.float64)
    assert (np.diff(np.abs(turned)) > -0.02).all()  # straight to it, without swinging past


@settings(max_examples=25, deadline=None)
@given(directions)
def test_wanted_direction_is_tried_at_full_speed_and_reached(wanted: float) -> None:
    motions = candidate_motions(wanted, AT_REST, SPEC)
    forward = motions.speed > 0.0
    fastest = motions.speed == SPEC.max_speed
    off = np.abs(wrap_angle(motions.direction - wanted))
    assert off[fastest].min() <= TURN_STEP / 2 + 1e-9
    yaw = motions.poses[:, -1, 2].astype(np.float64)
    assert np.abs(wrap_angle(yaw - motions.direction))[forward].max() < 0.02


@lru_cache
def _keyed(wanted: float, v: float, omega: float) -> dict[tuple[float, float], FloatArray]:
    motions = candidate_motions(wanted, Twist2D(v, omega), SPEC)
    driving = np.flatnonzero(motions.speed)
    degrees = np.degrees(wrap_angle(motions.direction)).round(6)
    return {
        (round(float(motions.speed[i]), 6), float(degrees[i])): motions.poses[i] for i in driving
    }


@settings(max_examples=25, deadline=None)
@given(st.integers(-88, 88), speeds, st.integers(-29, 29))
def test_left_is_the_mirror_of_right(turn: int, v: float, rate: int) -> None:
    """Candidates of the mirrored case are the mirrored candidates."""
    wanted, omega = turn * TURN_STEP, rate * 0.1
    left, right = _keyed(wanted, v, omega), _keyed(-wanted, v, -omega)
    compared = 0
    for (speed, degrees), poses in left.items():
        if abs(degrees) == 180.0 and speed > 0.0:
            continue  # right about: to either side
        mirrored = right[speed, -degrees if abs(degrees) < 180.0 else degrees]
        np.testing.assert_allclose(mirrored, poses * (1.0, -1.0, -1.0), atol=1e-5)
        compared += 1
    assert compared > 50


@settings(max_examples=25, deadline=None)
@given(directions, speeds, rates)
def test_facing_is_the_yaw_as_cosine_and_sine(wanted: float, v: float, omega: float) -> None:
    motions = candidate_motions(wanted, Twist2D(v, omega), SPEC)
    yaw = motions.poses[..., 2]
    facing = np.stack((np.cos(yaw), np.sin(yaw)), axis=-1)
    np.testing.assert_allclose(motions.facing, facing, atol=1e-15)


def test_places_after_the_first_period_in_the_world() -> None:
    """A robot at (1, 2) that looks along y: ahead is y, and left is -x."""
    poses = np.array([[[0.05, 0.01, 0.3], [9.0, 9.0, 9.0]], [[0.0, 0.0, 0.0], [9.0, 9.0, 9.0]]])
    places = places_after(poses, 1.0, 2.0, pi / 2)
    np.testing.assert_allclose(places, [[0.99, 2.05], [1.0, 2.0]], atol=1e-15)
