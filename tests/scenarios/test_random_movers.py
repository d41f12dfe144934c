"""Laws of the drawn obstacles, in the library's worlds and in tight ones."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from fuzzynav_mj.errors import ScenarioError
from fuzzynav_mj.geometry import footprint, is_convex, is_simple_polygon, signed_area
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.scenarios.motion import ClosedCurveMotion, Mover
from fuzzynav_mj.scenarios.random_movers import MARGIN, START_GAP, draw_polygon
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.scenarios.world import World, make_world
from fuzzynav_mj.shortest_path import shortest_path
from fuzzynav_mj.types import FloatArray

NAMES = ("concave", "convex", "maze", "narrow")
SEEDS = range(12)

each_world = pytest.mark.parametrize("name", NAMES)


@cache
def world(name: str, seed: int) -> World:
    return make_world(load_scenario(name), np.random.default_rng(seed))


def closed_curve(mover: Mover) -> ClosedCurveMotion:
    assert isinstance(mover.motion, ClosedCurveMotion)
    return mover.motion


def period(mover: Mover) -> float:
    return closed_curve(mover).length / abs(closed_curve(mover).speed)


def swept_discs(mover: Mover) -> BaseGeometry:
    """The area within the mover's circumscribed radius of its curve."""
    course = mover.motion.positions(np.linspace(0.0, period(mover), 400))
    return shapely.linestrings(course).buffer(mover.shape.radius)


@each_world
def test_swept_area_keeps_clear_of_statics_and_walls_inside_a_region(name: str) -> None:
    for seed in SEEDS:
        drawn = world(name, seed)
        x_min, y_min, x_max, y_max = drawn.scenario.bounds
        arena = shapely.box(x_min, y_min, x_max, y_max)
        regions = [Polygon(spec.region) for spec in drawn.scenario.random_moving]
        for mover in drawn.movers:
            swept = swept_discs(mover)
            assert swept.distance(drawn.static_union) >= MARGIN - 1e-3
            assert swept.distance(arena.exterior) >= MARGIN - 1e-3
            assert arena.contains(swept)
            assert any(region.contains(swept) for region in regions)


@each_world
def test_at_time_zero_every_mover_is_a_metre_from_the_robot(name: str) -> None:
    for seed in SEEDS:
        drawn = world(name, seed)
        robot = footprint(drawn.scenario.start, DEFAULT_ROBOT.half_side)
        for mover in drawn.movers:
            at_zero = mover.motion.positions(np.zeros(1))
            assert mover.shape.polygon is not None
            assert robot.distance(Polygon(mover.shape.polygon + at_zero)) >= START_GAP


@each_world
def test_counts_radii_corners_and_speeds_stay_in_their_ranges(name: str) -> None:
    specs = load_scenario(name).random_moving
    for seed in SEEDS:
        movers = world(name, seed).movers
        assert sum(s.count[0] for s in specs) <= len(movers) <= sum(s.count[1] for s in specs)
        for mover in movers:
            assert mover.shape.polygon is not None
            radius, speed = mover.shape.radius, abs(closed_curve(mover).speed)
            corners = len(mover.shape.polygon)
            assert any(
                s.radius[0] <= radius * (1 + 1e-9)
                and radius <= s.radius[1] * (1 + 1e-9)
                and s.speed[0] <= speed <= s.speed[1]
                and s.vertices[0] <= corners <= s.vertices[1]
                for s in specs
            )


@each_world
def test_speed_is_constant_and_acceleration_bounded(name: str) -> None:
    step = 0.005
    for seed in SEEDS:
        for mover in world(name, seed).movers:
            course = mover.motion.positions(np.arange(0.0, period(mover) + 2 * step, step))
            velocity = np.diff(course, axis=0) / step
            speeds = np.hypot(*velocity.T)
            np.testing.assert_allclose(speeds, abs(closed_curve(mover).speed), rtol=0.01)
            assert np.hypot(*np.diff(velocity, axis=0).T).max() / step <= 1.0


@each_world
def test_motion_is_periodic(name: str) -> None:
    for mover in world(name, 0).movers:
        times = np.linspace(0.0, 30.0, 50)
        again = mover.motion.positions(times + 3 * period(mover))
        np.testing.assert_allclose(again, mover.motion.positions(times), atol=1e-9)


@each_world
def test_same_seed_same_world_and_other_seed_other_world(name: str) -> None:
    scenario = load_scenario(name)
    times = np.linspace(0.0, 20.0, 5)

    def places(seed: int) -> FloatArray:
        drawn = make_world(scenario, np.random.default_rng(seed))
        return np.concatenate([mover.motion.positions(times) for mover in drawn.movers])

    np.testing.assert_array_equal(places(3), places(3))
    assert not np.array_equal(places(3)[:5], places(4)[:5])


@each_world
def test_both_senses_of_turning_and_both_kinds_of_polygon_occur(name: str) -> None:
    movers = [mover for seed in SEEDS for mover in world(name, seed).movers]
    assert {np.sign(closed_curve(mover).speed) for mover in movers} == {-1.0, 1.0}
    convex = [is_convex(m.shape.polygon) for m in movers if m.shape.polygon is not None]
    assert 0.5 < np.mean(convex) < 0.9  # 70 % by the files


@each_world
def test_a_robot_that_ignores_movers_is_often_hit(name: str) -> None:
    """It follows the shortest path at 0.45 m/s; its inscribed disc stands for it."""
    scenario = load_scenario(name)
    start = (scenario.start.x, scenario.start.y)
    length, path = shortest_path(scenario.static, scenario.bounds, start, scenario.goal)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    times = np.arange(0.0, length / 0.45, 0.1)
    robot = np.column_stack([np.interp(0.45 * times, along, path[:, axis]) for axis in (0, 1)])
    discs = shapely.buffer(shapely.points(robot), DEFAULT_ROBOT.half_side)

    def hit(mover: Mover) -> bool:
        assert mover.shape.polygon is not None
        course = mover.motion.positions(times)
        bodies = shapely.polygons(mover.shape.polygon + course[:, None])
        return bool(np.any(shapely.intersects(bodies, discs)))

    seeds = range(24)
    hits = sum(any(hit(mover) for mover in world(name, seed).movers) for seed in seeds)
    assert hits / len(seeds) >= 0.4


@given(st.integers(0, 2**32 - 1), st.integers(3, 8), st.integers(0, 24), st.booleans())
def test_drawn_polygons(seed: int, low: int, more: int, concave: bool) -> None:
    high = max(low + more, 4 if concave else 3)
    polygon = draw_polygon((low, high), concave, 0.2, np.random.default_rng(seed))
    assert low <= len(polygon) <= high
    assert is_simple_polygon(polygon)
    assert signed_area(polygon) > 0
    assert is_convex(polygon) is not concave
    assert np.hypot(*polygon.T).max() == pytest.approx(0.2)
    assert Polygon(polygon).contains(shapely.Point(0.0, 0.0))


def with_spec(**changes: object) -> World:
    scenario = load_scenario("convex")
    spec = replace(scenario.random_moving[0], **changes)  # type: ignore[arg-type]
    return make_world(replace(scenario, static=(), random_moving=(spec,)), np.random.default_rng(0))


def test_a_tight_region_bounds_the_speed_that_is_drawn() -> None:
    strip = np.array([[2.0, 4.0], [8.0, 4.0], [8.0, 4.6], [2.0, 4.6]])
    drawn = with_spec(region=strip, count=(8, 8), radius=(0.1, 0.1), speed=(0.1, 0.5))
    width = 0.6 - 2 * (0.1 + MARGIN)
    for mover in drawn.movers:
        assert closed_curve(mover).speed ** 2 / (width / 2) <= 1.0


def test_standing_movers_are_possible() -> None:
    for mover in with_spec(speed=(0.0, 0.0)).movers:
        course = mover.motion.positions(np.array([0.0, 50.0]))
        np.testing.assert_array_equal(course[0], course[1])


def test_no_movers_are_possible() -> None:
    assert with_spec(count=(0, 0)).movers == ()


@pytest.mark.parametrize(
    "changes",
    [
        {"radius": (6.0, 7.0)},  # wider than the arena
        {"region": np.array([[0.5, 0.5], [1.5, 0.5], [1.5, 1.5], [0.5, 1.5]])},  # on the start
        {"region": np.array([[20.0, 0.0], [30.0, 0.0], [25.0, 9.0]])},  # out of bounds
        {"acceleration": 1e-6},
    ],
)
def test_impossible_draws_name_the_entry(changes: dict[str, object]) -> None:
    with pytest.raises(ScenarioError) as caught:
        with_spec(**changes)
    assert str(caught.value) == (
        "convex.toml: random_moving.0: given a region, radius, speed and acceleration for which no "
        "free motion was found; allowed those that leave room for a closed curve between the "
        "static obstacles, with a place on it 1.0 m away from the robot's start"
    )


def test_a_region_that_obstacles_fill_has_no_room() -> None:
    scenario = load_scenario("convex")
    block = Shape(np.array([[1.5, 0.1], [9.9, 0.1], [9.9, 9.0], [1.5, 9.0]]), None)
    inside = np.array([[2.0, 2.0], [8.0, 2.0], [8.0, 8.0], [2.0, 8.0]])
    spec = replace(scenario.random_moving[0], region=inside)
    with pytest.raises(ScenarioError, match=r"^convex\.toml: random_moving\.0: "):
        make_world(
            replace(scenario, static=(block,), random_moving=(spec,)), np.random.default_rng(0)
        )
