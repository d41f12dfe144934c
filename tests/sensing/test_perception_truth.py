"""What perception must achieve, measured on the simulated truth.

The worlds are not those that its settings were chosen on.
"""

from dataclasses import replace

import numpy as np
import pytest
from ground_truth import SETTLED, Tally, judge, rover, weaver

from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.scenarios.loading import parse_scenario

CROWDED = parse_scenario(
    b"""
schema = 1
name = "crowded"
description = "Ten movers, circles and polygons, among three static obstacles."
bounds = [0.0, 0.0, 8.0, 8.0]
time_limit = 60.0
[robot]
start = [4.0, 4.0, 0.0]
goal = [7.5, 7.5]
[[static]]
circle = [2.0, 6.0, 0.3]
[[static]]
polygon = [[5.5, 5.5], [6.0, 5.3], [6.3, 6.0], [5.7, 6.2]]
[[static]]
polygon = [[2.0, 1.5], [2.8, 1.5], [2.8, 2.3], [2.5, 2.3], [2.5, 1.8], [2.0, 1.8]]
[[random_moving]]
count = [10, 10]
radius = [0.12, 0.25]
vertices = [3, 8]
concave_fraction = 0.3
speed = [0.15, 0.5]
region = [[0.3, 0.3], [7.7, 0.3], [7.7, 7.7], [0.3, 7.7]]
""",
    "crowded",
)


@pytest.fixture(scope="module")
def roving() -> Tally:
    """A robot that drives through the worlds at full speed, round what it meets."""
    tally = Tally()
    worlds = [(load_scenario(name), 4) for name in ("convex", "concave", "maze")]
    for scenario, episodes in [*worlds, (CROWDED, 8)]:
        for seed in range(7200, 7200 + episodes):
            judge(scenario, seed, rover(np.random.default_rng(seed), scenario.bounds), 110, tally)
    return tally


@pytest.fixture(scope="module")
def weaving() -> Tally:
    """A robot that drives a slalom at full speed, heedless of what is in its way."""
    tally = Tally()
    for seed in range(7300, 7326):
        judge(CROWDED, seed, weaver(turn_rate=2.0, period=6), 80, tally)
    return tally


@pytest.fixture(params=["roving", "weaving"])
def tally(request: pytest.FixtureRequest) -> Tally:
    found: Tally = request.getfixturevalue(request.param)
    return found


def test_the_robot_really_drives_at_full_speed_and_turns(roving: Tally, weaving: Tally) -> None:
    for tally, fast, turning in ((roving, 0.6, 0.15), (weaving, 0.9, 0.5)):
        v, omega = np.abs(np.array(tally.robot_speeds)).T
        assert (v > 0.9 * DEFAULT_ROBOT.max_speed).mean() > fast
        assert (omega > 1.0).mean() > turning


def test_static_points_are_not_called_dynamic(tally: Tally) -> None:
    assert tally.static_points > 3_000
    assert tally.called_dynamic <= 0.03 * tally.static_points


def test_movers_are_recognised_soon(roving: Tally, weaving: Tally) -> None:
    """Within 0.4 s of coming into sight."""
    assert SETTLED == 0.4
    entries = roving.entries + weaving.entries
    assert entries > 30
    assert roving.recognised + weaving.recognised >= 0.9 * entries


def test_movers_stay_recognised(tally: Tally) -> None:
    assert tally.settled_looks > 100
    assert tally.still_dynamic >= 0.9 * tally.settled_looks


def test_velocities(tally: Tally) -> None:
    assert np.median(tally.velocity_errors) <= 0.06


def test_counts_mostly_say_what_the_velocity_says(tally: Tally) -> None:
    """Of the quarters that show one mover alone, coming or going at more than 0.1 m/s.

    The counts err where a mover's visible side widens or narrows as it passes.
    """
    approach, growth = np.array(tally.approach), np.array(tally.growth)
    telling = (np.abs(approach) > 0.1) & (growth != 0)
    assert telling.sum() > 50
    assert (np.sign(growth) == np.sign(approach))[telling].mean() > 0.65


def test_a_world_at_rest_is_seen_at_rest() -> None:
    at_rest = replace(CROWDED, random_moving=())
    tally = Tally()
    judge(at_rest, 0, weaver(turn_rate=2.5, period=8), 60, tally)
    narrow = load_scenario("narrow")
    judge(narrow, 0, rover(np.random.default_rng(0), narrow.bounds), 150, tally)
    assert tally.static_points > 3_000
    assert tally.called_dynamic <= 0.001 * tally.static_points
