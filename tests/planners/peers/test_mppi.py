"""Model predictive path integral control: its samples, their costs, and what it makes of them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from peer_scenes import discs_scan, hit_points, observe, round_mover, seen_obstacle, towards

from fuzzynav_mj.planners.base import Observation
from fuzzynav_mj.planners.peers.mppi import (
    Costs,
    MppiPlanner,
    MppiSettings,
    Scene,
    evaluate,
    sample,
    scene,
    weights,
)
from fuzzynav_mj.robot import DEFAULT_ROBOT as SPEC
from fuzzynav_mj.types import Behaviour, Decision, FloatArray, Twist2D

SETTINGS = MppiSettings()
FULL = Twist2D(SPEC.max_speed, 0.0)
NOTHING = np.empty((0, 2))
T = SETTINGS.periods


def started(seed: int = 0, goal: tuple[float, float] = (5.0, 0.0)) -> MppiPlanner:
    """A planner at the start of an episode."""
    planner = MppiPlanner()
    planner.reset(towards(*goal), np.random.default_rng(seed))
    return planner


def settled(observation: Observation, seed: int = 0, decisions: int = 6) -> Decision:
    """The last one of several decisions on the same observation."""
    planner = started(seed)
    for _ in range(decisions):
        decision = planner.decide(observation)
    return decision


def held(v: float, omega: float = 0.0) -> FloatArray:
    """(T, 2, 1) controls that hold one pair of speeds."""
    return np.tile(np.array([[v], [omega]]), (T, 1, 1))


def cost(
    controls: FloatArray, standing: FloatArray = NOTHING, moving: FloatArray | None = None
) -> Costs:
    """Of controls from full speed, on the way to a goal 5 m ahead."""
    places = np.empty((T, 2, 0)) if moving is None else moving
    around = Scene(np.array([5.0, 0.0]), standing, places)
    return evaluate(controls, np.zeros((T, 2, 1)), around, FULL, SPEC, SETTINGS)


# Samples ---------------------------------------------------------------------------------------


@given(st.integers(0, 2**32 - 1), st.floats(-0.5, 0.5), st.floats(-3.0, 3.0))
@settings(max_examples=20, deadline=None)
def test_no_sample_is_beyond_the_limits(seed: int, v: float, omega: float) -> None:
    rng = np.random.default_rng(seed)
    plan = rng.normal(size=(T, 2, 1)) * np.array([[0.5], [3.0]])
    controls = sample(plan, Twist2D(v, omega), rng, SPEC, SETTINGS)
    assert controls.shape == (T, 2, SETTINGS.samples)
    assert np.abs(controls[:, 0]).max() <= SPEC.max_speed
    assert np.abs(controls[:, 1]).max() <= SPEC.max_yaw_rate
    start = np.tile(np.array([[v], [omega]]), (1, 1, SETTINGS.samples))
    change = np.abs(np.diff(controls, axis=0, prepend=start))
    assert change[:, 0].max() <= SPEC.max_acceleration * SPEC.decision_period + 1e-9
    assert change[:, 1].max() <= SPEC.max_yaw_acceleration * SPEC.decision_period + 1e-9


def test_the_plan_itself_and_braking_are_among_the_samples() -> None:
    controls = sample(held(0.5), FULL, np.random.default_rng(0), SPEC, SETTINGS)
    assert np.array_equal(controls[:, :, 0], held(0.5)[:, :, 0])
    assert controls[:3, 0, -1] == pytest.approx([0.3, 0.1, 0.0])
    assert np.all(controls[3:, 0, -1] == 0.0)


def test_noise_has_the_deviation_that_is_set() -> None:
    """Noise so small that the limits cut nothing off."""
    slow = MppiSettings(sigma_v=0.02, sigma_omega=0.05, samples=4000)
    noise = sample(held(0.0), Twist2D(0.0, 0.0), np.random.default_rng(1), SPEC, slow)
    assert noise[:, 0].std() == pytest.approx(0.02, rel=0.03)
    assert noise[:, 1].std() == pytest.approx(0.05, rel=0.03)
    next_to = np.corrcoef(noise[5, 0, 1:-1], noise[6, 0, 1:-1])[0, 1]
    assert next_to == pytest.approx(slow.keeping, abs=0.04)


# Weights ---------------------------------------------------------------------------------------


@given(
    st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=30),
    st.floats(1e-3, 10.0),
    st.floats(-50.0, 50.0),
)
def test_weights_sum_to_one_favour_the_cheap_and_ignore_what_all_cost(
    costs: list[float], temperature: float, common: float
) -> None:
    values = np.array(costs)
    share = weights(values, temperature)
    assert share.sum() == pytest.approx(1.0)
    order = np.argsort(values)
    assert (np.diff(share[order]) <= 1e-12).all()
    assert weights(values + common, temperature) == pytest.approx(share, rel=1e-6, abs=1e-9)


def test_one_temperature_dearer_counts_less_by_a_factor_of_e() -> None:
    share = weights(np.array([1.0, 1.2]), 0.2)
    assert share[0] / share[1] == pytest.approx(np.e)


# Costs -----------------------------------------------------------------------------------------


def test_way_left_over_is_what_a_free_drive_costs() -> None:
    """At 0.5 m/s: 5 cm a period."""
    paid = cost(held(0.5))
    left_over = 5.0 - 0.05 * np.arange(1, T + 1)
    wanted = SETTINGS.goal * left_over.mean() + SETTINGS.goal_at_end * left_over[-1]
    assert paid.progress == pytest.approx([wanted])
    assert paid.total == pytest.approx([wanted])
    assert paid.moving == paid.static == paid.contact == 0.0


def test_driving_through_what_stands_costs_contact_in_every_period_of_it() -> None:
    """A point 0.4 m ahead meets a footprint of 0.2 m in 5 places 5 cm apart, two of which it
    meets at the very edge, and with the contact gap 1.5 cm before."""
    paid = cost(held(0.5), standing=np.array([[0.4, 0.0]]))
    assert paid.contact == pytest.approx([SETTINGS.contact * 5])
    assert cost(held(0.5), standing=np.array([[0.4, 0.2]])).contact == [0.0]


def test_mover_is_met_where_it_will_be() -> None:
    """It crosses the way 0.5 m ahead: in the robot's way after 1 s, or gone by then."""
    times = 0.1 * np.arange(1, T + 1)
    ahead = np.full(T, 0.5)
    meeting = np.stack((ahead, 0.5 - 0.5 * times), axis=1)[:, :, None]
    gone = np.stack((ahead, -0.2 - 0.5 * times), axis=1)[:, :, None]
    assert cost(held(0.5), moving=meeting).contact[0] > 0.0
    assert cost(held(0.5), moving=gone).contact[0] == 0.0


def test_scene_moves_the_hits_of_movers_and_leaves_what_stands() -> None:
    observation = observe(
        obstacles=(seen_obstacle([(0.6, 0.1)], (-0.3, 0.2)), seen_obstacle([(0.0, 0.5)]))
    )
    assert observation.perception is not None
    around = scene(np.array([5.0, 0.0]), observation.perception, observation.pose, 10, SPEC)
    assert around.standing == pytest.approx(np.array([[0.0, 0.5]]))
    assert around.moving.shape == (10, 2, 1)
    assert around.moving[-1, :, 0] == pytest.approx((0.3, 0.3))


# Decisions -------------------------------------------------------------------------------------


def test_same_seed_gives_the_same_bits_and_another_one_others() -> None:
    seen = observe(twist=FULL, obstacles=(round_mover(0.6, 0.05, (-0.4, 0.0)),))
    runs = []
    for seed in (3, 3, 4):
        planner = started(seed)
        runs.append([planner.decide(seen).next_position for _ in range(3)])
    assert runs[0] == runs[1]
    assert runs[0] != runs[2]


def test_reset_forgets_the_last_episode() -> None:
    planner = started(3)
    first = planner.decide(observe()).next_position
    planner.reset(towards(5.0, 0.0), np.random.default_rng(3))
    assert planner.decide(observe()).next_position == first


def test_clear_field_is_crossed_at_nearly_top_speed() -> None:
    decision = settled(observe(twist=FULL))
    assert decision.next_position[0] > 0.045
    assert abs(decision.next_position[1]) < 0.005
    assert decision.behaviour is Behaviour.GOAL_SEEKING and decision.subgoal == (5.0, 0.0)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_mover_straight_ahead_is_evaded(side: float) -> None:
    """It comes head-on, a little to one side: the plan leads past it on the other, or back."""
    coming = round_mover(0.75, side * 0.04, (-0.4, 0.0))
    seen = observe(twist=FULL, obstacles=(coming,))
    planner = started()
    for _ in range(6):
        decision = planner.decide(seen)
    assert decision.behaviour in (Behaviour.DYNAMIC_AVOIDANCE, Behaviour.EVASION)
    plan = planner.plan
    assert seen.perception is not None
    around = scene(np.array([5.0, 0.0]), seen.perception, seen.pose, T, SPEC)
    taken = evaluate(plan, plan, around, FULL, SPEC, SETTINGS)
    straight = evaluate(held(0.5), plan, around, FULL, SPEC, SETTINGS)
    assert straight.contact[0] > 0.0
    assert taken.contact[0] == 0.0


def test_wall_ahead_is_not_driven_into() -> None:
    wall = discs_scan(*((0.30, y, 0.08) for y in np.arange(-0.7, 0.71, 0.05)))
    seen = observe(wall, FULL, (seen_obstacle(hit_points(wall)),))
    decision = settled(seen)
    assert decision.next_position[0] <= 0.041  # braked for as hard as may be
    assert decision.behaviour in (Behaviour.STATIC_AVOIDANCE, Behaviour.EVASION)
