"""Whose the hits of a look are, without known movers."""

import numpy as np
import pytest
from made_scans import HERE, REACH, scan_of, square

from fuzzynav_mj.sensing.evidence import Evidence
from fuzzynav_mj.sensing.expected import NOBODY
from fuzzynav_mj.sensing.looks import take_look
from fuzzynav_mj.sensing.ownership import Owned, owners_of
from fuzzynav_mj.sensing.segmentation import NEW, STANDS

WALL = np.array([[-0.6, 0.5], [0.6, 0.5], [0.6, 0.6], [-0.6, 0.6]])


def owned(speed: float, looks: int, still: float = 0.01) -> Owned:
    """A wall on the left, and a square ahead that has come nearer since the look before."""
    before = take_look(scan_of([WALL, square(0.6, 0.0)], 0.0), HERE)
    now = take_look(scan_of([WALL, square(0.6 - 0.1 * speed, 0.0)], 0.1), HERE)
    evidence = Evidence(0.9, 0.05, REACH, still, 2.0, 0.0, False, 0.7)
    earlier = (before, before) if looks else (now, now)
    return owners_of(now, earlier, looks, NOBODY, evidence)


@pytest.mark.parametrize("speed", [0.12, 0.3, 0.8])
def test_what_came_nearer_is_a_new_mover_and_the_wall_stands(speed: float) -> None:
    found = owned(speed, 1)
    ahead = found.hits.points[1] < 0.3
    assert ahead.sum() >= 9 and (~ahead).sum() >= 20
    assert (found.owners[ahead] == NEW).all() and (found.owners[~ahead] == STANDS).all()


def test_a_first_look_tells_no_mover() -> None:
    assert (owned(0.3, 0).owners == STANDS).all()


def test_what_moved_less_than_can_be_seen_stands() -> None:
    assert (owned(0.12, 1, still=0.02).owners == STANDS).all()
