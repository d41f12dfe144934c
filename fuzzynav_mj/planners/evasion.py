"""Ways out of a pinch, in two moves.

Where no candidate keeps its margins, none of them may last: each holds one direction. Here the most
lasting ones are driven for a while, and then any candidate from there; what a first move is worth
is the best of its second ones.
"""

from math import cos, sin

import numpy as np

from fuzzynav_mj.planners.clearance import facings, moving_clearance, static_clearance
from fuzzynav_mj.planners.motions import Motions, candidate_motions
from fuzzynav_mj.planners.outlook import Outlook, look_ahead
from fuzzynav_mj.planners.scene import Scene
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray, Twist2D

FIRST_MOVE = 4  # decision periods
TRIED = 8  # first moves
EVERY = 3  # so few of the candidates tell what a second move can do


def lasting(
    first: Outlook, scene: Scene, spec: RobotSpec, settings: DecisionSettings
) -> tuple[FloatArray, FloatArray]:
    """(m,) periods without contact, and (m,) room meanwhile, m, of candidates that may be followed
    by others; where a second move does not help, those of the candidate alone.

    Args:
        first: the candidates' prospects.
        scene: what they were held against.
        spec, settings: the robot's, and the decision's.
    """
    clear, room = first.contact_step.astype(np.float64), room_left(first)
    later = scene.later(FIRST_MOVE)
    order = np.lexsort((-room, -clear))
    possible = order[(first.static_ok & (clear >= FIRST_MOVE))[order]]
    for i in possible[:TRIED].tolist():
        second = look_ahead(_moves_after(first.poses[i], spec), later, spec, settings)
        then = np.where(second.static_ok, second.contact_step + FIRST_MOVE, 0)
        there = np.minimum(room_left(second), _room_during(first.poses[i], scene, spec))
        best = int(np.lexsort((-there, -then))[0])
        if (then[best], there[best]) > (clear[i], room[i]):
            clear[i], room[i] = then[best], there[best]
    return clear, room


def room_left(outlook: Outlook) -> FloatArray:
    """(m,) m."""
    return _room(outlook.static, outlook.moving, outlook.expected)


def _room(static: FloatArray, moving: FloatArray, expected: FloatArray) -> FloatArray:
    """Of the gaps (m,) of an outlook. The worst case is contact for most: then what is expected
    makes the difference."""
    room: FloatArray = np.minimum(static, (moving + expected) / 2)
    return room


def _room_during(poses: FloatArray, scene: Scene, spec: RobotSpec) -> FloatArray:
    """(1,) `room_left` during a first move (T, 3), m."""
    move, half_side = poses[None, :FIRST_MOVE], spec.half_side
    static = static_clearance(move, scene.standing, half_side).min(axis=1)
    expected, possible = (
        moving_clearance(move, points[..., :FIRST_MOVE].transpose(2, 0, 1), half_side).min(axis=1)
        for points in (scene.expected, scene.possible)
    )
    return _room(static, np.minimum(expected, possible), expected)


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
