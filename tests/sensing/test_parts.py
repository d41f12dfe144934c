"""Where outlines part."""

from itertools import pairwise

import numpy as np
import pytest

from fuzzynav_mj.sensing.parts import convex_parts


@pytest.mark.parametrize(
    ("corners", "parts"),
    [
        (((0.0, 0.3), (0.0, 0.0), (0.0, -0.3)), 1),  # straight
        (((0.1, 0.2), (0.0, 0.0), (0.1, -0.2)), 1),  # a corner towards the sensor at x < 0
        (((-0.1, 0.2), (0.0, 0.0), (-0.1, -0.2)), 2),  # one away from it
        (((-0.02, 0.2), (0.0, 0.0), (-0.02, -0.2)), 1),  # hardly one
    ],
)
def test_outlines_part_in_corners_that_point_away(
    corners: tuple[tuple[float, float], ...], parts: int
) -> None:
    """Bearings grow, so hits are listed from right to left: here from -y to y."""
    chain = np.array(corners[::-1])
    hits = np.concatenate(
        [a + np.linspace(0.05, 0.95, 8)[:, None] * (b - a) for a, b in pairwise(chain)]
    )
    joined = np.append(np.full(len(hits) - 1, True), False)
    part = convex_parts(np.ascontiguousarray(hits.T), joined)
    assert part[-1] + 1 == parts and (np.diff(part) >= 0).all()
    if parts == 2:
        assert (part == 0).sum() == (part == 1).sum() == 8


def test_outlines_part_where_they_are_not_joined() -> None:
    points = np.array([[0.5, 0.5, 0.5, 0.5], [0.0, 0.02, 0.1, 0.12]])
    joined = np.array([True, False, True, False])
    assert convex_parts(points, joined).tolist() == [0, 0, 1, 1]
    assert convex_parts(points[:, :1], joined[3:]).tolist() == [0]
    assert convex_parts(points[:, :0], joined[:0]).tolist() == []
