"""Motions by hand, and the laws that all of them keep."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fuzzynav_mj.scenarios.motion import (
    ClosedCurveMotion,
    Interpolation,
    Repeat,
    keyframe_motion,
    waypoint_motion,
)
from fuzzynav_mj.types import FloatArray

CORNER = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]])  # legs of 3 m and 4 m


def at(motion: object, *times: float) -> FloatArray:
    return motion.positions(np.array(times))  # type: ignore[attr-defined,no-any-return]


def test_waypoints_reverse_by_hand() -> None:
    motion = waypoint_motion(CORNER, speed=0.5)  # 14 s there, 14 s back
    expected = [[0, 0], [3, 0], [3, 2], [3, 4], [3, 3.5], [0, 0], [0.5, 0]]
    np.testing.assert_allclose(at(motion, 0, 6, 10, 14, 15, 28, 29), expected)


def test_waypoints_loop_by_hand() -> None:
    motion = waypoint_motion(CORNER, speed=1.0, repeat="loop")  # 3 + 4 + 5 m
    expected = [[3, 4], [1.5, 2], [0, 0], [1, 0]]
    np.testing.assert_allclose(at(motion, 7, 9.5, 12, 13), expected, atol=1e-12)


def test_waypoints_once_by_hand() -> None:
    motion = waypoint_motion(CORNER, speed=1.0, repeat="once", phase=-2.0)
    np.testing.assert_allclose(
        at(motion, 0, 2, 3, 9, 100), [[0, 0], [0, 0], [1, 0], [3, 4], [3, 4]]
    )


def test_phase_is_time_into_the_motion() -> None:
    times = np.linspace(0.0, 40.0, 81)
    for repeat in ("reverse", "loop", "once"):
        early = waypoint_motion(CORNER, 0.4, repeat)
        late = waypoint_motion(CORNER, 0.4, repeat, phase=3.0)
        np.testing.assert_allclose(late.positions(times), early.positions(times + 3.0), atol=1e-12)


def test_waypoints_without_speed_stand() -> None:
    np.testing.assert_array_equal(at(waypoint_motion(CORNER, 0.0), 0, 5), [[0, 0], [0, 0]])


def test_keyframes_by_hand() -> None:
    frames = [[1.0, 0.0, 0.0], [3.0, 4.0, 0.0], [4.0, 4.0, 2.0]]
    once = keyframe_motion(frames, "linear", "once")
    expected = [[0, 0], [0, 0], [2, 0], [4, 0], [4, 1], [4, 2]]
    np.testing.assert_allclose(at(once, 0, 1, 2, 3, 3.5, 9), expected)
    back = keyframe_motion(frames, "linear", "reverse")
    np.testing.assert_allclose(at(back, 4, 4.5, 5, 7), [[4, 2], [4, 1], [4, 0], [0, 0]])


def test_keyframe_loop_returns_at_the_mean_speed_instead_of_jumping() -> None:
    motion = keyframe_motion([[0.0, 0.0, 0.0], [2.0, 4.0, 0.0], [7.0, 4.0, 3.0]], repeat="loop")
    # 7 m in 7 s, so the 5 m back to the first place take 5 s
    np.testing.assert_allclose(at(motion, 7, 9.5, 12, 14), [[4, 3], [2, 1.5], [0, 0], [4, 0]])


def test_keyframe_loop_that_closes_by_itself_adds_no_time() -> None:
    motion = keyframe_motion([[0, 0, 0], [2, 4, 0], [4, 4, 3], [6, 0, 0]], repeat="loop")
    np.testing.assert_allclose(at(motion, 8), [[4, 0]])


def test_catmull_rom_by_hand() -> None:
    """The tangent at the middle knot is the chord between its neighbours over their time."""
    frames = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 0.0]]
    motion = keyframe_motion(frames, "catmull-rom", "once")
    # Hermite at half of the first second: (p0 + p1) / 2 + (m0 - m1) / 8, m0 = (1, 1), m1 = (1, 0)
    np.testing.assert_allclose(at(motion, 0.5), [[0.5, 0.5 + 1 / 8]])
    step = 1e-5
    speed = (at(motion, 1 + step) - at(motion, 1 - step)) / (2 * step)
    np.testing.assert_allclose(speed, [[1.0, 0.0]], atol=1e-4)


def test_catmull_rom_loop_is_smooth_where_it_closes() -> None:
    frames = [[0.0, 0.0, 0.0], [2.0, 2.0, 0.0], [4.0, 1.0, 2.0], [6.0, 0.0, 0.0]]
    motion = keyframe_motion(frames, "catmull-rom", "loop")
    step = 1e-6
    before, middle, after = at(motion, 6 - step, 6, 6 + step)
    np.testing.assert_allclose((middle - before) / step, (after - middle) / step, atol=1e-4)


frames_lists = st.lists(
    st.tuples(st.floats(0.5, 5.0), st.floats(-5, 5), st.floats(-5, 5)), min_size=2, max_size=6
)


@settings(max_examples=60, deadline=None)
@example([(1.0, 1e-229, 0.0), (1.0, 0.0, 1.0), (1.0, 0.0, 0.0)], "catmull-rom", "loop", 0.0)
@example([(1.0, 1e-18, 0.0), (1.0, 0.0, 1.0), (1.0, 0.0, 0.0)], "linear", "loop", 0.0)
@given(
    frames_lists,
    st.sampled_from(["linear", "catmull-rom"]),
    st.sampled_from(["reverse", "loop", "once"]),
    st.floats(-20, 20),
)
def test_keyframes_are_met_and_time_may_come_in_any_order(
    rows: list[tuple[float, float, float]], kind: Interpolation, repeat: Repeat, phase: float
) -> None:
    frames = np.array(rows)
    frames[:, 0] = np.cumsum(frames[:, 0])
    motion = keyframe_motion(frames, kind, repeat, phase)
    times = frames[:-1, 0] - phase
    np.testing.assert_allclose(motion.positions(times), frames[:-1, 1:], atol=1e-9)
    np.testing.assert_array_equal(motion.positions(times[::-1]), motion.positions(times)[::-1])
    assert motion.positions(np.empty(0)).shape == (0, 2)


@settings(max_examples=60)
@given(
    st.lists(st.tuples(st.floats(-5, 5), st.floats(-5, 5)), min_size=2, max_size=6, unique=True),
    st.floats(0.05, 1.0),
    st.sampled_from(["reverse", "loop", "once"]),
)
def test_no_step_along_waypoints_is_faster_than_the_speed(
    points: list[tuple[float, float]], speed: float, repeat: Repeat
) -> None:
    motion = waypoint_motion(np.array(points), speed, repeat)
    steps = np.diff(motion.positions(np.arange(0.0, 60.0, 0.05)), axis=0)
    assert np.hypot(*steps.T).max() <= 0.05 * speed * (1 + 1e-6) + 1e-12


@pytest.mark.parametrize("speed", [0.4, -0.4])
def test_closed_curve_around_a_circle(speed: float) -> None:
    angles = 2 * np.pi * np.arange(256) / 256
    circle = 2.0 * np.column_stack([np.cos(angles), np.sin(angles)])
    motion = ClosedCurveMotion(circle, 4 * np.pi, speed, offset=np.pi)  # a quarter turn
    times = np.linspace(0.0, 100.0, 500)
    turned = np.pi / 2 + speed * times / 2.0
    expected = 2.0 * np.column_stack([np.cos(turned), np.sin(turned)])
    np.testing.assert_allclose(motion.positions(times), expected, atol=1e-6)
