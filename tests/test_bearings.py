"""Which ray points at a place, against the exact bearing."""

from math import atan2, cos, floor, pi, sin

from hypothesis import given
from hypothesis import strategies as st

from fuzzynav_mj.bearings import bearing_of, nearest_ray, ray_before

COUNT = 180
STEP = 2 * pi / COUNT

angles = st.floats(-pi, pi)
distances = st.floats(1e-3, 10.0)
firsts = st.floats(-2 * pi, pi)


@given(angles, distances)
def test_bearing_is_exact_to_a_hundred_thousandth(angle: float, distance: float) -> None:
    x, y = distance * cos(angle), distance * sin(angle)
    off = bearing_of(x, y) - atan2(y, x)
    assert abs((off + pi) % (2 * pi) - pi) <= 1.2e-5


@given(angles, distances, firsts)
def test_rays_are_those_of_the_exact_bearing(angle: float, distance: float, first: float) -> None:
    x, y = distance * cos(angle), distance * sin(angle)
    place = (atan2(y, x) - first) * (COUNT / (2 * pi))
    assert nearest_ray(x, y, first, COUNT) == floor(place + 0.5) % COUNT
    assert ray_before(x, y, first, COUNT) == floor(place) % COUNT


@given(st.integers(0, COUNT - 1), distances, firsts)
def test_a_place_between_two_rays_is_after_the_first_of_them(
    ray: int, distance: float, first: float
) -> None:
    """Whichever way the first ray points, and where a bearing passes from pi to -pi, too."""
    for share, nearest in ((0.1, ray), (0.4, ray), (0.6, ray + 1), (0.9, ray + 1)):
        bearing = first + (ray + share) * STEP
        x, y = distance * cos(bearing), distance * sin(bearing)
        assert ray_before(x, y, first, COUNT) == ray
        assert nearest_ray(x, y, first, COUNT) == nearest % COUNT
