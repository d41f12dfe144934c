"""Laws of the bare model at its own step: wheel speeds in, motion out."""

from math import degrees, hypot, pi

import numpy as np
import pytest
from rigs import DT, drive, ramped

from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.types import FloatArray

TOP = DEFAULT_ROBOT.max_speed
SPIN = DEFAULT_ROBOT.max_yaw_rate


def fitted_radius(xy: FloatArray) -> float:
    """Radius of the circle through (n, 2) points, least squares."""
    rows = np.column_stack((2 * xy, np.ones(len(xy))))
    x, y, rest = np.linalg.lstsq(rows, (xy**2).sum(axis=1), rcond=None)[0]
    return float(np.sqrt(rest + x * x + y * y))


def test_ten_metres_straight_on() -> None:
    run = drive(ramped(TOP, 0.0), 20.5)
    assert run.xy[-1, 0] > 10.0
    assert np.abs(run.xy[:, 1]).max() < 1e-3
    assert np.abs(run.yaw).max() < 1e-6
    steady = slice(round(1.0 / DT), None)
    assert np.abs(run.slip[steady]).max() < 0.005 * TOP


@pytest.mark.parametrize(
    ("v", "radius"), [(0.5, 0.5), (0.5, 0.25), (0.5, 1.5), (0.3, 0.2), (0.2, 0.1), (-0.4, 0.5)]
)
def test_radius_of_a_commanded_circle(v: float, radius: float) -> None:
    omega = v / radius
    lap = 2 * pi / abs(omega)
    run = drive(ramped(v, omega), 1.0 + lap)
    # The axle's middle goes round at `radius`; the footprint's centre lies ahead of it.
    expected = hypot(radius, DEFAULT_ROBOT.axle_offset)
    assert fitted_radius(run.xy[round(1.0 / DT) :]) == pytest.approx(expected, rel=0.02)
    assert run.velocity[-1, 0] == pytest.approx(v, rel=0.01)


def test_spinning_turns_about_the_axle() -> None:
    run = drive(ramped(0.0, SPIN), 5.0)
    turns = abs(run.yaw[-1]) / (2 * pi)
    axle = run.xy - DEFAULT_ROBOT.axle_offset * np.stack((np.cos(run.yaw), np.sin(run.yaw)), axis=1)
    assert np.hypot(*(axle - axle[0]).T).max() < 1e-3 * turns
    assert run.velocity[-1, 2] == pytest.approx(SPIN, rel=0.005)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ((TOP, 0.0), (0.0, 0.0)),
        ((TOP, 0.0), (-TOP, 0.0)),
        ((-TOP, 0.0), (TOP, 0.0)),
        ((0.0, SPIN), (0.0, -SPIN)),
        ((TOP, SPIN), (-TOP, -SPIN)),
    ],
)
def test_abrupt_commands_neither_tip_it_nor_lift_the_castor(
    before: tuple[float, float], after: tuple[float, float]
) -> None:
    run = drive(lambda time: before if time < 1.0 else after, 2.0)
    assert degrees(run.tilt.max()) < 1.0
    assert run.castor_touches.all()
    assert np.abs(run.castor_gap).max() < 0.5e-3


def test_braking_at_the_limit_overruns_by_no_more_than_the_servos_lag() -> None:
    lag = 0.02  # s
    braking = 0.5 * TOP**2 / DEFAULT_ROBOT.max_acceleration

    def command(time: float) -> tuple[float, float]:
        slowed = TOP - DEFAULT_ROBOT.max_acceleration * (time - 1.0)
        return (TOP if time < 1.0 else max(slowed, 0.0)), 0.0

    run = drive(command, 2.0)
    travelled = run.xy[-1, 0] - run.xy[round(1.0 / DT) - 1, 0]
    assert braking <= travelled <= braking + lag * TOP
    assert run.velocity[-1, 0] == pytest.approx(0.0, abs=1e-6)


def test_standing_still() -> None:
    run = drive(lambda time: (0.0, 0.0), 10.0)
    assert np.abs(run.xy).max() < 1e-5
    assert np.abs(run.yaw).max() < 1e-6
    settled = slice(round(1.0 / DT), None)
    assert np.abs(run.velocity[settled]).max() < 1e-6


def test_two_runs_are_bit_identical() -> None:
    first, second = (drive(ramped(TOP, 2.0), 2.0) for _ in range(2))
    assert np.array_equal(first.xy, second.xy)
    assert np.array_equal(first.yaw, second.yaw)
