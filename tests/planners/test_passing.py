"""What places are worth near movers."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav_mj.planners.grid import CELL
from fuzzynav_mj.planners.passing import (
    BLOCKED,
    NO_WAY,
    OUTLOOK,
    Passing,
    leads_on,
    ways_past,
    worth,
)
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.planners.sight import Sight
from fuzzynav_mj.types import FloatArray

RANGE = 0.8
SETTINGS = DecisionSettings()
NO_MOVERS = np.empty((OUTLOOK, 0, 2))


def in_sight(*points: tuple[float, float]) -> Sight:
    """Free ground all around, but for single points."""
    bearings = -pi + np.arange(180) * (2 * pi / 180)
    spots = np.array(points, dtype=np.float64).reshape(-1, 2)
    return Sight(spots, bearings, np.full(180, RANGE), RANGE, np.zeros(180, dtype=bool))


def moving(start: tuple[float, float], velocity: tuple[float, float]) -> FloatArray:
    """The expected places of one point, (OUTLOOK, 1, 2)."""
    times = 0.1 * np.arange(1, OUTLOOK + 1)
    return (np.array(start) + times[:, None] * np.array(velocity))[:, None]


def at(passing: Passing, x: float, y: float) -> float:
    return float(worth(passing, np.array([x]), np.array([y]))[0])


def test_free_ground_costs_time_and_length_of_the_way() -> None:
    target = np.array([0.6, 0.0])
    free = ways_past(in_sight(), NO_MOVERS, target, SETTINGS)
    per_metre = SETTINGS.passing_time + SETTINGS.passing_length
    # Less the distance of the target; the way may end up to 0.1 m before it, on a whole step.
    assert 0.45 * per_metre - 0.6 <= at(free, 0.0, 0.0) <= 0.60 * per_metre + 0.1 - 0.6
    assert at(free, 0.6, 0.0) == pytest.approx(-0.6, abs=1e-9)
    assert at(free, 0.3, 0.0) < at(free, 0.0, 0.0) < at(free, -0.3, 0.0)


def test_a_place_leads_on_unless_hardly_a_cell_around_it_does() -> None:
    """Cells worth 0.5 m end a cell before ones from which no way leads on."""
    value = np.full((33, 33), NO_WAY)
    value[:17] = 0.5
    passing = Passing(value, 16, np.array([1.0, 0.0]))
    for share, on in ((-1.0, True), (0.0, True), (0.85, True), (0.95, False), (1.0, False)):
        assert leads_on(passing, share * CELL, 0.0) == on
        assert (at(passing, share * CELL, 0.0) == 0.5) == on


def test_mover_in_the_way_makes_a_place_dearer_but_fleeing_is_dearer_still() -> None:
    """A mover crosses from the right, 0.3 m ahead."""
    target = np.array([8.0, 0.0])
    crossing = ways_past(in_sight(), moving((0.3, -0.7), (0.0, 0.4)), target, SETTINGS)
    free = ways_past(in_sight(), NO_MOVERS, target, SETTINGS)
    assert at(crossing, 0.0, 0.0) > at(free, 0.0, 0.0)
    assert at(crossing, 0.0, 0.0) < at(crossing, -0.3, 0.0)


def test_being_driven_along_is_dearer_than_letting_the_mover_by() -> None:
    """A slow mover keeps abreast between the robot and its goal: behind it the way is shorter."""
    target = np.array([8.0, 0.0])
    abreast = ways_past(in_sight(), moving((0.35, -0.1), (0.0, 0.15)), target, SETTINGS)
    assert at(abreast, 0.0, -0.35) < at(abreast, 0.0, 0.15)


@settings(max_examples=20, deadline=None)
@given(
    st.tuples(st.floats(-0.7, 0.7), st.floats(-0.7, 0.7)),
    st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)),
    st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)),
)
def test_mirror_image_has_the_mirrored_value(
    start: tuple[float, float], velocity: tuple[float, float], target: tuple[float, float]
) -> None:
    flip = np.array([1.0, -1.0])
    here = ways_past(in_sight(), moving(start, velocity), np.array(target), SETTINGS)
    there = ways_past(
        in_sight(),
        moving((start[0], -start[1]), (velocity[0], -velocity[1])),
        np.array(target) * flip,
        SETTINGS,
    )
    np.testing.assert_allclose(here.value, there.value[:, ::-1], atol=1e-9)


@settings(max_examples=20, deadline=None)
@given(
    st.tuples(st.floats(-0.7, 0.7), st.floats(-0.7, 0.7)),
    st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)),
)
def test_another_mover_makes_no_place_cheaper(
    start: tuple[float, float], velocity: tuple[float, float]
) -> None:
    target = np.array([1.0, 0.5])
    one = moving((0.4, 0.4), (-0.3, 0.0))
    both = np.concatenate((one, moving(start, velocity)), axis=1)
    few = ways_past(in_sight(), one, target, SETTINGS).value
    more = ways_past(in_sight(), both, target, SETTINGS).value
    assert (more >= few - 1e-12).all()


def test_there_is_no_way_through_what_stands() -> None:
    """A wall with its ends out of sight, the target behind it."""
    wall = [(0.3, y) for y in np.arange(-0.8, 0.81, 0.05).tolist()]
    passing = ways_past(in_sight(*wall), NO_MOVERS, np.array([0.6, 0.0]), SETTINGS)
    middle = passing.half
    assert passing.value[middle + 6, middle] == NO_WAY
    assert at(passing, 0.3, 0.0) == pytest.approx(0.3 - 0.6 + BLOCKED)
    assert at(passing, 0.0, 0.0) > 0.0 - 1e-9


def test_the_robot_may_stand_where_it_stands() -> None:
    passing = ways_past(in_sight((0.11, 0.0)), NO_MOVERS, np.array([-0.6, 0.0]), SETTINGS)
    assert passing.value[passing.half, passing.half] < NO_WAY
