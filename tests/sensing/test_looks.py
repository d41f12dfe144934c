"""Which hits one look joins to a surface."""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from made_scans import HERE, scan_of

from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.sensing.looks import depth_behind, take_look
from fuzzynav_mj.types import LaserScan, Pose2D


def test_a_tip_and_what_lies_far_behind_it_are_not_one_side() -> None:
    """Jumps of 9 and 17 cm from ray to ray differ by 1.7 degrees only: both lie along the rays."""
    ranges = np.full(180, 0.8)
    ranges[78:90] = [0.74, 0.73, 0.72, 0.55, 0.46, 0.47, 0.49, 0.51, 0.53, 0.54, 0.55, 0.56]
    look = take_look(LaserScan(0.0, ray_bearings(180), ranges, ranges < 0.8, 0.8), HERE)
    along = look.normals[:, 80] @ look.normals[:, 81]
    assert 0.995 < along < 0.9999
    assert look.joined[78:80].all() and not look.joined[80:82].any() and look.joined[82:89].all()


def test_a_side_seen_at_a_grazing_angle_is_one() -> None:
    """Hits 12 cm apart and more, on one line to the last digit."""
    wall = np.array([[-1.0, 0.1], [1.0, 0.1], [1.0, 0.15], [-1.0, 0.15]])
    look = take_look(scan_of([wall], 0.0), HERE)
    steps = np.hypot(*np.diff(look.points[:, look.hit]))
    assert steps.max() > 0.12 and look.joined[look.hit][:-1].all()


@pytest.mark.parametrize("facing", [-170.0, -90.0, -20.0, 0.0, 45.0, 100.0, 135.0, 179.0])
@pytest.mark.parametrize("ray", [0, 30, 89, 150, 179])
def test_depth_counts_the_rays_on_both_sides_whichever_way_the_robot_faces(
    facing: float, ray: int
) -> None:
    """A single ray reaches 0.3 m, the others 0.8: places half a ray beside it are 0.1 m behind."""
    ranges = np.full(180, 0.8)
    ranges[ray] = 0.3
    scan = LaserScan(0.0, ray_bearings(180), ranges, ranges < 0.8, 0.8)
    look = take_look(scan, Pose2D(1.0, 2.0, radians(facing)))
    for beside, depth in ((-1.5, 0.4), (-0.5, -0.1), (0.5, -0.1), (1.5, 0.4)):
        bearing = radians(facing) - pi + (ray + beside) * (2 * pi / 180)
        x, y = 1.0 + 0.4 * cos(bearing), 2.0 + 0.4 * sin(bearing)
        assert depth_behind(x, y, look) == pytest.approx(depth)
