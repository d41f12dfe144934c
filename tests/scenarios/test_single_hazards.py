"""What the library's worlds of one hazard each promise, and that a good robot can keep it."""

import math

import numpy as np
import pytest
import shapely
import shapely.affinity
from shapely import LineString, Point, Polygon

from fuzzynav_mj.oracle import assess
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios import library_names, load_scenario
from fuzzynav_mj.scenarios.motion import Mover, RouteMotion
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.world import World, make_world
from fuzzynav_mj.shortest_path import shortest_path
from fuzzynav_mj.types import FloatArray

PAPER = {"concave", "convex", "maze", "narrow"}
NAMES = sorted(set(library_names()) - PAPER)
STANDING = "trap"  # the one without moving obstacles
MOVING = [name for name in NAMES if name != STANDING]
SIDE, TOP = DEFAULT_ROBOT.side, DEFAULT_ROBOT.max_speed


def world(scenario: Scenario, seed: int) -> World:
    return make_world(scenario, np.random.default_rng(seed))


def route(mover: Mover) -> RouteMotion:
    assert isinstance(mover.motion, RouteMotion)
    return mover.motion


def speeds(mover: Mover) -> FloatArray:
    motion = route(mover)
    return np.hypot(*np.diff(motion.points, axis=0).T) / np.diff(motion.times)


def ends(scenario: Scenario) -> FloatArray:
    return np.array([[scenario.start.x, scenario.start.y], scenario.goal])


def unit(vector: FloatArray) -> FloatArray:
    return np.asarray(vector / np.hypot(*vector))


def test_the_names() -> None:
    assert set(NAMES) == {
        "closing", "companion", "door", "faster", "head_on", "pursuer", "slow_ahead", "spiral",
        "swarm", "trap", "trap_movers",
    }  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_a_contact_free_run_exists(name: str) -> None:
    scenario = load_scenario(name)
    for seed in range(3):
        assert assess(world(scenario, seed), DEFAULT_ROBOT).possible_cautious


@pytest.mark.parametrize("name", MOVING)
def test_every_seed_is_another_world(name: str) -> None:
    scenario = load_scenario(name)
    places = set()
    for seed in range(50):
        movers = world(scenario, seed).movers
        places.add(tuple(tuple(m.motion.positions(np.zeros(1))[0].tolist()) for m in movers))
    assert len(places) == 50


@pytest.mark.parametrize("name", MOVING)
def test_a_robot_that_ignores_movers_is_often_hit(name: str) -> None:
    """It follows the shortest path at 0.35 m/s; its inscribed disc stands for it."""
    scenario = load_scenario(name)
    start = (scenario.start.x, scenario.start.y)
    length, path = shortest_path(scenario.static, scenario.bounds, start, scenario.goal)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    times = np.arange(0.0, length / 0.35, 0.1)
    robot = np.column_stack([np.interp(0.35 * times, along, path[:, axis]) for axis in (0, 1)])
    points = shapely.points(robot)

    def hit(mover: Mover) -> bool:
        corners = shapely.get_coordinates(mover.shape.footprint)
        bodies = shapely.polygons(corners + mover.motion.positions(times)[:, None])
        return bool(np.any(shapely.dwithin(bodies, points, DEFAULT_ROBOT.half_side)))

    seeds = range(20)
    hits = sum(any(hit(mover) for mover in world(scenario, seed).movers) for seed in seeds)
    assert hits / len(seeds) >= 0.3


@pytest.mark.parametrize("name", MOVING)
def test_scripted_movers_pass_through_nothing(name: str) -> None:
    scenario = load_scenario(name)
    arena = world(scenario, 0).free_space
    for mover in scenario.moving:
        motion = route(mover)
        for x, y in motion.positions(np.linspace(0.0, motion.period, 300)):
            assert arena.covers(shapely.affinity.translate(mover.shape.footprint, x, y))


@pytest.mark.parametrize("name", ["trap", "trap_movers"])
def test_trap_is_deep_and_the_line_runs_into_its_bottom(name: str) -> None:
    scenario = load_scenario(name)
    (shape,) = scenario.static
    pocket = shape.footprint.convex_hull - shape.footprint
    assert pocket.equals(shapely.box(2.6, 2.8, 5.2, 5.2))
    depth, sight = 5.2 - 2.6, DEFAULT_ROBOT.sensor_range
    assert depth > 3 * sight
    line = LineString(ends(scenario))
    assert line.intersection(pocket).length > depth
    assert line.intersection(shape.footprint).bounds[0] == pytest.approx(5.2)


def test_trap_movers_roam_in_and_around_the_trap_and_one_crosses_its_mouth() -> None:
    scenario = load_scenario("trap_movers")
    assert [shape.polygon.tolist() for shape in scenario.static if shape.polygon is not None] == [
        shape.polygon.tolist()
        for shape in load_scenario("trap").static
        if shape.polygon is not None
    ]
    inside, below, above = (Polygon(spec.region) for spec in scenario.random_moving)
    assert shapely.box(2.6, 2.8, 5.2, 5.2).covers(inside)
    assert below.bounds[3] <= 2.6 and above.bounds[1] >= 5.4
    crossing = LineString(route(scenario.moving[0]).points)
    assert crossing.crosses(LineString(ends(scenario))) and crossing.bounds[0] < 2.6


def test_spiral_winds_once_and_a_quarter_around_its_goal_in_corridors_a_metre_wide() -> None:
    scenario = load_scenario("spiral")
    _, path = shortest_path(
        scenario.static, scenario.bounds, (scenario.start.x, scenario.start.y), scenario.goal
    )
    bearings = np.unwrap(np.arctan2(*(path[:-1] - scenario.goal).T[::-1]))
    assert bearings[-1] - bearings[0] > 2.5 * math.pi
    free = world(scenario, 0).free_space
    assert free.buffer(-0.5 + 1e-6).buffer(0.5, join_style="mitre").buffer(1e-4).covers(free)
    assert len(scenario.moving) == 3


def test_door_is_too_narrow_for_the_mover_and_the_robot_at_once() -> None:
    scenario = load_scenario("door")
    below, above = (shape.footprint for shape in scenario.static)
    door = shapely.shortest_line(below, above)
    assert 0.6 <= door.length <= 0.9
    (mover,) = scenario.moving
    way = LineString(route(mover).points)
    assert way.crosses(door)
    assert door.length - 2 * mover.shape.radius < 2 * SIDE
    assert way.intersection(door).distance(below) - mover.shape.radius < SIDE
    assert way.intersection(door).distance(above) - mover.shape.radius < SIDE


def test_head_on_movers_come_along_the_line_at_top_speed_on_one_route() -> None:
    scenario = load_scenario("head_on")
    towards = unit(ends(scenario)[0] - ends(scenario)[1])
    assert len(scenario.moving) == 4
    for mover in scenario.moving:
        np.testing.assert_allclose(speeds(mover), TOP)
        first, second = route(mover).points[:2]
        np.testing.assert_allclose(unit(second - first), towards)
        assert LineString(ends(scenario)).distance(LineString([first, second])) == 0.0
        np.testing.assert_array_equal(route(mover).points, route(scenario.moving[0]).points)


def test_swarm_crosses_the_line_at_right_angles() -> None:
    scenario = load_scenario("swarm")
    line = ends(scenario)
    assert len(scenario.moving) == 8
    assert len({float(speeds(mover)[0]) for mover in scenario.moving}) >= 6
    for mover in scenario.moving:
        first, second = route(mover).points
        assert unit(second - first) @ unit(line[1] - line[0]) == pytest.approx(0.0)
        assert LineString([first, second]).crosses(LineString(line))


def test_slow_obstacle_ahead_leaves_room_on_either_side() -> None:
    scenario = load_scenario("slow_ahead")
    (mover,) = scenario.moving
    first, second = route(mover).points
    ahead = ends(scenario)[1] - ends(scenario)[0]
    np.testing.assert_allclose(unit(second - first), unit(ahead))
    assert speeds(mover)[0] < TOP / 2
    beside = scenario.bounds[3] / 2 - mover.shape.radius
    assert first[1] == scenario.bounds[3] / 2
    assert beside > 2 * DEFAULT_ROBOT.half_diagonal + 0.2


def test_three_obstacles_close_in_on_a_point_of_the_line_from_three_sides() -> None:
    scenario = load_scenario("closing")
    point = np.array([3.0, 3.0])
    assert LineString(ends(scenario)).distance(Point(point)) == 0.0
    sides = []
    for mover in scenario.moving:
        far, near = route(mover).points - point
        assert np.hypot(*near) < 0.2 < 1.2 < np.hypot(*far)
        np.testing.assert_allclose(unit(near), unit(far), atol=0.05)
        sides.append(math.degrees(math.atan2(far[1], far[0])) % 360.0)
    np.testing.assert_allclose(sorted(sides), [90.0, 210.0, 330.0], atol=1.0)


def test_companion_keeps_between_the_robot_and_its_goal() -> None:
    """Of a robot that drives ahead at top speed, as long as both have room to."""
    scenario = load_scenario("companion")
    (mover,) = scenario.moving
    np.testing.assert_allclose(speeds(mover), TOP)
    assert scenario.start.yaw == 0.0 and scenario.random_phases == frozenset()
    times = np.linspace(0.0, 8.0, 50)
    for time, (x, y) in zip(times, mover.motion.positions(times), strict=True):
        body = shapely.affinity.translate(mover.shape.footprint, x, y)
        robot = Point(scenario.start.x + TOP * time, scenario.start.y)
        assert body.distance(robot) < DEFAULT_ROBOT.sensor_range
        assert body.bounds[0] < robot.x < body.bounds[2]
        assert robot.y < y < scenario.goal[1]


def test_pursuers_come_from_behind_at_the_robot_s_top_speed() -> None:
    scenario = load_scenario("pursuer")
    line = ends(scenario)
    for mover in scenario.moving:
        np.testing.assert_allclose(speeds(mover), TOP)
        first, second = route(mover).points[:2]
        np.testing.assert_allclose(unit(second - first), unit(line[1] - line[0]))
        assert first[1] == line[0, 1] and first[0] < line[0, 0] - 0.7
        assert second[0] > line[0, 0] + 2.0
        assert LineString(route(mover).points).intersection(LineString(line)).length > 4.5
    assert scenario.random_phases == {1, 2}  # the first is behind the robot for every seed
    assert route(scenario.moving[0]).phase == 0.0
    assert LineString(line).crosses(scenario.static[0].footprint)  # what makes the robot slow down


def test_faster_obstacles_are_half_as_fast_again_as_the_robot() -> None:
    scenario = load_scenario("faster")
    assert scenario.allow_faster
    (spec,) = scenario.random_moving
    assert spec.speed == (1.5 * TOP, 1.5 * TOP)
    others = [load_scenario(name) for name in NAMES if name != "faster"]
    assert not any(other.allow_faster for other in others)
