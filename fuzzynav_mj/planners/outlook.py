"""What becomes of each candidate: rolled on against what stands and what moves.

The speed cap lies here, below the fuzzy gate: a candidate is admissible only if the robot can stop
short of everything that stands and of everything that this look has not seen.
"""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from fuzzynav_mj.planners.clearance import FAR, moving_clearance, static_clearance
from fuzzynav_mj.planners.motions import HORIZON, Motions
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.planners.sight import Sight
from fuzzynav_mj.planners.surroundings import Surroundings, period_ends
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray, Pose2D

SOON = 4  # decision periods that count where no candidate keeps clear of what stands


@dataclass(frozen=True, slots=True, eq=False)
class Outlook:
    """Prospects of m candidates.

    Attributes:
        poses: (m, HORIZON, 3) float32, robot frame: driving on until just before what stands or
            is unseen, and stopped there from then on.
        static: (m,) smallest gap to what stands, m.
        moving: (m,) smallest gap to what moves, m.
        crowding: (m,) at the worst moment, how much is missing of the berth that movers are given.
        static_ok: (m,) True if the robot can stop in time.
        contact_step: (m,) period of the first contact with a mover that goes on as expected;
            HORIZON for none.
        soon: (m,) smallest gap to what stands in the next few periods, without stopping.
        admissible: (m,) True if the whole roll-out, stop included, keeps its margins.
    """

    poses: np.ndarray
    static: FloatArray
    moving: FloatArray
    crowding: FloatArray
    static_ok: BoolArray
    contact_step: IntArray
    soon: FloatArray
    admissible: BoolArray


def look_ahead(
    motions: Motions,
    around: Surroundings,
    pose: Pose2D,
    spec: RobotSpec,
    settings: DecisionSettings,
) -> Outlook:
    """Rolls the candidates on."""
    c, s = cos(pose.yaw), sin(pose.yaw)
    to_robot = np.array([[c, s], [-s, c]])
    times = period_ends(spec)[:, None]
    # From here on the periods are the rows: (HORIZON, m).
    static, blocked = _static(motions, around.sight.points @ to_robot.T, times, spec, settings)
    blocked |= _unseen(motions.poses, around.sight, pose)
    driven = np.logical_and.accumulate(~blocked)  # before the first one that is blocked
    first = np.add.reduce(driven, dtype=np.intp)
    last = first - 1 - np.maximum(motions.brake_steps, _spin_steps(motions.poses, first, spec))
    stops = np.where(first == HORIZON, HORIZON - 1, np.maximum(last, 0))
    poses = motions.stopping(stops)
    static_ok = (last >= 0) | (first == HORIZON)
    expected = moving_clearance(poses, to_robot @ around.expected, spec.half_side).T
    possible = moving_clearance(poses, to_robot @ around.possible, spec.half_side).T
    moving = np.minimum(expected, possible)
    berth = settings.moving_gap + settings.moving_gap_growth * np.minimum(
        times, settings.moving_gap_time
    )
    wanted = settings.moving_margin + settings.moving_margin_growth * times
    free = np.logical_and.accumulate(expected >= settings.contact_gap)
    reached = np.arange(HORIZON)[:, None] <= stops
    return Outlook(
        poses=poses,
        static=np.where(reached, static, np.inf).min(axis=0),
        moving=moving.min(axis=0),
        crowding=np.maximum(berth - moving, 0.0).max(axis=0),
        static_ok=static_ok,
        contact_step=np.add.reduce(free, dtype=np.intp),
        soon=static[:SOON].min(axis=0),
        admissible=static_ok & (moving >= wanted).all(axis=0),
    )


def _static(
    motions: Motions,
    standing: FloatArray,
    times: FloatArray,
    spec: RobotSpec,
    settings: DecisionSettings,
) -> tuple[FloatArray, BoolArray]:
    """(HORIZON, m) gaps to what stands, and where they are less than the margin."""
    beside = np.maximum(np.abs(standing.astype(np.float32)) - np.float32(spec.half_side), 0.0)
    gap_now = float(np.sqrt((beside * beside).sum(axis=1)).min(initial=FAR))
    speed = np.abs(motions.speed)
    margin = settings.static_margin + settings.static_margin_growth * speed
    # Closer than that already: any speed will do that makes room at once.
    regained = gap_now - 0.002 + settings.static_recovery * speed * times
    gaps = static_clearance(motions.poses, standing, spec.half_side).T
    return gaps, gaps < np.minimum(margin, regained)


def _spin_steps(poses: np.ndarray, first: IntArray, spec: RobotSpec) -> IntArray:
    """(m,) periods it takes to stop turning at the pace of period `first` (m,), rounded up."""
    candidates, period = np.arange(len(first)), np.minimum(first, HORIZON - 1)
    yaw = poses.T[2]
    start = np.where(period > 0, yaw[period - 1, candidates], np.float32(0.0))
    pace = np.abs(yaw[period, candidates] - start)
    slowing = spec.max_yaw_acceleration * spec.decision_period**2
    steps: IntArray = np.ceil(pace / slowing - 1e-3).astype(np.intp)
    return steps


def _unseen(poses: np.ndarray, sight: Sight, pose: Pose2D) -> BoolArray:
    """(HORIZON, m) True where the footprint's centre would leave what this look has seen."""
    x, y, _ = poses.T
    count = len(sight.bearings)
    bearing = np.arctan2(y, x) + (pose.yaw - float(sight.bearings[0]))
    rays = np.rint(bearing * (count / (2 * pi))).astype(np.intp) % count
    beyond: BoolArray = x * x + y * y > sight.ranges.take(rays) ** 2
    return beyond
