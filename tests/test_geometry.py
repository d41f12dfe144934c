"""Laws of the shared plane geometry."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon

from fuzzynav_mj.geometry import (
    convex_parts,
    counter_clockwise,
    footprint,
    footprint_corners,
    footprints,
    is_convex,
    is_simple_polygon,
    rotation,
    signed_area,
    wrap_angle,
)
from fuzzynav_mj.types import FloatArray, Pose2D

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
POCKET = np.array([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [4, 3], [4, 4], [0, 4]], dtype=float)


@st.composite
def star_polygons(draw: st.DrawFn) -> FloatArray:
    """Simple polygons, mostly concave, in a random order of turning."""
    count = draw(st.integers(3, 14))
    radii = draw(st.lists(st.floats(0.2, 3.0), min_size=count, max_size=count))
    shift = draw(st.floats(0.0, 2 * math.pi))
    angles = shift + 2 * np.pi * np.arange(count) / count
    polygon = np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
    return polygon[::-1] if draw(st.booleans()) else polygon


@given(st.floats(-1e4, 1e4))
def test_wrapped_angle_is_in_range_and_points_the_same_way(angle: float) -> None:
    wrapped = wrap_angle(angle)
    assert -math.pi <= wrapped < math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)


def test_wrap_angle_keeps_arrays_and_maps_pi_to_minus_pi() -> None:
    wrapped = wrap_angle(np.array([np.pi, -np.pi, 3 * np.pi / 2, 0.0]))
    np.testing.assert_allclose(wrapped, [-np.pi, -np.pi, -np.pi / 2, 0.0])
    assert isinstance(wrap_angle(7.0), float)


def test_rotation_turns_x_into_y_and_stacks() -> None:
    np.testing.assert_allclose(rotation(np.pi / 2) @ [1.0, 0.0], [0.0, 1.0], atol=1e-15)
    stacked = rotation(np.array([[0.1, 0.2, 0.3]]))
    assert stacked.shape == (1, 3, 2, 2)
    np.testing.assert_allclose(stacked[0, 0] @ stacked[0, 1], stacked[0, 2])


def test_signed_area_of_known_polygons() -> None:
    assert signed_area(SQUARE) == 1.0
    assert signed_area(SQUARE[::-1]) == -1.0
    assert signed_area(POCKET) == 10.0


@given(star_polygons())
def test_counter_clockwise_keeps_the_area_and_the_corners(polygon: FloatArray) -> None:
    turned = counter_clockwise(polygon)
    assert signed_area(turned) == pytest.approx(abs(signed_area(polygon)))
    assert sorted(map(tuple, turned)) == sorted(map(tuple, polygon))


@pytest.mark.parametrize(
    ("corners", "simple"),
    [
        (SQUARE, True),
        (POCKET, True),
        (SQUARE[::-1], True),
        (SQUARE[:2], False),
        (SQUARE[[0, 2, 1, 3]], False),  # crosses itself
        (SQUARE[[0, 1, 2, 3, 0]], False),  # repeats a corner
        (np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), False),  # spans nothing
        (np.array([[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]], dtype=float), False),  # touches itself
    ],
)
def test_simple_polygons(corners: FloatArray, simple: bool) -> None:
    assert is_simple_polygon(corners) is simple


def test_convexity_of_known_polygons() -> None:
    assert is_convex(SQUARE)
    assert not is_convex(POCKET)
    assert is_convex(np.insert(SQUARE, 1, [0.5, 0.0], axis=0))  # a straight corner is not reflex


@settings(max_examples=60)
@given(star_polygons())
def test_convex_parts_tile_the_polygon(polygon: FloatArray) -> None:
    parts = convex_parts(polygon)
    area = abs(signed_area(polygon))
    assert all(is_convex(part) and signed_area(part) > 0 for part in parts)
    assert sum(signed_area(part) for part in parts) == pytest.approx(area, rel=1e-12)
    union = shapely.union_all([Polygon(part) for part in parts])
    assert union.symmetric_difference(Polygon(polygon)).area <= 1e-9 * area
    corners = set(map(tuple, polygon))
    assert all(tuple(corner) in corners for part in parts for corner in part)


@settings(max_examples=60)
@given(star_polygons())
def test_no_two_neighbouring_convex_parts_could_be_merged(polygon: FloatArray) -> None:
    reflex = sum(
        not is_convex(counter_clockwise(polygon)[[i - 1, i, (i + 1) % len(polygon)]])
        for i in range(len(polygon))
    )
    # Hertel and Mehlhorn: at most two diagonals per reflex corner are needed
    assert len(convex_parts(polygon)) <= 2 * reflex + 1


def test_convex_polygon_is_one_part_and_pocket_needs_three() -> None:
    np.testing.assert_array_equal(convex_parts(SQUARE)[0], SQUARE)
    assert len(convex_parts(SQUARE)) == 1
    assert len(convex_parts(POCKET)) == 3


def test_footprint_corners_by_hand() -> None:
    corners = footprint_corners(Pose2D(1.0, 2.0, 0.0), 0.1)
    np.testing.assert_allclose(corners, [[1.1, 2.1], [0.9, 2.1], [0.9, 1.9], [1.1, 1.9]])
    diagonal = footprint_corners(Pose2D(0.0, 0.0, np.pi / 4), 0.1)
    np.testing.assert_allclose(diagonal[0], [0.0, 0.1 * 2**0.5], atol=1e-15)


@given(st.floats(-5, 5), st.floats(-5, 5), st.floats(-7, 7), st.floats(0.01, 2))
def test_footprint_is_a_square_about_its_pose(x: float, y: float, yaw: float, half: float) -> None:
    square = footprint(Pose2D(x, y, yaw), half)
    assert square.area == pytest.approx(4 * half**2)
    assert (square.centroid.x, square.centroid.y) == pytest.approx((x, y), abs=1e-9)
    quarter_turned = footprint(Pose2D(x, y, yaw + np.pi / 2), half)
    assert square.hausdorff_distance(quarter_turned) < 1e-9


def test_footprints_equal_one_footprint_at_a_time() -> None:
    poses = np.random.default_rng(0).uniform(-3, 3, (20, 3))
    many = footprints(poses, 0.1)
    assert many.shape == (20,)
    for square, pose in zip(many, poses, strict=True):
        one = footprint(Pose2D(*pose), 0.1)
        np.testing.assert_allclose(shapely.get_coordinates(square), shapely.get_coordinates(one))
