"""Which way is taken, among ways made by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav_mj.planners.boundary import Following, same_boundary
from fuzzynav_mj.planners.openings import gaining_way, shortest_way, unreached_rays
from fuzzynav_mj.planners.settings import GuidanceSettings
from fuzzynav_mj.planners.sight import Sight, Ways
from fuzzynav_mj.types import BoolArray, FloatArray

RAYS = 36
BEARINGS = np.arange(RAYS) * (2 * np.pi / RAYS)
UNITS = np.stack((np.cos(BEARINGS), np.sin(BEARINGS)), axis=1)
GOAL = np.array([3.0, 0.0])  # on ray 0


def opened(*rays: int) -> BoolArray:
    is_open = np.zeros(RAYS, dtype=bool)
    is_open[list(rays)] = True
    return is_open


def lengths(is_open: BoolArray) -> FloatArray:
    return np.where(is_open, 0.8, np.inf)


@settings(max_examples=50, deadline=None)
@given(st.sets(st.integers(0, RAYS - 1), min_size=1))
def test_shortest_way_is_the_one_nearest_to_the_goals_direction(rays: set[int]) -> None:
    """All ways are as long, and blind ones cost nothing more here."""
    is_open = opened(*rays)
    ranges = np.where(is_open, 0.8, 0.3)
    best, left_over = shortest_way(
        0, ranges, 0.8, is_open, lengths(is_open), 0.8 * UNITS, GOAL, 0.0
    )
    expected = np.hypot(*(0.8 * UNITS - GOAL).T)
    assert is_open[best] and left_over == pytest.approx(expected[is_open].min())


def test_a_way_gains_only_if_it_ends_near_enough_and_is_wanted() -> None:
    is_open = opened(2, 3)
    left_over = np.hypot(*(0.8 * UNITS - GOAL).T)
    given = (lengths(is_open), 0.8 * UNITS, GOAL)
    assert gaining_way(is_open, *given, 3.0) == 2
    assert gaining_way(opened(3), *given, 3.0) == 3
    assert gaining_way(is_open, *given, float(left_over[2])) == -1
    assert gaining_way(opened(), *given, 3.0) == -1


@pytest.mark.parametrize("side", [1, -1])
def test_free_ground_before_the_first_way_is_counted_from_the_boundary(side: int) -> None:
    ranges = np.full(RAYS, 0.3)
    ranges[[4 * side, 9 * side]] = 0.8
    assert unreached_rays(0, side, ranges, 0.8, 0.13, opened(9 * side)) == 5
    assert unreached_rays(0, side, ranges, 0.8, 0.13, opened(2 * side)) == 0
    assert unreached_rays(0, side, ranges, 0.8, 0.13, opened()) == RAYS
    assert unreached_rays(0, side, np.full(RAYS, 0.3), 0.8, 0.13, opened()) == 0


def test_boundaries_hang_together_across_the_last_ray_but_not_across_a_gap() -> None:
    ring = 0.5 * UNITS  # 9 cm from one to the next
    for missing, same in (([], True), ([9], True), ([9, 10, 11, 27, 28, 29], False)):
        points = np.delete(ring, missing, axis=0)
        sight = Sight(points, BEARINGS, np.full(RAYS, 0.5), 0.8, opened())
        assert same_boundary((1.0, 1.0), sight, (1.5, 1.0), (0.5, 1.0)) == same
        assert same_boundary((1.0, 1.0), sight, (1.5, 1.0), (1.48, 0.9))
    # Nothing is in sight near the first point: what is seen elsewhere does not hang together.
    assert not same_boundary((1.0, 1.0), sight, (2.0, 1.0), (0.5, 1.0))


@pytest.mark.parametrize("side", [1, -1])
def test_first_way_beside_the_boundary(side: int) -> None:
    """The boundary is nearest on ray 0; the way taken keeps off it where there is room."""
    ranges = np.full(RAYS, 0.5)
    ranges[0] = 0.2
    sight = Sight(0.5 * UNITS, BEARINGS, ranges, 0.8, opened())

    def chosen(is_open: BoolArray, comfortable: BoolArray) -> int:
        following = Following(side, (0.0, 0.0), (0.2, 0.0), 3.0, 3.0)
        ways = Ways(is_open, lengths(is_open), 0.8 * UNITS, comfortable, opened())
        ray, another = following.along((0.0, 0.0), sight, ways, False, GuidanceSettings())
        assert not another
        first = int(np.flatnonzero(is_open[np.arange(RAYS) * side])[0]) * side
        if not is_open[0]:
            assert following.edge == pytest.approx(tuple(0.5 * UNITS[first - side]))
        return ray

    def rays(*numbers: int) -> BoolArray:
        return opened(*(side * number for number in numbers))

    assert chosen(rays(5, 6, 7), rays()) == 5 * side % RAYS
    assert chosen(rays(5, 6, 7), rays(7)) == 7 * side % RAYS
    assert chosen(rays(5, 7), rays(7)) == 5 * side % RAYS  # not in this opening
    # The boundary has ended: the way closest behind its end.
    assert chosen(rays(-2, -1, 0, 1, 20), rays()) == -2 * side % RAYS


SEEN = {"in_sight": 0.5, "hidden": 0.6, "beyond_sight": 0.85}  # m to the boundary's edge
OTHER = np.arange(15, 22)  # rays that end at another wall, 0.3 m away


def follow_beside_another_wall(
    side: int, away: float, seen: bool, hidden: bool
) -> tuple[int, bool, Following]:
    """The robot followed a boundary whose edge is on ray 0, and another wall is nearer now."""
    ranges = np.full(RAYS, 0.8)
    ranges[OTHER] = 0.3
    points = 0.3 * UNITS[OTHER]
    if seen:
        ranges[0] = away
        points = np.concatenate((away * UNITS[:1], points))
    sight = Sight(points, BEARINGS, ranges, 0.8, opened(0) if hidden else opened())
    is_open = ranges == 0.8
    ways = Ways(is_open, lengths(is_open), 0.8 * UNITS, is_open, opened())
    following = Following(side, (0.0, 0.0), (away, 0.0), 3.0, 3.0)
    onward = UNITS[18]
    following.direction = (float(onward[0]), float(onward[1]))
    ray, another = following.along((0.0, 0.0), sight, ways, True, GuidanceSettings())
    return ray, another, following


@pytest.mark.parametrize("where", SEEN)
@pytest.mark.parametrize("side", [1, -1])
def test_boundary_is_kept_though_movers_drove_the_robot_over_to_another(
    side: int, where: str
) -> None:
    away = SEEN[where]
    ray, another, following = follow_beside_another_wall(
        side, away, where == "in_sight", where == "hidden"
    )
    assert (another, following.edge) == (False, (away, 0.0))
    # Past the edge at the comfortable distance, on the side on which the boundary is passed.
    aside = np.arcsin(GuidanceSettings().comfortable / away) / (2 * np.pi / RAYS)
    assert ray == side * round(aside) % RAYS


@pytest.mark.parametrize("side", [1, -1])
def test_boundary_is_given_up_where_its_place_is_seen_to_be_free(side: int) -> None:
    _, another, following = follow_beside_another_wall(side, 0.5, seen=False, hidden=False)
    assert another
    assert np.hypot(*(0.3 * UNITS[OTHER] - following.edge).T).min() == pytest.approx(0.0)
