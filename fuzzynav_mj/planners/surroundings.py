"""What a perception means for the roll-outs: what stands, and where what moves will be."""

from dataclasses import dataclass
from math import pi

import numpy as np

from fuzzynav_mj.planners.motions import HORIZON
from fuzzynav_mj.planners.passing import OUTLOOK
from fuzzynav_mj.planners.prediction import displacements
from fuzzynav_mj.planners.sight import Sight, thin
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray, PerceivedObstacle, Perception, Pose2D

MOVER_SPACING = 0.10  # as `sight.SPACING`, for movers: their margins are wider


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """Robot-centred, axes parallel to the world's.

    Attributes:
        sight: what stands. Rays that a mover stops count as free: it will go away.
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
    ranges = _seen_through(scan.ranges, bearings, movers, here, scan.max_range)
    expected, possible = [], []
    for mover in movers:
        points_now = thin(mover.points - here, MOVER_SPACING).T[None]
        first, *others = displacements(mover, here, period_ends(spec, OUTLOOK))
        expected.append(points_now + first[:, :, None])
        possible += [points_now + way[:HORIZON, :, None] for way in others]
    sight = Sight(points, bearings, ranges, scan.max_range)
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
) -> FloatArray:
    if not movers:
        return ranges
    free = ranges.copy()
    offset = np.concatenate([mover.points for mover in movers]) - here
    angle = np.arctan2(offset[:, 1], offset[:, 0]) - bearings[0]
    rays = np.rint(angle * (len(bearings) / (2 * pi))).astype(int) % len(bearings)
    free[rays] = max_range
    return free
