"""Movers that turn at once: what is known of them a look or two later."""

from math import cos, pi, sin

import numpy as np
import pytest
from made_scans import HERE, PERIOD, scan_of, square

from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.sensing.corners import changed_at_once, explains_most, turned_at_once
from fuzzynav_mj.sensing.free_space import FreeSpace
from fuzzynav_mj.sensing.looks import take_look
from fuzzynav_mj.sensing.outline import Outline, outline_around
from fuzzynav_mj.sensing.perception import Perceiver
from fuzzynav_mj.sensing.velocity_filter import Beliefs
from fuzzynav_mj.types import FloatArray, PerceivedObstacle

BELIEFS = Beliefs(
    flow_sigma=0.0003, noise=0.0, independent_hits=6.0, outlier=0.06, outline_sigma=0.03
)
SPEED = 0.4  # m/s
CORNER = np.array([0.45, 0.1])  # where the mover turns
STRAIGHT = 0.72  # s, until it does: between two looks


def place(time: float, before: FloatArray, after: FloatArray) -> FloatArray:
    off = time - STRAIGHT
    return CORNER + off * (before if off < 0.0 else after)


def seen_after(
    turn: float, heading: float, looks: int
) -> tuple[list[PerceivedObstacle], FloatArray]:
    """What moves, so many looks after a mover of this heading has turned by an angle, and how."""
    before = SPEED * np.array([cos(heading), sin(heading)])
    after = SPEED * np.array([cos(heading + turn), sin(heading + turn)])
    perceiver, number = Perceiver(DEFAULT_ROBOT), 0
    while True:
        time = PERIOD * number
        x, y = place(time, before, after).tolist()
        seen = perceiver.perceive(scan_of([square(x, y, 0.08)], time), HERE)
        if time >= STRAIGHT + PERIOD * (looks - 1):
            return [obstacle for obstacle in seen.obstacles if obstacle.dynamic], after
        number += 1


@pytest.mark.parametrize("turn", [pi / 2, -pi / 2, 0.75 * pi, pi])
@pytest.mark.parametrize("heading", [0.5 * pi + 0.2, -0.5 * pi - 0.3])
def test_two_looks_after_a_corner_a_mover_is_known_again(turn: float, heading: float) -> None:
    """As one mover, which goes straight on."""
    movers, after = seen_after(turn, heading, 2)
    assert len(movers) == 1
    assert np.hypot(*(movers[0].velocity - after)) < 0.05
    assert abs(movers[0].turn_rate) < 0.6


def test_a_corner_is_a_change_that_no_bend_explains() -> None:
    """In 0.1 s a bend changes a velocity by 0.12 m/s at most."""
    expected, known = (
        np.array([0.4, 0.0] + [0.0] * 4),
        np.diag([0.02, 0.02, 0.6, 0.6, 0.0, 0.0]) ** 2,
    )
    bend = np.array([0.4, 0.119] + [0.0] * 4)
    corner = np.array([0.4, 0.121] + [0.0] * 4)
    assert not changed_at_once(bend, expected, known, PERIOD)
    assert changed_at_once(corner, expected, known, PERIOD)


def test_where_a_velocity_was_not_known_no_change_is_a_corner() -> None:
    """Up to three standard deviations."""
    expected = np.array([0.4, 0.0] + [0.0] * 4)
    corner = np.array([0.4, 0.3] + [0.0] * 4)
    for sigma, turned in ((0.099, True), (0.101, False)):
        known = np.diag([sigma, sigma, 0.6, 0.6, 0.0, 0.0]) ** 2
        assert changed_at_once(corner, expected, known, PERIOD) is turned


def test_half_of_the_hits_and_two_at_least_must_be_explained() -> None:
    assert explains_most(np.array([False, False, True, True]))
    assert not explains_most(np.array([False, False, True, True, True]))
    assert not explains_most(np.array([False]))


def outline_at(x: float, y: float, stamp: float) -> tuple[Outline, FreeSpace]:
    look = take_look(scan_of([square(x, y, 0.08)], stamp), HERE)
    nobody = np.zeros(len(look.ranges), dtype=bool)
    return outline_around(look, nobody, x, y, 0.5), FreeSpace(look)


def test_after_a_corner_the_mean_since_the_look_before_is_known() -> None:
    """The velocity is beyond it, as seen from the one before, by half of the change or so."""
    last, before = outline_at(0.4, 0.25, 0.0)
    outline, now = outline_at(0.38, 0.27, PERIOD)
    space = FreeSpace(now.now, [before.now])
    turned = turned_at_once(outline, last, np.array([0.3, 0.0]), 0.02, space, BELIEFS)
    assert turned is not None and not turned.others.any()
    np.testing.assert_allclose(turned.state, [-0.2, 0.2, 0.0, 0.0, 0.0, 0.0], atol=0.01)
    way = turned.state[:2] - np.array([0.3, 0.0])
    along = way / np.hypot(*way)
    sigma = np.sqrt(along @ turned.covariance[:2, :2] @ along)
    assert sigma == pytest.approx(np.hypot(*way) / 2, rel=0.1)


@pytest.mark.parametrize(("speed", "sigma"), [(0.05, 0.02), (0.3, 0.02), (0.05, 0.3)])
def test_who_turns_goes_no_faster_than_before(speed: float, sigma: float) -> None:
    """In 0.1 s the outline has moved by 28 mm: too far for one that went at 0.05 m/s, unless that
    was hardly known."""
    last, before = outline_at(0.4, 0.25, 0.0)
    outline, now = outline_at(0.38, 0.27, PERIOD)
    space = FreeSpace(now.now, [before.now])
    turned = turned_at_once(outline, last, np.array([speed, 0.0]), sigma, space, BELIEFS)
    assert (turned is None) is (speed + 3.0 * sigma < 0.28)


def test_a_flat_side_went_no_farther_along_itself_than_its_speed_allows() -> None:
    """Across itself it went at 0.1 m/s, so along itself at no more than 0.28, of 0.3 in all."""
    last, before = outline_at(0.45, 0.0, 0.0)
    outline, now = outline_at(0.44, 0.0, PERIOD)
    space = FreeSpace(now.now, [before.now])
    along = {}
    for speed in (0.11, 0.3):
        velocity = np.array([0.0, speed])
        turned = turned_at_once(outline, last, velocity, 0.02, space, BELIEFS)
        assert turned is not None
        change = turned.state[:2] - velocity
        spread = turned.covariance[:2, :2] - np.outer(change, change) / 4
        along[speed] = abs(turned.state[1]) + 2.0 * np.sqrt(spread[1, 1])
    assert along[0.11] < along[0.3] < 0.28


def test_a_flat_side_that_turns_back_along_itself_contradicts_what_is_free() -> None:
    """Its ends are 6 cm from where they should be, and rays went by there; 1 cm may be a bend."""
    last, before = outline_at(0.45, 0.0, 0.0)
    outline, now = outline_at(0.45, -0.03, PERIOD)
    space = FreeSpace(now.now, [before.now])
    assert space.contradicts(np.array([0.0, 0.3, 0.0, 0.0]), outline, last)
    assert not space.contradicts(np.array([0.0, -0.3, 0.0, 0.0]), outline, last)
    assert not space.contradicts(np.array([0.0, -0.2, 0.0, 0.0]), outline, last)


def test_a_mover_that_was_out_of_sight_has_not_turned() -> None:
    """Where it has been in between is not known."""
    last, before = outline_at(0.45, 0.0, 0.0)
    nothing = take_look(scan_of([], PERIOD), HERE)
    outline, now = outline_at(0.43, 0.02, 2 * PERIOD)
    space = FreeSpace(now.now, [before.now, nothing])
    assert turned_at_once(outline, last, np.array([0.3, 0.0]), 0.02, space, BELIEFS) is None


def test_what_looks_otherwise_is_another_mover() -> None:
    """Of which the outline of before explains nothing."""
    last, before = outline_at(0.45, 0.0, 0.0)
    round_ = 2 * pi * np.arange(24) / 24
    disc = 0.05 * np.stack((np.cos(round_), np.sin(round_)), axis=1) + np.array([0.3, 0.2])
    look = take_look(scan_of([disc], PERIOD), HERE)
    outline = outline_around(look, np.zeros(len(look.ranges), dtype=bool), 0.3, 0.2, 0.5)
    space = FreeSpace(look, [before.now])
    assert turned_at_once(outline, last, np.array([0.3, 0.0]), 0.02, space, BELIEFS) is None
