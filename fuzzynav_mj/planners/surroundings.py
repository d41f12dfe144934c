"""What a perception means for the roll-outs: what stands, and where what moves will be."""

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.headings import HORIZON
from fuzzynav_mj.planners.passing import OUTLOOK
from fuzzynav_mj.planners.prediction import displacements
from fuzzynav_mj.planners.reach import range_of_line
from fuzzynav_mj.planners.sight import Sight, thin
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray, Perception, Pose2D

LONGEST_HIDDEN = 1.0  # m of an outline that is thought to go on behind a mover
MOVER_SPACING = 0.10  # as `sight.SPACING`, for movers: their margins are wider


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
    expected = [np.empty((OUTLOOK, 0, 2))]
    possible = [np.empty((HORIZON, 0, 2))]
    outlines: list[tuple[int, int]] = []
    shares = [np.empty(0)]
    if movers:
        hits = np.ascontiguousarray(np.concatenate([mover.points for mover in movers]))
        ranges, hidden, behind = _seen_through(ranges, bearings, hits, place, scan.max_range)
        points = np.concatenate((points, thin(behind)))
        here, times = np.array(place), period_ends(spec, OUTLOOK)
        for mover in movers:
            outline = thin(mover.points, MOVER_SPACING, place)
            ways, likely = displacements(mover, here, times)
            onward, else_where = _carried(outline, ways, HORIZON)
            outlines.append((len(outline), len(ways)))
            shares.append(likely)
            expected.append(onward)
            possible.append(else_where)
    return Surroundings(
        Sight(points, bearings, ranges, scan.max_range, hidden),
        np.concatenate(expected, axis=1),
        np.concatenate(possible, axis=1),
        np.array(outlines, dtype=np.intp).reshape(-1, 2),
        np.concatenate(shares),
        max((mover.closing_sigma for mover in movers), default=0.0),
    )


@compiled
def _carried(points: FloatArray, ways: FloatArray, horizon: int) -> tuple[FloatArray, FloatArray]:
    """(T, k, 2) points (k, 2) carried along the first of ways (w, T, 2), and (horizon, (w - 1) k,
    2) along the others."""
    count = len(points)
    expected = np.empty((ways.shape[1], count, 2))
    possible = np.empty((horizon, (len(ways) - 1) * count, 2))
    for t in range(ways.shape[1]):
        for k in range(count):
            expected[t, k] = points[k, 0] + ways[0, t, 0], points[k, 1] + ways[0, t, 1]
    for t in range(horizon):
        for w in range(1, len(ways)):
            for k in range(count):
                place = (w - 1) * count + k
                possible[t, place] = points[k, 0] + ways[w, t, 0], points[k, 1] + ways[w, t, 1]
    return expected, possible


def period_ends(spec: RobotSpec, count: int = HORIZON) -> FloatArray:
    """(count,) ends of the decision periods to come, s from now."""
    return np.arange(1, count + 1, dtype=np.float64) * spec.decision_period


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
        angle = atan2(movers[k, 1] - place[1], movers[k, 0] - place[0]) - bearings[0]
        hidden[round(angle * (count / (2 * pi))) % count] = True
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
