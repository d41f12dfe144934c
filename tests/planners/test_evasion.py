"""Two moves out of a pinch against what one of them can do."""

from math import pi

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from point_scene import SETTINGS, scene_of

from fuzzynav_mj.planners.evasion import lasting, room_left
from fuzzynav_mj.planners.motions import HORIZON, candidate_motions
from fuzzynav_mj.planners.outlook import Outlook, look_ahead
from fuzzynav_mj.planners.passing import OUTLOOK
from fuzzynav_mj.planners.scene import Scene
from fuzzynav_mj.robot import DEFAULT_ROBOT as SPEC
from fuzzynav_mj.types import FloatArray, Twist2D


def pinch(expected: FloatArray, standing: FloatArray) -> tuple[Outlook, Scene]:
    """Prospects of a robot that stands still, among points (k, 2) that stand, and points
    (OUTLOOK, k, 2) of movers."""
    scene = scene_of(standing, expected, expected[:HORIZON])
    motions = candidate_motions(0.0, Twist2D(0.0, 0.0), SPEC)
    return look_ahead(motions, scene, SPEC, SETTINGS), scene


def test_first_along_a_closing_lane_and_then_aside() -> None:
    """Movers leave a lane until 1.0 s, and from 1.5 s on fill all but what lies to the left of it:
    no single direction lasts, but along the lane and then aside does."""
    x = np.arange(-1.0, 1.0, 0.04)
    lane = np.concatenate([np.stack((x, np.full(len(x), side)), axis=1) for side in (0.25, -0.25)])
    filled = np.concatenate(
        [np.stack((x, np.full(len(x), y)), axis=1) for y in np.arange(-0.3, 0.1, 0.04)]
    )
    away = 9.0
    expected = np.full((OUTLOOK, len(lane) + len(filled), 2), away)
    expected[:10, : len(lane)] = lane
    expected[14:, len(lane) :] = filled
    found, scene = pinch(expected, np.empty((0, 2)))
    assert found.contact_step.max() < HORIZON
    clear, room = lasting(found, scene, SPEC, SETTINGS)
    assert clear.max() == HORIZON
    assert room[clear.argmax()] > 0.03


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
    clear, room = lasting(found, scene, SPEC, SETTINGS)
    alone = room_left(found)
    assert (clear >= found.contact_step).all() and (clear <= HORIZON).all()
    same = clear == found.contact_step
    assert (room[same] >= alone[same]).all()
