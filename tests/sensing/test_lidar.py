"""Raw readings to ranges, and the ring of rays."""

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav_mj.sensing.lidar import decode, ray_bearings
from fuzzynav_mj.types import FloatArray

REACH = 0.8


@pytest.mark.parametrize(
    ("reading", "distance", "hit"),
    [
        (0.35, 0.35, True),
        (0.0, 0.0, True),
        (-1.0, REACH, False),  # a ray that hit nothing
        (-REACH, REACH, False),  # a sensor that hit nothing: the cutoff clips both signs
        (REACH, REACH, False),  # a sensor's hit beyond its cutoff
        (1.7, REACH, False),  # a ray's hit beyond the range
        (float("inf"), REACH, False),
        (float("-inf"), REACH, False),
        (float("nan"), 0.0, True),  # nothing is known: take the worst
    ],
)
def test_single_readings(reading: float, distance: float, hit: bool) -> None:
    ranges, hits = decode(np.array([reading]), REACH)
    assert ranges.tolist() == [distance]
    assert hits.tolist() == [hit]


def test_ray_that_starts_inside_an_obstacle_is_a_hit() -> None:
    """MuJoCo then reports the way out, which is no farther than the obstacle is deep."""
    ranges, hits = decode(np.array([0.12, 0.79]), REACH)
    assert hits.all() and ranges.tolist() == [0.12, 0.79]


@given(st.lists(st.floats(allow_nan=True, allow_infinity=True), min_size=1, max_size=40))
def test_ranges_are_always_usable(readings: list[float]) -> None:
    given_readings = np.array(readings)
    before = given_readings.copy()
    ranges, hits = decode(given_readings, REACH)
    assert ((ranges >= 0.0) & (ranges <= REACH)).all()
    assert (ranges[~hits] == REACH).all() and (ranges[hits] < REACH).all()
    assert np.array_equal(given_readings, before, equal_nan=True)


@pytest.mark.parametrize("count", [4, 36, 180, 7])
def test_bearings_go_once_round(count: int) -> None:
    bearings: FloatArray = ray_bearings(count)
    assert bearings[0] == -pi and bearings[-1] < pi
    assert np.diff(bearings) == pytest.approx(2 * pi / count)
    if count % 2 == 0:
        assert np.abs(bearings).min() < 1e-12  # one ray looks straight ahead
