"""Two moves out of a pinch against what one of them can do."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from point_scene import SETTINGS, scene_of

from fuzzynav_mj.planners.evasion import BEYOND, FIRST_MOVES, ROUNDING, TRIED, lasting
from fuzzynav_mj.planners.grid import CELL
from fuzzynav_mj.planners.headings import HORIZON
from fuzzynav_mj.planners.motions import candidate_motions, moves_after
from fuzzynav_mj.planners.outlook import Outlook, look_ahead
from fuzzynav_mj.planners.passing import (
    JUDGED,
    NO_WAY,
    OUTLOOK,
    Passing,
    judged_places,
    leads_on,
)
from fuzzynav_mj.planners.scene import Scene
from fuzzynav_mj.robot import DEFAULT_ROBOT as SPEC
from fuzzynav_mj.types import FloatArray, Twist2D


def pinch(expected: FloatArray, standing: FloatArray) -> tuple[Outlook, Scene]:
    """Prospects of a robot that stands still, among points (k, 2) that stand, and points
    (OUTLOOK, k, 2) of movers."""
    scene = scene_of(standing, expected, expected[:HORIZON])
    motions = candidate_motions(0.0, Twist2D(0.0, 0.0), SPEC)
    return look_ahead(motions, scene, SPEC, SETTINGS), scene


NO_BONUS = np.zeros(len(candidate_motions(0.0, Twist2D(0.0, 0.0), SPEC).speed))
NOWHERE = Passing(np.full((33, 33), NO_WAY), 16, np.array([1.0, 0.0]))  # no way leads on


def crossed_by_movers(seed: int) -> tuple[Outlook, Scene]:
    """A pinch among movers on straight lines past points that stand."""
    rng = np.random.default_rng(seed)
    bearings = rng.uniform(-pi, pi, 30)
    places = np.stack((np.cos(bearings), np.sin(bearings)), axis=1)
    starts, velocity = 0.5 * places[:10], rng.uniform(-0.4, 0.4, (10, 2))
    times = 0.1 * (np.arange(OUTLOOK) + 1.0)
    expected = starts + times[:, None, None] * velocity
    return pinch(expected, rng.uniform(0.3, 0.8, (20, 1)) * places[10:])


def all_worked_out(
    found: Outlook, scene: Scene, passing: Passing, bonus: FloatArray, yaw: float
) -> FloatArray:
    """(m,) of `lasting`, with every second move of those first ones that are tried."""

    def periods(poses: FloatArray, alive: FloatArray) -> FloatArray:
        x, y = judged_places(poses, yaw)
        onward = [leads_on(passing, *place) for place in zip(x, y, strict=True)]
        return np.asarray(alive.sum(axis=1) + BEYOND * alive[:, -1] * onward)

    lasts = np.where(found.static_ok, periods(found.poses[:, JUDGED - 1], found.alive), -1.0)
    tried = np.argsort(-lasts, kind="stable")[:TRIED]
    tried = tried[lasts[tried] >= 0.0]
    for length in FIRST_MOVES:
        moves = moves_after(np.ascontiguousarray(found.poses[tried, :length]), SPEC)
        second = look_ahead(moves, scene.later(length), SPEC, SETTINGS)
        each = len(moves.speed) // len(tried)
        before = np.repeat(found.alive[tried, :length], each, axis=0)
        alive = np.concatenate((before, before[:, -1:] * second.alive), axis=1)
        then = periods(second.poses[:, JUDGED - length - 1], alive)
        best = np.where(second.static_ok, then, -1.0).reshape(len(tried), each).max(axis=1)
        lasts[tried] = np.maximum(lasts[tried], best)
    return np.asarray(lasts + bonus)


def alone(found: Outlook) -> FloatArray:
    """(m,) periods that can be expected of each candidate that nothing follows."""
    in_order = np.cumsum(found.alive, axis=1)[:, -1]  # as compiled code adds up
    return np.where(found.static_ok, in_order, -1.0)


@pytest.mark.parametrize(
    ("closes", "filled", "alone_at_most", "at_least"),
    [(3, 6, 6.5, 8.4), (8, 13, 13.0, 15.5), (10, 14, 14.0, 15.1)],
    ids=["a short first move", "one of middle length", "a long one"],
)
def test_first_along_a_closing_lane_and_then_aside(
    closes: int, filled: int, alone_at_most: float, at_least: float
) -> None:
    """Movers leave a lane for some periods, and later fill all but what lies to the left of it: no
    single direction is sure to last, but along the lane and then aside is."""
    x = np.arange(-1.0, 1.0, 0.04)
    lane = np.concatenate([np.stack((x, np.full(len(x), side)), axis=1) for side in (0.28, -0.28)])
    block = np.concatenate(
        [np.stack((x, np.full(len(x), y)), axis=1) for y in np.arange(-0.3, 0.1, 0.04)]
    )
    away = 9.0
    expected = np.full((OUTLOOK, len(lane) + len(block), 2), away)
    expected[:closes, : len(lane)] = lane
    expected[filled:, len(lane) :] = block
    found, scene = pinch(expected, np.empty((0, 2)))
    assert found.alive[:, -1].max() < 0.5
    lasts = lasting(found, scene, NOWHERE, NO_BONUS, 0.0, SPEC, SETTINGS)
    assert alone(found).max() <= alone_at_most + 0.01 and lasts.max() > at_least


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_second_move_never_makes_a_first_one_worse(seed: int) -> None:
    found, scene = crossed_by_movers(seed)
    lasts = lasting(found, scene, NOWHERE, NO_BONUS, 0.0, SPEC, SETTINGS)
    assert (lasts >= alone(found)).all() and (lasts <= HORIZON).all()
    assert (lasts[~found.static_ok] == -1.0).all()


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_what_is_left_out_is_not_the_best(seed: int) -> None:
    found, scene = crossed_by_movers(seed)
    rng = np.random.default_rng(seed)
    value = np.where(rng.random((33, 33)) < 0.5, 0.0, NO_WAY)
    passing, bonus = (
        Passing(value, 16, np.array([1.0, 0.0])),
        0.3 * (rng.random(len(NO_BONUS)) < 0.1),
    )
    lasts = lasting(found, scene, passing, bonus, 1.0, SPEC, SETTINGS)
    complete = all_worked_out(found, scene, passing, bonus, 1.0)
    assert (lasts <= complete + ROUNDING).all()
    best = np.flatnonzero(complete > complete.max() - ROUNDING)
    np.testing.assert_allclose(lasts[best], complete[best], rtol=0.0, atol=ROUNDING)


def test_of_two_places_that_last_as_long_the_one_with_a_way_on_is_better() -> None:
    """Ahead all is free; behind, movers are all around from the end of the roll-outs on."""
    expected = np.full((OUTLOOK, 1, 2), 9.0)
    found, scene = pinch(expected, np.empty((0, 2)))
    value = np.zeros((33, 33))
    value[:16] = NO_WAY  # behind the robot
    passing = Passing(value, 16, np.array([1.0, 0.0]))
    lasts = lasting(found, scene, passing, NO_BONUS, 0.0, SPEC, SETTINGS)
    ahead = found.poses[:, JUDGED - 1, 0] > CELL
    behind = found.poses[:, JUDGED - 1, 0] < -CELL
    # The second move may lead back from behind: a first one alone cannot tell.
    assert ahead.any() and behind.any()
    assert (lasts[ahead] == OUTLOOK).all() and lasts[behind].min() == HORIZON
