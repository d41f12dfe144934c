"""What the four library worlds promise, measured on their geometry."""

import math

import numpy as np
import pytest
import shapely
from shapely import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from fuzzynav_mj.geometry import is_convex
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios import library_names, load_scenario
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.scenarios.world import make_world
from fuzzynav_mj.shortest_path import shortest_path
from fuzzynav_mj.types import BoolArray, FloatArray

NAMES = ("concave", "convex", "maze", "narrow")


def solve(scenario: Scenario, extra: tuple[Shape, ...] = ()) -> tuple[float, FloatArray]:
    start = (scenario.start.x, scenario.start.y)
    return shortest_path(scenario.static + extra, scenario.bounds, start, scenario.goal)


def straight_line(scenario: Scenario) -> LineString:
    return LineString([(scenario.start.x, scenario.start.y), scenario.goal])


def footprints(scenario: Scenario) -> list[Polygon]:
    return [shape.footprint for shape in scenario.static]


def gap_between(first: BaseGeometry, second: BaseGeometry) -> LineString:
    return shapely.shortest_line(first, second)


def regions(scenario: Scenario) -> list[Polygon]:
    return [Polygon(spec.region) for spec in scenario.random_moving]


def test_library_holds_the_four_worlds_under_their_own_names() -> None:
    assert set(NAMES) <= set(library_names())
    assert all(load_scenario(name).name == name for name in library_names())


@pytest.mark.parametrize(
    ("name", "shortest", "longest", "pinned"),
    [
        ("concave", 11.5, 12.5, 11.875),
        ("convex", 11.5, 12.5, 12.108),
        ("maze", 14.5, 16.0, 14.787),
        ("narrow", 8.0, 8.8, 8.470),
    ],
)
def test_shortest_path(name: str, shortest: float, longest: float, pinned: float) -> None:
    length, _ = solve(load_scenario(name))
    assert shortest <= length <= longest
    assert length == pytest.approx(pinned, abs=1e-3)


@pytest.mark.parametrize("name", NAMES)
def test_arena_and_movers(name: str) -> None:
    scenario = load_scenario(name)
    assert scenario.bounds == (0.0, 0.0, 10.0, 10.0)
    assert scenario.walls and not scenario.allow_faster
    assert sum(spec.count[0] for spec in scenario.random_moving) >= 5
    assert sum(spec.count[1] for spec in scenario.random_moving) <= 9
    for spec in scenario.random_moving:
        assert spec.speed == (0.1, 0.5)
        assert spec.vertices == (3, 8)
        assert spec.concave_fraction == 0.3


@pytest.mark.parametrize("name", ["concave", "convex"])
def test_open_worlds_have_seven_to_nine_larger_movers(name: str) -> None:
    specs = load_scenario(name).random_moving
    assert (sum(s.count[0] for s in specs), sum(s.count[1] for s in specs)) == (7, 9)
    assert all(spec.radius == (0.12, 0.25) for spec in specs)


TIPS = ((2.69, 1.74), (3.05, 3.33))  # of the cul-de-sac's shorter and longer arm, at its mouth


def test_concave_pocket_is_deep_and_the_line_enters_its_mouth() -> None:
    scenario = load_scenario("concave")
    cul_de_sac = footprints(scenario)[0]
    pocket = cul_de_sac.convex_hull - cul_de_sac
    mouth = pocket.exterior - cul_de_sac.exterior.buffer(1e-9)
    depth = max(mouth.distance(Point(corner)) for corner in pocket.exterior.coords)
    assert depth >= 1.5
    assert depth == pytest.approx(1.638, abs=1e-3)
    line = straight_line(scenario)
    start = Point(line.coords[0])
    assert line.crosses(mouth) and line.crosses(cul_de_sac)
    # the mouth is met before anything solid, and the way in is wide enough for the robot
    assert start.distance(line.intersection(mouth)) < start.distance(line.intersection(cul_de_sac))
    assert LineString(TIPS).buffer(1e-9).covers(mouth)
    assert all(line.distance(Point(tip)) > DEFAULT_ROBOT.half_diagonal for tip in TIPS)
    # it opens to the left
    (x, y), (u, v) = TIPS
    assert math.degrees(math.atan2(u - x, y - v)) == pytest.approx(167, abs=1)


def test_concave_arms_differ_and_the_line_meets_the_longer_one_near_its_tip() -> None:
    """So that following the boundary around the tip costs little, and around the pocket much."""
    scenario = load_scenario("concave")
    cul_de_sac, line = footprints(scenario)[0], straight_line(scenario)
    shorter = LineString([TIPS[0], (2.85, 1.93), (3.69, 1.22)])  # inner sides of the two arms
    longer = LineString([TIPS[1], (4.46, 2.14)])
    assert cul_de_sac.exterior.buffer(1e-9).covers(longer)
    assert cul_de_sac.exterior.buffer(1e-9).covers(shorter)
    assert longer.length > shorter.length + 0.4
    met = line.intersection(longer)
    start = Point(line.coords[0])
    assert isinstance(met, Point)
    assert met.distance(start) == pytest.approx(cul_de_sac.intersection(line).distance(start))
    assert met.distance(Point(TIPS[1])) == pytest.approx(0.199, abs=1e-3)


def test_concave_passage_is_narrow_and_on_the_shortest_path() -> None:
    scenario = load_scenario("concave")
    hook, horseshoe = footprints(scenario)[1:3]
    passage = gap_between(hook, horseshoe)
    assert 0.40 <= passage.length <= 0.50
    length, path = solve(scenario)
    assert passage.intersects(LineString(path))
    plug = Shape(shapely.get_coordinates(passage.buffer(0.01))[:-1], None)
    assert solve(scenario, (plug,))[0] > length + 0.3
    assert all(region.distance(passage) > 0.6 for region in regions(scenario))


def test_concave_obstacles_are_concave() -> None:
    polygons = [shape.polygon for shape in load_scenario("concave").static]
    assert all(polygon is not None and not is_convex(polygon) for polygon in polygons)


def test_convex_obstacles_are_many_and_convex_and_no_two_alike() -> None:
    shapes = load_scenario("convex").static
    assert len(shapes) >= 8
    assert all(shape.polygon is None or is_convex(shape.polygon) for shape in shapes)
    signatures = set()
    for shape in shapes:
        corners = 0 if shape.polygon is None else len(shape.polygon)
        signatures.add((corners, round(shape.footprint.area, 2)))
    assert len(signatures) == len(shapes)
    assert len({corners for corners, _ in signatures}) >= 7


def test_convex_line_is_blocked_at_least_three_times_and_all_gaps_let_the_robot_pass() -> None:
    scenario = load_scenario("convex")
    obstacles = footprints(scenario)
    line = straight_line(scenario)
    assert sum(line.crosses(obstacle) for obstacle in obstacles) >= 3
    for index, obstacle in enumerate(obstacles):
        assert all(obstacle.distance(other) > 0.8 for other in obstacles[index + 1 :])


def test_maze_forces_four_turns() -> None:
    """Its free space has no loop, so that every path bends as the shortest one does."""
    scenario = load_scenario("maze")
    free = make_world(scenario, np.random.default_rng(0)).free_space
    start, goal = Point(scenario.start.x, scenario.start.y), Point(scenario.goal)
    room = free.buffer(-DEFAULT_ROBOT.half_side)
    assert isinstance(room, Polygon) and room.covers(start) and room.covers(goal)
    assert len(room.interiors) == 0
    _, path = solve(scenario)
    legs = np.diff(path, axis=0)
    headings = np.arctan2(legs[:, 1], legs[:, 0])[np.hypot(*legs.T) > 0.5]
    assert np.sum(np.abs(np.diff(headings)) > math.radians(45)) >= 4


def free_run(free: BoolArray, sizes: FloatArray) -> FloatArray:
    """How far the free cells around each cell reach along axis 0, m; 0 in blocked cells."""
    runs = np.zeros(free.shape)
    for column, cells in enumerate(free.T):
        for run in np.split(np.arange(len(cells)), np.flatnonzero(np.diff(cells)) + 1):
            runs[run, column] = sizes[run].sum() if cells[run[0]] else 0.0
    return runs


def test_maze_corridors_are_0_8_to_1_2_m_wide() -> None:
    """A place is as wide as the shorter of its chords; the walls run along the axes.

    Both chords are long only at turns and forks, which are as large as the corridors there.
    """
    free = make_world(load_scenario("maze"), np.random.default_rng(0)).free_space
    x, y = (np.unique(axis) for axis in shapely.get_coordinates(free).T)
    width, height = np.diff(x), np.diff(y)
    middle_x, middle_y = np.meshgrid(x[:-1] + width / 2, y[:-1] + height / 2, indexing="ij")
    cells = shapely.contains_xy(free, middle_x, middle_y)
    chords = np.minimum(free_run(cells, width), free_run(cells.T, height).T)
    corridors = np.unique(chords[cells & (chords <= 1.2 + 1e-9)].round(9))
    assert corridors.tolist() == [0.8, 1.0, 1.1]  # the narrowest is the dead end
    boxes = shapely.box(x[:-1, None], y[:-1], x[1:, None], y[1:])
    crossings = shapely.get_parts(shapely.union_all(boxes[chords > 1.2 + 1e-9]))
    assert len(crossings) == 5
    for x_min, y_min, x_max, y_max in shapely.bounds(crossings):
        assert max(x_max - x_min, y_max - y_min) <= 1.2


def test_maze_dead_end_is_short_and_on_the_side_of_the_goal() -> None:
    scenario = load_scenario("maze")
    free = make_world(scenario, np.random.default_rng(0)).free_space
    junction = (1.9, 0.5)  # in the first corridor, below the dead end
    above = shapely.get_parts(shapely.box(0.0, 1.0, 2.7, 9.0).intersection(free))
    (dead_end,) = above[shapely.area(above) > 0.0]
    assert dead_end.equals(shapely.box(1.5, 1.0, 2.3, 1.7))  # 0.8 m wide and 0.7 m deep
    assert 1.5 < junction[0] < 2.3
    _, path = solve(scenario)
    assert LineString(path).intersection(dead_end).is_empty
    east, north = np.subtract(scenario.goal, junction)
    assert north > east  # the goal lies nearer to the dead end's direction than to the corridor's


def test_maze_movers_leave_room_for_the_robot_beside_them() -> None:
    for spec in load_scenario("maze").random_moving:
        x_min, y_min, x_max, y_max = Polygon(spec.region).bounds
        width = min(x_max - x_min, y_max - y_min)
        assert width - 2 * spec.radius[1] - DEFAULT_ROBOT.side > 0.25


def test_narrow_gaps_must_be_passed_in_succession() -> None:
    scenario = load_scenario("narrow")
    obstacles = footprints(scenario)
    _, path = solve(scenario)
    places = []
    for below, above in zip(obstacles[::2], obstacles[1::2], strict=True):
        gap = gap_between(below, above)
        assert 0.35 <= gap.length <= 0.45
        assert gap.intersects(LineString(path))
        plug = Shape(shapely.get_coordinates(gap.buffer(0.01))[:-1], None)
        assert solve(scenario, (plug,))[0] == math.inf
        assert all(region.distance(gap) >= 0.35 for region in regions(scenario))
        places.append(gap.centroid.x)
    assert len(places) >= 3
    assert places == sorted(places)
