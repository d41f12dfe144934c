"""What a late scan showed, at the time when it is known."""

from math import hypot, pi

import numpy as np
import pytest

from fuzzynav_mj.sensing.lateness import brought_up
from fuzzynav_mj.types import (
    FloatArray,
    LaserScan,
    PerceivedObstacle,
    Perception,
    Pose2D,
    VisibilityMatrix,
)

BEARINGS = -pi + np.arange(180) * (2 * pi / 180)
NOTHING = VisibilityMatrix(np.zeros((4, 180), dtype=bool), np.zeros(4, int), np.zeros(4, int))


def seen(points: FloatArray, velocity: tuple[float, float], turn_rate: float = 0.0) -> Perception:
    """One obstacle seen from the origin, looking along x."""
    distance = np.hypot(points[:, 0], points[:, 1])
    nearest = int(distance.argmin())
    ranges = np.full(180, 0.8)
    rays = np.rint((np.arctan2(points[:, 1], points[:, 0]) + pi) * 180 / (2 * pi)).astype(int)
    ranges[rays % 180] = distance
    obstacle = PerceivedObstacle(
        points=points,
        nearest_point=points[nearest],
        distance=float(distance[nearest]),
        bearing=float(np.arctan2(points[nearest, 1], points[nearest, 0])),
        dynamic=velocity != (0.0, 0.0),
        approaching=velocity[0] < 0.0,
        velocity=np.array(velocity),
        turn_rate=turn_rate,
    )
    return Perception(LaserScan(0.0, BEARINGS, ranges, ranges < 0.8, 0.8), (obstacle,), NOTHING)


FACE = np.array([(0.5, y) for y in np.arange(-0.1, 0.101, 0.01)])


def test_what_moves_has_gone_on() -> None:
    now = brought_up(seen(FACE, (-0.4, 0.0)), Pose2D(0.0, 0.0, 0.0), 0.1)
    (obstacle,) = now.obstacles
    np.testing.assert_allclose(obstacle.points, FACE - (0.04, 0.0))
    assert obstacle.distance == pytest.approx(0.46) and obstacle.approaching
    assert now.scan.ranges[90] == pytest.approx(0.46, abs=1e-9)


def test_what_turns_has_gone_on_round_its_bend() -> None:
    """0.1 s at 0.4 m/s and 1.5 rad/s is a chord at half the angle, and the velocity has turned."""
    now = brought_up(seen(FACE, (-0.4, 0.0), turn_rate=1.5), Pose2D(0.0, 0.0, 0.0), 0.1)
    (obstacle,) = now.obstacles
    np.testing.assert_allclose(obstacle.velocity, -0.4 * np.array([np.cos(0.15), np.sin(0.15)]))
    way = -0.04 * np.array([np.cos(0.075), np.sin(0.075)])
    np.testing.assert_allclose(obstacle.points, FACE + way)


def test_what_stands_is_nearer_by_the_way_driven() -> None:
    now = brought_up(seen(FACE, (0.0, 0.0)), Pose2D(0.05, 0.0, 0.0), 0.1)
    (obstacle,) = now.obstacles
    np.testing.assert_array_equal(obstacle.points, FACE)
    assert obstacle.distance == pytest.approx(0.45) and not obstacle.dynamic
    assert now.scan.ranges[90] == pytest.approx(0.45, abs=1e-9)


def test_turning_moves_the_bearing_and_nothing_else() -> None:
    turned = brought_up(seen(FACE, (0.0, 0.0)), Pose2D(0.0, 0.0, pi / 2), 0.1)
    (obstacle,) = turned.obstacles
    assert obstacle.bearing == pytest.approx(-pi / 2)
    assert turned.scan.hit.sum() == seen(FACE, (0.0, 0.0)).scan.hit.sum()
    assert turned.scan.ranges[45] == pytest.approx(0.5, abs=1e-9)


def test_rays_between_the_points_hit_the_line_between_them() -> None:
    coarse = FACE[::10]
    now = brought_up(seen(coarse, (0.0, 0.0)), Pose2D(0.0, 0.0, 0.0), 0.1)
    for ray in range(86, 95):
        bearing = float(BEARINGS[ray])
        assert now.scan.ranges[ray] == pytest.approx(0.5 / np.cos(bearing), abs=1e-9)
    assert hypot(*now.obstacles[0].nearest_point.tolist()) == pytest.approx(0.5)
