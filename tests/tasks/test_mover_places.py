"""Places looked up step by step are those of the motions, in whatever order they are asked for."""

import numpy as np

from fuzzynav_mj.scenarios.motion import Mover, waypoint_motion
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.tasks.mover_places import STEPS, MoverPlaces

PERIOD = 0.005
MOVERS = [
    Mover(Shape(None, (0.0, 0.0, 0.1)), waypoint_motion(np.array(way), speed))
    for way, speed in (([[0.0, 0.0], [2.0, 1.0]], 0.3), ([[1.0, 0.0], [1.0, 3.0]], 0.5))
]


def test_rows_are_the_motions_at_those_steps_forwards_and_back() -> None:
    places = MoverPlaces(MOVERS, PERIOD)
    for first, count in ((0, 1), (20, 20), (STEPS - 5, 20), (3 * STEPS, 20), (7, 1)):
        times = PERIOD * (first + np.arange(count))
        expected = np.stack([mover.motion.positions(times) for mover in MOVERS], axis=1)
        assert np.array_equal(places.rows(first, count), expected)


def test_a_world_without_movers_has_rows_without_places() -> None:
    assert MoverPlaces([], PERIOD).rows(40, 20).shape == (20, 0, 2)
