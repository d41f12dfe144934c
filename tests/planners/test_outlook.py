"""Which candidates are admissible, in scenes whose gaps are known by construction."""

from math import pi

import numpy as np
import pytest
from point_scene import SETTINGS, scene_of

from fuzzynav_mj.planners.headings import HORIZON
from fuzzynav_mj.planners.motions import Motions, candidate_motions
from fuzzynav_mj.planners.outlook import Outlook, look_ahead
from fuzzynav_mj.planners.passing import OUTLOOK
from fuzzynav_mj.robot import DEFAULT_ROBOT as SPEC
from fuzzynav_mj.types import FloatArray, Twist2D


def outlook(
    motions: Motions,
    standing: FloatArray | None = None,
    expected: FloatArray | None = None,
    possible: FloatArray | None = None,
    doubt: float = 0.0,
) -> Outlook:
    """Among points that stand (k, 2), and points that stay where movers are and may be (k, 2)."""
    stands, is_there, may_be = (
        np.empty((0, 2)) if points is None else points for points in (standing, expected, possible)
    )
    stays = np.tile(is_there, (OUTLOOK, 1, 1)), np.tile(may_be, (HORIZON, 1, 1))
    return look_ahead(motions, scene_of(stands, *stays, doubt), SPEC, SETTINGS)


def straight_on(motions: Motions, speed: float) -> int:
    """The candidate that goes straight ahead at a speed, m/s."""
    ahead = (np.abs(motions.speed - speed) < 1e-9) & (np.abs(np.sin(motions.direction)) < 1e-9)
    return int(np.flatnonzero(ahead)[0])


def wall_beside(gap: float) -> FloatArray:
    """Points of a wall to the right, along the robot's way."""
    x = np.arange(-0.8, 0.8, 0.02)
    return np.stack((x, np.full(len(x), -SPEC.half_side - gap)), axis=1)


@pytest.mark.parametrize(("gap", "fast"), [(0.005, False), (0.015, False), (0.06, True)])
def test_close_to_a_wall_it_may_creep_along_but_not_drive(gap: float, fast: bool) -> None:
    motions = candidate_motions(0.0, Twist2D(0.0, 0.0), SPEC)
    found = outlook(motions, wall_beside(gap))
    assert found.static_ok[straight_on(motions, 0.2 * SPEC.max_speed)]
    assert found.static_ok[straight_on(motions, SPEC.max_speed)] == fast


def test_nothing_drives_nearer_to_a_wall_that_is_too_near() -> None:
    motions = candidate_motions(-pi / 2, Twist2D(0.0, 0.0), SPEC)
    found = outlook(motions, wall_beside(0.01))
    assert (found.static >= 0.01 - 0.002 - 1e-9)[found.static_ok].all()


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_margins_to_movers_are_smaller_where_they_are_not_expected(share: float) -> None:
    """Standing still beside points that stay; the margin at the horizon's end is the widest."""
    widest = SETTINGS.moving_margin + SETTINGS.moving_margin_growth * 1.6
    motions = candidate_motions(0.0, Twist2D(0.0, 0.0), SPEC)
    beside = np.array([[0.0, SPEC.half_side + share * widest]])
    assert outlook(motions, expected=beside).admissible[-1] == (share > 1.0)
    nearer = np.array([[0.0, SPEC.half_side + share * SETTINGS.unlikely_share * widest]])
    assert outlook(motions, possible=nearer).admissible[-1] == (share > 1.0)
    # Where their speeds are hardly known, they may as well be there.
    doubted = outlook(motions, possible=beside, doubt=SETTINGS.doubtful)
    assert doubted.admissible[-1] == (share > 1.0)


def test_movers_far_away_make_no_difference_and_near_ones_crowd() -> None:
    motions = candidate_motions(0.0, Twist2D(0.0, 0.0), SPEC)
    far, near = np.array([[0.0, 0.7]]), np.array([[0.0, SPEC.half_side + 0.12]])
    assert outlook(motions, expected=far).crowding[-1] == 0.0
    berth = SETTINGS.moving_gap + SETTINGS.moving_gap_growth * 0.9
    assert outlook(motions, expected=near).crowding[-1] == pytest.approx(berth - 0.12)
    assert outlook(motions, expected=near).moving[-1] == pytest.approx(0.12)
    touched = outlook(motions, expected=np.array([[0.0, SPEC.half_side]]))
    assert touched.alive[-1, 0] == 0.0 and not touched.admissible[-1]
