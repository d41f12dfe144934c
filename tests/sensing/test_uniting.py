"""Two tracks that turn out to be faces of one mover, and two that do not."""

import numpy as np
from made_outlines import CORNER, followed

from fuzzynav_mj.sensing.uniting import absorb, are_one


def test_two_faces_of_one_mover_become_one_track() -> None:
    velocity = np.array([0.3, 0.2])
    one, other = followed(CORNER[:2], velocity, 8), followed(CORNER[1:], velocity, 8)
    assert are_one(one, other)
    absorb(one, other)
    np.testing.assert_allclose(one.velocity, velocity, atol=0.01)
    assert one.expected_outline.shape[1] == 8 + 10


def test_faces_of_two_movers_stay_two_tracks() -> None:
    one = followed(CORNER, np.array([0.3, 0.2]), 8)
    other = followed(CORNER[1:], np.array([-0.1, 0.2]), 8)
    assert not are_one(one, other)
