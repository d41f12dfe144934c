"""Groups of hits, and where moving and standing ones are parted; counted by hand."""

from math import pi

import numpy as np
import pytest

from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.sensing.looks import Look, take_look
from fuzzynav_mj.sensing.segmentation import (
    NEW,
    STANDS,
    Hits,
    divide,
    drop_single,
    gather_hits,
    moved_as_one,
    run_bounds,
)
from fuzzynav_mj.types import IntArray, LaserScan, Pose2D

COUNT = 180
KINDS = {"m": 1, "s": -1, "?": 0}


def look(arcs: list[tuple[int, int, float]], pose: Pose2D) -> Look:
    """What meets something at `range` on the rays from `first` to `last`."""
    ranges = np.full(COUNT, 0.8)
    for first, last, distance in arcs:
        ranges[np.arange(first, last + 1) % COUNT] = distance
    return take_look(LaserScan(0.0, ray_bearings(COUNT), ranges, ranges < 0.8, 0.8), pose)


def flags_of(kinds: str) -> IntArray:
    return np.array([KINDS[kind] for kind in kinds], dtype=np.intp)


def row_of(groups: str, step: float = 0.02, parts: str = "") -> Hits:
    """Hits on a line, `step` m apart, with a gap before each new letter, and a new part of the
    outline with each new letter of `parts`, those of the groups by default."""
    count = len(groups)
    points = np.array([np.arange(count) * step, np.zeros(count)])
    first = np.array([i == 0 or groups[i] != groups[i - 1] for i in range(count)], dtype=bool)
    part = np.array([ord(letter) for letter in parts or groups], dtype=np.intp)
    return Hits(points, np.arange(count), first, part)


@pytest.mark.parametrize("yaw", [0.0, 1.0, -pi])
def test_groups_are_parted_by_gaps_and_not_by_the_first_ray(yaw: float) -> None:
    """One arc goes across the ray behind the robot, another is stepped in range by 0.2 m."""
    hits = gather_hits(look([(-5, 5, 0.4), (60, 65, 0.3), (66, 70, 0.5)], Pose2D(2.0, 1.0, yaw)))
    rays = np.concatenate((np.arange(60, 71), np.arange(-5, 6) % COUNT))
    order = np.roll(rays, -int(np.flatnonzero(rays == hits.rays[0])[0]))
    assert hits.rays.tolist() == order.tolist()
    starts = {int(ray) for ray in hits.rays[hits.first]}
    assert starts == {60, 66, COUNT - 5}


def divided(
    groups: str, flags: str, claims: str, centre: float = 0.05, step: float = 0.02, parts: str = ""
) -> str:
    """Owners as text: 0..9 a known mover, n new, s stands. `claims` names movers or none (.)."""
    hits = row_of(groups, step, parts)
    around = look([], Pose2D(0.0, 0.0, 0.0))
    around.joined[: max(len(groups) - 1, 0)] = ~hits.first[1:]
    claimed = np.array([-1 if c == "." else int(c) for c in claims], dtype=np.intp)
    centres = np.array([[centre, 0.0], [centre, 0.0]])
    owners = divide(hits, flags_of(flags), claimed, centres, around, 0.7)
    names = {STANDS: "s", NEW: "n"}
    return "".join(names.get(int(owner), str(owner)) for owner in owners)


def test_no_hit_no_group() -> None:
    hits = gather_hits(look([], Pose2D(0.0, 0.0, 0.0)))
    assert hits.points.shape == (2, 0) and len(hits.rays) == len(hits.first) == 0
    assert divided("", "", "") == ""
    assert run_bounds(hits.first, np.empty(0, dtype=np.intp)).tolist() == [0]


@pytest.mark.parametrize(
    ("groups", "flags", "owners"),
    [
        ("aaaabb", "ssssss", "ssssss"),
        ("aaaabb", "??????", "ssssss"),  # nothing known: standing
        ("aaaaaaaabb", "s????s?smm", "ssssssssnn"),
        ("aaaa", "smss", "ssss"),  # a lone hit is overruled by its neighbours
        ("aaaaaaaa", "smmsssss", "nnnnnnnn"),  # a quarter moves: so does all of it
        ("aabb", "smms", "snns"),  # one hit does not move a group
    ],
)
def test_groups_that_nobody_claims(groups: str, flags: str, owners: str) -> None:
    assert divided(groups, flags, "." * len(groups)) == owners


def test_large_group_is_split_where_motion_ends_and_unknown_hits_go_with_those_before() -> None:
    assert divided("a" * 12, "??mmm??sssss", "." * 12, step=0.1) == "nnnnnnnsssss"


@pytest.mark.parametrize(
    ("flags", "claims", "owners"),
    [
        ("mmmm??", "0000..", "000000"),  # two hits came into view beside it
        ("mmsss", "0....", "00sss"),  # a hit that moves beside it; most of the group stands
        ("mmmmsm", "0000.1", "000001"),  # most of a small group is known: all of it is
        ("ssss", "0000", "0000"),  # a side that slides along itself
    ],
)
def test_hits_beside_known_movers(flags: str, claims: str, owners: str) -> None:
    assert divided("a" * len(flags), flags, claims) == owners


def test_standing_hits_far_from_where_the_mover_should_be_are_none_of_its() -> None:
    assert divided("aaaa", "ssss", "0000", centre=0.3) == "ssss"


def test_what_comes_out_from_behind_a_mover_is_not_given_to_it() -> None:
    """Moving hits more than 5 cm from its own, which no mover claims, are new; others are its, and
    so is what goes on in one with its own, without a corner that points away."""
    other = "aaaaabbbb"
    assert divided("a" * 9, "?????mmmm", "00000....", step=0.03, parts=other) == "000000nnn"
    assert divided("a" * 9, "?????????", "00000....", step=0.03, parts=other) == "000000000"
    assert divided("a" * 9, "?????mmmm", "00000....", step=0.03) == "000000000"


def test_a_wall_beside_a_mover_stands() -> None:
    wall = "aaaabbbbbbbb"
    assert divided("a" * 12, "mmmm????ssss", "0000........", step=0.08) == "00000000ssss"
    assert divided("a" * 12, "mmmm????ssss", "0000........", 0.05, 0.08, wall) == "0000ssssssss"
    # A group no larger than a mover: what is known not to move is none of it.
    assert divided("a" * 12, "mmmmmmm??sss", "0000000.....", parts="aaaaaaabbbbb") == "0000000sssss"


def test_a_side_that_slides_along_itself_beside_a_wall_is_its_movers() -> None:
    """Only the face across its way shows that it moves; the wall makes the group a large one."""
    parts = "aaaaaabbbbbb"
    assert divided("a" * 12, "mmssssssssss", "000000......", step=0.08, parts=parts) == (
        "000000ssssss"
    )
    assert divided("a" * 12, "ssssssssssss", "000000......", step=0.08, parts=parts) == "s" * 12


@pytest.mark.parametrize(
    ("parts", "step", "moved"),
    [
        ("a" * 8, 0.02, "mmmmmmmm"),  # one body: all of it, though its side slides along itself
        ("aaaabbbb", 0.02, "ssssmmmm"),  # the other part may be a wall
        ("a" * 8, 0.15, "sssssssm"),  # a metre long: no mover
    ],
)
def test_a_part_moves_as_a_whole_if_a_hit_comes_where_it_was_free(
    parts: str, step: float, moved: str
) -> None:
    hits = row_of("a" * 8, step, parts)
    intrudes = np.arange(8) == 7
    found = moved_as_one(hits, flags_of("sssssssm"), intrudes, 0.7)
    assert found.tolist() == flags_of(moved).tolist()
    nowhere = moved_as_one(hits, flags_of("sssssssm"), np.zeros(8, dtype=bool), 0.7)
    assert nowhere.tolist() == flags_of("sssssssm").tolist()


def test_bounds_part_groups_and_owners() -> None:
    first = np.array([True, False, False, True, False])
    assert run_bounds(first, np.array([0, 0, -1, -1, -1])).tolist() == [0, 2, 3, 5]


def test_single_moving_hits_tell_nothing() -> None:
    first = np.array([True, False, False, False, False, True, False])
    dropped = drop_single(first, flags_of("msmmsms"))
    assert dropped.tolist() == flags_of("?smms?s").tolist()
    parted = drop_single(np.array([True, True]), flags_of("mm"))  # not in one group
    assert parted.tolist() == flags_of("??").tolist()
