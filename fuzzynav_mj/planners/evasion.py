"""Ways out of a pinch, in two moves.

Where no candidate keeps its margins, none of them may last: each holds one direction. Here the most
lasting ones are driven for a while, short or long, and then any candidate from there; what a first
move is worth is the best of its second ones. What cannot be the best of all is not worked out to
the end: that spares nine tenths of the work.
"""

from math import cos, sin

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.headings import HORIZON
from fuzzynav_mj.planners.motions import moves_after
from fuzzynav_mj.planners.outlook import Outlook, drive_up, margins_to_standing
from fuzzynav_mj.planners.passing import JUDGED, OUTLOOK, Passing, judged_places, leads_on
from fuzzynav_mj.planners.scene import Scene
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.planners.survival import hold_against_movers
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray, IntArray

FIRST_MOVES = (2, 4, 7)  # decision periods that a first move may take
TRIED = 40  # first moves
BEYOND = OUTLOOK - HORIZON  # periods that count where a way leads on after the roll-outs
ROUNDING = 1e-9  # periods: sums in different orders differ by less


def lasting(
    first: Outlook,
    scene: Scene,
    passing: Passing,
    bonus: FloatArray,
    yaw: float,
    spec: RobotSpec,
    settings: DecisionSettings,
) -> FloatArray:
    """(m,) periods without contact that can be expected of candidates that may be followed by
    others, up to `OUTLOOK`, and the bonus. Where that cannot be the most of all it may be more.
    Below zero, but for the bonus, where the robot cannot stop before what stands.

    Args:
        first: the candidates' prospects.
        scene: what they were held against.
        passing: what places are worth beyond the roll-outs.
        bonus: (m,) periods by which a candidate is preferred.
        yaw: of the robot, rad.
        spec, settings: the robot's, and the decision's.
    """
    lasts = _alone(first, passing, yaw)
    tried = np.argsort(-lasts, kind="stable")[:TRIED]
    tried = tried[lasts[tried] >= 0.0]
    lasts += bonus
    for length in FIRST_MOVES:
        most = _most(first.alive, length, bonus)
        worth = tried[most[tried] >= lasts.max() - ROUNDING]
        if len(worth) == 0:
            continue
        moves = moves_after(np.ascontiguousarray(first.poses[worth, :length]), spec)
        _follow(
            lasts, most, bonus, worth, first.alive, length, moves.poses, moves.facing, moves.speed,
            moves.brake_steps, scene.later(length), passing, yaw,
            spec.max_yaw_acceleration * spec.decision_period**2, spec.half_side,
            settings.static_margin, settings.static_margin_growth, settings.static_recovery,
            settings.creeping_speed,
        )  # fmt: skip
    return lasts


@compiled
def _alone(first: Outlook, passing: Passing, yaw: float) -> FloatArray:
    """(m,) periods that can be expected of candidates that nothing follows; -1 for those that
    cannot stop before what stands."""
    lasts = np.full(len(first.poses), -1.0)
    x, y = judged_places(first.poses[:, JUDGED - 1], yaw)
    for i in range(len(lasts)):
        if first.static_ok[i]:
            onward = BEYOND if leads_on(passing, x[i], y[i]) else 0.0
            lasts[i] = first.alive[i].sum() + onward * first.alive[i, -1]
    return lasts


def _most(alive: FloatArray, length: int, bonus: FloatArray) -> FloatArray:
    """(m,) periods, the bonus (m,) included, that first moves of some length can come to at most,
    whatever follows; less than any where nothing can follow."""
    after = alive[:, length - 1]
    most = alive[:, :length].sum(axis=1) + bonus + after * (HORIZON - length + BEYOND)
    return np.where(after > 0.0, most, -np.inf)


@compiled
def _follow(
    lasts: FloatArray,
    most: FloatArray,
    bonus: FloatArray,
    tried: IntArray,
    alive: FloatArray,
    length: int,
    poses: FloatArray,
    facing: FloatArray,
    aim: FloatArray,
    brake_steps: IntArray,
    scene: Scene,
    passing: Passing,
    yaw: float,
    slowing: float,
    half_side: float,
    margin: float,
    growth: float,
    recovery: float,
    creeping: float,
) -> None:
    """Raises how long first moves last to what the best of their second ones do, as far as that can
    be more than the best of all.

    Args:
        lasts: (m,) periods, `bonus` (m,) included.
        most: (m,) what they can come to.
        tried: (p,) numbers of the first moves.
        alive: (m, HORIZON) of all of them.
        length: periods that a first move takes.
        poses, facing, aim, brake_steps: of the second moves, those of each first one after those of
            the one before, as in `Motions`.
        scene: from the end of the first moves on.
        passing, yaw: as in `lasting`.
        slowing, half_side, margin, growth, recovery, creeping: as `look_ahead` hands them on.
    """
    each, periods = len(aim) // len(tried), poses.shape[1]
    margins = margins_to_standing(
        aim[:each], scene.standing, scene.times, half_side, margin, growth, recovery, creeping
    )
    placed, gaps = np.empty((4, periods)), np.empty(periods)
    lived, elsewhere = np.empty(periods), np.empty(periods)
    surely_seen = scene.ranges.min() ** 2
    c, s, judged = cos(yaw), sin(yaw), JUDGED - 1 - length
    best = lasts.max()
    for n in range(len(tried)):
        number = tried[n]
        if most[number] < best - ROUNDING:
            continue
        before, after = alive[number, :length].sum() + bonus[number], alive[number, length - 1]
        for k in range(n * each, (n + 1) * each):
            if lasts[number] > most[number] - ROUNDING:
                break
            last = drive_up(
                placed, gaps, poses[k], facing[k], margins[k % each], brake_steps[k],
                scene.standing, scene.ranges, scene.turn, surely_seen, slowing, half_side,
            )  # fmt: skip
            if last < 0:
                continue
            x, y = placed[0, judged], placed[1, judged]
            beyond = BEYOND if leads_on(passing, c * x - s * y, s * x + c * y) else 0.0
            least = (best - before) / after - ROUNDING
            then = hold_against_movers(
                lived, gaps, elsewhere, placed, scene, half_side, beyond, least
            )
            if then >= 0.0:
                lasts[number] = max(lasts[number], before + after * then)
                best = max(best, lasts[number])
