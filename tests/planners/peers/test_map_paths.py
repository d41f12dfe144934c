"""Paths on a map: clear of obstacles, not shorter than the shortest, same seed same path."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import shapely

from fuzzynav_mj.episode import static_map
from fuzzynav_mj.planners.peers.free_space import FreeSpace, free_space
from fuzzynav_mj.planners.peers.path_following import RADIUS
from fuzzynav_mj.planners.peers.paths import PathMethod, length, shortened
from fuzzynav_mj.planners.peers.prm import Prm
from fuzzynav_mj.planners.peers.rrt import Rrt
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.world import World
from fuzzynav_mj.shortest_path import shortest_path
from fuzzynav_mj.types import FloatArray

WORLDS = ["concave", "convex", "maze", "narrow", "trap", "spiral"]
# Largest ratio to the shortest path: generous bounds of what 10 seeds gave, 1.07 and 1.30.
WORST = {Prm: 1.15, Rrt: 1.6}
ARC = 0.005  # relative: arcs are polygons inscribed in them

Method = Callable[[], PathMethod]


@cache
def world(name: str) -> tuple[Scenario, FreeSpace, FloatArray]:
    """A scenario, its free space and its start."""
    scenario = load_scenario(name)
    space = free_space(static_map(World(scenario, scenario.static, ())), scenario.goal, RADIUS)
    return scenario, space, np.array([scenario.start.x, scenario.start.y])


def planned(method: Method, name: str, seed: int = 0) -> FloatArray:
    """The path from start to goal."""
    scenario, space, start = world(name)
    planner = method()
    planner.prepare(space, np.array(scenario.goal), np.random.default_rng(seed))
    path = planner.path(space, start)
    assert path is not None
    return path


@pytest.mark.parametrize("name", WORLDS)
@pytest.mark.parametrize("method", [Prm, Rrt])
def test_a_path_is_clear_and_not_shorter_than_the_shortest(method: Method, name: str) -> None:
    scenario, _, start = world(name)
    path = planned(method, name)
    assert path[0].tolist() == start.tolist()
    assert path[-1].tolist() == list(scenario.goal)
    line = shapely.LineString(path)
    gaps = [shapely.distance(line, shape.footprint) for shape in scenario.static]
    gaps.append(shapely.distance(line, shapely.box(*scenario.bounds).exterior))
    assert min(gaps) >= RADIUS * (1 - 2 * ARC)
    bounds = scenario.bounds if scenario.walls else None
    ends = (scenario.start.x, scenario.start.y), scenario.goal
    shortest = shortest_path(scenario.static, bounds, *ends, RADIUS)[0]
    assert (1 - ARC) * shortest <= length(path) <= WORST[method] * shortest


@pytest.mark.parametrize("method", [Prm, Rrt])
def test_same_seed_same_path_alone_or_after_others(method: Method) -> None:
    scenario, space, start = world("concave")
    alone = planned(method, "concave", 3)
    planned(method, "maze", 4)
    assert planned(method, "concave", 3).tobytes() == alone.tobytes()
    assert planned(method, "concave", 4).tobytes() != alone.tobytes()
    used = method()
    used.prepare(space, np.array(scenario.goal), np.random.default_rng(9))
    used.path(space, start)
    used.prepare(space, np.array(scenario.goal), np.random.default_rng(3))
    again = used.path(space, start)
    assert again is not None
    assert again.tobytes() == alone.tobytes()


def square(x_min: float, y_min: float, x_max: float, y_max: float) -> FloatArray:
    """Corners of a rectangle."""
    return np.array([[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]])


DOORS = free_space(
    [
        square(0, 0, 4, 4),
        square(1.9, 0, 2.1, 1),
        square(1.9, 1.6, 2.1, 3),
        square(1.9, 3.6, 2.1, 4),
    ],
    (3.5, 1.3),
    RADIUS,
)
LOWER_DOOR = np.column_stack((np.full(7, 2.0), np.linspace(1.0, 1.6, 7)))
UPPER_DOOR = LOWER_DOOR + np.array([0.0, 2.0])


@pytest.mark.parametrize("method", [Prm, Rrt])
def test_temporary_obstacles_are_gone_around_and_then_forgotten(method: Method) -> None:
    """Two doors: the nearer one, the other one if that is shut, none if both are shut."""
    start = np.array([0.5, 1.3])
    planner = method()
    planner.prepare(DOORS, np.array([3.5, 1.3]), np.random.default_rng(0))

    def door(space: FreeSpace) -> float | None:
        path = planner.path(space, start)
        if path is None:
            return None
        return float(shapely.LineString(path).intersection(shapely.LineString([(2, 0), (2, 4)])).y)

    assert door(DOORS.without(UPPER_DOOR)) == pytest.approx(1.3, abs=0.16)
    assert door(DOORS.without(LOWER_DOOR)) == pytest.approx(3.3, abs=0.16)
    assert door(DOORS.without(np.vstack((LOWER_DOOR, UPPER_DOOR)))) is None
    assert door(DOORS.without(UPPER_DOOR)) == pytest.approx(1.3, abs=0.16)


def test_the_outline_around_the_goal_is_free_inside() -> None:
    inside, outside = np.array([[1.0, 1.0]]), np.array([[5.0, 1.0]])
    assert DOORS.holds(inside)[0]
    assert not DOORS.holds(outside)[0]
    open_world = free_space([square(1.9, 0, 2.1, 1)], (3.5, 1.3), RADIUS)
    assert not open_world.holds(np.array([[2.0, 0.5]]))[0]
    assert open_world.holds(np.array([[2.0, 1.0 + RADIUS + 0.01], [2.0, -0.5]])).all()
    assert not open_world.holds(np.array([[2.0, 1.0 + RADIUS - 0.01]]))[0]


def test_the_nearest_free_place() -> None:
    """Beside a wall it lies as far from it as the radius, else where one is."""
    assert DOORS.nearest(np.array([1.0, 1.0])).tolist() == [1.0, 1.0]
    moved = DOORS.nearest(np.array([0.05, 2.0]))
    assert moved == pytest.approx([RADIUS, 2.0], abs=5e-3)
    assert DOORS.holds(moved[None])[0]


def test_hits_on_the_map_are_told_from_others() -> None:
    on_the_map = np.array([[1.9, 0.5], [0.0, 2.0], [2.0, 1.02]])
    strange = np.array([[1.0, 1.0], [2.0, 1.3]])
    assert DOORS.unmapped(np.vstack((on_the_map, strange)), 0.03).tolist() == strange.tolist()
    nowhere = free_space([], (1.0, 1.0), RADIUS)
    assert nowhere.unmapped(strange, 0.03).tolist() == strange.tolist()


def test_shortening_keeps_the_ends_and_never_lengthens() -> None:
    zigzag = np.array([[0.5, 0.5], [0.6, 3.4], [1.0, 0.5], [1.5, 1.3], [3.5, 1.3]])
    rng = np.random.default_rng(0)
    shorter = shortened(zigzag, DOORS, rng)
    assert shorter[[0, -1]].tolist() == zigzag[[0, -1]].tolist()
    assert length(shorter) < 0.5 * length(zigzag)
    assert DOORS.joins(shorter[:-1], shorter[1:]).all()


@pytest.mark.parametrize("name", ["concave", "maze"])
@pytest.mark.parametrize("kind", ["PRM", "RRT"])
def test_paths_are_as_long_as_those_of_ompl(name: str, kind: str) -> None:
    """The open motion planning library, which draws from clocks and global state, as a witness."""
    base = pytest.importorskip("ompl.base")
    geometric = pytest.importorskip("ompl.geometric")
    scenario, space, start = world(name)
    plane = base.RealVectorStateSpace(2)
    limits = base.RealVectorBounds(2)
    for axis in (0, 1):
        limits.setLow(axis, space.bounds[axis])
        limits.setHigh(axis, space.bounds[2 + axis])
    plane.setBounds(limits)
    setup = geometric.SimpleSetup(plane)
    setup.setStateValidityChecker(lambda at: bool(space.holds(np.array([[at[0], at[1]]]))[0]))
    setup.getSpaceInformation().setStateValidityCheckingResolution(0.002)
    ends = []
    for x, y in (start, scenario.goal):
        state = plane.allocState()
        state[0], state[1] = float(x), float(y)
        ends.append(state)
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(getattr(geometric, kind)(setup.getSpaceInformation()))
    assert setup.solve(1.0)
    setup.simplifySolution(0.5)
    theirs = setup.getSolutionPath().length()
    method: Method = {"PRM": Prm, "RRT": Rrt}[kind]
    ours = np.mean([length(planned(method, name, seed)) for seed in range(3)])
    assert 0.6 * theirs <= ours <= 1.3 * theirs
