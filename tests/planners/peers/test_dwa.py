"""The dynamic window approach: what it may choose, and what it chooses."""

from math import hypot, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from peer_scenes import discs_scan, hit_points, observe, towards

from fuzzynav_mj.control import drive_towards
from fuzzynav_mj.planners.clearance import static_clearance
from fuzzynav_mj.planners.peers.dwa import (
    DwaSettings,
    DynamicWindowPlanner,
    dynamic_window,
    hits,
    look_along,
)
from fuzzynav_mj.planners.peers.rollout import roll_out, within_limits
from fuzzynav_mj.robot import DEFAULT_ROBOT as SPEC
from fuzzynav_mj.types import Behaviour, Decision, LaserScan, Twist2D

SETTINGS = DwaSettings()
FAR = (5.0, 0.0)
STOP = Twist2D(0.0, 0.0)

V = st.floats(0.0, SPEC.max_speed)
OMEGA = st.floats(-SPEC.max_yaw_rate, SPEC.max_yaw_rate)
PLACE = st.tuples(st.floats(-0.7, 0.7), st.floats(-0.7, 0.7), st.just(0.08)).filter(
    lambda disc: hypot(disc[0], disc[1]) > 0.28
)


def decide(scan: LaserScan, twist: Twist2D = STOP, goal: tuple[float, float] = FAR) -> Decision:
    """One decision of a fresh planner."""
    planner = DynamicWindowPlanner()
    planner.reset(towards(*goal), np.random.default_rng(0))
    return planner.decide(observe(scan, twist))


def driven(decision: Decision, twist: Twist2D) -> Twist2D:
    """The speeds that the controller makes of a decision."""
    return drive_towards(decision.next_position, observe().pose, twist, SPEC).final


@given(V, OMEGA)
def test_window_is_what_one_period_can_reach_and_the_robot_may_drive(
    v: float, omega: float
) -> None:
    window = dynamic_window(Twist2D(v, omega), SPEC)
    assert len(window.v) == len(window.omega) == window.shape[0] * window.shape[1] > 0
    assert (np.abs(window.v - v) <= 0.2 + 1e-6).all()
    assert (np.abs(window.omega - omega) <= 1.0 + 1e-6).all()
    assert window.v.min() >= 0.0 and window.v.max() <= SPEC.max_speed + 1e-9
    assert np.abs(window.omega).max() <= SPEC.max_yaw_rate + 1e-9


def test_window_backs_up_only_when_told_to() -> None:
    assert dynamic_window(STOP, SPEC).v.min() == 0.0
    assert dynamic_window(STOP, SPEC, back_up=0.1).v.min() == pytest.approx(-0.1)


def test_clear_field_is_crossed_at_top_speed_straight_at_the_goal() -> None:
    twist = Twist2D(SPEC.max_speed, 0.0)
    decision = decide(discs_scan(), twist)
    assert decision.behaviour is Behaviour.GOAL_SEEKING
    assert decision.next_position == pytest.approx((0.05, 0.0), abs=1e-6)
    from_rest = decide(discs_scan(), STOP)
    assert driven(from_rest, STOP).v == pytest.approx(0.2, abs=0.01)
    assert from_rest.next_position[1] == pytest.approx(0.0, abs=1e-6)


@given(V, OMEGA, st.lists(PLACE, max_size=4))
@settings(max_examples=60, deadline=None)
def test_chosen_velocity_can_stop_short_of_every_hit(
    v: float, omega: float, discs: list[tuple[float, float, float]]
) -> None:
    """Rolled out: the period, then the steepest braking on both speeds, without a touch."""
    twist, scan = Twist2D(v, omega), discs_scan(*discs)
    window = dynamic_window(twist, SPEC)
    prospects = look_along(window, hits(scan), np.array(FAR), twist, SPEC, SETTINGS)
    if not prospects.admissible.any():
        return
    chosen = int(prospects.objective.argmax())
    assert prospects.admissible[chosen]
    speeds = (float(window.v[chosen]), float(window.omega[chosen]))
    distance = float(prospects.distance[chosen])
    if distance < SETTINGS.look_ahead:  # the way of the rim is at least that of the axle
        assert speeds[0] <= sqrt(2 * distance * SPEC.max_acceleration) + 1e-6
    aims = np.zeros((6, 2, 1))
    aims[0, :, 0] = speeds
    poses = roll_out(within_limits(aims, twist, SPEC), twist, SPEC)
    now = np.zeros((1, 1, 3), dtype=np.float32)
    points = hit_points(scan)
    if static_clearance(now, points, SPEC.half_side)[0, 0] > SETTINGS.margin:
        assert static_clearance(poses, points, SPEC.half_side).min() > 0.0


@given(st.lists(PLACE, max_size=3))
@settings(max_examples=40, deadline=None)
def test_mirrored_surroundings_have_mirrored_prospects(
    discs: list[tuple[float, float, float]],
) -> None:
    window, goal = dynamic_window(Twist2D(0.3, 0.0), SPEC), np.array(FAR)
    mirrored = discs_scan(*((x, -y, r) for x, y, r in discs))
    seen = [
        look_along(window, hit_points(scan), goal, Twist2D(0.3, 0.0), SPEC, SETTINGS)
        for scan in (discs_scan(*discs), mirrored)
    ]
    grids = [p.objective.reshape(window.shape) for p in seen]
    assert window.omega.reshape(window.shape)[:, ::-1] == pytest.approx(
        -window.omega.reshape(window.shape)
    )
    same = np.isclose(grids[0], grids[1][:, ::-1], atol=1e-3) | (
        np.isinf(grids[0]) & np.isinf(grids[1][:, ::-1])
    )
    # A sample at the very margin may fall to either side of it.
    assert same.mean() > 0.97


def test_objective_is_the_weighted_sum_where_nothing_is_near() -> None:
    """Straight at the goal at 0.5 m/s: 2.0 heading + 0.2 clearance + 0.2 velocity."""
    twist = Twist2D(SPEC.max_speed, 0.0)
    window = dynamic_window(twist, SPEC)
    prospects = look_along(window, np.empty((0, 2)), np.array(FAR), twist, SPEC, SETTINGS)
    best = int(prospects.objective.argmax())
    assert (window.v[best], window.omega[best]) == pytest.approx((0.5, 0.0), abs=1e-12)
    # Smoothed with its neighbours: 0.05 m/s slower, and turned either way.
    assert 2.3 < prospects.objective[best] < 2.4


def test_obstacle_beside_the_way_turns_the_robot_to_the_other_side() -> None:
    left = decide(discs_scan((0.45, 0.08, 0.1)), Twist2D(0.4, 0.0))
    right = decide(discs_scan((0.45, -0.08, 0.1)), Twist2D(0.4, 0.0))
    assert left.behaviour is right.behaviour is Behaviour.STATIC_AVOIDANCE
    assert left.next_position[1] < 0.0 < right.next_position[1]


def test_in_front_of_a_wall_the_robot_does_not_drive_on() -> None:
    wall = discs_scan(*((0.24, y, 0.08) for y in np.arange(-0.7, 0.71, 0.05)))
    decision = decide(wall)
    assert decision.behaviour is Behaviour.STATIC_AVOIDANCE
    assert decision.next_position[0] <= 1e-3


def test_square_without_room_to_turn_backs_up_until_a_way_is_free() -> None:
    """3.5 cm in front and at both sides: neither forwards nor round, but back."""
    reach, grain = 0.135 + 0.01, 0.01
    along = np.arange(-0.15, 0.16, 0.02)
    front = [(reach, float(t), grain) for t in along]
    sides = [(float(t), side * reach, grain) for t in along for side in (1, -1)]
    planner = DynamicWindowPlanner()
    planner.reset(towards(*FAR), np.random.default_rng(0))
    pocket = observe(discs_scan(*front, *sides))
    notes = [planner.decide(pocket).note for _ in range(2)]
    assert "backing up" in notes[1]
    decision = planner.decide(pocket)
    assert decision.behaviour is Behaviour.EVASION
    assert driven(decision, STOP).v == pytest.approx(-0.1, abs=0.01)
    assert planner.decide(observe()).behaviour is Behaviour.GOAL_SEEKING


def test_enclosed_robot_stops() -> None:
    ring = discs_scan(
        *((0.2 * np.cos(a), 0.2 * np.sin(a), 0.06) for a in np.linspace(0, 2 * np.pi, 60))
    )
    decision = decide(ring, Twist2D(0.1, 0.0))
    assert driven(decision, Twist2D(0.1, 0.0)).v == pytest.approx(0.0, abs=0.05)
    assert decision.note


def test_what_was_weighed_is_in_the_record() -> None:
    decision = decide(discs_scan((0.45, 0.08, 0.1)), Twist2D(0.4, 0.0))
    weighed = decision.candidates
    assert weighed is not None and decision.subgoal == FAR
    best = int(weighed.cost.argmin())
    assert weighed.admissible[best]
    assert weighed.positions[best] == pytest.approx(decision.next_position, abs=1.5e-3)
    assert np.isinf(weighed.cost[~weighed.admissible]).all()
