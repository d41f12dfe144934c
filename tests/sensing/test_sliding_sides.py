"""Movers that slide along a flat side of theirs, of which only the end that leads shows it."""

import numpy as np
import pytest
from made_scans import HERE, PERIOD, scan_of, square

from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.sensing.perception import Perceiver
from fuzzynav_mj.types import FloatArray, Perception

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
