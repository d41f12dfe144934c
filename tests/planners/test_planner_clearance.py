"""Gaps between the rolled-out square and points, against an exact geometry library."""

from math import pi

import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav_mj.geometry import footprints, rotation
from fuzzynav_mj.planners.clearance import (
    FAR,
    facings,
    gaps_to_standing,
    moving_clearance,
    place,
    static_clearance,
)
from fuzzynav_mj.types import FloatArray

HALF_SIDE = 0.1
ROUNDING = 2e-6  # m: single precision of places within 2 m

coordinate = st.floats(-1.0, 1.0)
pose = st.tuples(coordinate, coordinate, st.floats(-pi, pi))
point = st.tuples(coordinate, coordinate)


def exact_gaps(poses: FloatArray, points: FloatArray) -> FloatArray:
    """(n,) gap between the square at each pose (n, 3) and the nearest point (k, 2)."""
    gaps: FloatArray = shapely.distance(
        footprints(poses, HALF_SIDE), shapely.multipoints(shapely.points(points))
    )
    return gaps


def gap(x: float, y: float, yaw: float, *points: tuple[float, float]) -> float:
    """The gap at one pose."""
    poses = np.array([[[x, y, yaw]]], dtype=np.float32)
    return float(static_clearance(poses, np.array(points), HALF_SIDE)[0, 0])


def test_hand_computed_gaps() -> None:
    assert abs(gap(0.0, 0.0, 0.0, (0.5, 0.0)) - 0.4) < ROUNDING  # ahead of the front side
    assert abs(gap(0.0, 0.0, 0.0, (0.4, 0.5)) - 0.5) < ROUNDING  # a 3-4-5 triangle off a corner
    assert abs(gap(0.0, 0.0, pi / 4, (0.5, 0.0)) - (0.5 - 0.1 * 2**0.5)) < ROUNDING  # corner first
    assert abs(gap(1.0, -1.0, pi / 2, (1.0, -0.7), (1.5, -1.0)) - 0.2) < ROUNDING
    assert gap(0.3, 0.3, 1.0, (0.35, 0.32)) == 0.0  # inside


@settings(max_examples=25, deadline=None)
@given(st.lists(pose, min_size=1, max_size=6), st.lists(point, min_size=1, max_size=8))
def test_gap_is_exact(poses: list[tuple[float, ...]], points: list[tuple[float, ...]]) -> None:
    at, spots = np.array(poses), np.array(points)
    found = static_clearance(at[:, None].astype(np.float32), spots, HALF_SIDE)
    assert found.shape == (len(at), 1)
    np.testing.assert_allclose(found[:, 0], exact_gaps(at, spots), atol=ROUNDING)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), pose)
def test_gap_does_not_depend_on_where_and_which_way(
    seed: int, moved: tuple[float, float, float]
) -> None:
    rng = np.random.default_rng(seed)
    poses = rng.uniform(-1.0, 1.0, (4, 5, 3))
    points = rng.uniform(-1.0, 1.0, (7, 2))
    turn, shift = rotation(moved[2]), np.array(moved[:2])
    carried = np.concatenate((poses[..., :2] @ turn.T + shift, poses[..., 2:] + moved[2]), axis=2)
    np.testing.assert_allclose(
        static_clearance(carried.astype(np.float32), points @ turn.T + shift, HALF_SIDE),
        static_clearance(poses.astype(np.float32), points, HALF_SIDE),
        atol=3 * ROUNDING,
    )


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 9), st.integers(1, 6), st.integers(1, 12))
def test_movers_that_do_not_move_are_obstacles_that_stand(
    seed: int, count: int, steps: int, points: int
) -> None:
    rng = np.random.default_rng(seed)
    poses = rng.uniform(-1.0, 1.0, (count, steps, 3)).astype(np.float32)
    spots = rng.uniform(-1.0, 1.0, (points, 2))
    places = np.broadcast_to(spots.T, (steps, 2, points))
    moving = moving_clearance(poses, places, HALF_SIDE)
    assert moving.shape == (count, steps)
    np.testing.assert_allclose(moving, static_clearance(poses, spots, HALF_SIDE), atol=ROUNDING)


def test_every_column_has_its_own_places() -> None:
    """One point comes nearer while the square stands; another square runs away as fast."""
    steps = np.arange(4)
    places = np.stack((0.8 - 0.1 * steps, np.zeros(4)), axis=1)[:, :, None]
    still = np.zeros((4, 3))
    away = np.stack((-0.1 * steps, np.zeros(4), np.zeros(4)), axis=1)
    gaps = moving_clearance(np.stack((still, away)).astype(np.float32), places, HALF_SIDE)
    np.testing.assert_allclose(gaps, [[0.7, 0.6, 0.5, 0.4], [0.7, 0.7, 0.7, 0.7]], atol=ROUNDING)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_more_points_never_widen_the_gap(seed: int) -> None:
    rng = np.random.default_rng(seed)
    poses = rng.uniform(-1.0, 1.0, (3, 4, 3)).astype(np.float32)
    points = rng.uniform(-1.0, 1.0, (6, 2))
    few = static_clearance(poses, points[:3], HALF_SIDE)
    assert (static_clearance(poses, points, HALF_SIDE) <= few + ROUNDING).all()


def test_nothing_in_sight_is_far_everywhere() -> None:
    poses = np.zeros((3, 4, 3), dtype=np.float32)
    assert (static_clearance(poses, np.empty((0, 2)), HALF_SIDE) == FAR).all()
    nothing = moving_clearance(poses, np.empty((4, 2, 0)), HALF_SIDE)
    assert nothing.shape == (3, 4) and (nothing == FAR).all()


@settings(max_examples=50, deadline=None)
@given(st.lists(pose, min_size=1, max_size=6), st.lists(point, max_size=8), st.floats(0.01, 2.0))
def test_what_is_farther_than_near_is_as_good_as_near(
    way: list[tuple[float, ...]], points: list[tuple[float, ...]], near: float
) -> None:
    poses, spots = np.array([way]), np.array(points).reshape(-1, 2)
    gaps, placed = np.empty(len(way)), np.empty((4, len(way)))
    place(placed, poses[0], facings(poses)[0])
    gaps_to_standing(gaps, placed, spots, HALF_SIDE, near)
    exact = static_clearance(poses, spots, HALF_SIDE)[0]
    np.testing.assert_allclose(gaps, np.minimum(exact, near), rtol=1e-12)
