"""Predicted displacements of movers against closed forms."""

from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from perceived import mover

from fuzzynav_mj.geometry import rotation
from fuzzynav_mj.planners.prediction import displacements, going
from fuzzynav_mj.types import FloatArray, PerceivedObstacle

TIMES = (np.arange(16) + 1.0) * 0.1
HERE = (0.0, 0.0)  # the robot's place

speeds = st.floats(0.05, 0.8)
angles = st.floats(-pi, pi)
turns = st.floats(0.02, 2.0) | st.floats(-2.0, -0.02)


def ways(
    velocity: tuple[float, float],
    turn_rate: float = 0.0,
    closing_sigma: float = 0.0,
    place: tuple[float, float] = HERE,
    times: FloatArray = TIMES,
) -> list[FloatArray]:
    """The predictions for a mover whose nearest point is (0.6, 0)."""
    seen = mover([(0.6, 0.0), (0.65, 0.1)], velocity, turn_rate, closing_sigma)
    return list(predicted(seen, place, times)[0])


def predicted(
    seen: PerceivedObstacle, place: tuple[float, float] = HERE, times: FloatArray = TIMES
) -> tuple[FloatArray, FloatArray]:
    return displacements(np.array(going(seen, place)), times)


def among(found: list[FloatArray], wanted: FloatArray) -> bool:
    """True if one of the predictions is the wanted one."""
    return any(np.allclose(way, wanted, atol=1e-9) for way in found)


@settings(max_examples=30, deadline=None)
@given(speeds, angles)
def test_straight_motion(speed: float, heading: float) -> None:
    velocity = (speed * cos(heading), speed * sin(heading))
    found = ways(velocity)
    np.testing.assert_allclose(found[0], TIMES[:, None] * velocity, atol=1e-12)


@settings(max_examples=30, deadline=None)
@given(speeds, angles, turns)
def test_circular_motion(speed: float, heading: float, turn_rate: float) -> None:
    """A constant turn rate keeps the mover on a circle of radius v / omega about its left."""
    velocity = np.array([speed * cos(heading), speed * sin(heading)])
    radius = speed / turn_rate
    phase = heading + turn_rate * TIMES
    circle = radius * np.stack((np.sin(phase) - sin(heading), cos(heading) - np.cos(phase)), axis=1)
    found = ways((velocity[0], velocity[1]), turn_rate)
    np.testing.assert_allclose(found[0], circle, atol=1e-9)
    centre = radius * np.array([-sin(heading), cos(heading)])
    np.testing.assert_allclose(np.hypot(*(found[0] - centre).T), abs(radius), rtol=1e-9)


def test_half_a_circle_by_hand() -> None:
    """0.5 m/s and pi/2 rad/s: after 2 s on the other side of a circle of radius 1/pi."""
    (arc, *_) = ways((0.5, 0.0), pi / 2, times=np.array([1.0, 2.0]))
    np.testing.assert_allclose(arc, [[1 / pi, 1 / pi], [0.0, 2 / pi]], atol=1e-12)


@settings(max_examples=30, deadline=None)
@given(speeds, angles, turns)
def test_speed_is_kept_on_arcs(speed: float, heading: float, turn_rate: float) -> None:
    times = np.arange(0.0, 1.6, 1e-3)
    (arc, *_) = ways((speed * cos(heading), speed * sin(heading)), turn_rate, times=times)
    moved = np.hypot(*np.diff(arc, axis=0).T) / 1e-3
    np.testing.assert_allclose(moved, speed, rtol=1e-5)


def test_slow_turn_is_nearly_straight() -> None:
    """Both sides of the turn rate from which on an arc is computed agree."""
    straight = ways((0.3, 0.2))[0]
    for turn_rate in (1e-6, 0.9e-3, 1.1e-3, -1.1e-3):
        np.testing.assert_allclose(ways((0.3, 0.2), turn_rate)[0], straight, atol=1e-3)


@pytest.mark.parametrize("turn_rate", [1.0, -1.0])
def test_turning_mover_may_go_straight_on(turn_rate: float) -> None:
    assert among(ways((0.2, -0.3), turn_rate), TIMES[:, None] * (0.2, -0.3))


@settings(max_examples=30, deadline=None)
@given(st.floats(0.0, 0.8), angles, st.floats(-2.0, 2.0), st.floats(0.0, 0.6))
def test_every_way_begins_where_the_mover_is(
    speed: float, heading: float, turn_rate: float, sigma: float
) -> None:
    velocity = (speed * cos(heading), speed * sin(heading))
    for way in ways(velocity, turn_rate, sigma, times=np.array([0.0, 1e-4])):
        assert way.shape == (2, 2) and np.isfinite(way).all()
        assert np.abs(way).max() < 2e-4


@settings(max_examples=30, deadline=None)
@given(speeds, angles, st.floats(-2.0, 2.0), st.floats(0.0, 0.6), angles)
def test_turned_world_turns_the_prediction(
    speed: float, heading: float, turn_rate: float, sigma: float, angle: float
) -> None:
    turn = rotation(angle)
    velocity = np.array([speed * cos(heading), speed * sin(heading)])
    points = np.array([(0.6, 0.0), (0.65, 0.1)])
    plain, likely = predicted(mover(points, velocity, turn_rate, sigma))
    turned, as_likely = predicted(mover(points @ turn.T, turn @ velocity, turn_rate, sigma))
    assert len(plain) == len(turned)
    np.testing.assert_allclose(likely, as_likely, rtol=1e-12)
    for one, other in zip(plain, turned, strict=True):
        np.testing.assert_allclose(one @ turn.T, other, atol=1e-9)


@settings(max_examples=30, deadline=None)
@given(speeds, angles, st.floats(-2.0, 2.0))
def test_left_is_the_mirror_of_right(speed: float, heading: float, turn_rate: float) -> None:
    vx, vy = speed * cos(heading), speed * sin(heading)
    left, right = ways((vx, vy), turn_rate), ways((vx, -vy), -turn_rate)
    assert len(left) == len(right)
    for way in left:
        assert among(right, way * (1.0, -1.0))


def test_a_mover_may_turn_back_on_the_spot() -> None:
    """For 0.4 s, in which a robot that stands sees it and becomes as fast; then as expected."""
    for turn_rate in (0.0, 1.0):
        found = ways((0.3, -0.4), turn_rate)
        back = found[0].copy()
        back[:4] = -TIMES[:4, None] * (0.3, -0.4)
        assert among(found, back)


@settings(max_examples=30, deadline=None)
@given(speeds, angles, st.floats(-2.0, 2.0))
def test_a_mover_may_turn_aside_on_the_spot_or_swerve(
    speed: float, heading: float, turn_rate: float
) -> None:
    """At its own speed for 0.2 s, or with 0.5 m/s2 if that takes it farther; so for 0.6 s; then it
    goes on as expected."""
    found = ways((speed * cos(heading), speed * sin(heading)), turn_rate)
    left = np.array([-sin(heading), cos(heading)])
    aside = np.where(TIMES < 0.61, 0.25 * TIMES**2, 0.0)
    aside = np.where(TIMES < 0.21, np.maximum(aside, speed * TIMES), aside)
    for side in (1.0, -1.0):
        assert among(found, found[0] + side * aside[:, None] * left)


def test_a_mover_of_uncertain_direction_may_go_astray_to_both_sides() -> None:
    """By three standard deviations of what is beyond 0.03 m/s, but no more than 0.3 m/s."""

    def widest(drift_sigma: float, time: int) -> float:
        seen = mover([(0.6, 0.0), (0.65, 0.1)], (-0.2, 0.0), drift_sigma=drift_sigma)
        found, _ = predicted(seen)
        left, right = float(found[:, time, 1].max()), float(found[:, time, 1].min())
        assert left == pytest.approx(-right)
        return left

    for time, swerve in ((5, 0.09), (7, 0.0)):  # after 0.6 and 0.8 s
        assert widest(0.03, time) == pytest.approx(swerve, abs=1e-9)
        assert widest(0.05, time) == pytest.approx(swerve + 3.0 * 0.02 * TIMES[time])
        assert widest(0.5, time) == pytest.approx(swerve + 0.3 * TIMES[time])


def test_uncertain_closing_speed_is_met_with_caution() -> None:
    """An unsure look is answered by thinking of the mover as coming faster, never slower."""
    sure, unsure = ways((-0.2, 0.0)), ways((-0.2, 0.0), closing_sigma=0.3)
    assert min(way[-1, 0] for way in unsure) < min(way[-1, 0] for way in sure) - 0.3
    for way in sure:
        assert among(unsure, way)


@settings(max_examples=30, deadline=None)
@given(speeds, angles, st.floats(-2.0, 2.0), st.floats(0.0, 0.6))
def test_the_expected_way_is_the_likeliest_and_turning_back_the_least_likely(
    speed: float, heading: float, turn_rate: float, sigma: float
) -> None:
    seen = mover([(0.6, 0.0)], (speed * cos(heading), speed * sin(heading)), turn_rate, sigma)
    found, likely = predicted(seen)
    assert likely.shape == (len(found),) and likely.sum() == pytest.approx(1.0)
    assert likely.argmax() == 0
    going_back = found[:, 0] @ seen.velocity < -0.5 * 0.1 * speed**2
    assert likely.argmin() in np.flatnonzero(going_back)


def test_a_mover_may_go_on_faster_or_slower_where_least_is_known_of_its_velocity() -> None:
    """A flat side seen alone: by one standard deviation to both sides, for 0.8 s, but by no more
    than 0.5 m/s; and not at all where the velocity is known to 0.12 m/s."""
    spots, velocity = [(0.6, 0.0), (0.6, 0.1)], (-0.2, 0.0)
    known = mover(spots, velocity)
    for sigma, speed in ((0.12, 0.0), (0.3, 0.3), (0.8, 0.5)):
        seen = mover(spots, velocity, unsure=(0.0, sigma))
        found, _ = predicted(seen)
        plain, _ = predicted(known)
        assert len(found) == len(plain) + (2 if speed > 0.0 else 0)
        assert np.array_equal(found[: len(plain)], plain)
        aside = np.where(TIMES <= 0.8 + 1e-9, speed * TIMES, 0.0)
        for way, side in zip(found[len(plain) :], (1.0, -1.0), strict=False):
            expected = plain[0] + side * np.stack((np.zeros_like(aside), aside), axis=1)
            np.testing.assert_allclose(way, expected, atol=1e-12)
