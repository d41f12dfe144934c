"""Next positions, and where the simulated robot really is when they are due."""

from math import atan2, cos, hypot, pi, sin

import numpy as np
import pytest
from scenes import scenario

from fuzzynav_mj.control import SpeedProfile, centre_displacement, drive_towards, ramp
from fuzzynav_mj.robot import DEFAULT_ROBOT as SPEC
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.types import FloatArray, Twist2D

OPEN = scenario(bounds=(-50.0, -50.0, 50.0, 50.0), walls=False, goal=(40.0, 40.0), time_limit=1e3)


def feasible(twist: Twist2D, v: float, omega: float) -> SpeedProfile:
    """Ramps towards the given speeds, as far as one period allows."""
    period, steps = SPEC.decision_period, SPEC.substeps
    return SpeedProfile(
        ramp(twist.v, v, SPEC.max_acceleration, period, steps),
        ramp(twist.omega, omega, SPEC.max_yaw_acceleration, period, steps),
    )


@pytest.mark.parametrize("seed", range(4))
def test_feasible_drives_are_tracked(seed: int) -> None:
    """Speeds drawn anew every 0.8 s over the whole range, with the steepest ramps between them."""
    rng = np.random.default_rng(seed)
    simulation = EpisodeSimulation(OPEN, 0)
    twist, misses, slips = Twist2D(0.0, 0.0), [], []
    for k in range(200):
        if k % 8 == 0:
            v, omega = rng.uniform(-1, 1, 2) * (SPEC.max_speed, SPEC.max_yaw_rate)
        pose = simulation.pose
        dx, dy = centre_displacement(pose.yaw, feasible(twist, v, omega), SPEC)
        target = (pose.x + dx, pose.y + dy)
        twist = drive_towards(target, pose, twist, SPEC).final
        block = simulation.drive(target)
        misses.append(hypot(simulation.pose.x - target[0], simulation.pose.y - target[1]))
        slips.append(block.slip.max())
    assert np.sqrt(np.mean(np.square(misses))) < 5e-3
    assert max(misses) < 10e-3
    assert max(slips) < 0.1


def lap(v: float, radius: float) -> FloatArray:
    """(n, 2) places on one lap, each next position taken on the circle about (0, radius)."""
    simulation = EpisodeSimulation(OPEN, 0)
    rows = []
    for _ in range(round(2 * pi * radius / (v * SPEC.decision_period)) + 20):
        pose = simulation.pose
        angle = atan2(pose.y - radius, pose.x) + v * SPEC.decision_period / radius
        block = simulation.drive((radius * cos(angle), radius + radius * sin(angle)))
        rows.append(block.poses[:, :2])
    return np.concatenate(rows[20:])


@pytest.mark.parametrize(
    ("v", "radius"), [(0.5, 0.5), (0.5, 1.0), (0.5, 0.25), (0.3, 0.2), (0.2, 0.3), (0.1, 0.1)]
)
def test_radius_of_a_circle_of_next_positions(v: float, radius: float) -> None:
    off = np.hypot(*(lap(v, radius) - (0.0, radius)).T) / radius - 1.0
    assert np.abs(off).max() < 0.02


@pytest.mark.parametrize(("v", "omega"), [(0.5, 1.0), (0.4, -2.0), (-0.3, 1.5), (0.5, 0.4)])
def test_radius_of_steady_speeds(v: float, omega: float) -> None:
    """Next positions that steady speeds would reach: the wheels' droop is not corrected for."""
    simulation = EpisodeSimulation(OPEN, 0)
    twist, rows = Twist2D(0.0, 0.0), []
    for _ in range(round(2 * pi / abs(omega) / SPEC.decision_period) + 10):
        pose = simulation.pose
        profile = feasible(twist, v, omega)
        dx, dy = centre_displacement(pose.yaw, profile, SPEC)
        rows.append(simulation.drive((pose.x + dx, pose.y + dy)).poses[:, :2])
        twist = profile.final
    xy = np.concatenate(rows[10:])
    table = np.column_stack((2 * xy, np.ones(len(xy))))
    x, y, rest = np.linalg.lstsq(table, (xy**2).sum(axis=1), rcond=None)[0]
    expected = hypot(v / omega, SPEC.axle_offset)
    assert np.sqrt(rest + x * x + y * y) == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("degrees", [0, 15, 40, 90, 140, 180])
def test_far_action_is_approached_on_the_straight_line(degrees: float) -> None:
    c, s = cos(np.radians(degrees)), sin(np.radians(degrees))
    simulation = EpisodeSimulation(OPEN, 0)
    way = np.concatenate([simulation.drive((3 * c, 3 * s)).poses[:, :2] for _ in range(75)])
    assert np.abs(way @ (-s, c)).max() < 0.04
    assert hypot(way[-1, 0] - 3 * c, way[-1, 1] - 3 * s) < 0.07
