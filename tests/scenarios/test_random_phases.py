"""Phases that are drawn for every seed."""

import numpy as np
import pytest
import shapely
from shapely.affinity import translate

from fuzzynav_mj.errors import ScenarioError
from fuzzynav_mj.geometry import footprint
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.loading import parse_scenario
from fuzzynav_mj.scenarios.motion import RouteMotion
from fuzzynav_mj.scenarios.random_movers import START_GAP
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.world import World, make_world
from fuzzynav_mj.types import FloatArray

HEAD = """\
schema = 1
name = "phases"
bounds = [0.0, 0.0, 10.0, 10.0]
[robot]
start = [1.0, 1.0, 0.3]
goal = [9.0, 9.0]
"""
SHUTTLE = '[[moving]]\ncircle = 0.2\nwaypoints = [[2, 8], [6, 8]]\nspeed = 0.5\nphase = "random"\n'


def parse(*tables: str) -> Scenario:
    return parse_scenario((HEAD + "\n".join(tables)).encode(), "phases.toml")


def worlds(scenario: Scenario, count: int) -> list[World]:
    return [make_world(scenario, np.random.default_rng(seed)) for seed in range(count)]


def phases(scenario: Scenario, index: int, count: int = 400) -> FloatArray:
    """Phases that `count` seeds give to one scripted obstacle."""
    motions = [world.movers[index].motion for world in worlds(scenario, count)]
    assert all(isinstance(motion, RouteMotion) for motion in motions)
    return np.array([motion.phase for motion in motions])  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("route", "first", "period"),
    [
        ("waypoints = [[2, 8], [6, 8]]\nspeed = 0.5", 0.0, 16.0),  # there and back
        ('waypoints = [[2, 8], [6, 8]]\nspeed = 0.5\nrepeat = "loop"', 0.0, 16.0),
        ('waypoints = [[2, 8], [6, 8]]\nspeed = 0.5\nrepeat = "once"', 0.0, 8.0),
        ('keyframes = [[3, 2, 8], [9, 6, 8]]\nrepeat = "once"', 3.0, 6.0),
        ("keyframes = [[3, 2, 8], [9, 6, 8]]", 3.0, 12.0),
    ],
)
def test_phase_is_uniform_over_one_period(route: str, first: float, period: float) -> None:
    drawn = phases(parse(f'[[moving]]\ncircle = 0.2\nphase = "random"\n{route}'), 0)
    assert first <= drawn.min() and drawn.max() < first + period
    counts, _ = np.histogram(drawn, 8, (first, first + period))
    assert counts.sum() == 400
    assert ((counts - 50) ** 2 / 50).sum() < 24.3  # chi squared, 7 degrees of freedom, 0.1 %


def test_phases_of_one_file_are_independent_and_repeat_with_the_seed() -> None:
    scenario = parse(SHUTTLE, SHUTTLE)
    first, second = phases(scenario, 0), phases(scenario, 1)
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.2
    assert len(np.unique(np.concatenate([first, second]))) == 800
    np.testing.assert_array_equal(first, phases(scenario, 0))


def test_only_those_that_ask_for_it_get_a_phase() -> None:
    fixed = SHUTTLE.replace('"random"', "2.5")
    scenario = parse(fixed, SHUTTLE, fixed)
    assert scenario.random_phases == {1}
    for world in worlds(scenario, 3):
        assert world.movers[::2] == scenario.moving[::2]
        assert world.movers[1].shape is scenario.moving[1].shape


def test_drawn_obstacles_stay_the_same_without_random_phases() -> None:
    roaming = """[[random_moving]]
count = [3, 3]
radius = [0.1, 0.2]
speed = [0.1, 0.5]
region = [[3, 3], [9, 3], [9, 9], [3, 9]]
"""
    fixed = SHUTTLE.replace('"random"', "0.0")
    times = np.linspace(0.0, 9.0, 4)
    for with_fixed, alone in zip(
        worlds(parse(fixed, roaming), 3), worlds(parse(roaming), 3), strict=True
    ):
        for one, other in zip(with_fixed.movers[1:], alone.movers, strict=True):
            np.testing.assert_array_equal(
                one.motion.positions(times), other.motion.positions(times)
            )


def test_at_time_zero_it_is_a_metre_from_the_robot_even_if_its_route_is_not() -> None:
    across_start = (
        "[[moving]]\npolygon = [[-0.3, -0.1], [0.3, -0.1], [0.3, 0.1], [-0.3, 0.1]]\n"
        'waypoints = [[0.4, 1.0], [5.0, 1.0]]\nspeed = 0.5\nphase = "random"\n'
    )
    scenario = parse(across_start)
    robot = footprint(scenario.start, DEFAULT_ROBOT.half_side)
    places = []
    for world in worlds(scenario, 200):
        (mover,) = world.movers
        x, y = mover.motion.positions(np.zeros(1))[0]
        assert robot.distance(translate(mover.shape.footprint, x, y)) >= START_GAP
        places.append(x)
    nearest = 1.0 + shapely.bounds(robot)[2] - 1.0 + START_GAP + 0.3
    assert nearest - 0.01 < min(places) < nearest + 0.15  # and no farther than need be
    assert max(places) > 4.9


def test_a_motion_that_stays_at_the_start_is_an_error() -> None:
    scenario = parse(SHUTTLE.replace("[[2, 8], [6, 8]]", "[[1.0, 1.5], [1.5, 1.0]]"))
    with pytest.raises(ScenarioError) as caught:
        make_world(scenario, np.random.default_rng(0))
    assert str(caught.value) == (
        "phases.toml: moving.0.phase: given 'random' for a motion that was found at no time away "
        "from the robot's start; allowed a motion that takes the obstacle 1.0 m away from it"
    )


def test_an_obstacle_without_speed_stands_where_its_route_begins() -> None:
    (world,) = worlds(parse(SHUTTLE.replace("speed = 0.5", "speed = 0.0")), 1)
    np.testing.assert_array_equal(
        world.movers[0].motion.positions(np.array([0.0, 9.0])), 2 * [[2, 8]]
    )


@pytest.mark.parametrize("given", ['"Random"', "true", "[1.0]", "nan"])
def test_message(given: str) -> None:
    shown = {'"Random"': "'Random'"}.get(given, given)
    with pytest.raises(ScenarioError) as caught:
        parse(SHUTTLE.replace('"random"', given))
    assert str(caught.value) == (
        f"phases.toml: moving.0.phase: given {shown}; allowed a number (s) or 'random'"
    )


def test_keyframes_are_taken_as_they_are_however_fast() -> None:
    """Only `speed` is held against the robot's top speed."""
    scenario = parse("[[moving]]\ncircle = 0.2\nkeyframes = [[0, 2, 8], [1, 4, 8]]\n")
    assert not scenario.allow_faster
