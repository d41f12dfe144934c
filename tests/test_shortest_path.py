"""Numbers and laws of the shortest path."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.shortest_path import shortest_path

BOUNDS = (0.0, 0.0, 10.0, 10.0)


def box(x_min: float, y_min: float, x_max: float, y_max: float) -> Shape:
    corners = [[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]]
    return Shape(np.array(corners), None)


def test_without_obstacles_the_path_is_the_straight_line() -> None:
    length, path = shortest_path([], BOUNDS, (1.0, 1.0), (4.0, 5.0))
    assert length == 5.0
    np.testing.assert_array_equal(path, [[1.0, 1.0], [4.0, 5.0]])


def test_around_a_disc_by_hand() -> None:
    """Two tangents and an arc about a disc of radius 1 that clearance makes 1.5."""
    disc = Shape(None, (5.0, 5.0, 1.0))
    length, _ = shortest_path([disc], BOUNDS, (2.5, 5.0), (7.5, 5.0), clearance=0.5)
    tangent = math.sqrt(2.5**2 - 1.5**2)
    arc = 1.5 * (math.pi - 2 * math.acos(1.5 / 2.5))
    exact = 2 * tangent + arc
    assert exact == pytest.approx(5.930503, abs=1e-6)
    assert length == pytest.approx(5.9302, abs=1e-3)
    assert length <= exact


def test_over_a_wall_from_the_floor_by_hand() -> None:
    """A thin wall from y = -1 to 2 between (0, 0) and (4, 0), no clearance."""
    wall = box(1.5, -5.0, 2.5, 2.0)
    length, path = shortest_path([wall], (-1.0, -5.0, 5.0, 5.0), (0.0, 0.0), (4.0, 0.0), 0.0)
    assert length == pytest.approx(2.5 + 1.0 + 2.5)
    np.testing.assert_allclose(path, [[0, 0], [1.5, 2], [2.5, 2], [4, 0]])


def test_arcs_of_a_corner_err_by_less_than_a_tenth_of_a_millimetre() -> None:
    """Around two corners of a wall with clearance 0.1: tangents, two arcs and the wall's side."""
    length, _ = shortest_path([box(4.0, -20, 6.0, 2.0)], None, (0.0, 0.0), (10.0, 0.0), 0.1)
    distance, slope = math.hypot(4.0, 2.0), math.atan2(2.0, 4.0)
    tangent = math.sqrt(distance**2 - 0.1**2)
    turn = slope + math.asin(0.1 / distance)  # angle of the tangent, which the arc turns back to 0
    exact = 2 * tangent + 2 * 0.1 * turn + 2.0
    assert exact - 1e-4 < length <= exact


def test_walls_keep_the_path_inside_and_their_absence_does_not() -> None:
    wall = box(4.0, 1.0, 6.0, 10.5)  # leaves 0.8 m below its inflated edge, nothing above
    inside, path = shortest_path([wall], BOUNDS, (1.0, 9.0), (9.0, 9.0), 0.1)
    outside, _ = shortest_path([wall], None, (1.0, 9.0), (9.0, 9.0), 0.1)
    assert path[:, 1].min() == pytest.approx(0.9, abs=1e-3)
    assert inside > 2 * 8.1
    assert outside < 9.5


def test_no_path_is_infinite() -> None:
    closed = [box(4.0, 0.0, 5.0, 4.9), box(4.0, 5.05, 5.0, 10.0)]
    length, path = shortest_path(closed, BOUNDS, (1.0, 5.0), (9.0, 5.0), 0.1)
    assert length == math.inf
    assert path.shape == (0, 2)


def test_passage_opens_at_twice_the_clearance() -> None:
    def gap(width: float) -> list[Shape]:
        return [box(4.0, 0.0, 5.0, 5.0), box(4.0, 5.0 + width, 5.0, 10.0)]

    start, goal = (1.0, 5.1), (9.0, 5.1)
    assert shortest_path(gap(0.199), BOUNDS, start, goal, 0.1)[0] == math.inf
    assert shortest_path(gap(0.201), BOUNDS, start, goal, 0.1)[0] == pytest.approx(8.0, abs=1e-4)


def test_start_or_goal_in_an_obstacle_or_wall_has_no_path() -> None:
    disc = [Shape(None, (5.0, 5.0, 1.0))]
    assert shortest_path(disc, BOUNDS, (5.0, 5.5), (9.0, 9.0))[0] == math.inf
    assert shortest_path(disc, BOUNDS, (1.0, 1.0), (5.0, 4.5))[0] == math.inf
    assert shortest_path([], BOUNDS, (1.0, 1.0), (9.95, 9.0))[0] == math.inf


places = st.floats(0.5, 9.5)
discs = st.tuples(places, places, st.floats(0.2, 1.5))


@settings(max_examples=40, deadline=None)
@given(st.lists(discs, max_size=5), places, places, places, places)
def test_laws_of_the_shortest_path(
    circles: list[tuple[float, float, float]], x: float, y: float, u: float, v: float
) -> None:
    shapes = [Shape(None, circle) for circle in circles]
    start, goal = (x, y), (u, v)
    length, path = shortest_path(shapes, BOUNDS, start, goal, 0.1)
    back, _ = shortest_path(shapes, BOUNDS, goal, start, 0.1)
    assert length == pytest.approx(back)
    assert length >= math.dist(start, goal) - 1e-12
    wider, _ = shortest_path(shapes, BOUNDS, start, goal, 0.2)
    assert wider >= length - 1e-9
    fewer, _ = shortest_path(shapes[1:], BOUNDS, start, goal, 0.1)
    assert fewer <= length + 1e-9
    if math.isfinite(length):
        assert np.hypot(*np.diff(path, axis=0).T).sum() == pytest.approx(length)
        line = shapely.linestrings(path)
        assert all(line.distance(shape.footprint) > 0.1 - 2e-3 for shape in shapes)
