"""Optimal reciprocal collision avoidance with full responsibility."""

from math import hypot, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from peer_scenes import observe, round_mover, seen_obstacle, towards

from fuzzynav_mj.planners.peers.half_planes import HalfPlanes
from fuzzynav_mj.planners.peers.orca import (
    Disc,
    OrcaPlanner,
    OrcaSettings,
    choose_velocity,
    enclosing_disc,
    half_plane,
    mover_half_planes,
    preferred_velocity,
    reachable,
    static_half_planes,
)
from fuzzynav_mj.robot import DEFAULT_ROBOT as SPEC
from fuzzynav_mj.types import Behaviour, Decision, FloatArray, PerceivedObstacle, Pose2D, Twist2D

SETTINGS = OrcaSettings()
HERE = Pose2D(0.0, 0.0, 0.0)
NONE = HalfPlanes(np.empty((0, 2)), np.empty(0))
FULL = Twist2D(SPEC.max_speed, 0.0)


def decide(
    *obstacles: PerceivedObstacle, twist: Twist2D = FULL, goal: tuple[float, float] = (5.0, 0.0)
) -> Decision:
    """One decision of a fresh planner."""
    planner = OrcaPlanner()
    planner.reset(towards(*goal), np.random.default_rng(0))
    return planner.decide(observe(twist=twist, obstacles=obstacles))


def smallest_distance(place: FloatArray, relative: FloatArray, horizon: float) -> float:
    """Of the origin, moving at `relative`, and `place`, within a time horizon."""
    squared = float(relative @ relative)
    time = 0.0 if squared == 0 else min(max(float(place @ relative) / squared, 0.0), horizon)
    return hypot(*(place - time * relative).tolist())


# One mover -------------------------------------------------------------------------------------


def test_head_on_half_plane_by_hand() -> None:
    """At 2 m, two radii of 0.2 m: a gap of 1.6 m. A horizon of 1.5 s allows a closing speed of
    1.6 / 1.5 m/s, of which the mover has 0.5."""
    disc = Disc(np.array([2.0, 0.0]), np.array([-0.5, 0.0]), 0.2)
    plane = half_plane(disc, np.array([0.5, 0.0]), 0.2, 1.5, 0.1)
    assert plane.normals == pytest.approx(np.array([[1.0, 0.0]]))
    assert plane.offsets == pytest.approx([1.6 / 1.5 - 0.5])


def test_passing_half_plane_follows_the_leg_of_the_cone() -> None:
    """A disc at (1, 0) of reach 0.5: legs at 30 degrees. Well beyond the cap and just left of the
    axis, the left leg is the border; it passes through the velocity of the disc."""
    disc = Disc(np.array([1.0, 0.0]), np.array([0.1, 0.2]), 0.3)
    plane = half_plane(disc, np.array([1.6, 0.21]), 0.2, 5.0, 0.1)
    assert plane.normals == pytest.approx(np.array([[0.5, -sqrt(3) / 2]]))
    assert plane.offsets == pytest.approx(plane.normals @ disc.velocity)


@given(
    st.floats(0.42, 3.0),
    st.floats(-3.1, 3.1),
    st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)),
    st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)),
    st.floats(0.5, 4.0),
    st.floats(-2.0, 2.0),
    st.floats(0.0, 1.0),
)
def test_every_velocity_that_is_allowed_keeps_clear_until_the_horizon(
    distance: float,
    bearing: float,
    own: tuple[float, float],
    its: tuple[float, float],
    horizon: float,
    along: float,
    inside: float,
) -> None:
    place = distance * np.array([np.cos(bearing), np.sin(bearing)])
    disc = Disc(place, np.array(its), 0.2)
    plane = half_plane(disc, np.array(own), 0.2, horizon, 0.1)
    normal = plane.normals[0]
    velocity = normal * (plane.offsets[0] - inside) + along * np.array([-normal[1], normal[0]])
    assert smallest_distance(place, velocity - disc.velocity, horizon) >= 0.4 - 1e-6


@given(st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)), st.floats(0.5, 3.0))
def test_velocity_that_is_clear_by_itself_is_not_forbidden(
    own: tuple[float, float], horizon: float
) -> None:
    """The half-plane touches the velocity obstacle next to the present velocity, and so holds a
    present velocity that keeps clear."""
    disc = Disc(np.array([0.6, 0.3]), np.array([-0.2, 0.1]), 0.2)
    velocity = np.array(own)
    clear = smallest_distance(disc.centre, velocity - disc.velocity, horizon) >= 0.4
    allowed = half_plane(disc, velocity, 0.2, horizon, 0.1).excess(velocity)[0] <= 1e-9
    assert allowed == clear


def test_overlap_is_left_within_one_period() -> None:
    """Overlapping by 0.1 m: the relative speed away is at least 0.1 m in 0.1 s."""
    disc = Disc(np.array([0.3, 0.0]), np.array([0.0, 0.0]), 0.2)
    plane = half_plane(disc, np.zeros(2), 0.2, 2.0, 0.1)
    assert plane.normals == pytest.approx(np.array([[1.0, 0.0]]))
    assert plane.offsets == pytest.approx([-1.0])


def test_disc_holds_all_that_is_seen_of_the_mover() -> None:
    disc = enclosing_disc(round_mover(0.5, 0.2, (0.0, -0.3)), Pose2D(0.0, 0.0, np.pi / 2))
    assert disc.centre == pytest.approx((0.2, -0.5))
    assert disc.radius == pytest.approx(0.08)
    assert disc.velocity == pytest.approx((-0.3, 0.0), abs=1e-12)


# What stands -----------------------------------------------------------------------------------


def test_speed_towards_what_stands_is_its_distance_over_the_horizon() -> None:
    wall = seen_obstacle([(0.3, 0.0)])
    seen = observe(obstacles=(wall,)).perception
    assert seen is not None
    planes = static_half_planes(seen, HERE, SPEC, SETTINGS)
    gap = 0.3 - SPEC.half_diagonal - SETTINGS.static_margin
    assert planes.normals == pytest.approx(np.array([[1.0, 0.0]]))
    assert planes.offsets == pytest.approx([gap / SETTINGS.static_horizon])


@given(st.lists(st.tuples(st.floats(-0.8, 0.8), st.floats(-0.8, 0.8)), min_size=1, max_size=9))
def test_standing_still_is_allowed_by_all_that_stands(points: list[tuple[float, float]]) -> None:
    seen = observe(obstacles=(seen_obstacle(points),)).perception
    assert seen is not None
    planes = static_half_planes(seen, HERE, SPEC, SETTINGS)
    assert (planes.excess(np.zeros(2)) <= 0.0).all()


# The choice ------------------------------------------------------------------------------------


def test_from_rest_a_fifth_of_a_metre_per_second_and_one_radian_are_within_reach() -> None:
    """2 m/s2 and 10 rad/s2 for 0.1 s; 1 rad/s moves the centre sideways at 0.05 m/s."""
    planes = reachable(Twist2D(0.0, 0.0), SPEC)
    assert planes.offsets == pytest.approx([0.2, 0.2, 0.05, 0.05])
    assert reachable(FULL, SPEC).offsets == pytest.approx([0.5, -0.3, 0.05, 0.05])


def test_preferred_velocity_is_top_speed_and_does_not_go_past_the_goal() -> None:
    assert preferred_velocity(np.array([3.0, 4.0]), SPEC) == pytest.approx((0.3, 0.4))
    assert preferred_velocity(np.array([0.0, 0.03]), SPEC) == pytest.approx((0.0, 0.3))


def test_without_obstacles_the_preferred_velocity_is_chosen() -> None:
    wanted = np.array([0.45, 0.01])
    choice = choose_velocity(wanted, reachable(FULL, SPEC), NONE, NONE)
    assert choice.velocity == pytest.approx(wanted) and choice.note == ""
    decision = decide()
    assert decision.next_position == pytest.approx((0.05, 0.0), abs=1e-6)
    assert decision.behaviour is Behaviour.GOAL_SEEKING and decision.subgoal == (5.0, 0.0)


def test_velocity_chosen_in_front_of_a_mover_keeps_clear_until_the_horizon() -> None:
    """Far enough for the speeds within reach to suffice."""
    obstacle = round_mover(0.78, 0.1, (-0.2, 0.0))
    seen = observe(obstacles=(obstacle,)).perception
    assert seen is not None
    twist, settings = Twist2D(0.2, 0.0), OrcaSettings(margin=0.05)
    moving = mover_half_planes(seen, HERE, twist, SPEC, settings)
    wanted = np.array([0.5, 0.0])
    choice = choose_velocity(wanted, reachable(twist, SPEC), NONE, moving)
    disc = enclosing_disc(obstacle, HERE)
    reach = disc.radius + SPEC.half_diagonal + settings.margin
    assert choice.note == ""
    relative = choice.velocity - disc.velocity
    assert smallest_distance(disc.centre, relative, settings.horizon) >= reach - 1e-6
    assert smallest_distance(disc.centre, wanted - disc.velocity, settings.horizon) < reach


def test_robot_turns_away_from_a_mover_that_comes_from_one_side() -> None:
    left = decide(round_mover(0.5, 0.25, (-0.3, -0.2)))
    right = decide(round_mover(0.5, -0.25, (-0.3, 0.2)))
    for decision in (left, right):
        assert decision.behaviour in (Behaviour.DYNAMIC_AVOIDANCE, Behaviour.EVASION)
    straight = 0.05
    assert left.next_position[0] < straight - 1e-3 or left.next_position[1] < -1e-3
    assert right.next_position[0] == pytest.approx(left.next_position[0], abs=2e-3)
    assert right.next_position[1] == pytest.approx(-left.next_position[1], abs=2e-3)


def test_what_stands_outweighs_movers() -> None:
    """Ahead a wall, behind a mover that comes: the wall's half-plane is kept."""
    firm = HalfPlanes(np.array([[1.0, 0.0]]), np.array([0.05]))
    chased = HalfPlanes(np.array([[-1.0, 0.0]]), np.array([-0.15]))
    choice = choose_velocity(np.zeros(2), reachable(Twist2D(0.0, 0.0), SPEC), firm, chased)
    assert choice.velocity[0] == pytest.approx(0.05)
    assert choice.note == "no velocity keeps clear of the movers"


def test_too_fast_for_what_stands_is_braked_for() -> None:
    firm = HalfPlanes(np.array([[1.0, 0.0]]), np.array([0.1]))
    choice = choose_velocity(np.array([0.5, 0.0]), reachable(FULL, SPEC), firm, NONE)
    assert choice.velocity[0] == pytest.approx(0.3)
    assert choice.note == "no velocity keeps clear of what stands"
