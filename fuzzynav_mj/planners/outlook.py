"""What becomes of each candidate: rolled on against what stands and what moves.

The speed cap lies here, below the fuzzy gate: a candidate is admissible only if the robot can stop
short of everything that stands and of everything that this look has not seen.
"""

from dataclasses import dataclass
from math import atan2, ceil, cos, pi, sin

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.clearance import FAR, moving_clearance, static_clearance
from fuzzynav_mj.planners.motions import HORIZON, Motions
from fuzzynav_mj.planners.passing import JUDGED
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.planners.surroundings import Surroundings, period_ends
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray, Pose2D

SOON = 4  # decision periods that count where no candidate keeps clear of what stands


@dataclass(frozen=True, slots=True, eq=False)
class Outlook:
    """Prospects of m candidates.

    Attributes:
        poses: (m, HORIZON, 3) robot frame: driving on until just before what stands or
            is unseen, and stopped there from then on.
        static: (m,) smallest gap to what stands, m.
        moving: (m,) smallest gap to what moves, m, whichever way it goes on ...
        expected: (m,) ... and if it goes on as expected.
        crowding: (m,) at the worst moment, how much is missing of the berth that movers are given.
        static_ok: (m,) True if the robot can stop in time.
        contact_step: (m,) period of the first contact with a mover that goes on as expected;
            HORIZON for none.
        soon: (m,) smallest gap to what stands in the next few periods, without stopping.
        admissible: (m,) True if the whole roll-out, stop included, keeps its margins.
    """

    poses: FloatArray
    static: FloatArray
    moving: FloatArray
    expected: FloatArray
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
    times = period_ends(spec)
    standing = around.sight.points @ to_robot.T
    gaps = static_clearance(motions.poses, standing, spec.half_side)
    stops, static, static_ok = _stop_in_time(
        motions.poses,
        gaps,
        _margins(motions.speed, standing, times, spec, settings),
        around.sight.ranges,
        pose.yaw - float(around.sight.bearings[0]),
        motions.brake_steps,
        spec.max_yaw_acceleration * spec.decision_period**2,
    )
    poses = motions.stopping(stops)
    expected = moving_clearance(poses, to_robot @ around.expected[:HORIZON], spec.half_side)
    possible = moving_clearance(poses, to_robot @ around.possible, spec.half_side)
    moving = np.minimum(expected, possible)
    berth = settings.moving_gap + settings.moving_gap_growth * np.minimum(
        times, settings.moving_gap_time
    )
    wanted = settings.moving_margin + settings.moving_margin_growth * times
    free = np.logical_and.accumulate(expected >= settings.contact_gap, axis=1)
    return Outlook(
        poses=poses,
        static=static,
        moving=moving.min(axis=1),
        expected=expected.min(axis=1),
        crowding=np.maximum(berth - moving, 0.0)[:, :JUDGED].max(axis=1),
        static_ok=static_ok,
        contact_step=np.add.reduce(free, axis=1, dtype=np.intp),
        soon=gaps[:, :SOON].min(axis=1),
        admissible=static_ok & (moving >= wanted).all(axis=1),
    )


def _margins(
    aim: FloatArray,
    standing: FloatArray,
    times: FloatArray,
    spec: RobotSpec,
    settings: DecisionSettings,
) -> FloatArray:
    """(m, HORIZON) gaps to keep to what stands, for the speeds (m,) aimed at."""
    beside = np.maximum(np.abs(standing) - spec.half_side, 0.0)
    gap_now = float(np.sqrt((beside * beside).sum(axis=1)).min(initial=FAR))
    speed = np.abs(aim)[:, None]
    margin = settings.static_margin + settings.static_margin_growth * speed
    # Closer than that already: any speed will do that makes room at once.
    return np.minimum(margin, gap_now - 0.002 + settings.static_recovery * speed * times)


@compiled
def _stop_in_time(
    poses: FloatArray,
    gaps: FloatArray,
    margins: FloatArray,
    ranges: FloatArray,
    turn: float,
    brake_steps: IntArray,
    slowing: float,
) -> tuple[IntArray, FloatArray, BoolArray]:
    """Stops each candidate before what stands or is unseen.

    Args:
        poses: (m, T, 3) robot frame.
        gaps: (m, T) to what stands.
        margins: (m, T) that must be kept.
        ranges: (n,) of the rays.
        turn: bearing of the robot's own axis from the first ray, rad.
        brake_steps: (m,) periods it takes to stop driving.
        slowing: by which a turn per period can slow down in a period, rad.

    Returns:
        (m,) the periods after which they stop, (m,) the smallest gap until then, and (m,) whether
        there is time to stop.
    """
    count, periods = gaps.shape
    rays_per_radian = len(ranges) / (2 * pi)
    stops = np.full(count, periods - 1)
    smallest = np.empty(count)
    in_time = np.full(count, True)
    for i in range(count):
        for j in range(periods):
            x, y = poses[i, j, 0], poses[i, j, 1]
            blocked = gaps[i, j] < margins[i, j]
            if not blocked:
                ray = round((atan2(y, x) + turn) * rays_per_radian) % len(ranges)
                blocked = x * x + y * y > ranges[ray] ** 2
            if blocked:
                before = poses[i, j - 1, 2] if j > 0 else 0.0
                spin_steps = ceil(abs(poses[i, j, 2] - before) / slowing - 1e-3)
                last = j - 1 - max(brake_steps[i], spin_steps)
                in_time[i] = last >= 0
                stops[i] = max(last, 0)
                break
        smallest[i] = gaps[i, : stops[i] + 1].min()
    return stops, smallest, in_time
