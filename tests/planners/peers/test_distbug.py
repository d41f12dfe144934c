"""DistBug as a point that moves among standing obstacles of pure geometry."""

from math import hypot, pi

import numpy as np
import pytest
import shapely
from solids import RANGE, scan_of

from fuzzynav_mj.planners.peers.clear_motion import hits_around
from fuzzynav_mj.planners.peers.distbug import GAIN, WIDTH, DistBug
from fuzzynav_mj.types import FloatArray, Pose2D

Point = tuple[float, float]

STEP, TOLERANCE = 0.1, 0.1


def strip(*corners: Point, half: float = 0.1) -> shapely.Geometry:
    """A wall along a broken line."""
    return shapely.LineString(corners).buffer(half, cap_style="flat", join_style="mitre")


def hits_at(place: Point, solid: shapely.Geometry) -> FloatArray:
    """(k, 2) hits around a place."""
    pose = Pose2D(*place, 0.0)
    return hits_around(scan_of(solid, pose), pose)


def walk(
    solid: shapely.Geometry, start: Point, goal: Point, longest: float
) -> tuple[str, list[Point]]:
    """Moves until the goal, a closed loop, or the longest way: which, and the places."""
    bug, places = DistBug(goal, TOLERANCE), [start]
    while STEP * len(places) < longest:
        x, y = places[-1]
        if hypot(goal[0] - x, goal[1] - y) <= TOLERANCE:
            return "goal", places
        course = bug.course((x, y), hits_at((x, y), solid), RANGE)
        if course.closed:
            return "closed", places
        dx, dy = course.target[0] - x, course.target[1] - y
        share = min(1.0, STEP / max(hypot(dx, dy), 1e-9))
        places.append((x + share * dx, y + share * dy))
    return "lost", places


ROOM = strip((-1, -1), (7, -1), (7, 7), (-1, 7), (-1, -1))
POCKET = ROOM | strip((2, 1.5), (4, 1.5), (4, 4.5), (2, 4.5))
HOOK = ROOM | strip((2.5, 2.6), (2, 2.6), (2, 1.5), (4, 1.5), (4, 4.5), (2, 4.5))
SLALOM = ROOM | strip((1, -1), (1, 5)) | strip((2.5, 1), (2.5, 7)) | strip((4, -1), (4, 5))
BOX = ROOM | shapely.box(4.2, 2.2, 5.8, 3.8).exterior.buffer(0.1)


@pytest.mark.parametrize("solid", [POCKET, HOOK, SLALOM], ids=["pocket", "hook", "slalom"])
@pytest.mark.parametrize("start", [(0.0, 3.0), (0.0, 0.2)])
def test_it_leaves_every_trap(solid: shapely.Geometry, start: Point) -> None:
    """Within the straight line and one and a half times around all boundaries, DistBug's worst
    case with each boundary met once; and without touching."""
    goal = (5.0, 3.0)
    around = shapely.length(solid.buffer(WIDTH).boundary)
    straight = hypot(goal[0] - start[0], goal[1] - start[1])
    end, places = walk(solid, start, goal, straight + 1.5 * around)
    assert end == "goal"
    assert shapely.distance(shapely.LineString(places), solid) > 0.1


@pytest.mark.parametrize("start", [(0.0, 3.0), (3.0, -0.5), (5.0, 6.0)])
def test_a_goal_shut_in_is_found_to_be_so(start: Point) -> None:
    """After once around the box, 1.7 m wide plus the disc's radius on all sides."""
    goal = (5.0, 3.0)
    straight = hypot(goal[0] - start[0], goal[1] - start[1])
    around = 4 * 1.7 + 2 * pi * (WIDTH + 0.1)
    end, places = walk(BOX, start, goal, straight + 1.3 * around)
    assert end == "closed"
    assert STEP * len(places) > 0.9 * around


def test_in_the_open_the_way_is_straight() -> None:
    end, places = walk(ROOM, (0.0, 0.0), (5.0, 3.0), 7.0)
    assert end == "goal"
    assert max(abs(5.0 * y - 3.0 * x) for x, y in places) < 1e-9


def test_every_boundary_is_met_nearer_to_the_goal() -> None:
    """The argument for completeness: from one meeting to the next the goal is `GAIN` nearer."""
    goal, start = (5.0, 3.0), (0.0, 3.0)
    bug, place, met, before = DistBug(goal, TOLERANCE), start, [], False
    for _ in range(800):
        course = bug.course(place, hits_at(place, SLALOM), RANGE)
        distance = hypot(goal[0] - place[0], goal[1] - place[1])
        if distance <= TOLERANCE:
            break
        if course.following and not before:
            met.append(distance)
        before = course.following
        dx, dy = course.target[0] - place[0], course.target[1] - place[1]
        share = STEP / max(hypot(dx, dy), STEP)
        place = (place[0] + share * dx, place[1] + share * dy)
    assert distance <= TOLERANCE
    assert len(met) >= 2
    assert (np.diff(met) <= -GAIN + STEP).all()
