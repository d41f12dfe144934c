"""Which hits beside a known mover cannot be its own; counted by hand."""

import numpy as np
import pytest

from fuzzynav_mj.sensing.claims import without_strangers
from fuzzynav_mj.sensing.expected import Expected
from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.sensing.looks import Look, take_look
from fuzzynav_mj.sensing.segmentation import NEW, STANDS, Hits
from fuzzynav_mj.types import FloatArray, IntArray, LaserScan, Pose2D

ELAPSED, REACH = 0.1, 0.04
VELOCITY = (0.0, 0.3)


def look_before(beyond: float) -> Look:
    """A mover on the rays up to 90, straight ahead, at 0.4 m; what is seen past it is `beyond`."""
    ranges = np.where(np.arange(180) <= 90, 0.4, beyond)
    return take_look(
        LaserScan(0.0, ray_bearings(180), ranges, ranges < 0.8, 0.8), Pose2D(0.0, 0.0, 0.0)
    )


def kept(ranges: list[float], flags: list[int], beyond: float = 0.7, claimed: int = 1) -> IntArray:
    """Owners of hits on the rays from 91 on, all given to the mover, which claims the first few."""
    rays = np.arange(len(ranges)) + 91
    bearings = ray_bearings(180)[rays]
    points: FloatArray = np.array(ranges) * np.array([np.cos(bearings), np.sin(bearings)])
    points[1] += ELAPSED * VELOCITY[1]  # it has gone on since
    hits = Hits(points, rays, rays == 91, np.zeros(len(rays), dtype=np.intp))
    claims = np.where(np.arange(len(rays)) < claimed, 0, STANDS)
    nothing = np.zeros((2, 1))
    mover = Expected(
        nothing,
        np.zeros(1, dtype=bool),
        nothing,
        np.zeros(1, dtype=np.intp),
        np.array([VELOCITY]),
        np.zeros((1, 2)),
        np.array([REACH]),
    )
    owners = np.zeros(len(rays), dtype=np.intp)
    found: IntArray = without_strangers(
        hits, np.array(flags), claims, owners, mover, look_before(beyond), ELAPSED
    )
    return found


def test_what_comes_out_beside_a_mover_where_it_was_free_is_new() -> None:
    assert kept([0.4] * 4, [1, 1, 1, 1]).tolist() == [0, NEW, NEW, NEW]
    assert kept([0.4] * 4, [0, 0, 0, 1]).tolist() == [0, NEW, NEW, NEW]
    assert kept([0.4] * 4, [0, 0, 0, 0]).tolist() == [0, STANDS, STANDS, STANDS]


@pytest.mark.parametrize("beyond", [0.3, 0.4, 0.43])
def test_what_something_hid_may_be_the_movers(beyond: float) -> None:
    """Rays that reached no farther than its uncertain place tell nothing."""
    assert kept([0.4] * 4, [1, 1, 1, 1], beyond).tolist() == [0, 0, 0, 0]


def test_a_single_hit_and_what_the_mover_claims_are_left_to_it() -> None:
    assert kept([0.4, 0.4], [1, 1]).tolist() == [0, 0]
    assert kept([0.4] * 4, [1, 1, 1, 1], claimed=4).tolist() == [0, 0, 0, 0]
