"""What becomes of each candidate: rolled on against what stands and what moves.

The speed cap lies here, below the fuzzy gate: a candidate is admissible only if the robot can stop
short of everything that stands and of everything that this look has not seen.
"""

from math import atan2, ceil, cos, pi, sin
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.clearance import FAR, nearest_gap
from fuzzynav_mj.planners.motions import HORIZON, Motions
from fuzzynav_mj.planners.passing import JUDGED
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.planners.surroundings import Surroundings, period_ends
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray, Pose2D

SOON = 4  # decision periods that count where no candidate keeps clear of what stands


class Outlook(NamedTuple):
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


class _Movers(NamedTuple):
    """What moves, and how far to keep away from it in each of T periods.

    Attributes:
        expected: (T, k, 2) points as far as their motion can be foreseen, robot frame ...
        possible: (T, j, 2) ... and where else they may be.
        wanted: (T,) gap that an admissible candidate keeps to the former, m ...
        unlikely: (T,) ... and to the latter.
        berth: (T,) gap below which a candidate costs more.
        contact: a smaller gap counts as contact, m.
    """

    expected: FloatArray
    possible: FloatArray
    wanted: FloatArray
    unlikely: FloatArray
    berth: FloatArray
    contact: float


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
    wanted = settings.moving_margin + settings.moving_margin_growth * times
    share = min(max(around.doubt / settings.doubtful, settings.unlikely_share), 1.0)
    movers = _Movers(
        expected=around.expected[:HORIZON].transpose(0, 2, 1) @ to_robot.T,
        possible=around.possible.transpose(0, 2, 1) @ to_robot.T,
        wanted=wanted,
        unlikely=share * wanted,
        berth=settings.moving_gap
        + settings.moving_gap_growth * np.minimum(times, settings.moving_gap_time),
        contact=settings.contact_gap,
    )
    return _prospects(
        motions.poses,
        standing,
        _margins(motions.speed, standing, times, spec, settings),
        around.sight.ranges,
        pose.yaw - float(around.sight.bearings[0]),
        motions.brake_steps,
        spec.max_yaw_acceleration * spec.decision_period**2,
        movers,
        spec.half_side,
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
    # Closer than that already: any speed will do that makes room at once, and a slow one that keeps
    # what room there is; or else a robot that was driven into a nook could never leave it.
    kept = gap_now - (0.002 if gap_now > 0.01 else 0.0005)
    hasty = np.maximum(speed - settings.creeping_speed, 0.0)
    return np.minimum(margin, kept + settings.static_recovery * hasty * times)


@compiled
def _prospects(
    poses: FloatArray,
    standing: FloatArray,
    margins: FloatArray,
    ranges: FloatArray,
    turn: float,
    brake_steps: IntArray,
    slowing: float,
    movers: _Movers,
    half_side: float,
) -> Outlook:
    """What becomes of candidates that stop before what stands or is unseen.

    Args:
        poses: (m, T, 3) robot frame.
        standing: (k, 2) points of what stands, robot frame.
        margins: (m, T) that must be kept to it.
        ranges: (n,) of the rays.
        turn: bearing of the robot's own axis from the first ray, rad.
        brake_steps: (m,) periods it takes to stop driving.
        slowing: by which a turn per period can slow down in a period, rad.
        movers: what moves.
        half_side: of the footprint, m.
    """
    count, periods = poses.shape[:2]
    found = Outlook(
        poses.copy(),
        np.full(count, FAR),
        np.full(count, FAR),
        np.full(count, FAR),
        np.zeros(count),
        np.full(count, True),
        np.full(count, periods),
        np.full(count, FAR),
        np.empty(count, dtype=np.bool_),
    )
    c, s, gaps = np.empty(periods), np.empty(periods), np.empty(periods)
    surely_seen = ranges.min() ** 2
    for i in range(count):
        stop = _stop_in_time(
            found, i, c, s, gaps, standing, margins, ranges, surely_seen, turn, brake_steps[i],
            slowing, half_side,
        )  # fmt: skip
        found.poses[i, stop + 1 :] = poses[i, stop]
        _meet_movers(found, i, c, s, stop, movers, half_side)
    return found


@compiled
def _stop_in_time(
    found: Outlook,
    i: int,
    c: FloatArray,
    s: FloatArray,
    gaps: FloatArray,
    standing: FloatArray,
    margins: FloatArray,
    ranges: FloatArray,
    surely_seen: float,
    turn: float,
    brake_steps: int,
    slowing: float,
    half_side: float,
) -> int:
    """Rolls candidate `i` on until just before what stands or is unseen; returns the period after
    which it stops, and fills in `static`, `static_ok` and `soon`.

    Args:
        found: the prospects, `poses` still without a stop.
        c, s, gaps: (T,) to be filled with cosines and sines of the candidate's yaws, and with its
            smallest gap up to each period, up to where it stops.
        surely_seen: squared distance up to which all is seen, m2.
        standing, margins, ranges, turn, slowing, half_side: as in `_prospects`.
        brake_steps: the candidate's.
    """
    periods = len(c)
    stop, likely, smallest, blocked = periods - 1, 0, FAR, False
    for j in range(periods):
        x, y, yaw = found.poses[i, j]
        c[j], s[j] = cos(yaw), sin(yaw)
        gap, likely = nearest_gap(x, y, c[j], s[j], standing, likely, half_side)
        smallest = min(smallest, gap)
        gaps[j] = smallest
        if j < SOON:
            found.soon[i] = smallest
        if not blocked:
            blocked = gap < margins[i, j]
            if not blocked and x * x + y * y > surely_seen:
                ray = round((atan2(y, x) + turn) * (len(ranges) / (2 * pi))) % len(ranges)
                blocked = x * x + y * y > ranges[ray] ** 2
            if blocked:
                before = found.poses[i, j - 1, 2] if j > 0 else 0.0
                spin_steps = ceil(abs(yaw - before) / slowing - 1e-3)
                last = j - 1 - max(brake_steps, spin_steps)
                found.static_ok[i] = last >= 0
                stop = max(last, 0)
        if blocked and j + 1 >= SOON:
            break
    found.static[i] = gaps[stop]
    return stop


@compiled
def _meet_movers(
    found: Outlook,
    i: int,
    c: FloatArray,
    s: FloatArray,
    stop: int,
    movers: _Movers,
    half_side: float,
) -> None:
    """Holds candidate `i`, which stops after the period `stop`, against what moves; fills in
    `moving`, `expected`, `crowding`, `contact_step` and `admissible`."""
    kept, near, other = found.static_ok[i], 0, 0
    for j in range(len(c)):
        k = min(j, stop)
        x, y = found.poses[i, k, 0], found.poses[i, k, 1]
        gap, near = nearest_gap(x, y, c[k], s[k], movers.expected[j], near, half_side)
        swerved, other = nearest_gap(x, y, c[k], s[k], movers.possible[j], other, half_side)
        kept = kept and gap >= movers.wanted[j] and swerved >= movers.unlikely[j]
        if gap < movers.contact:
            found.contact_step[i] = min(found.contact_step[i], j)
        found.expected[i] = min(found.expected[i], gap)
        found.moving[i] = min(found.moving[i], gap, swerved)
        if j < JUDGED:
            found.crowding[i] = max(found.crowding[i], movers.berth[j] - min(gap, swerved))
    found.admissible[i] = kept
