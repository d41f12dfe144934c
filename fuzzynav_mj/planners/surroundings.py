"""What a perception means for the roll-outs: what stands, and where what moves will be."""

from dataclasses import dataclass, replace
from math import cos, hypot, sin

import numpy as np

from fuzzynav_mj.bearings import nearest_ray
from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.headings import HORIZON
from fuzzynav_mj.planners.passing import OUTLOOK
from fuzzynav_mj.planners.prediction import displacements, going
from fuzzynav_mj.planners.reach import range_of_line
from fuzzynav_mj.planners.sight import Sight, thin, thin_around
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray, Perception, Pose2D

LONGEST_HIDDEN = 1.0  # m of an outline that is thought to go on behind a mover
MOVER_SPACING = 0.10  # as `sight.SPACING`, for movers: their margins are wider
NOTHING_MOVES = (
    np.empty((OUTLOOK, 0, 2)),
    np.empty((HORIZON, 0, 2)),
    np.empty((0, 2), dtype=np.intp),
    np.empty(0),
)


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """Robot-centred, axes parallel to the world's.

    Attributes:
        sight: what stands. Rays that a mover stops count as free, or as the outline that goes on
            behind it: it will go away.
        expected: (OUTLOOK, k, 2) where points of what moves will be at the end of each period, as
            far as its motion can be foreseen ...
        possible: (HORIZON, j, 2) ... and where else they may be.
        outlines: (movers, 2) how many of these points, and how many ways to go on, each has.
        shares: (ways,) how likely each of these is, mover by mover.
        doubt: the largest uncertainty of a mover's speed towards the robot, m/s.
    """

    sight: Sight
    expected: FloatArray
    possible: FloatArray
    outlines: IntArray
    shares: FloatArray
    doubt: float


def surroundings(perception: Perception, pose: Pose2D, spec: RobotSpec) -> Surroundings:
    """The surroundings of the robot at `pose`."""
    place = (pose.x, pose.y)
    scan = perception.scan
    standing = [o.points for o in perception.obstacles if not o.dynamic]
    movers = [o for o in perception.obstacles if o.dynamic]
    points = thin(np.concatenate(standing), place=place) if standing else np.empty((0, 2))
    bearings = scan.bearings + pose.yaw
    ranges, hidden = scan.ranges, np.zeros(len(bearings), dtype=bool)
    moving, doubt = NOTHING_MOVES, 0.0
    if movers:
        hits = np.ascontiguousarray(np.concatenate([mover.points for mover in movers]))
        ranges, hidden, behind = _seen_through(ranges, bearings, hits, place, scan.max_range)
        points = np.concatenate((points, thin(behind)))
        sizes = np.array([len(mover.points) for mover in movers])
        goings = np.array([going(mover, place) for mover in movers])
        moving = _moving(hits, sizes, goings, place, spec.decision_period)
        doubt = max(mover.closing_sigma for mover in movers)
    sight = Sight(points, bearings, ranges, scan.max_range, hidden)
    return Surroundings(sight, *moving, doubt)


def as_if_standing(
    around: Surroundings, perception: Perception, pose: Pose2D, trails: list[FloatArray]
) -> Surroundings:
    """The surroundings as if movers stood wherever their hits (k, 2) of the last looks lie, and
    nothing were expected to move."""
    scan, place = perception.scan, (pose.x, pose.y)
    bearings = around.sight.bearings
    standing = [o.points for o in perception.obstacles if not o.dynamic]
    points = thin(np.concatenate((*standing, np.empty((0, 2)), *trails)), place=place)
    points = points[np.hypot(points[:, 0], points[:, 1]) < scan.max_range]
    ranges = _ended_at(scan.ranges, bearings, points)
    hidden = np.zeros(len(bearings), dtype=bool)
    sight = Sight(points, bearings, ranges, scan.max_range, hidden)
    return replace(around, sight=sight, expected=NOTHING_MOVES[0])


@compiled
def _ended_at(ranges: FloatArray, bearings: FloatArray, points: FloatArray) -> FloatArray:
    """(n,) ranges that end at points (k, 2) on the rays, robot-centred."""
    ended = ranges.copy()
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        ray = nearest_ray(x, y, bearings[0], len(bearings))
        ended[ray] = min(ended[ray], hypot(x, y))
    return ended


@compiled
def _moving(
    hits: FloatArray,
    sizes: IntArray,
    goings: FloatArray,
    place: tuple[float, float],
    decision_period: float,
) -> tuple[FloatArray, FloatArray, IntArray, FloatArray]:
    """`expected`, `possible`, `outlines` and `shares` of `Surroundings`.

    Args:
        hits: (k, 2) of the movers, one after the other, world frame, m.
        sizes: (movers,) how many each has.
        goings: (movers, 9) how they go on, as in `Going`.
        place: of the robot, world frame, m.
        decision_period: s.
    """
    count = len(sizes)
    times: FloatArray = np.arange(1, OUTLOOK + 1) * np.float64(decision_period)
    points, ways = np.empty_like(hits), []
    outlines, shares = np.empty((count, 2), dtype=np.intp), np.empty(0)
    hit = thinned = others = 0
    for m in range(count):
        outline = thin_around(hits[hit : hit + sizes[m]], MOVER_SPACING, place)
        hit += sizes[m]
        points[thinned : thinned + len(outline)] = outline
        thinned += len(outline)
        onward, likely = displacements(goings[m], times)
        ways.append(onward)
        outlines[m, 0], outlines[m, 1] = len(outline), len(onward)
        shares = np.concatenate((shares, likely))
        others += len(outline) * (len(onward) - 1)
    expected, possible = np.empty((OUTLOOK, thinned, 2)), np.empty((HORIZON, others, 2))
    first = other = 0
    for m in range(count):
        outline = points[first : first + outlines[m, 0]]
        _carry(expected[:, first : first + len(outline)], outline, ways[m][0])
        first += len(outline)
        for w in range(1, len(ways[m])):
            _carry(possible[:, other : other + len(outline)], outline, ways[m][w])
            other += len(outline)
    return expected, possible, outlines, shares


@compiled
def _carry(places: FloatArray, points: FloatArray, way: FloatArray) -> None:
    """Fills in the places (T, k, 2) of points (k, 2) carried along a way (at least T, 2)."""
    for t in range(len(places)):
        for k in range(len(points)):
            places[t, k, 0], places[t, k, 1] = points[k, 0] + way[t, 0], points[k, 1] + way[t, 1]


@compiled
def _seen_through(
    ranges: FloatArray,
    bearings: FloatArray,
    movers: FloatArray,
    place: tuple[float, float],
    max_range: float,
) -> tuple[FloatArray, BoolArray, FloatArray]:
    """(n,) ranges without the movers, (n,) which of them a mover hides, and (k, 2) points that are
    thought to stand behind movers: an outline seen on both sides of one goes on behind it.

    Args:
        ranges, bearings: (n,) of evenly spaced rays.
        movers: (j, 2) hits of movers, world frame.
        place: of the robot, world frame, m.
        max_range: m.
    """
    count = len(bearings)
    hidden = np.zeros(count, dtype=np.bool_)
    for k in range(len(movers)):
        x, y = movers[k, 0] - place[0], movers[k, 1] - place[1]
        hidden[nearest_ray(x, y, bearings[0], count)] = True
    free = np.where(hidden, max_range, ranges)
    behind, found = np.empty((count, 2)), 0
    for first in range(count):
        if not hidden[first] or hidden[first - 1]:
            continue
        length = 1
        while hidden[(first + length) % count]:
            length += 1
        before, after = first - 1, (first + length) % count
        if max(ranges[before], ranges[after]) >= max_range:
            continue
        x, y = ranges[before] * cos(bearings[before]), ranges[before] * sin(bearings[before])
        along_x = ranges[after] * cos(bearings[after]) - x
        along_y = ranges[after] * sin(bearings[after]) - y
        if hypot(along_x, along_y) > LONGEST_HIDDEN:
            continue
        for step in range(length):
            ray = (first + step) % count
            c, s = cos(bearings[ray]), sin(bearings[ray])
            reach = range_of_line(x, y, along_x, along_y, c, s)
            if ranges[ray] < reach < max_range:
                free[ray] = reach
                behind[found] = reach * c, reach * s
                found += 1
    return free, hidden, behind[:found].copy()
