"""What a perception means for the roll-outs: what stands, and where what moves will be."""

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.motions import HORIZON
from fuzzynav_mj.planners.passing import OUTLOOK
from fuzzynav_mj.planners.prediction import displacements
from fuzzynav_mj.planners.sight import Sight, thin
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import BoolArray, FloatArray, Perception, Pose2D

LONGEST_HIDDEN = 1.0  # m of an outline that is thought to go on behind a mover
MOVER_SPACING = 0.10  # as `sight.SPACING`, for movers: their margins are wider


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """Robot-centred, axes parallel to the world's.

    Attributes:
        sight: what stands. Rays that a mover stops count as free, or as the outline that goes on
            behind it: it will go away.
        expected: (OUTLOOK, 2, k) where points of what moves will be at the end of each period, as
            far as its motion can be foreseen ...
        possible: (HORIZON, 2, j) ... and where else they may be.
    """

    sight: Sight
    expected: FloatArray
    possible: FloatArray


def surroundings(perception: Perception, pose: Pose2D, spec: RobotSpec) -> Surroundings:
    """The surroundings of the robot at `pose`."""
    here = np.array([pose.x, pose.y])
    standing = [o.points for o in perception.obstacles if not o.dynamic]
    movers = [o for o in perception.obstacles if o.dynamic]
    points = thin(np.concatenate(standing) - here) if standing else np.empty((0, 2))
    scan = perception.scan
    bearings = scan.bearings + pose.yaw
    hidden = np.zeros(len(bearings), dtype=bool)
    ranges = scan.ranges
    if movers:
        offsets = np.concatenate([mover.points for mover in movers]) - here
        offsets = np.ascontiguousarray(offsets)
        ranges, hidden, behind = _seen_through(ranges, bearings, offsets, scan.max_range)
        points = np.concatenate((points, thin(behind)))
    expected, possible, times = [], [], period_ends(spec, OUTLOOK)
    for mover in movers:
        points_now = thin(mover.points - here, MOVER_SPACING).T[None]
        ways = displacements(mover, here, times)[..., None]
        expected.append(points_now + ways[0])
        possible += [points_now + way[:HORIZON] for way in ways[1:]]
    sight = Sight(points, bearings, ranges, scan.max_range, hidden)
    return Surroundings(sight, _joined(expected, OUTLOOK), _joined(possible, HORIZON))


def _joined(places: list[FloatArray], periods: int) -> FloatArray:
    return np.concatenate(places, axis=2) if places else np.empty((periods, 2, 0))


def period_ends(spec: RobotSpec, count: int = HORIZON) -> FloatArray:
    """(count,) ends of the decision periods to come, s from now."""
    return np.arange(1, count + 1, dtype=np.float64) * spec.decision_period


@compiled
def _seen_through(
    ranges: FloatArray, bearings: FloatArray, movers: FloatArray, max_range: float
) -> tuple[FloatArray, BoolArray, FloatArray]:
    """(n,) ranges without the movers, (n,) which of them a mover hides, and (k, 2) points that are
    thought to stand behind movers: an outline seen on both sides of one goes on behind it.

    Args:
        ranges, bearings: (n,) of evenly spaced rays.
        movers: (j, 2) hits of movers, robot-centred.
        max_range: m.
    """
    count = len(bearings)
    hidden = np.zeros(count, dtype=np.bool_)
    for k in range(len(movers)):
        angle = atan2(movers[k, 1], movers[k, 0]) - bearings[0]
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
            across = c * along_y - s * along_x
            if across == 0.0:
                continue
            reach = (x * along_y - y * along_x) / across
            if ranges[ray] < reach < max_range:
                free[ray] = reach
                behind[found] = reach * c, reach * s
                found += 1
    return free, hidden, behind[:found].copy()
