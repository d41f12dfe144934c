"""The filter of movers' velocities, on outlines made by hand."""

from math import cos, exp, hypot, pi, sin

import numpy as np
import pytest
from made_outlines import BELIEFS, CORNER, FACE, PERIOD, followed, look_at, outline

from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.sensing.outline import in_one
from fuzzynav_mj.sensing.perception import Perceiver
from fuzzynav_mj.sensing.tracking import Track
from fuzzynav_mj.sensing.velocity_filter import (
    ACCELERATION_SIGMA,
    ACCELERATION_TIME,
    carried_on,
)
from fuzzynav_mj.types import FloatArray, LaserScan, Pose2D


def test_a_prediction_drives_the_state_on() -> None:
    track = Track.begin(np.array([1.0, 2.0]))
    track.state = np.array([0.3, -0.1, 0.5, 0.2, 0.01, 0.02])
    fade = exp(-PERIOD / ACCELERATION_TIME)
    track.predict(PERIOD)
    velocity, acceleration = [0.3 + 0.05, -0.1 + 0.02], [0.5 * fade, 0.2 * fade]
    way = [0.01 + 0.03 + 0.0025, 0.02 - 0.01 + 0.001]
    np.testing.assert_allclose(track.state, [*velocity, *acceleration, *way], atol=1e-15)
    np.testing.assert_allclose(track.centre, [1.03, 1.99], atol=1e-15)
    assert track.missed == 1


def spread_of_futures(sigma: float, elapsed: float, steps: int = 2000) -> FloatArray:
    """(3, 3) covariance of way, velocity and acceleration of a mover that was known for certain, by
    adding up what white noise of the acceleration's rate, that keeps up accelerations of `sigma`
    (m/s2), leads to in each short step."""
    fade = exp(-elapsed / ACCELERATION_TIME)
    power = sigma**2 * (1.0 - fade**2) / elapsed
    step = elapsed / steps
    left = elapsed - step * (np.arange(steps) + 0.5)
    led_to = np.stack((left**2 / 2, left, np.ones(steps)))
    covariance: FloatArray = power * step * (led_to @ led_to.T)
    return covariance


@pytest.mark.parametrize("elapsed", [0.1, 0.3, 0.8])
@pytest.mark.parametrize(("speed", "sigma"), [(0.7, ACCELERATION_SIGMA), (0.2, 0.24), (0.0, 0.0)])
def test_a_prediction_doubts_what_changes_meanwhile(
    speed: float, sigma: float, elapsed: float
) -> None:
    """Slow movers change their velocity by turning at some 1.2 rad/s, no more than that."""
    state = np.array([0.6 * speed, 0.8 * speed, 0.0, 0.0, 0.0, 0.0])
    _, covariance = carried_on(state, np.zeros((6, 6)), elapsed)
    for axis in (0, 1):
        chosen = [axis + 4, axis, axis + 2]
        found = covariance[np.ix_(chosen, chosen)]
        np.testing.assert_allclose(found, spread_of_futures(sigma, elapsed), rtol=1e-5, atol=2e-10)
    assert not covariance[0::2, 1::2].any()


def test_what_is_believed_of_accelerations_stays_as_strong() -> None:
    state, covariance = np.array([0.7, 0.0, 0.0, 0.0, 0.0, 0.0]), np.zeros((6, 6))
    covariance[2, 2] = covariance[3, 3] = ACCELERATION_SIGMA**2
    for _ in range(5):
        state, covariance = carried_on(state, covariance, PERIOD)
    np.testing.assert_allclose(np.diag(covariance)[2:4], ACCELERATION_SIGMA**2, rtol=1e-12)


def on_a_circle(speed: float, rate: float, time: float) -> tuple[FloatArray, FloatArray]:
    """(2,) place and (2,) velocity on a circle."""
    angle, radius = rate * time, speed / rate
    place = radius * np.array([sin(angle), 1.0 - cos(angle)])
    return place, speed * np.array([cos(angle), sin(angle)])


def followed_round(
    first: tuple[tuple[float, float], ...],
    then: tuple[tuple[float, float], ...],
    rate: float,
    looks: int,
) -> tuple[Track, FloatArray]:
    """A track after eight looks at a mover that goes straight, and so many after it has begun to
    turn on a circle, which may show other faces; and the velocity that it has then."""
    speed, straight = 0.45, 8
    track, velocity = Track.begin(np.zeros(2)), np.array([speed, 0.0])
    for number in range(straight + looks):
        if number:
            track.predict(PERIOD)
        stamp = PERIOD * number
        since = stamp - PERIOD * (straight - 1)
        place, corners = np.array([speed * since, 0.0]), first
        if number >= straight:
            (place, velocity), corners = on_a_circle(speed, rate, since), then
        track.take_in(outline(corners, 0.5 + place, stamp), look_at(stamp), BELIEFS)
    return track, velocity


@pytest.mark.parametrize("rate", [-1.5, -0.8, 0.8, 1.5])
def test_a_turn_is_seen_within_four_looks(rate: float) -> None:
    track, velocity = followed_round(CORNER, CORNER, rate, looks=4)
    np.testing.assert_allclose(track.velocity, velocity, atol=0.01)
    assert track.turn_rate == pytest.approx(rate, rel=0.2)


@pytest.mark.parametrize(
    ("unsure", "believed"), [(0.0, 1.0), (0.75, 16 / 17), (1.5, 0.5), (3.0, 1 / 17)]
)
def test_a_turn_of_which_little_is_known_counts_less(unsure: float, believed: float) -> None:
    """Half of a turn is believed that is known to 1.5 rad/s, and the less the less is known."""
    track = Track.begin(np.zeros(2))
    speed, turn, bearing = 0.1, 0.8, 0.7
    along = np.array([cos(bearing), sin(bearing)])
    across = np.array([-sin(bearing), cos(bearing)])
    track.state[:4] = [*(speed * along), *(speed * turn * across)]
    track.covariance[2:4, 2:4] = (speed * unsure) ** 2 * np.outer(across, across)
    assert track.turn_rate == pytest.approx(believed * turn)


@pytest.mark.parametrize("rate", [-1.5, 1.5])
def test_what_is_seen_of_a_turn_across_one_face_tells_the_rest_of_it(rate: float) -> None:
    """Along itself a face does not show any motion, but the mover keeps its speed: less than 0.6 of
    what a straight mover would be off by there remains."""
    corner, face = ((0.0, 0.0), (0.12, 0.09), (0.03, 0.21)), ((0.0, 0.0), (0.12, 0.09))
    track, velocity = followed_round(corner, face, rate, looks=4)
    along = np.array([0.8, 0.6])
    unseen = abs((velocity - np.array([0.45, 0.0])) @ along)
    assert abs((track.velocity - velocity) @ along) < 0.6 * unseen
    assert track.turn_rate * rate > 0.75


@pytest.mark.parametrize("bearing", np.arange(0.0, 2 * pi, pi / 4))
def test_steady_motion_of_a_corner_is_learnt_to_the_full(bearing: float) -> None:
    velocity = 0.45 * np.array([cos(bearing), sin(bearing)])
    track = followed(CORNER, velocity, 12)
    np.testing.assert_allclose(track.velocity, velocity, atol=3e-3)
    assert abs(track.turn_rate) < 0.05


def test_of_one_face_only_the_motion_across_it_is_known() -> None:
    track = followed(FACE, np.array([0.2, 0.3]), 12)
    assert track.velocity[1] == pytest.approx(0.3, abs=2e-3)
    assert track.velocity[0] == pytest.approx(0.0, abs=1e-6)
    assert track.sigma_along(1.0, 0.0) > 5.0 * track.sigma_along(0.0, 1.0)


def test_the_ends_of_a_face_tell_the_motion_along_it() -> None:
    track = followed(FACE, np.array([0.2, 0.3]), 20, ends=True)
    np.testing.assert_allclose(track.velocity, [0.2, 0.3], atol=0.03)


def test_an_end_is_held_against_the_end_that_was_nearest_to_its_place() -> None:
    """A mover that something nearer parts in two shows four ends; each has its own of before."""
    both = ((0.0, 0.0), (0.06, 0.0)), ((0.09, 0.0), (0.15, 0.0))
    track = Track.begin(np.zeros(2))
    for number in range(20):
        if number:
            track.predict(PERIOD)
        stamp = PERIOD * number
        left, right = (outline(p, 0.5 + np.array([0.2, 0.3]) * stamp, stamp, True) for p in both)
        track.take_in(in_one(left, right), look_at(stamp), BELIEFS)
    np.testing.assert_allclose(track.velocity, [0.2, 0.3], atol=0.03)


def test_a_slow_stranger_is_found_out_within_a_few_looks() -> None:
    """At 0.1 m/s it parts by 10 mm a look, and a motion between the two misses both by 5 mm, which
    it may; over two looks it misses them by more than the 8 mm allowed."""
    velocity = np.array([0.3, 0.2])
    track = followed(CORNER, velocity, 8)
    found = []
    for number in range(8, 12):
        stamp = PERIOD * number
        track.predict(PERIOD)
        shown = outline(CORNER, 0.5 + velocity * stamp, stamp)
        shown.points[1, :4] -= 0.1 * PERIOD * (number - 7)
        found.append(track.take_in(shown, look_at(stamp), BELIEFS)[:4].any())
    assert not found[0] and any(found)


def test_a_turning_mover_is_followed_round_its_bend() -> None:
    rate, speed = 1.2, 0.4
    track = Track.begin(np.zeros(2))
    for number in range(20):
        if number:
            track.predict(PERIOD)
        stamp = PERIOD * number
        angle = rate * stamp
        place = 0.5 + speed / rate * np.array([sin(angle), 1.0 - cos(angle)])
        track.take_in(outline(CORNER, place, stamp), look_at(stamp), BELIEFS)
    heading = rate * PERIOD * 19
    ahead = speed * np.array([cos(heading), sin(heading)])
    assert hypot(*(track.velocity - ahead)) < 0.02
    assert track.turn_rate == pytest.approx(rate, rel=0.2)  # it is believed to fade


def test_hits_of_another_mover_are_told_apart_and_not_learnt_from() -> None:
    velocity = np.array([0.3, 0.2])
    track = followed(CORNER, velocity, 8)
    track.predict(PERIOD)
    shown = outline(CORNER, 0.5 + velocity * 0.8, 0.8)
    shown.points[1, :5] -= 0.04  # these have stayed behind
    others = track.take_in(shown, look_at(0.8), BELIEFS)
    assert others[:4].all() and not others[6:].any()
    np.testing.assert_allclose(track.velocity, velocity, atol=0.02)
    assert track.outlines[-1].points.shape[1] == (~others).sum()


def test_nothing_is_learnt_from_an_outline_that_the_motion_does_not_explain() -> None:
    velocity = np.array([0.3, 0.2])
    track = followed(CORNER, velocity, 8)
    track.predict(PERIOD)
    state, outlines = track.state.copy(), list(track.outlines)
    jumped = outline(CORNER, 0.62 + velocity * 0.8, 0.8)
    assert track.take_in(jumped, look_at(0.8), BELIEFS).all()
    np.testing.assert_array_equal(track.state, state)
    assert track.missed == 1 and list(track.outlines) == outlines


def test_the_fullest_outline_is_carried_on_while_part_of_it_is_hidden() -> None:
    velocity = np.array([0.3, 0.2])
    track = followed(CORNER, velocity, 8)
    whole = track.expected_outline
    for number in (8, 9, 10):
        track.predict(PERIOD)
        stamp = PERIOD * number
        track.take_in(outline(CORNER[:2], 0.5 + velocity * stamp, stamp), look_at(stamp), BELIEFS)
    assert track.partly_hidden
    np.testing.assert_allclose(track.expected_outline - whole, 0.3 * velocity[:, None] + 0 * whole,
                               atol=3e-3)  # fmt: skip


def test_a_mover_that_comes_out_again_with_another_side_keeps_its_motion() -> None:
    """For two looks only the start of one face is in sight, then only the other face: nothing that
    the last looks have shown. It is where the fullest outline should be."""
    velocity = np.array([-0.2, 0.3])
    track = followed(CORNER, velocity, 6)
    start, side = (CORNER[0], (0.04, 0.0)), CORNER[1:]
    for number, faces in ((6, start), (7, start), (8, side), (9, side)):
        before = track.velocity
        track.predict(PERIOD)
        stamp = PERIOD * number
        shown = outline(faces, 0.5 + velocity * stamp, stamp)
        assert not track.take_in(shown, look_at(stamp), BELIEFS).any()
        np.testing.assert_allclose(track.velocity, before, atol=0.01)
    assert track.seen == 10


def test_another_mover_that_comes_out_where_one_is_expected_is_not_taken_for_it() -> None:
    """Its side lies 3 cm off where the other face should be."""
    velocity = np.array([-0.2, 0.3])
    track = followed(CORNER, velocity, 6)
    start, side = (CORNER[0], (0.04, 0.0)), CORNER[1:]
    for number in (6, 7):
        track.predict(PERIOD)
        stamp = PERIOD * number
        track.take_in(outline(start, 0.5 + velocity * stamp, stamp), look_at(stamp), BELIEFS)
    track.predict(PERIOD)
    shown = outline(side, 0.5 + velocity * 0.8 + np.array([0.03, 0.0]), 0.8)
    assert track.take_in(shown, look_at(0.8), BELIEFS).all()


def test_looks_at_the_same_time_give_no_speed_and_no_error() -> None:
    ranges = np.full(180, 0.8)
    ranges[80:90] = 0.5
    perceiver, here = Perceiver(DEFAULT_ROBOT), Pose2D(0.0, 0.0, 0.0)
    for shift in (0.0, 0.02, 0.04, 0.08):
        nearer = np.where(ranges < 0.8, ranges - shift, ranges)
        scan = LaserScan(1.0, ray_bearings(180), nearer, ranges < 0.8, 0.8)
        seen = perceiver.perceive(scan, here)
    assert min(obstacle.distance for obstacle in seen.obstacles) == pytest.approx(0.42)
    assert all(np.isfinite(obstacle.velocity).all() for obstacle in seen.obstacles)


def test_uncertainty_along_a_direction_is_that_of_the_covariance() -> None:
    track = followed(FACE, np.array([0.2, 0.3]), 5)
    direction = np.array([3.0, -4.0]) / hypot(3.0, 4.0)
    expected = float(np.sqrt(direction @ track.covariance[:2, :2] @ direction))
    assert track.sigma_along(*direction.tolist()) == pytest.approx(expected, rel=1e-12)


def test_of_a_flat_side_least_is_known_along_it() -> None:
    """FACE lies along the x axis; of CORNER both directions are measured."""
    flat = followed(FACE, np.array([0.2, 0.3]), 6).least_known
    assert abs(flat[1]) < 0.01 * abs(flat[0]) and np.hypot(*flat) > 0.25
    assert np.hypot(*followed(CORNER, np.array([0.2, 0.3]), 6).least_known) < 0.05


def test_least_known_is_the_longest_axis_of_the_uncertainty() -> None:
    track = Track.begin(np.zeros(2))
    turn = np.array([[cos(0.7), -sin(0.7)], [sin(0.7), cos(0.7)]])
    track.covariance[:2, :2] = turn @ np.diag([0.01, 0.09]) @ turn.T
    x, y = track.least_known
    assert hypot(x, y) == pytest.approx(0.3)
    assert abs(x * cos(0.7) + y * sin(0.7)) < 1e-12  # across the shorter axis
