"""How likely contact is, in scenes whose gaps are known by construction."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from point_scene import SETTINGS, scene_of

from fuzzynav_mj.planners.clearance import facings, place
from fuzzynav_mj.planners.headings import HORIZON
from fuzzynav_mj.planners.passing import OUTLOOK
from fuzzynav_mj.planners.survival import TOUCH, hold_against_movers
from fuzzynav_mj.robot import DEFAULT_ROBOT as SPEC
from fuzzynav_mj.types import FloatArray

NOTHING = np.empty((0, 2))
STILL = np.zeros((1, HORIZON, 3))
TIMES = 0.1 * (np.arange(HORIZON) + 1.0)


def held(
    expected: FloatArray = NOTHING,
    possible: FloatArray = NOTHING,
    poses: FloatArray = STILL,
    beyond: float = 0.0,
    least: float = -1.0,
) -> tuple[FloatArray, float]:
    """(T,) likelihoods for a way among points (k, 2) that stay, and the periods expected of it."""
    stays = np.tile(expected, (OUTLOOK, 1, 1)), np.tile(possible, (HORIZON, 1, 1))
    found, gaps, placed = np.empty(HORIZON), np.empty((2, HORIZON)), np.empty((4, HORIZON))
    place(placed, poses[0], facings(poses)[0])
    scene = scene_of(NOTHING, *stays)
    lasts = hold_against_movers(
        found, gaps[0], gaps[1], placed, scene, SPEC.half_side, beyond, least
    )
    return found, lasts


def alive(
    expected: FloatArray = NOTHING, possible: FloatArray = NOTHING, poses: FloatArray = STILL
) -> FloatArray:
    """(T,) likelihoods of `held`."""
    return held(expected, possible, poses)[0]


def beside(gap: float) -> FloatArray:
    return np.array([[0.0, SPEC.half_side + gap]])


def test_without_movers_nothing_happens() -> None:
    assert (alive() == 1.0).all()
    assert (alive(np.array([[0.0, 0.7]])) == 1.0).all()


def test_touch_is_certain_where_a_mover_is_expected_and_as_likely_as_the_way_elsewhere() -> None:
    assert (alive(beside(0.0)) == 0.0).all()
    np.testing.assert_allclose(alive(possible=beside(0.0)), 0.8)
    np.testing.assert_allclose(alive(beside(0.0), beside(0.0)), 0.0)


@pytest.mark.parametrize("gap", [0.03, 0.06, 0.1])
def test_risk_of_a_gap_falls_with_its_square_and_grows_with_time(gap: float) -> None:
    clear = SETTINGS.risky_gap + SETTINGS.risky_gap_growth * TIMES
    risk = np.clip(1.0 - (gap - TOUCH) / clear, 0.0, 1.0) ** 2
    np.testing.assert_allclose(alive(beside(gap)), 1.0 - risk)
    np.testing.assert_allclose(alive(possible=beside(gap)), 1.0 - 0.2 * risk)


@pytest.mark.parametrize("beyond", [0.0, 14.0])
def test_periods_expected_are_the_sum_of_likelihoods_unless_they_are_too_few(beyond: float) -> None:
    found, lasts = held(beside(0.06), beside(0.03), beyond=beyond)
    assert 1.0 < lasts < HORIZON + beyond
    assert lasts == pytest.approx(found.sum() + beyond * found[-1], abs=1e-12)
    assert held(beside(0.06), beside(0.03), beyond=beyond, least=lasts - 1e-9)[1] == lasts
    assert held(beside(0.06), beside(0.03), beyond=beyond, least=lasts + 1e-9)[1] == -1.0


def test_risk_that_is_over_is_not_forgotten() -> None:
    """A point beside the robot is passed at half a metre per second."""
    away = np.zeros((1, HORIZON, 3))
    away[0, :, 0] = 0.5 * TIMES
    found = alive(beside(0.03), poses=away)
    assert 0.0 < found[-1] < 1.0 and (np.diff(found) <= 0.0).all()
    assert (found[4:] == found[4]).all()


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_survival_never_rises_and_more_movers_never_raise_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bearings, ranges = rng.uniform(-pi, pi, 8), rng.uniform(0.15, 0.6, 8)
    points = (ranges * np.stack((np.cos(bearings), np.sin(bearings)))).T
    poses = np.cumsum(rng.uniform(-0.05, 0.05, (1, HORIZON, 3)), axis=1)
    few, more = alive(points[:2], points[2:4], poses), alive(points[:4], points[2:8], poses)
    assert (np.diff(few) <= 0.0).all() and (few >= 0.0).all() and (few <= 1.0).all()
    assert (more <= few + 1e-12).all()
