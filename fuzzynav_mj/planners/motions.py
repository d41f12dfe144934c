"""Candidate motions: directions times speeds, rolled out under the robot's limits.

A candidate turns towards its direction and drives on in it. How the heading turns depends only on
the present yaw rate, so headings come from a table; speeds and places are rolled out each time.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import cos, pi, sin

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.headings import (
    HORIZON,
    NO_TURN,
    TURN_STEP,
    TURNS,
    headings,
    rate_class,
)
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray, Twist2D

FORWARD_SPEEDS = (1.0, 0.5, 0.2)  # fractions of the top speed
REVERSE_SPEEDS = (1.0, 0.4)

# Offsets from the wanted direction, finer around it, in turn steps; and heading changes tried
# while reversing.
_AROUND = np.array([0, 2, 4, 7, 10, 15, 20, 27, 35, 45, 60, 75], dtype=int)
FORWARD_OFFSETS = np.concatenate((_AROUND, -_AROUND[1:], [90]))
REVERSE_OFFSETS = np.array([0, 5, -5, 10, -10, 18, -18, 26, -26])


@dataclass(frozen=True, slots=True, eq=False)
class Motions:
    """Rolled-out candidates, robot frame of the present pose.

    Attributes:
        poses: (m, HORIZON, 3) x, y of the footprint's centre and yaw, after each period.
        facing: (m, HORIZON, 2) cosine and sine of that yaw.
        speeds: (m, 2) forward speed and yaw rate after the first one, m/s and rad/s.
        speed: (m,) speed aimed at, m/s, negative in reverse.
        direction: (m,) direction of travel aimed at, rad.
        brake_steps: (m,) periods it takes to stop from that speed, rounded up.
        on_the_spot: (m,) True for the one that turns without driving. The last one stops.
    """

    poses: FloatArray
    facing: FloatArray
    speeds: FloatArray
    speed: FloatArray
    direction: FloatArray
    brake_steps: IntArray
    on_the_spot: BoolArray

    def stopping(self, stops: IntArray) -> FloatArray:
        """(m, HORIZON, 3) poses that stay where they are after the period `stops` (m,) of each."""
        steps = np.minimum(np.arange(HORIZON), stops[:, None])
        return self.poses[np.arange(len(stops))[:, None], steps]


def candidate_motions(wanted: float, twist: Twist2D, spec: RobotSpec) -> Motions:
    """Candidates around a wanted direction of travel (rad, robot frame), a turn on the spot to it,
    and the one that stops."""
    aims, table = _aims(spec), headings(spec)
    kind = rate_class(twist.omega, len(table.courses))
    poses, facing, speeds, direction = _drive(
        table.courses[kind],
        table.rate[kind],
        round(wanted / TURN_STEP),
        aims.turn,
        aims.speed,
        twist.v,
        spec.max_acceleration,
        table.span,
        table.whole,
    )
    return Motions(poses, facing, speeds, aims.speed, direction, aims.brake_steps, aims.on_the_spot)


def moves_after(first: FloatArray, spec: RobotSpec) -> Motions:
    """Candidates around straight ahead from where first moves end, those of each after those of the
    one before.

    Args:
        first: (p, k, 3) the first moves' poses in the periods that they take, at least two.
        spec: the robot's.

    Returns:
        Candidates through the HORIZON - k periods that are left.
    """
    aims, table = _aims(spec), headings(spec)
    poses, facing, speeds, direction = _drive_on(
        first, table.courses, table.rate, aims.turn, aims.speed, spec.decision_period,
        spec.max_acceleration, table.span, table.whole[: HORIZON - first.shape[1]],
    )  # fmt: skip
    count = len(first)
    return Motions(
        poses,
        facing,
        speeds,
        np.tile(aims.speed, count),
        direction,
        np.tile(aims.brake_steps, count),
        np.tile(aims.on_the_spot, count),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Aims:
    """What the candidates aim at, whichever direction is wanted.

    Attributes:
        turn: (m,) turn steps from the wanted direction, or from the present heading in reverse;
            NO_TURN for the one that stops.
        speed: (m,) m/s, negative in reverse.
        brake_steps, on_the_spot: (m,) as in `Motions`.
    """

    turn: IntArray
    speed: FloatArray
    brake_steps: IntArray
    on_the_spot: BoolArray


@lru_cache(maxsize=8)
def _aims(spec: RobotSpec) -> _Aims:
    forward = np.repeat(np.array(FORWARD_SPEEDS), len(FORWARD_OFFSETS))
    reverse = np.repeat(-np.array(REVERSE_SPEEDS), len(REVERSE_OFFSETS))
    speed = np.concatenate((forward, reverse, [0.0, 0.0])) * spec.max_speed
    time = np.abs(speed) / spec.max_acceleration
    return _Aims(
        turn=np.concatenate(
            (
                np.tile(FORWARD_OFFSETS, len(FORWARD_SPEEDS)),
                np.tile(REVERSE_OFFSETS, len(REVERSE_SPEEDS)),
                [0, NO_TURN],
            )
        ),
        speed=speed,
        brake_steps=np.ceil(time / spec.decision_period - 1e-9).astype(np.intp),
        on_the_spot=np.arange(len(speed)) == len(speed) - 2,
    )


@compiled
def _drive(
    courses: FloatArray,
    rates: FloatArray,
    wanted: int,
    turns: IntArray,
    aim: FloatArray,
    speed_now: float,
    acceleration: float,
    span: FloatArray,
    whole: IntArray,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """(m, HORIZON, 3) poses: the speed follows its share of the aim within the acceleration;
    (m, HORIZON, 2) cosines and sines of their yaw; (m, 2) speeds after the first period; and (m,)
    directions of travel, rad.

    Args:
        courses, rates: (rows, steps, 8) and (rows,) of `Headings`, for the present yaw rate.
        wanted: direction, turn steps.
        turns, aim: (m,) turn and speed of `_Aims`.
        speed_now: m/s.
        acceleration: m/s2.
        span, whole: of `Headings`.
    """
    count = len(aim)
    poses, speeds = np.empty((count, len(whole), 3)), np.empty((count, 2))
    facing, direction = np.empty((count, len(whole), 2)), np.empty(count)
    for i in range(count):
        if turns[i] == NO_TURN:
            row, direction[i] = NO_TURN, 0.0
        elif aim[i] < 0.0:
            row = turns[i] % TURNS
            direction[i] = row * TURN_STEP + pi
        else:
            row = (wanted + turns[i]) % TURNS
            direction[i] = row * TURN_STEP
        speeds[i, 1] = rates[row]
        x, y, speed, period = 0.0, 0.0, speed_now, 0
        for step in range(whole[-1] + 1):
            drive, c, s, aside_x, aside_y, yaw, ahead, aside = courses[row, step]
            change = acceleration * span[step]
            after = min(max(drive * aim[i], speed - change), speed + change)
            mean = (speed + after) / 2
            x += (c * mean + aside_x) * span[step]
            y += (s * mean + aside_y) * span[step]
            speed = after
            if step == whole[0]:
                speeds[i, 0] = speed
            if step == whole[period]:
                poses[i, period, 0] = x
                poses[i, period, 1] = y
                poses[i, period, 2] = yaw
                facing[i, period, 0], facing[i, period, 1] = ahead, aside
                period += 1
    return poses, facing, speeds, direction


@compiled
def _drive_on(
    first: FloatArray,
    courses: FloatArray,
    rates: FloatArray,
    turns: IntArray,
    aim: FloatArray,
    decision_period: float,
    acceleration: float,
    span: FloatArray,
    whole: IntArray,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """What `_drive` returns, in the frame of the first moves (p, k, 3), for p times the candidates.

    Args:
        first: as in `moves_after`.
        courses, rates: (classes, rows, steps, 8) and (classes, rows) of `Headings`.
        turns, aim: (m,) turn and speed of `_Aims`.
        decision_period: s.
        acceleration, span, whole: as in `_drive`.
    """
    count, each = len(first), len(aim)
    poses = np.empty((count * each, len(whole), 3))
    facing = np.empty((count * each, len(whole), 2))
    speeds, direction = np.empty((count * each, 2)), np.empty(count * each)
    for n in range(count):
        before_x, before_y, before = first[n, -2]
        x, y, yaw = first[n, -1]
        c, s = cos(yaw), sin(yaw)
        speed = (c * (x - before_x) + s * (y - before_y)) / decision_period
        kind = rate_class((yaw - before) / decision_period, len(courses))
        own, own_facing, own_speeds, own_direction = _drive(
            courses[kind], rates[kind], 0, turns, aim, speed, acceleration, span, whole
        )
        of = slice(n * each, (n + 1) * each)
        ahead, aside = own[..., 0], own[..., 1]
        poses[of, :, 0], poses[of, :, 1] = c * ahead - s * aside + x, s * ahead + c * aside + y
        poses[of, :, 2] = own[..., 2] + yaw
        ahead, aside = own_facing[..., 0], own_facing[..., 1]
        facing[of, :, 0], facing[of, :, 1] = c * ahead - s * aside, s * ahead + c * aside
        speeds[of], direction[of] = own_speeds, own_direction + yaw
    return poses, facing, speeds, direction


@compiled
def places_after(poses: FloatArray, x: float, y: float, yaw: float) -> FloatArray:
    """(m, 2) world frame, where candidates (m, T, 3) of the robot at this pose are after the first
    period."""
    places, c, s = np.empty((len(poses), 2)), cos(yaw), sin(yaw)
    for i in range(len(poses)):
        places[i, 0] = c * poses[i, 0, 0] - s * poses[i, 0, 1] + x
        places[i, 1] = s * poses[i, 0, 0] + c * poses[i, 0, 1] + y
    return places
