"""Movers that slide along a flat side of theirs, of which only the end that leads shows it."""

import numpy as np
import pytest
from made_scans import HERE, PERIOD, scan_of, square

from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.sensing.looks import take_look
from fuzzynav_mj.sensing.perception import Perceiver
from fuzzynav_mj.types import FloatArray, LaserScan, Perception

# A wall behind the movers, and one that a mover slides along.
FAR = np.array([[0.7, -0.6], [0.75, -0.6], [0.75, 0.6], [0.7, 0.6]])
NEAR = np.array([[0.53, -0.6], [0.58, -0.6], [0.58, 0.6], [0.53, 0.6]])


def seen_after(looks: int, speed: float, wall: FloatArray) -> Perception:
    """The last look at a square, 20 cm wide, that slides past in front of a wall; its side that
    faces the robot is 41 cm away."""
    perceiver = Perceiver(DEFAULT_ROBOT)
    for number in range(looks):
        mover = square(0.51, -0.1 + speed * PERIOD * number)
        seen = perceiver.perceive(scan_of([mover, wall], PERIOD * number), HERE)
    return seen


def velocities(seen: Perception) -> tuple[FloatArray, FloatArray]:
    """(2, k) velocities told of the hits on the square's side, and of all others."""
    told = [(o.points, np.tile(o.velocity, (len(o.points), 1))) for o in seen.obstacles]
    points, moves = (np.concatenate(rows) for rows in zip(*told, strict=True))
    side = np.abs(points[:, 0] - 0.41) < 1e-6
    assert side.sum() >= 10
    return moves[side].T, moves[~side].T


@pytest.mark.parametrize("speed", [0.12, 0.2, 0.4])
def test_a_side_that_slides_along_itself_is_seen_to_move_as_a_whole(speed: float) -> None:
    side, rest = velocities(seen_after(5, speed, FAR))
    np.testing.assert_allclose(side[1], speed, atol=0.05)
    np.testing.assert_allclose(side[0], 0.0, atol=0.01)
    assert not rest.any()


def test_a_wall_that_a_mover_slides_along_stands() -> None:
    """It is 2 cm behind the mover's back: one group with it."""
    side, rest = velocities(seen_after(6, 0.2, NEAR))
    np.testing.assert_allclose(side[1], 0.2, atol=0.05)
    assert (rest != 0.0).any(axis=0).sum() <= 2  # a hit in the corner on either side


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
