"""What a perception means for the roll-outs: what stands, and where what moves will be."""

from dataclasses import dataclass
from math import hypot, pi

import numpy as np

from fuzzynav_mj.planners.motions import HORIZON
from fuzzynav_mj.planners.passing import OUTLOOK
from fuzzynav_mj.planners.prediction import displacements
from fuzzynav_mj.planners.sight import Sight, thin
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import BoolArray, FloatArray, PerceivedObstacle, Perception, Pose2D

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
    ranges, hidden, behind = _seen_through(scan.ranges, bearings, movers, here, scan.max_range)
    points = np.concatenate((points, thin(behind)))
    expected, possible = [], []
    for mover in movers:
        points_now = thin(mover.points - here, MOVER_SPACING).T[None]
        first, *others = displacements(mover, here, period_ends(spec, OUTLOOK))
        expected.append(points_now + first[:, :, None])
        possible += [points_now + way[:HORIZON, :, None] for way in others]
    sight = Sight(points, bearings, ranges, scan.max_range, hidden)
    return Surroundings(sight, _joined(expected, OUTLOOK), _joined(possible, HORIZON))


def _joined(places: list[FloatArray], periods: int) -> FloatArray:
    return np.concatenate(places, axis=2) if places else np.empty((periods, 2, 0))


def period_ends(spec: RobotSpec, count: int = HORIZON) -> FloatArray:
    """(count,) ends of the decision periods to come, s from now."""
    return np.arange(1, count + 1, dtype=np.float64) * spec.decision_period


def _seen_through(
    ranges: FloatArray,
    bearings: FloatArray,
    movers: list[PerceivedObstacle],
    here: FloatArray,
    max_range: float,
) -> tuple[FloatArray, BoolArray, FloatArray]:
    """(n,) ranges without the movers, (n,) which of them a mover hides, and (k, 2) points that are
    thought to stand behind movers: an outline seen on both sides of one goes on behind it."""
    count = len(bearings)
    hidden = np.zeros(count, dtype=bool)
    if not movers:
        return ranges, hidden, np.empty((0, 2))
    offset = np.concatenate([mover.points for mover in movers]) - here
    angle = np.arctan2(offset[:, 1], offset[:, 0]) - bearings[0]
    hidden[np.rint(angle * (count / (2 * pi))).astype(int) % count] = True
    free = np.where(hidden, max_range, ranges)
    behind = []
    for first in np.flatnonzero(hidden & ~np.roll(hidden, 1)).tolist():
        ahead = (first + np.arange(count)) % count
        length = int((~hidden[ahead]).argmax())
        sides = np.array([first - 1, (first + length) % count])
        if length == 0 or ranges[sides].max() >= max_range:
            continue
        start, end = ranges[sides, None] * _unit(bearings[sides])
        if hypot(*(end - start).tolist()) > LONGEST_HIDDEN:
            continue
        along = end - start
        unit = _unit(bearings[ahead[:length]])
        reach = (start[0] * along[1] - start[1] * along[0]) / (
            unit[:, 0] * along[1] - unit[:, 1] * along[0]
        )
        farther = (reach > ranges[ahead[:length]]) & (reach < max_range)
        rays = ahead[:length][farther]
        free[rays] = reach[farther]
        behind.append(unit[farther] * reach[farther, None])
    return free, hidden, np.concatenate(behind) if behind else np.empty((0, 2))


def _unit(bearings: FloatArray) -> FloatArray:
    unit: FloatArray = np.stack((np.cos(bearings), np.sin(bearings)), axis=1)
    return unit
