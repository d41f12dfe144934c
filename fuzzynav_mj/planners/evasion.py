"""Ways out of a pinch, in two moves.

Where no candidate keeps its margins, none of them may last: each holds one direction. Here the most
lasting ones are driven for a while, and then any candidate from there; what a first move is worth
is the best of its second ones.
"""

from math import cos, sin

import numpy as np

from fuzzynav_mj.planners.clearance import facings
from fuzzynav_mj.planners.motions import HORIZON, Motions, candidate_motions
from fuzzynav_mj.planners.outlook import Outlook, look_ahead
from fuzzynav_mj.planners.passing import JUDGED, OUTLOOK, Passing, judged_places
from fuzzynav_mj.planners.scene import Scene
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray, Twist2D

FIRST_MOVE = 4  # decision periods
TRIED = 8  # first moves
EVERY = 3  # so few of the candidates tell what a second move can do


def lasting(
    first: Outlook,
    scene: Scene,
    passing: Passing | None,
    yaw: float,
    spec: RobotSpec,
    settings: DecisionSettings,
) -> FloatArray:
    """(m,) periods without contact that can be expected of candidates that may be followed by
    others; at most `OUTLOOK`. Negative where the robot cannot stop before what stands.

    Args:
        first: the candidates' prospects.
        scene: what they were held against.
        passing: what places are worth beyond the roll-outs.
        yaw: of the robot, rad.
        spec, settings: the robot's, and the decision's.
    """
    lasts = np.where(
        first.static_ok, _periods(first.poses[:, JUDGED - 1], first.alive, passing, yaw), -1.0
    )
    later = scene.later(FIRST_MOVE)
    for i in np.argsort(-lasts, kind="stable")[:TRIED].tolist():
        if lasts[i] < 0.0:
            break
        second = look_ahead(_moves_after(first.poses[i], spec), later, spec, settings)
        then = second.poses[second.static_ok]
        before = np.broadcast_to(first.alive[i, :FIRST_MOVE], (len(then), FIRST_MOVE))
        after = first.alive[i, FIRST_MOVE - 1] * second.alive[second.static_ok]
        alive = np.concatenate((before, after), axis=1)
        judged = then[:, JUDGED - FIRST_MOVE - 1]
        lasts[i] = _periods(judged, alive, passing, yaw).max(initial=lasts[i])
    return lasts


def _periods(
    judged: FloatArray, alive: FloatArray, passing: Passing | None, yaw: float
) -> FloatArray:
    """(m,) periods that can be expected on a way that is survived as likely as `alive` (m, HORIZON)
    says; those after it where a way leads on from its pose after the periods `JUDGED` (m, 3)."""
    lasts: FloatArray = alive.sum(axis=1)
    if passing is not None:
        leads_on = passing.leads_on(*judged_places(judged, yaw))
        lasts += (OUTLOOK - HORIZON) * alive[:, -1] * leads_on
    return lasts


def _moves_after(poses: FloatArray, spec: RobotSpec) -> Motions:
    """Candidates from where a first move (T, 3) ends, through the periods that are left."""
    (before_x, before_y, before), (x, y, yaw) = poses[FIRST_MOVE - 2 : FIRST_MOVE].tolist()
    c, s, period = cos(yaw), sin(yaw), spec.decision_period
    ahead = c * (x - before_x) + s * (y - before_y)
    twist = Twist2D(ahead / period, (yaw - before) / period)
    motions = candidate_motions(0.0, twist, spec)
    steps = motions.poses[::EVERY, : len(poses) - FIRST_MOVE]
    turned = steps @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    turned += np.array([x, y, yaw])
    # Copies, for compiled functions are made anew for every layout.
    return Motions(
        turned,
        facings(turned),
        motions.speeds[::EVERY].copy(),
        motions.speed[::EVERY].copy(),
        motions.direction[::EVERY].copy(),
        motions.brake_steps[::EVERY].copy(),
        motions.on_the_spot[::EVERY].copy(),
    )
