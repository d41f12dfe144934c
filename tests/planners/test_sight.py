"""Free distances and ways in hand-made scenes."""

from math import hypot, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from point_world import RANGE, box, distance_to, sight_at, walls

from fuzzynav_mj.geometry import wrap_angle
from fuzzynav_mj.planners.grid import CELL
from fuzzynav_mj.planners.reach import free_distance
from fuzzynav_mj.planners.search import searched_ways
from fuzzynav_mj.planners.sight import (
    Ways,
    either,
    straight_ways,
    thin,
)
from fuzzynav_mj.types import FloatArray

TIGHT, COMFORTABLE = 0.15, 0.20
ROOM = box(-4.0, -4.0, 4.0, 4.0)


def one_free(point: tuple[float, float], width: float, bearing: float = 0.0) -> float:
    """The free distance on one bearing, past one point."""
    return float(free_distance(np.array([point]), np.array([bearing]), width)[0])


def searched(sides: FloatArray, place: tuple[float, float], yaw: float = 0.0) -> Ways:
    """The searched ways at `place`."""
    return searched_ways(sight_at(sides, place, yaw), TIGHT, COMFORTABLE)


def straight(
    sides: FloatArray, place: tuple[float, float], yaw: float = 0.0, width: float = TIGHT
) -> Ways:
    """The straight ways at `place`."""
    return straight_ways(sight_at(sides, place, yaw), width, width, 0.0)


def degrees_open(ways: Ways, yaw: float = 0.0) -> FloatArray:
    """Bearings of the open ways, in degrees of [-180, 180)."""
    bearings = np.arange(len(ways.open)) * (2 * pi / len(ways.open)) - pi + yaw
    degrees: FloatArray = np.degrees(wrap_angle(bearings[ways.open]))
    return degrees


# Free distance --------------------------------------------------------------------------------


def test_hand_computed_free_distances() -> None:
    assert one_free((0.5, 0.0), 0.2) == pytest.approx(0.3)
    assert one_free((0.5, 0.1), 0.2) == pytest.approx(0.5 - sqrt(0.2**2 - 0.1**2))
    assert one_free((0.0, -0.5), 0.2, bearing=-pi / 2) == pytest.approx(0.3)
    assert one_free((0.3, 0.3), 0.2, bearing=pi / 4) == pytest.approx(0.3 * sqrt(2) - 0.2)


def test_what_lies_beside_or_behind_stops_nothing() -> None:
    assert one_free((0.5, 0.2001), 0.2) == np.inf
    assert one_free((-0.5, 0.0), 0.2) == np.inf
    assert free_distance(np.empty((0, 2)), np.array([0.0, 1.0]), 0.2).tolist() == [np.inf, np.inf]


def test_overlapped_point_stops_only_motion_towards_it() -> None:
    assert one_free((0.1, 0.0), 0.2) == 0.0
    assert one_free((0.1, 0.0), 0.2, bearing=pi) == np.inf


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 12), st.floats(0.05, 0.3))
def test_disc_touches_where_it_is_said_to_stop(seed: int, count: int, width: float) -> None:
    """Brute force: the disc is clear of every point until then, and touches one there."""
    rng = np.random.default_rng(seed)
    distance, angle = rng.uniform(width + 1e-3, 1.0, count), rng.uniform(-pi, pi, count)
    points = distance[:, None] * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    bearings = rng.uniform(-pi, pi, 8)
    for bearing, free in zip(bearings, free_distance(points, bearings, width), strict=True):
        unit = np.array([np.cos(bearing), np.sin(bearing)])
        travelled = np.linspace(0.0, min(free, 2.0), 200)[:, None] * unit
        gaps = np.hypot(*(travelled[:, None] - points).transpose(2, 0, 1)).min(axis=1)
        assert gaps.min() >= width - 1e-9
        if np.isfinite(free):
            assert gaps[-1] == pytest.approx(width)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.05, 0.3), st.floats(0.0, 0.2))
def test_wider_disc_gets_no_farther(seed: int, width: float, more: float) -> None:
    rng = np.random.default_rng(seed)
    points, bearings = rng.uniform(-1.0, 1.0, (9, 2)), rng.uniform(-pi, pi, 20)
    narrow = free_distance(points, bearings, width)
    assert (free_distance(points, bearings, width + more) <= narrow + 1e-12).all()


# Ways -----------------------------------------------------------------------------------------


def test_open_ground_is_open_all_around() -> None:
    ways, found = straight(ROOM, (0.0, 0.0)), searched(ROOM, (0.0, 0.0))
    assert ways.open.all()
    np.testing.assert_allclose(ways.length, RANGE)
    np.testing.assert_allclose(np.hypot(*ways.end.T), RANGE)
    # Not every ray has a cell of the grid, but one of two neighbours does.
    assert (found.open | np.roll(found.open, 1)).all()
    # The grid's sixteen directions make ways at most 2.8 % longer; it ends a cell short.
    assert found.length[found.open].max() <= 1.028 * RANGE
    assert found.length.min() >= RANGE - 1.5 * CELL


@pytest.mark.parametrize("yaw", [0.0, 1.234])
def test_corridor_leads_two_ways(yaw: float) -> None:
    corridor = walls(box(-4.0, 0.3, 4.0, 0.4), box(-4.0, -0.4, 4.0, -0.3))
    for ways in (straight(corridor, (0.0, 0.0), yaw), searched(corridor, (0.0, 0.0), yaw)):
        degrees = np.abs(degrees_open(ways, yaw))
        assert (degrees < 20.0).any() and (degrees > 160.0).any()
        # Farther off than this a ray meets a wall within range.
        steepest = np.degrees(np.arcsin(0.3 / RANGE)) + 2.0
        assert ((degrees < steepest) | (degrees > 180.0 - steepest)).all()


@pytest.mark.parametrize(("half_width", "passable"), [(0.16, True), (0.14, False)])
def test_corridor_must_be_as_wide_as_the_way(half_width: float, passable: bool) -> None:
    corridor = walls(
        box(-4.0, half_width, 4.0, half_width + 0.1), box(-4.0, -half_width - 0.1, 4.0, -half_width)
    )
    assert straight(corridor, (0.0, 0.0)).open.any() == passable


def wall_with_gap(gap: float, thickness: float, ahead: float) -> FloatArray:
    """A wall across the way that begins `ahead` of the origin, with a gap at y = 0."""
    return walls(
        ROOM,
        box(ahead, -4.0, ahead + thickness, -gap / 2),
        box(ahead, gap / 2, ahead + thickness, 4.0),
    )


def through(ways: Ways, ahead: float) -> bool:
    """True if some way leads through the wall."""
    return bool((ways.open & (ways.end[:, 0] > ahead)).any())


lateral = st.floats(-0.3, 0.3)
distances = st.floats(0.3, 0.5)
thicknesses = st.floats(0.1, 0.3)


@settings(max_examples=25, deadline=None)
@given(st.floats(0.35, 0.6), thicknesses, distances, lateral, st.floats(-pi, pi))
def test_gap_wide_enough_is_found(
    gap: float, thickness: float, ahead: float, aside: float, yaw: float
) -> None:
    """From anywhere before it, straight or round the jamb."""
    assert through(searched(wall_with_gap(gap, thickness, ahead), (0.0, aside), yaw), ahead)


@settings(max_examples=25, deadline=None)
@given(st.floats(0.1, 0.25), thicknesses, distances, lateral, st.floats(-pi, pi))
def test_gap_too_narrow_is_no_way(
    gap: float, thickness: float, ahead: float, aside: float, yaw: float
) -> None:
    scene = wall_with_gap(gap, thickness, ahead)
    assert not through(searched(scene, (0.0, aside), yaw), ahead)
    assert not through(straight(scene, (0.0, aside), yaw), ahead)


def test_straight_way_through_the_middle_of_a_gap() -> None:
    scene = wall_with_gap(0.35, 0.2, 0.4)
    assert through(straight(scene, (0.0, 0.0)), 0.4)
    assert not through(straight(scene, (0.0, 0.0), width=COMFORTABLE), 0.4)
    # From the side a straight way would cut the jamb; a searched one leads round it.
    assert not through(straight(scene, (0.1, 0.25)), 0.4)
    assert through(searched(scene, (0.1, 0.25)), 0.4)


@pytest.mark.parametrize("yaw", [0.0, 2.5])
def test_pocket_leads_only_back_out(yaw: float) -> None:
    pocket = walls(
        ROOM,
        box(0.5, -0.6, 0.6, 0.6),  # its bottom, ahead
        box(-0.5, 0.5, 0.6, 0.6),
        box(-0.5, -0.6, 0.6, -0.5),
    )
    for ways in (straight(pocket, (0.0, 0.0), yaw), searched(pocket, (0.0, 0.0), yaw)):
        degrees = np.abs(degrees_open(ways, yaw))
        assert len(degrees) > 0 and degrees.min() > 120.0


def test_closed_cell_has_no_way_out() -> None:
    cell = box(-0.5, -0.5, 0.5, 0.5)
    assert not straight(cell, (0.1, 0.0)).open.any()
    assert not searched(cell, (0.1, 0.0)).open.any()


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_searched_way_keeps_its_width(seed: int) -> None:
    """No cell of a way lies nearer to a hit than the width, but those that the robot is on."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-1.0, 1.0, (12, 2))
    corners = corners[np.abs(corners + 0.1).max(axis=1) > 0.3]
    scene = walls(ROOM, *(box(x, y, x + 0.2, y + 0.2) for x, y in corners.tolist()))
    sight = sight_at(scene, (0.0, 0.0), float(rng.uniform(-pi, pi)))
    ways = searched_ways(sight, TIGHT, COMFORTABLE)
    search = ways.search
    assert search is not None
    for ray in np.flatnonzero(ways.open).tolist():
        chain = search.grid.chain(search.before, int(search.target[ray]))
        way = np.stack((search.grid.x[chain], search.grid.y[chain]), axis=1)
        away = np.hypot(*way.T) >= 1.5 * CELL
        gaps = np.hypot(*(way[away][:, None] - sight.points).transpose(2, 0, 1))
        assert gaps.min(initial=np.inf) >= TIGHT - 1e-3
        assert np.allclose(way[0], ways.end[ray])  # the chain begins at the way's end
        steps = np.diff(np.concatenate((way, [[0.0, 0.0]])), axis=0)
        assert ways.length[ray] == pytest.approx(np.hypot(*steps.T).sum())
        assert (np.abs(steps).sum(axis=1) <= 3 * CELL + 1e-9).all()


@settings(max_examples=25, deadline=None)
@given(lateral, st.floats(-pi, pi))
def test_first_point_is_in_straight_reach(aside: float, yaw: float) -> None:
    """On the way there the robot comes no nearer to the walls than the width and the hits'
    spacing allow."""
    scene = wall_with_gap(0.4, 0.2, 0.4)
    ways = searched(scene, (0.0, aside), yaw)
    for ray in np.flatnonzero(ways.open).tolist():
        x, y = ways.first_point(ray).tolist()
        assert 0.0 < hypot(x, y) <= RANGE
        for share in np.linspace(0.0, 1.0, 12).tolist():
            assert distance_to(scene, (share * x, aside + share * y)) > TIGHT - 0.04


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.5))
def test_either_takes_the_shorter_way(seed: int, penalty: float) -> None:
    rng = np.random.default_rng(seed)
    place = (float(rng.uniform(-0.2, 0.2)), float(rng.uniform(-0.2, 0.2)))
    scene = wall_with_gap(0.42, 0.2, 0.4)
    wide, tight = straight(scene, place, width=COMFORTABLE), straight(scene, place)
    for both in (
        either(wide, tight, penalty),
        straight_ways(sight_at(scene, place), COMFORTABLE, TIGHT, penalty),
    ):
        shorter = tight.length + penalty < wide.length
        assert np.array_equal(both.open, wide.open | tight.open)
        np.testing.assert_array_equal(both.length, np.minimum(wide.length, tight.length + penalty))
        np.testing.assert_array_equal(both.end[shorter], tight.end[shorter])
        np.testing.assert_array_equal(both.end[~shorter], wide.end[~shorter])
        np.testing.assert_array_equal(both.comfortable, wide.open & ~shorter)


# Thinning -------------------------------------------------------------------------------------


@settings(max_examples=25, deadline=None)
@given(st.floats(0.2, 0.75), st.floats(-pi, pi))
def test_thinned_wall_is_as_near_as_the_wall(distance: float, yaw: float) -> None:
    """What is left out changes the nearest hit by millimetres, and begins and ends the same."""
    bearings = np.arange(180) * (2 * pi / 180) - pi + yaw
    ahead = np.abs(wrap_angle(bearings)) < np.arccos(distance / 0.8)
    angle = np.sort(wrap_angle(bearings[ahead]))
    points = distance * np.stack((np.ones_like(angle), np.tan(angle)), axis=1)
    kept = thin(points)
    assert {tuple(p) for p in kept.tolist()} <= {tuple(p) for p in points.tolist()}
    assert np.array_equal(kept[[0, -1]], points[[0, -1]])
    nearest = np.hypot(*points.T).min()
    assert nearest <= np.hypot(*kept.T).min() <= nearest + 2e-3
    widest = np.hypot(*np.diff(points, axis=0).T).max()
    assert np.hypot(*np.diff(kept, axis=0).T).max() <= 0.05 * 0.8 + widest
