"""Roll-outs: within the limits, and where the controller would really take the robot."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav_mj.planners.peers.rollout import (
    roll_out,
    to_robot_frame,
    to_world_frame,
    within_limits,
)
from fuzzynav_mj.planners.steering import position_after
from fuzzynav_mj.robot import DEFAULT_ROBOT as SPEC
from fuzzynav_mj.types import Pose2D, Twist2D

TOP = np.array([[SPEC.max_speed], [SPEC.max_yaw_rate]])
REACH = SPEC.decision_period * np.array([[SPEC.max_acceleration], [SPEC.max_yaw_acceleration]])

SEEDS = st.integers(0, 2**32 - 1)
TWISTS = st.builds(
    Twist2D,
    st.floats(-SPEC.max_speed, SPEC.max_speed),
    st.floats(-SPEC.max_yaw_rate, SPEC.max_yaw_rate),
)


@given(SEEDS, TWISTS)
def test_speeds_keep_the_limits_and_change_no_faster_than_allowed(seed: int, now: Twist2D) -> None:
    aims = np.random.default_rng(seed).normal(size=(7, 2, 5)) * 2 * TOP
    speeds = within_limits(aims, now, SPEC)
    start = np.full((1, 2, 5), [[[now.v], [now.omega]]])
    assert (np.abs(speeds) <= TOP).all()
    assert (np.abs(np.diff(speeds, axis=0, prepend=start)) <= REACH + 1e-12).all()


@given(SEEDS, TWISTS)
def test_speeds_within_the_limits_stay_as_they_are(seed: int, now: Twist2D) -> None:
    rng = np.random.default_rng(seed)
    once = within_limits(rng.normal(size=(7, 2, 5)) * TOP, now, SPEC)
    assert np.array_equal(within_limits(once, now, SPEC), once)


@given(SEEDS, TWISTS)
def test_first_period_is_the_one_that_the_controller_drives(seed: int, now: Twist2D) -> None:
    """Up to a millimetre: the controller counts in physics steps."""
    aims = np.random.default_rng(seed).normal(size=(1, 2, 1)) * TOP
    speeds = within_limits(aims, now, SPEC)
    v, omega = speeds[0, :, 0].tolist()
    pose = Pose2D(3.0, -1.0, 0.7)
    driven = position_after(v, omega, pose, now, SPEC)
    rolled = to_world_frame(roll_out(speeds, now, SPEC)[0, :, :2].astype(float), pose)[0]
    assert rolled == pytest.approx(driven, abs=1.5e-3)


def test_turn_on_the_spot_keeps_the_axle_in_its_place() -> None:
    """A full period at 3 rad/s each: the centre goes round the axle, 5 cm behind it."""
    speeds = np.tile(np.array([[0.0], [3.0]]), (8, 1, 1))
    x, y, yaw = roll_out(speeds, Twist2D(0.0, 3.0), SPEC)[0].T
    assert yaw == pytest.approx(0.3 * np.arange(1, 9))
    assert x + 0.05 == pytest.approx(0.05 * np.cos(yaw), abs=1e-6)
    assert y == pytest.approx(0.05 * np.sin(yaw), abs=1e-6)


def test_ramp_from_rest_covers_half_the_way_of_its_end_speed() -> None:
    """2 m/s2 for 0.1 s: 1 cm, and 2 cm in each period after that."""
    speeds = np.tile(np.array([[0.2], [0.0]]), (3, 1, 1))
    x = roll_out(speeds, Twist2D(0.0, 0.0), SPEC)[0, :, 0]
    assert x == pytest.approx([0.01, 0.03, 0.05])


@given(SEEDS, st.floats(-4, 4), st.floats(-4, 4), st.floats(-7, 7))
def test_frames_are_each_others_inverse(seed: int, x: float, y: float, yaw: float) -> None:
    points = np.random.default_rng(seed).normal(size=(6, 2))
    pose = Pose2D(x, y, yaw)
    assert to_robot_frame(to_world_frame(points, pose), pose) == pytest.approx(points)
    assert to_world_frame(np.zeros((1, 2)), pose)[0] == pytest.approx((x, y))
    ahead = to_world_frame(np.array([[1.0, 0.0]]), pose)[0] - (x, y)
    assert ahead == pytest.approx((np.cos(yaw), np.sin(yaw)))
