"""What rays that went by tell of movers: laws, and cases worked out by hand."""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made_scans import HERE, PERIOD, RAYS, REACH, scan_of, square

from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.sensing.free_space import CONTRADICTION, FreeSpace
from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.sensing.looks import Look, take_look
from fuzzynav_mj.sensing.outline import Outline, outline_around
from fuzzynav_mj.sensing.parts import convex_parts
from fuzzynav_mj.sensing.perception import Perceiver
from fuzzynav_mj.sensing.velocity_filter import nothing_known
from fuzzynav_mj.sensing.velocity_grid import KNOWN
from fuzzynav_mj.types import FloatArray, LaserScan, PerceivedObstacle


def look_of(bodies: list[FloatArray], stamp: float) -> Look:
    return take_look(scan_of(bodies, stamp), HERE)


def outline_in(look: Look) -> Outline:
    """All that a look shows, as one outline."""
    return outline_around(look, np.zeros(RAYS, dtype=bool), 0.0, 0.0, 2.0)


def moving(velocity: FloatArray) -> FloatArray:
    return np.array([*velocity, 0.0, 0.0, 0.0, 0.0])


def perceived(body: FloatArray, velocity: FloatArray, looks: int) -> PerceivedObstacle:
    """The nearest obstacle after so many looks at a moving body; the last shows it as given."""
    perceiver = Perceiver(DEFAULT_ROBOT)
    for number in range(looks):
        ago = PERIOD * (looks - 1 - number)
        seen = perceiver.perceive(scan_of([body - velocity * ago], PERIOD * number), HERE)
    return min(seen.obstacles, key=lambda obstacle: obstacle.distance)


@given(
    bearing=st.floats(-pi, pi),
    distance=st.floats(0.35, 0.7),
    heading=st.floats(-pi, pi),
    speed=st.floats(0.0, 0.8),
    corners=st.integers(3, 8),
    turned=st.floats(0.0, pi),
)
@settings(max_examples=60, deadline=None)
def test_what_is_true_is_never_ruled_out(
    bearing: float, distance: float, heading: float, speed: float, corners: int, turned: float
) -> None:
    angles = turned + 2 * pi * np.arange(corners) / corners
    body = 0.15 * np.stack((np.cos(angles), np.sin(angles)), axis=1)
    body = body + distance * np.array([cos(bearing), sin(bearing)])
    velocity = speed * np.array([cos(heading), sin(heading)])
    past = [look_of([body - velocity * ago], -ago) for ago in (0.4, 0.3, 0.2, 0.1)]
    now = look_of([body], 0.0)
    before = [outline_in(look) for look in past[-2:]]
    space = FreeSpace(now, past)
    strange, anew = space.strangers(moving(velocity), outline_in(now), before)
    assert not strange.any() and not anew
    # Nor is it less likely than before among all that may be.
    state, covariance = nothing_known()
    narrowed, left = space.narrow(state, covariance, outline_in(now), before)
    off = velocity - narrowed[:2]
    assert off @ np.linalg.solve(left[:2, :2] + 0.05**2 * np.eye(2), off) < 12.0
    assert np.linalg.eigvalsh(left[:4, :4]).min() > 0.0


@pytest.mark.parametrize("speed", [-0.4, -0.2, 0.2, 0.4])
def test_three_looks_tell_how_a_flat_side_moves_along_itself(speed: float) -> None:
    body = square(0.5, 0.0)
    seen = perceived(body, np.array([0.0, speed]), 4)
    assert seen.dynamic
    np.testing.assert_allclose(seen.velocity, [0.0, speed], atol=0.1)


def test_what_comes_into_view_must_have_been_fast_enough_to_come_so_far() -> None:
    """Nothing within 0.8 m, and 0.1 s later a side at 0.74 m: at least 0.06 m nearer, less the
    margin."""
    far = FreeSpace(look_of([square(0.84, 0.0)], 0.1), [look_of([], 0.0)])
    state, covariance = far.narrow(*nothing_known(), outline_in(far.now), [])
    assert state[0] < -(0.06 - 0.015) / PERIOD
    assert sqrt(covariance[0, 0]) < 0.2 and state[1] == pytest.approx(0.0, abs=0.03)


def test_a_half_of_the_velocities_ruled_out_leaves_a_half_normal() -> None:
    """The left end of a side, whose other end is out of sight, lies where nothing was before, so it
    moves to the left: the mean of half a normal is 0.8 standard deviations off its middle, its
    variance 0.36 times as large."""
    sigma, last = 0.4, RAYS // 2 + 8
    edge = 0.5 * np.tan(ray_bearings(RAYS)[last]) + 1e-6
    body = np.array([[0.5, -0.8], [0.9, -0.8], [0.9, edge], [0.5, edge]])
    now, before = look_of([body], 0.1), scan_of([body], 0.0)
    assert now.hit[last] and not now.hit[last + 1]
    ranges = np.where(np.arange(RAYS) < last, before.ranges, REACH)
    past = take_look(LaserScan(0.0, before.bearings, ranges, ranges < REACH, REACH), HERE)
    covariance = np.diag([0.01, sigma, 0.6, 0.6, 0.0, 0.0]) ** 2
    state, left = FreeSpace(now, [past]).narrow(np.zeros(6), covariance, outline_in(now), [])
    assert state[1] == pytest.approx(sqrt(2 / pi) * sigma, rel=0.15)
    assert left[1, 1] == pytest.approx((1 - 2 / pi) * sigma**2, rel=0.15)
    assert state[0] == pytest.approx(0.0, abs=1e-9) and left[0, 0] == covariance[0, 0]


def test_a_mover_that_turned_at_once_is_not_held_against_where_it_was() -> None:
    """Upwards until 0.2 s ago, then towards the sensor: of looks before the turn its present motion
    would have been seen, so that they tell of another one; nothing of it may be believed."""
    path = {0.4: (0.55, -0.1), 0.3: (0.55, -0.05), 0.2: (0.55, 0.0), 0.1: (0.5, 0.0)}
    past = [look_of([square(*place)], -ago) for ago, place in path.items()]
    space = FreeSpace(look_of([square(0.45, 0.0)], 0.0), past)
    recent = FreeSpace(space.now, past[-2:])
    believed = np.array([-0.5, 0.0] + [0.0] * 4), np.diag([0.02, 0.15, 0.6, 0.6, 0.0, 0.0]) ** 2
    state, _ = space.narrow(*believed, outline_in(space.now), [])
    np.testing.assert_allclose(state[:2], [-0.5, 0.0], atol=0.05)
    np.testing.assert_allclose(state, recent.narrow(*believed, outline_in(space.now), [])[0])


def test_what_is_known_well_is_left_as_it_is() -> None:
    now, past = look_of([square(0.5, 0.0)], 0.1), look_of([], 0.0)
    covariance = np.diag([0.9 * KNOWN, 0.5 * KNOWN, 0.6, 0.6, 0.0, 0.0]) ** 2
    state = np.array([0.1, 0.2] + [0.0] * 4)
    same = FreeSpace(now, [past]).narrow(state, covariance, outline_in(now), [])
    assert same[0] is state and same[1] is covariance


def test_where_all_is_ruled_out_nothing_is_learnt() -> None:
    """In the middle of what was free, farther in than anything believed could come."""
    now, past = look_of([square(0.3, 0.0)], 0.1), look_of([], 0.0)
    state, covariance = np.zeros(6), np.diag([0.1, 0.1, 0.6, 0.6, 0.0, 0.0]) ** 2
    same = FreeSpace(now, [past]).narrow(state, covariance, outline_in(now), [])
    assert same[0] is state and same[1] is covariance


def test_noise_takes_away_what_rays_that_went_by_tell() -> None:
    now, past = look_of([square(0.84, 0.0)], 0.1), look_of([], 0.0)
    state, _ = FreeSpace(now, [past], noise=0.02).narrow(*nothing_known(), outline_in(now), [])
    exact, _ = FreeSpace(now, [past]).narrow(*nothing_known(), outline_in(now), [])
    assert exact[0] < -0.4 < state[0]


def two_sides(stamp: float) -> list[FloatArray]:
    """Two squares side by side, of which one moves to the left and one comes nearer: no common
    motion, but one that fits both sides across themselves."""
    left = square(0.55, 0.12 + 0.4 * stamp)
    right = square(0.50 - 0.3 * stamp, -0.12)
    return [left, right]


def test_hits_of_a_stranger_are_those_that_the_motion_puts_where_nothing_was() -> None:
    """A small body came out from behind a larger one, nearer than it; as a part of that one, which
    stands, it would have been seen before."""
    large = np.array([[0.6, -0.2], [0.8, -0.2], [0.8, 0.2], [0.6, 0.2]])
    small = square(0.55, 0.24, 0.05)
    past = [look_of([large], 0.0), look_of([large], 0.1)]
    now = look_of([large, small], 0.2)
    shown = outline_in(now)
    strange, anew = FreeSpace(now, past).strangers(np.zeros(6), shown, [outline_in(past[1])])
    own = shown.points[1] < 0.2 - 1e-6
    own &= shown.points[0] > 0.6 - 1e-6
    assert not anew
    np.testing.assert_array_equal(strange, ~own)


def test_a_motion_that_one_of_two_movers_contradicts_is_learnt_anew() -> None:
    """Each side alone would bear the motion; where the larger one should be in sight it is not."""
    past = [look_of(two_sides(PERIOD * k), PERIOD * k) for k in range(4)]
    now = look_of(two_sides(0.4), 0.4)
    believed = moving(np.array([-0.3, -0.9]))
    strange, anew = FreeSpace(now, past).strangers(believed, outline_in(now), [])
    assert anew
    kept = outline_in(now).points[:, ~strange]
    part = convex_parts(outline_in(now).points, outline_in(now).joined)
    assert len(np.unique(part[~strange])) == 1 and kept.shape[1] >= 2


def test_a_contradiction_smaller_than_the_margin_is_none() -> None:
    """Two bodies that stand: believed to go away, they would have been nearer before."""
    bodies = [square(0.5, 0.0), square(0.5, 0.25, 0.04)]
    now, past = look_of(bodies, 0.1), look_of(bodies, 0.0)
    for off, anew in ((0.9, False), (1.1, True)):
        believed = moving(np.array([off * CONTRADICTION / PERIOD, 0.0]))
        assert FreeSpace(now, [past]).strangers(believed, outline_in(now), [])[1] == anew


def test_one_body_that_contradicts_a_motion_has_begun_to_turn() -> None:
    now, past = look_of([square(0.5, 0.0)], 0.1), look_of([square(0.5, 0.0)], 0.0)
    believed = moving(np.array([1.0, 0.0]))
    strange, anew = FreeSpace(now, [past]).strangers(believed, outline_in(now), [])
    assert not strange.any() and not anew
