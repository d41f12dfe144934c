"""The motion layer the peers share: towards a target, clear of the scan, able to stop in time.

The candidate motions are those of `planners.motions`. Every hit counts as standing still;
hits that a map does not explain may be given a wide berth.
"""

from dataclasses import dataclass
from math import atan2, cos, sin

import numpy as np

from fuzzynav_mj.planners.clearance import static_clearance
from fuzzynav_mj.planners.headings import HORIZON
from fuzzynav_mj.planners.motions import candidate_motions
from fuzzynav_mj.planners.sight import thin
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray, LaserScan, Pose2D, Twist2D

MARGIN = 0.012  # m: smallest gap kept between footprint and hits, when creeping ...
MARGIN_GROWTH = 0.03  # ... and per m/s of speed
RECOVERY = 0.10  # m of gap to regain per metre travelled where there is less than the margin
SPIN_STEPS = 3  # decision periods it takes to stop turning from the largest yaw rate
REVERSE_COST = 0.05  # m: what driving backwards costs
BERTH = 0.30  # m: gap to strange hits below which a candidate costs more ...
BERTH_WEIGHT = 8.0  # ... in m of way per m missing
SOON = 3  # decision periods that count where no candidate keeps clear


@dataclass(frozen=True, slots=True)
class Step:
    """One step of the motion layer.

    Attributes:
        next_position: (x, y) of the footprint's centre one decision period later, world frame.
        clear: False if no candidate keeps clear; the step then is the one with the largest gap.
    """

    next_position: tuple[float, float]
    clear: bool


def hits_around(scan: LaserScan, pose: Pose2D) -> FloatArray:
    """(k, 2) thinned hits, robot-centred with axes parallel to the world's, m."""
    ranges, bearings = scan.ranges[scan.hit], scan.bearings[scan.hit] + pose.yaw
    return thin(np.column_stack((ranges * np.cos(bearings), ranges * np.sin(bearings))))


def step_towards(
    target: tuple[float, float],
    hits: FloatArray,
    pose: Pose2D,
    twist: Twist2D,
    spec: RobotSpec,
    turn_to: float | None = None,
    strange: FloatArray | None = None,
) -> Step:
    """The step that brings the footprint's centre nearest to a target soonest.

    A candidate counts only as far as the square footprint on its way, stop included, keeps the
    margin to every hit.

    Args:
        target: (x, y), world frame, m.
        hits: (k, 2) robot-centred, axes parallel to the world's, m.
        pose: present pose, world frame.
        twist: present speeds.
        spec: the robot's limits.
        turn_to: yaw to turn to on the spot instead of driving, rad.
        strange: (j, 2) those of the hits that are given a wide berth.
    """
    c, s = cos(pose.yaw), sin(pose.yaw)
    dx, dy = target[0] - pose.x, target[1] - pose.y
    ahead, left = c * dx + s * dy, c * dy - s * dx
    wanted = atan2(left, ahead) if turn_to is None else turn_to - pose.yaw
    motions = candidate_motions(wanted, twist, spec)
    to_robot = np.array([[c, -s], [s, c]])
    gaps = static_clearance(motions.poses, hits @ to_robot, spec.half_side)
    speed = np.abs(motions.speed)[:, None]
    travelled = speed * spec.decision_period * np.arange(1, HORIZON + 1)
    # Closer than the margin already: any motion will do that makes room at once.
    regained = _gap_now(hits, pose, spec) - 2e-3 + RECOVERY * travelled
    blocked = gaps < np.minimum(MARGIN + MARGIN_GROWTH * speed, regained)
    free = np.where(blocked.any(axis=1), blocked.argmax(axis=1), HORIZON)
    turning = np.abs(motions.poses[:, 0, 2]) > 1e-3
    last = free - 1 - np.maximum(motions.brake_steps, np.where(turning, SPIN_STEPS, 0))
    admissible = (free == HORIZON) | (last >= 0)
    if not admissible.any():
        best = int(gaps[:, :SOON].min(axis=1).argmax())
    elif turn_to is not None and admissible[spot := int(motions.on_the_spot.argmax())]:
        best = spot
    else:
        stops = np.where(free == HORIZON, HORIZON - 1, np.maximum(last, 0))
        poses = motions.stopping(stops)
        away = np.hypot(poses[..., 0] - ahead, poses[..., 1] - left)
        cost = np.minimum.accumulate(away, axis=1).mean(axis=1)
        cost += REVERSE_COST * (motions.speed < 0)
        if strange is not None:
            room = static_clearance(poses, strange @ to_robot, spec.half_side)
            cost += BERTH_WEIGHT * np.maximum(BERTH - room, 0.0).mean(axis=1)
        best = int(np.where(admissible, cost, np.inf).argmin())
    x, y = motions.poses[best, 0, :2].tolist()
    return Step((pose.x + c * x - s * y, pose.y + s * x + c * y), bool(admissible[best]))


def _gap_now(hits: FloatArray, pose: Pose2D, spec: RobotSpec) -> float:
    here = np.array([[[0.0, 0.0, pose.yaw]]], dtype=np.float32)
    return float(static_clearance(here, hits, spec.half_side)[0, 0])
