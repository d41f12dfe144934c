"""Ways out of a pinch, in two moves.

Where no candidate keeps its margins, none of them may last: each holds one direction. Here the most
lasting ones are driven for a while, short or long, and then any candidate from there; what a first
move is worth is the best of its second ones. Pinches are rare, so the search may take its time.
"""

import numpy as np

from fuzzynav_mj.planners.headings import HORIZON
from fuzzynav_mj.planners.motions import moves_after
from fuzzynav_mj.planners.outlook import Outlook, look_ahead
from fuzzynav_mj.planners.passing import JUDGED, OUTLOOK, Passing, judged_places, leads_on
from fuzzynav_mj.planners.scene import Scene
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray

FIRST_MOVES = (2, 4, 7)  # decision periods that a first move may take
TRIED = 40  # first moves


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
    tried = np.argsort(-lasts, kind="stable")[:TRIED]
    tried = tried[lasts[tried] >= 0.0]
    for length in FIRST_MOVES:
        moves = moves_after(np.ascontiguousarray(first.poses[tried, :length]), spec)
        second = look_ahead(moves, scene.later(length), spec, settings)
        each = len(moves.speed) // len(tried)
        before = np.repeat(first.alive[tried, :length], each, axis=0)
        alive = np.concatenate((before, before[:, -1:] * second.alive), axis=1)
        then = _periods(second.poses[:, JUDGED - length - 1], alive, passing, yaw)
        best = np.where(second.static_ok, then, -1.0).reshape(len(tried), each).max(axis=1)
        lasts[tried] = np.maximum(lasts[tried], best)
    return lasts


def _periods(
    judged: FloatArray, alive: FloatArray, passing: Passing | None, yaw: float
) -> FloatArray:
    """(m,) periods that can be expected on a way that is survived as likely as `alive` (m, HORIZON)
    says; those after it where a way leads on from its pose after the periods `JUDGED` (m, 3)."""
    lasts: FloatArray = alive.sum(axis=1)
    if passing is not None:
        onward = leads_on(passing, *judged_places(judged, yaw))
        lasts += (OUTLOOK - HORIZON) * alive[:, -1] * onward
    return lasts
