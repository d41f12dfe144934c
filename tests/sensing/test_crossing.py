"""Outlines across rays that went by, in cases worked out by hand."""

import numpy as np
import pytest
from made_scans import HERE, scan_of, square

from fuzzynav_mj.sensing.crossing import first_across, pieces_across
from fuzzynav_mj.sensing.looks import Look, take_look
from fuzzynav_mj.sensing.outline import Outline

EMPTY = take_look(scan_of([], 0.0), HERE)  # rays reach 0.8 m everywhere
STANDS = np.zeros(6)


def wall(x: float, stamp: float = 0.0) -> Outline:
    """Three hits on a line across the x axis, 0.1 m apart."""
    points = np.array([[x, x, x], [-0.1, 0.0, 0.1]])
    joined = np.array([True, True, False])
    normals = np.array([[-1.0, -1.0, -1.0], [0.0, 0.0, 0.0]])
    return Outline(stamp, points, joined, normals, np.zeros((2, 3), dtype=bool))


def across(outline: Outline, look: Look, *more: tuple[float, float]) -> list[bool]:
    """Whether each of the velocities puts the outline across rays of the look, by 1 cm or more."""
    tried = np.array([[*velocity, 0.0, 0.0] for velocity in more])
    left_out = np.zeros(len(tried), dtype=bool)
    return (first_across(outline, STANDS, tried, left_out, look, 0.01) >= 0).tolist()


@pytest.mark.parametrize(("x", "expected"), [(0.5, True), (0.785, True), (0.795, False)])
def test_outline_lies_across_rays_that_reached_farther_by_the_margin(
    x: float, expected: bool
) -> None:
    assert across(wall(x), EMPTY, (0.0, 0.0)) == [expected]


def test_where_it_was_counts_at_the_time_of_the_look() -> None:
    # A tenth of a second before, at 1 m/s, it was out of sight; at 0.1 m/s it was not.
    assert across(wall(0.75, stamp=0.1), EMPTY, (-1.0, 0.0), (-0.1, 0.0)) == [False, True]


def test_what_accelerates_was_farther_behind() -> None:
    """In half a second 4 m/s2 are worth as much as 1 m/s: without them it was out of sight."""
    tried = np.array([[-0.4, 0.0, 0.0, 0.0], [-0.4, 0.0, -1.6, 0.0]])
    none = np.zeros(2, dtype=bool)
    found = first_across(wall(0.7, stamp=0.5), STANDS, tried, none, EMPTY, 0.01)
    assert found.tolist() == [-1, 0]


def test_what_stands_there_is_no_contradiction() -> None:
    seen = take_look(scan_of([square(0.5, 0.0)], 0.0), HERE)
    nearest = 0.5 - 0.1
    assert across(wall(nearest), seen, (0.0, 0.0)) == [False]


def test_left_out_velocities_are_not_marked() -> None:
    tried, left_out = np.zeros((2, 4)), np.array([True, False])
    found = first_across(wall(0.5), STANDS, tried, left_out, EMPTY, 0.01)
    assert found.tolist() == [-1, 0]


def test_only_pieces_between_joined_hits_lie_across() -> None:
    shown = wall(0.5)
    assert pieces_across(shown, STANDS, EMPTY, 0.01).tolist() == [True, True, False]
    apart = shown._replace(joined=np.array([True, False, False]))
    assert pieces_across(apart, STANDS, EMPTY, 0.01).tolist() == [True, False, False]
