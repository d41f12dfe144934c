"""Straight walls in sight, the corners they make, and the ways beside them."""

from math import atan2, cos, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from point_world import RANGE, RAYS, Point, box, sight_at

from fuzzynav_mj.planners.settings import GuidanceSettings
from fuzzynav_mj.planners.sight import Sight, straight_ways
from fuzzynav_mj.planners.walls import Walls, corners_closed, led_along, walls_in_sight
from fuzzynav_mj.types import FloatArray

SETTINGS = GuidanceSettings()
CENTRE = (0.0, 0.0)


def strip(x: float) -> FloatArray:
    """(4, 2, 2) a wall along the y axis that faces the centre at this x."""
    return box(min(x, 2 * x), -5.0, max(x, 2 * x), 5.0)


def wall_of(sight: Sight) -> FloatArray:
    walls = walls_in_sight(sight)
    assert len(walls.ends) == 1
    ends: FloatArray = walls.ends[0]
    return ends


@settings(max_examples=50, deadline=None)
@given(st.floats(0.2, 0.7), st.floats(-pi, pi))
def test_a_long_wall_is_seen_up_to_the_edge_of_sight_and_runs_on(x: float, yaw: float) -> None:
    sight = sight_at(strip(x), CENTRE, yaw)
    x0, y0, x1, y1 = wall_of(sight)
    assert x0 == pytest.approx(x) and x1 == pytest.approx(x)
    # The last hits lie within a ray's width of the circle of sight.
    reach = np.sqrt(RANGE**2 - x**2)
    spacing = 2 * pi / RAYS * RANGE**2 / x
    assert -reach <= y0 <= -reach + spacing and reach - spacing <= y1 <= reach
    assert walls_in_sight(sight).runs_on.tolist() == [[True, True]]


def test_a_wall_that_ends_in_sight_does_not_run_on_there() -> None:
    walls = walls_in_sight(sight_at(box(0.4, -5.0, 0.6, 0.2), CENTRE))
    assert walls.ends[0, 2:] == pytest.approx([0.4, 0.2], abs=0.02)
    assert walls.runs_on[0].tolist() == [True, False]


def test_what_hides_the_rest_of_a_wall_says_nothing_of_its_end() -> None:
    sight = sight_at(box(0.4, -5.0, 0.6, 0.2), CENTRE)
    after = int(walls_in_sight(sight).rays[0, 1]) + 1
    hidden = np.zeros(RAYS, dtype=bool)
    hidden[after] = True
    behind = Sight(sight.points, sight.bearings, sight.ranges, RANGE, hidden)
    assert walls_in_sight(behind).runs_on[0].tolist() == [True, True]


def test_what_is_round_or_small_is_no_wall() -> None:
    bearings = np.arange(RAYS) * (2 * pi / RAYS) - pi
    ranges = np.where(np.abs(bearings) < 0.5, 0.5, RANGE)  # a bow around the robot
    points = (ranges * np.stack((np.cos(bearings), np.sin(bearings)))).T[ranges < RANGE]
    bow = walls_in_sight(Sight(points, bearings, ranges, RANGE, np.zeros(len(ranges), dtype=bool)))
    assert (np.hypot(*(bow.ends[:, 2:] - bow.ends[:, :2]).T) < 0.35).all()
    assert len(walls_in_sight(sight_at(box(0.5, -0.06, 0.6, 0.06), CENTRE)).ends) == 0


def corner_at(x: float, y: float) -> FloatArray:
    """(8, 2, 2) walls at this x and this y, both longer than can be seen, that meet."""
    return np.concatenate((box(x, -5.0, x + 1.0, y + 1.0), box(-5.0, y, x + 1.0, y + 1.0)))


def test_corner_out_of_sight_is_closed_where_its_walls_meet() -> None:
    """At (0.6, 0.7): 0.92 m away, and the walls are seen up to y = 0.53 and x = 0.39."""
    sight = sight_at(corner_at(0.6, 0.7), CENTRE)
    walls = walls_in_sight(sight)
    closed = corners_closed(sight, walls, 0.25)
    added = closed.points[len(sight.points) :]
    assert len(added) > 0
    on_one = np.isclose(added[:, 0], 0.6) & (added[:, 1] <= 0.7 + 1e-9)
    on_other = np.isclose(added[:, 1], 0.7) & (added[:, 0] <= 0.6 + 1e-9)
    assert (on_one | on_other).all()
    between = (sight.bearings > atan2(0.53, 0.6)) & (sight.bearings < atan2(0.7, 0.39))
    assert (sight.ranges[between] >= RANGE).any() and (closed.ranges[between] < RANGE).all()
    assert np.array_equal(closed.ranges[~between], sight.ranges[~between])


@pytest.mark.parametrize("reach", [0.0, 0.15])
def test_corner_farther_than_the_reach_stays_open(reach: float) -> None:
    """The wall at y = 0.7 would have to go on for 0.21 m."""
    sight = sight_at(corner_at(0.6, 0.7), CENTRE)
    assert corners_closed(sight, walls_in_sight(sight), reach) is sight


def test_parallel_walls_and_ends_in_sight_make_no_corner() -> None:
    corridor = np.concatenate((strip(0.5), strip(-0.5)))
    ended = np.concatenate((box(0.6, -5.0, 0.8, 0.3), box(-5.0, 0.7, 0.8, 0.9)))
    for sides in (corridor, ended):
        sight = sight_at(sides, CENTRE)
        assert corners_closed(sight, walls_in_sight(sight), 0.5) is sight


def led(sides: FloatArray, goal: Point, onward: float = SETTINGS.onward) -> tuple[float, float]:
    """Bearings, rad, of the straight way to the goal and of the one that is taken for it."""
    sight = sight_at(sides, CENTRE)
    ways = straight_ways(sight, SETTINGS.comfortable, SETTINGS.tight, SETTINGS.tight_penalty)
    straight = round((atan2(goal[1], goal[0]) + pi) * RAYS / (2 * pi)) % RAYS
    assert ways.open[straight]
    taken = led_along(
        straight, sight.bearings, ways.open, ways.end[straight], np.array(goal),
        walls_in_sight(sight), onward, SETTINGS.comfortable,
    )  # fmt: skip
    assert ways.open[taken]
    return float(sight.bearings[straight]), float(sight.bearings[taken])


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_way_in_a_corridor_leads_to_where_the_wall_in_the_way_may_end(side: float) -> None:
    """By hand: the wall at x = 0.7 is seen up to y = 0.387; 1.5 m beyond, less the berth of 0.2 m,
    lies (0.5, 1.887) on the bearing of 75.2 degrees, in place of 60 degrees to the goal."""
    goal = (side * 5.0 * cos(pi / 3), 5.0 * sin(pi / 3))
    straight, taken = led(strip(side * 0.7), goal)
    degrees = np.degrees([straight, taken])
    expected = [60.0, 75.2] if side > 0 else [120.0, 104.8]
    assert degrees == pytest.approx(expected, abs=1.5)


def test_way_is_kept_where_no_wall_that_runs_on_is_between_it_and_the_goal() -> None:
    goal = (5.0 * cos(pi / 3), 5.0 * sin(pi / 3))
    for sides in (strip(-0.5), box(0.7, -5.0, 0.9, 0.2), box(0.3, -0.9, 0.5, -0.3)):
        straight, taken = led(sides, goal)
        assert taken == straight
    before_the_wall = (0.6, 0.6 * np.tan(pi / 3))
    straight, taken = led(strip(0.7), before_the_wall)
    assert taken == straight


@pytest.mark.parametrize(("degrees", "changes"), [(25.0, False), (35.0, True)])
def test_wall_across_the_way_to_the_goal_changes_no_way(degrees: float, changes: bool) -> None:
    """Going along it, at more than 60 degrees to the goal, would only put off the sight of its
    end."""
    bearing = np.radians(degrees)
    straight, taken = led(strip(0.78), (5.0 * cos(bearing), 5.0 * sin(bearing)))
    assert (taken > straight) is changes


def test_no_walls_are_seen_on_open_ground() -> None:
    found = walls_in_sight(sight_at(box(3.0, 3.0, 4.0, 4.0), CENTRE))
    assert isinstance(found, Walls) and len(found.ends) == 0
