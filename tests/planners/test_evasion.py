"""Two moves out of a pinch against what one of them can do."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from point_scene import SETTINGS, scene_of

from fuzzynav_mj.planners.evasion import lasting
from fuzzynav_mj.planners.grid import CELL
from fuzzynav_mj.planners.headings import HORIZON
from fuzzynav_mj.planners.motions import candidate_motions
from fuzzynav_mj.planners.outlook import Outlook, look_ahead
from fuzzynav_mj.planners.passing import JUDGED, NO_WAY, OUTLOOK, Passing
from fuzzynav_mj.planners.scene import Scene
from fuzzynav_mj.robot import DEFAULT_ROBOT as SPEC
from fuzzynav_mj.types import FloatArray, Twist2D


def pinch(expected: FloatArray, standing: FloatArray) -> tuple[Outlook, Scene]:
    """Prospects of a robot that stands still, among points (k, 2) that stand, and points
    (OUTLOOK, k, 2) of movers."""
    scene = scene_of(standing, expected, expected[:HORIZON])
    motions = candidate_motions(0.0, Twist2D(0.0, 0.0), SPEC)
    return look_ahead(motions, scene, SPEC, SETTINGS), scene


def alone(found: Outlook) -> FloatArray:
    """(m,) periods that can be expected of each candidate that nothing follows."""
    return np.where(found.static_ok, found.alive.sum(axis=1), -1.0)


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
    lasts = lasting(found, scene, None, 0.0, SPEC, SETTINGS)
    assert alone(found).max() <= alone_at_most + 0.01 and lasts.max() > at_least


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_second_move_never_makes_a_first_one_worse(seed: int) -> None:
    """Among movers on straight lines past points that stand."""
    rng = np.random.default_rng(seed)
    bearings = rng.uniform(-pi, pi, 30)
    places = np.stack((np.cos(bearings), np.sin(bearings)), axis=1)
    starts, velocity = 0.5 * places[:10], rng.uniform(-0.4, 0.4, (10, 2))
    times = 0.1 * (np.arange(OUTLOOK) + 1.0)
    expected = starts + times[:, None, None] * velocity
    found, scene = pinch(expected, rng.uniform(0.3, 0.8, (20, 1)) * places[10:])
    lasts = lasting(found, scene, None, 0.0, SPEC, SETTINGS)
    assert (lasts >= alone(found)).all() and (lasts <= HORIZON).all()
    assert (lasts[~found.static_ok] == -1.0).all()


def test_of_two_places_that_last_as_long_the_one_with_a_way_on_is_better() -> None:
    """Ahead all is free; behind, movers are all around from the end of the roll-outs on."""
    expected = np.full((OUTLOOK, 1, 2), 9.0)
    found, scene = pinch(expected, np.empty((0, 2)))
    value = np.zeros((33, 33))
    value[:16] = NO_WAY  # behind the robot
    passing = Passing(value, 16, np.array([1.0, 0.0]))
    lasts = lasting(found, scene, passing, 0.0, SPEC, SETTINGS)
    ahead = found.poses[:, JUDGED - 1, 0] > CELL
    behind = found.poses[:, JUDGED - 1, 0] < -CELL
    # The second move may lead back from behind: a first one alone cannot tell.
    assert ahead.any() and behind.any()
    assert (lasts[ahead] == OUTLOOK).all() and lasts[behind].min() == HORIZON
