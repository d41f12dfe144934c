"""What the priorities measure on rolled-out candidates, by hand."""

from math import pi

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav_mj.planners.priorities import (
    cheapest,
    closest_approach,
    secondary_costs,
    stand_still,
    way_lengths,
)
from fuzzynav_mj.types import FloatArray


def way(*places: tuple[float, float]) -> FloatArray:
    """(1, T, 3) a candidate that passes these places."""
    return np.array([[(x, y, 0.0) for x, y in places]])


def test_length_is_that_of_all_legs_up_to_the_last_step_that_counts() -> None:
    poses = way((0.0, 0.0), (0.3, 0.4), (0.3, 0.0), (5.0, 5.0))
    assert abs(way_lengths(poses, 3)[0] - 0.9) < 1e-15
    assert way_lengths(poses, 1)[0] == 0.0


def test_nearest_place_counts_not_the_last() -> None:
    poses = way((1.0, 0.0), (0.5, 0.0), (1.0, 0.0), (0.0, 0.0))
    assert closest_approach(poses, 3, (0.0, 0.0))[0] == 0.5


def test_turning_on_the_spot_is_not_standing_still() -> None:
    poses = np.array(
        [
            [[0.2, 0.0, 0.0], [0.03, -0.03, 0.03]],  # ends where it began
            [[0.0, 0.0, 0.0], [0.0, 0.0, 0.1]],
            [[0.0, 0.0, 0.0], [0.0, -0.04, 0.0]],
        ]
    )
    assert stand_still(poses, 0.03).tolist() == [True, False, False]


def test_costs_of_room_reverse_and_turning_add_up() -> None:
    gaps, speed = np.array([0.2, 0.06, 0.2, 0.2]), np.array([0.5, 0.5, -0.5, 0.5])
    direction = np.array([0.0, 0.0, 0.0, 3.0])
    costs = secondary_costs(gaps, speed, direction, pi, pi, 0.10, 1.5, 0.1, 0.02)
    np.testing.assert_allclose(costs, [0.0, 0.06, 0.1, 0.06], atol=1e-15)


@given(st.lists(st.tuples(st.integers(-5, 5), st.booleans()), min_size=1, max_size=9))
def test_cheapest_is_the_first_of_the_smallest_allowed(rows: list[tuple[int, bool]]) -> None:
    costs = np.array([float(cost) for cost, _ in rows])
    allowed = np.array([allow for _, allow in rows])
    found = cheapest(costs, allowed)
    if not allowed.any():
        assert found == -1
    else:
        assert found == int(np.where(allowed, costs, np.inf).argmin())
