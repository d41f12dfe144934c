"""What becomes of each candidate: rolled on against what stands and what moves.

The speed cap lies here, below the fuzzy gate: a candidate is admissible only if the robot can stop
short of everything that stands and of everything that this look has not seen.
"""

from math import ceil, sqrt
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.bearings import nearest_ray
from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.clearance import FAR, gaps_to_standing, place
from fuzzynav_mj.planners.motions import Motions
from fuzzynav_mj.planners.passing import JUDGED
from fuzzynav_mj.planners.scene import Scene
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.planners.survival import hold_against_movers
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

NEARBY = 0.25  # m: a larger gap to what stands makes no difference
SOON = 4  # decision periods that count where no candidate keeps clear of what stands


class Outlook(NamedTuple):
    """Prospects of m candidates.

    Attributes:
        poses: (m, T, 3) robot frame: driving on until just before what stands or
            is unseen, and stopped there from then on.
        static: (m,) smallest gap to what stands, m, at most `NEARBY`.
        moving: (m,) smallest gap to what moves, m, whichever way it goes on.
        alive: (m, T) likelihood that there was no contact with it up to each period's end.
        crowding: (m,) at the worst moment, how much is missing of the berth that movers are given.
        static_ok: (m,) True if the robot can stop in time.
        soon: (m,) smallest gap to what stands in the next few periods, without stopping.
        admissible: (m,) True if the whole roll-out, stop included, keeps its margins.
    """

    poses: FloatArray
    static: FloatArray
    moving: FloatArray
    alive: FloatArray
    crowding: FloatArray
    static_ok: BoolArray
    soon: FloatArray
    admissible: BoolArray


def look_ahead(
    motions: Motions, scene: Scene, spec: RobotSpec, settings: DecisionSettings
) -> Outlook:
    """Rolls the candidates on, through all of the scene's periods."""
    return _prospects(
        motions.poses,
        motions.facing,
        motions.speed,
        motions.brake_steps,
        scene,
        spec.max_yaw_acceleration * spec.decision_period**2,
        spec.half_side,
        settings.static_margin,
        settings.static_margin_growth,
        settings.static_recovery,
        settings.creeping_speed,
    )


@compiled
def margins_to_standing(
    aim: FloatArray,
    standing: FloatArray,
    times: FloatArray,
    half_side: float,
    margin: float,
    growth: float,
    recovery: float,
    creeping: float,
) -> FloatArray:
    """(m, T) gaps to keep to what stands, (k, 2), at each of the times (T,), for the speeds (m,)
    aimed at.

    The last four arguments are the settings `static_margin`, `static_margin_growth`,
    `static_recovery` and `creeping_speed`.
    """
    gap_now = FAR
    for k in range(len(standing)):
        ahead = max(abs(standing[k, 0]) - half_side, 0.0)
        aside = max(abs(standing[k, 1]) - half_side, 0.0)
        gap_now = min(gap_now, sqrt(ahead * ahead + aside * aside))
    # Closer than that already: any speed will do that makes room at once, and a slow one that keeps
    # what room there is; or else a robot that was driven into a nook could never leave it.
    kept = gap_now - (0.002 if gap_now > 0.01 else 0.0005)
    margins = np.empty((len(aim), len(times)))
    for i in range(len(aim)):
        speed = abs(aim[i])
        hasty = max(speed - creeping, 0.0)
        for j in range(len(times)):
            margins[i, j] = min(margin + growth * speed, kept + recovery * hasty * times[j])
    return margins


@compiled
def _prospects(
    poses: FloatArray,
    facing: FloatArray,
    aim: FloatArray,
    brake_steps: IntArray,
    scene: Scene,
    slowing: float,
    half_side: float,
    margin: float,
    growth: float,
    recovery: float,
    creeping: float,
) -> Outlook:
    """What becomes of candidates that stop before what stands or is unseen.

    Args:
        poses: (m, T, 3) robot frame.
        facing: (m, T, 2) cosines and sines of their yaw.
        aim: (m,) speeds aimed at, m/s.
        brake_steps: (m,) periods it takes to stop driving.
        scene: what they are held against.
        slowing: by which a turn per period can slow down in a period, rad.
        half_side: of the footprint, m.
        margin, growth, recovery, creeping: as in `margins_to_standing`.
    """
    count, periods = poses.shape[:2]
    margins = margins_to_standing(
        aim, scene.standing, scene.times, half_side, margin, growth, recovery, creeping
    )
    found = Outlook(
        poses.copy(),
        np.full(count, FAR),
        np.full(count, FAR),
        np.empty((count, periods)),
        np.zeros(count),
        np.full(count, True),
        np.full(count, FAR),
        np.empty(count, dtype=np.bool_),
    )
    placed, gaps, elsewhere = np.empty((4, periods)), np.empty(periods), np.empty(periods)
    surely_seen = scene.ranges.min() ** 2
    for i in range(count):
        last = drive_up(
            placed, gaps, poses[i], facing[i], margins[i], brake_steps[i], scene.standing,
            scene.ranges, scene.turn, surely_seen, slowing, half_side,
        )  # fmt: skip
        stop, found.static_ok[i] = max(last, 0), last >= 0
        for j in range(stop + 1):
            found.static[i] = min(found.static[i], gaps[j])
        for j in range(SOON):
            found.soon[i] = min(found.soon[i], gaps[j])
        for j in range(stop + 1, periods):
            for axis in range(3):
                found.poses[i, j, axis] = poses[i, stop, axis]
        hold_against_movers(found.alive[i], gaps, elsewhere, placed, scene, half_side, 0.0, -1.0)
        _meet_movers(found, i, gaps, elsewhere, scene)
    return found


@compiled
def drive_up(
    placed: FloatArray,
    gaps: FloatArray,
    poses: FloatArray,
    facing: FloatArray,
    margins: FloatArray,
    brake_steps: int,
    standing: FloatArray,
    ranges: FloatArray,
    turn: float,
    surely_seen: float,
    slowing: float,
    half_side: float,
) -> int:
    """Rolls a candidate on until just before what stands or is unseen; returns the period after
    which it stops, -1 or less if it cannot stop in time. It is handed only what it needs of a
    scene: a compiled function has all that it is handed copied for each call.

    Args:
        placed: (4, T) filled in as `gaps_on_the_way` takes it, stopped ...
        gaps: (T,) ... and with the gaps to what stands, m, without a stop.
        poses, facing: (T, 3) and (T, 2) of the candidate, without a stop.
        margins: (T,) gaps that must be kept.
        brake_steps: the candidate's.
        standing, ranges, turn: of the scene.
        surely_seen: squared distance up to which all is seen, m2.
        slowing, half_side: as in `_prospects`.
    """
    place(placed, poses, facing)
    gaps_to_standing(gaps, placed, standing, half_side, NEARBY)
    last = _last_period(gaps, poses, margins, brake_steps, ranges, turn, surely_seen, slowing)
    stop = max(last, 0)
    for j in range(stop + 1, len(gaps)):
        for row in range(4):
            placed[row, j] = placed[row, stop]
    return last


@compiled
def _last_period(
    gaps: FloatArray,
    poses: FloatArray,
    margins: FloatArray,
    brake_steps: int,
    ranges: FloatArray,
    turn: float,
    surely_seen: float,
    slowing: float,
) -> int:
    """The period after which a candidate stops; see `drive_up`."""
    for j in range(len(gaps)):
        x, y, yaw = poses[j, 0], poses[j, 1], poses[j, 2]
        blocked = gaps[j] < margins[j]
        if not blocked and x * x + y * y > surely_seen:
            ray = nearest_ray(x, y, -turn, len(ranges))
            blocked = x * x + y * y > ranges[ray] ** 2
        if blocked:
            before = poses[j - 1, 2] if j > 0 else 0.0
            spin_steps = ceil(abs(yaw - before) / slowing - 1e-3)
            last: int = j - 1 - max(brake_steps, spin_steps)
            return last
    return len(gaps) - 1


@compiled
def _meet_movers(
    found: Outlook, i: int, gaps: FloatArray, elsewhere: FloatArray, scene: Scene
) -> None:
    """Holds candidate `i` against what moves, which comes near it in each period by the gaps (T,)
    if it goes on as expected, and by `elsewhere` (T,) if not, m; fills in `moving`, `crowding` and
    `admissible`."""
    kept = found.static_ok[i]
    for j in range(len(gaps)):
        nearest = min(gaps[j], elsewhere[j])
        kept = kept and gaps[j] >= scene.wanted[j] and elsewhere[j] >= scene.unlikely[j]
        found.moving[i] = min(found.moving[i], nearest)
        if j < JUDGED:
            found.crowding[i] = max(found.crowding[i], scene.berth[j] - nearest)
    found.admissible[i] = kept
