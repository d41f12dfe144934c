"""Groups of hits, and where moving and standing ones are parted; counted by hand."""

from math import pi

import numpy as np
import pytest

from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.sensing.looks import Look, take_look
from fuzzynav_mj.sensing.segmentation import Hits, drop_single, gather_hits, split_by_motion
from fuzzynav_mj.types import IntArray, LaserScan, Pose2D

COUNT = 180
NOBODY = np.empty((0, 2))
KINDS = {"m": 1, "s": -1, "?": 0}


def look(arcs: list[tuple[int, int, float]], pose: Pose2D) -> Look:
    """What meets something at `range` on the rays from `first` to `last`."""
    ranges = np.full(COUNT, 0.8)
    for first, last, distance in arcs:
        ranges[np.arange(first, last + 1) % COUNT] = distance
    return take_look(LaserScan(0.0, ray_bearings(COUNT), ranges, ranges < 0.8, 0.8), pose)


def flags_of(kinds: str) -> IntArray:
    return np.array([KINDS[kind] for kind in kinds], dtype=np.intp)


def row_of(groups: str, step: float = 0.02) -> Hits:
    """Hits on a line, `step` m apart, with a gap before each new letter."""
    count = len(groups)
    points = np.array([np.arange(count) * step, np.zeros(count)])
    first = np.array([i == 0 or groups[i] != groups[i - 1] for i in range(count)])
    return Hits(points, np.arange(count), first)


@pytest.mark.parametrize("yaw", [0.0, 1.0, -pi])
def test_groups_are_parted_by_gaps_and_not_by_the_first_ray(yaw: float) -> None:
    """One arc goes across the ray behind the robot, another is stepped in range by 0.2 m."""
    hits = gather_hits(look([(-5, 5, 0.4), (60, 65, 0.3), (66, 70, 0.5)], Pose2D(2.0, 1.0, yaw)))
    rays = np.concatenate((np.arange(60, 71), np.arange(-5, 6) % COUNT))
    order = np.roll(rays, -int(np.flatnonzero(rays == hits.rays[0])[0]))
    assert hits.rays.tolist() == order.tolist()
    starts = {int(ray) for ray in hits.rays[hits.first]}
    assert starts == {60, 66, COUNT - 5}


def test_no_hit_no_group() -> None:
    hits = gather_hits(look([], Pose2D(0.0, 0.0, 0.0)))
    assert hits.points.shape == (2, 0) and len(hits.rays) == len(hits.first) == 0
    bounds, kinds = split_by_motion(hits, flags_of(""), NOBODY, 0.7)
    assert bounds.tolist() == [0] and len(kinds) == 0


@pytest.mark.parametrize(
    ("groups", "flags", "bounds", "kinds"),
    [
        ("aaaabb", "ssssss", [0, 4, 6], "ss"),
        ("aaaabb", "??????", [0, 4, 6], "ss"),  # nothing known: standing
        ("aaaaaaaabb", "s????s?smm", [0, 8, 10], "sm"),
        ("aaaa", "smss", [0, 4], "s"),  # a lone hit is overruled by its neighbours
        ("aaaaaaaa", "smmsssss", [0, 8], "m"),  # a quarter moves: so does all of it
        ("aabb", "smms", [0, 1, 2, 3, 4], "smms"),  # one hit does not move a group
    ],
)
def test_small_groups(groups: str, flags: str, bounds: list[int], kinds: str) -> None:
    found, said = split_by_motion(row_of(groups), flags_of(flags), NOBODY, 0.7)
    assert found.tolist() == bounds
    assert said.tolist() == flags_of(kinds).tolist()


def test_large_group_is_split_where_motion_ends_and_unknown_hits_go_with_those_before() -> None:
    hits = row_of("a" * 12, step=0.1)
    bounds, kinds = split_by_motion(hits, flags_of("??mmm??sssss"), NOBODY, 0.7)
    assert bounds.tolist() == [0, 7, 12]
    assert kinds.tolist() == flags_of("ms").tolist()


@pytest.mark.parametrize(("away", "kind"), [(0.10, "m"), (0.20, "s")])
def test_small_group_where_a_mover_is_expected_moves(away: float, kind: str) -> None:
    hits = row_of("aaaaa")
    expected = np.array([[9.0, 9.0], [0.04, away]])
    _, kinds = split_by_motion(hits, flags_of("sssss"), expected, 0.7)
    assert kinds.tolist() == flags_of(kind).tolist()


def test_single_moving_hits_tell_nothing() -> None:
    first = np.array([True, False, False, False, False, True, False])
    dropped = drop_single(first, flags_of("msmmsms"))
    assert dropped.tolist() == flags_of("?smms?s").tolist()
    parted = drop_single(np.array([True, True]), flags_of("mm"))  # not in one group
    assert parted.tolist() == flags_of("??").tolist()
