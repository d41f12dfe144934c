"""Candidate motions: directions times speeds, rolled out under the robot's limits.

A candidate turns towards its direction and drives on in it. How the heading turns depends only on
the present yaw rate, so headings come from a table; speeds and places are rolled out each time.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import pi

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray, Twist2D

HORIZON = 16  # steps of one decision period each
TURN_STEP = pi / 90  # directions are held in steps of two degrees
TURNS = round(2 * pi / TURN_STEP)
NO_TURN = TURNS  # the row of the heading table in which the robot stops turning
YAW_RATE_CLASS = 0.1  # rad/s
TURN_TIME = 0.2  # s: time constant of the turn towards the direction
FINE_STEPS = 4  # so many half periods are rolled out first, where speeds still change fast
FORWARD_SPEEDS = (1.0, 0.5, 0.2)  # fractions of the top speed
REVERSE_SPEEDS = (1.0, 0.4)

# Offsets from the wanted direction, finer around it, in turn steps; and heading changes tried
# while reversing.
_AROUND = np.array([0, 2, 4, 7, 10, 15, 20, 27, 35, 45, 60, 75], dtype=int)
FORWARD_OFFSETS = np.concatenate((_AROUND, -_AROUND[1:], [90]))
REVERSE_OFFSETS = np.array([0, 5, -5, 10, -10, 18, -18, 26, -26])

# Every candidate's place among the forward directions, the reverse ones, and no direction.
_CANDIDATES = np.concatenate(
    (
        np.tile(np.arange(len(FORWARD_OFFSETS)), len(FORWARD_SPEEDS)),
        np.tile(len(FORWARD_OFFSETS) + np.arange(len(REVERSE_OFFSETS)), len(REVERSE_SPEEDS)),
        [0, -1],
    )
)
_BACK = np.append(REVERSE_OFFSETS % TURNS, NO_TURN)
_BACK_DIRECTIONS = np.append((REVERSE_OFFSETS % TURNS) * TURN_STEP + pi, 0.0)
_ON_THE_SPOT = np.arange(len(_CANDIDATES)) == len(_CANDIDATES) - 2


@dataclass(frozen=True, slots=True, eq=False)
class Motions:
    """Rolled-out candidates, robot frame of the present pose.

    Attributes:
        poses: (m, HORIZON, 3) x, y of the footprint's centre and yaw, after each period.
        speeds: (m, 2) forward speed and yaw rate after the first one, m/s and rad/s.
        speed: (m,) speed aimed at, m/s, negative in reverse.
        direction: (m,) direction of travel aimed at, rad.
        brake_steps: (m,) periods it takes to stop from that speed, rounded up.
        on_the_spot: (m,) True for the one that turns without driving. The last one stops.
    """

    poses: FloatArray
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
    ahead = (round(wanted / TURN_STEP) + FORWARD_OFFSETS) % TURNS
    rows = np.concatenate((ahead, _BACK)).take(_CANDIDATES)
    direction = np.concatenate((ahead * TURN_STEP, _BACK_DIRECTIONS)).take(_CANDIDATES)
    speed, brake_steps = _aims(spec)
    poses, speeds = _roll(rows, speed, twist, spec)
    return Motions(poses, speeds, speed, direction, brake_steps, _ON_THE_SPOT)


@lru_cache(maxsize=8)
def _aims(spec: RobotSpec) -> tuple[FloatArray, IntArray]:
    forward = np.repeat(np.array(FORWARD_SPEEDS), len(FORWARD_OFFSETS))
    reverse = np.repeat(-np.array(REVERSE_SPEEDS), len(REVERSE_OFFSETS))
    speed = np.concatenate((forward, reverse, [0.0, 0.0])) * spec.max_speed
    time = np.abs(speed) / spec.max_acceleration
    return speed, np.ceil(time / spec.decision_period - 1e-9).astype(np.intp)


@dataclass(frozen=True, slots=True, eq=False)
class _Headings:
    """Headings over time for each class of yaw rate and each row of turns.

    Attributes:
        span: (steps,) length of each time step, s.
        whole: (HORIZON,) the step that each decision period ends with.
        rate: (classes, rows) yaw rate after the first period, rad/s.
        courses: (classes, rows, steps, 6) share of the speed aimed at, at each step's end; x and y
            of the heading in its middle; x and y of the centre's mean velocity about the axle,
            m/s; and the heading at its end.
    """

    span: FloatArray
    whole: IntArray
    rate: FloatArray
    courses: FloatArray


@lru_cache(maxsize=8)
def _headings(spec: RobotSpec) -> _Headings:
    period = spec.decision_period
    span = np.array([period / 2] * FINE_STEPS + [period] * (HORIZON - FINE_STEPS // 2))
    whole = np.searchsorted(np.cumsum(span), (np.arange(HORIZON) + 1) * period - 1e-9)
    turns = np.arange(TURNS) * TURN_STEP
    turns = np.append(np.where(turns > pi, turns - 2 * pi, turns), 0.0)
    turning = np.append(np.ones(TURNS), 0.0)
    classes = round(spec.max_yaw_rate / YAW_RATE_CLASS)
    rate = np.repeat(np.arange(-classes, classes + 1)[:, None] * YAW_RATE_CLASS, len(turns), axis=1)
    yaw = np.zeros_like(rate)
    middle, mean, drive, after, rates = [], [], [], [], []
    for step in span:
        start = yaw
        for part in (step / 2, step / 2):
            error = turns - yaw
            wanted = turning * np.clip(error / TURN_TIME, -spec.max_yaw_rate, spec.max_yaw_rate)
            change = np.clip(wanted - rate, *(spec.max_yaw_acceleration * part * np.array([-1, 1])))
            yaw = yaw + (rate + change / 2) * part
            rate = rate + change
            middle.append(yaw)
        mean.append((yaw - start) / step)
        error = turns - yaw
        # Drive while roughly on course; turn on the spot otherwise.
        drive.append(np.maximum(np.cos(np.clip(error, -pi / 2, pi / 2)), 0.0) ** 2)
        after.append(yaw)
        rates.append(rate)
    c, s = np.cos(middle[::2]), np.sin(middle[::2])
    side = spec.axle_offset * np.array(mean)
    courses = np.stack((drive, c, s, -s * side, c * side, after), axis=-1)
    courses = np.ascontiguousarray(courses.transpose(1, 2, 0, 3))
    return _Headings(span, whole, rates[whole[0]], courses)


def _roll(
    rows: IntArray, aim: FloatArray, twist: Twist2D, spec: RobotSpec
) -> tuple[FloatArray, FloatArray]:
    """(m, HORIZON, 3) poses, and (m, 2) speeds after the first period, for rows (m,) of the heading
    table and speeds aimed at (m,)."""
    table = _headings(spec)
    classes = round(spec.max_yaw_rate / YAW_RATE_CLASS)
    kind = min(max(round(twist.omega / YAW_RATE_CLASS), -classes), classes) + classes
    poses, first = _drive(
        table.courses[kind], rows, aim, twist.v, spec.max_acceleration, table.span, table.whole
    )
    return poses, np.column_stack((first, table.rate[kind].take(rows)))


@compiled
def _drive(
    courses: FloatArray,
    rows: IntArray,
    aim: FloatArray,
    speed_now: float,
    acceleration: float,
    span: FloatArray,
    whole: IntArray,
) -> tuple[FloatArray, FloatArray]:
    """(m, HORIZON, 3) poses: the speed follows its share of the aim within the acceleration; and
    (m,) the speed after the first period."""
    poses = np.empty((len(rows), len(whole), 3))
    first = np.empty(len(rows))
    for i in range(len(rows)):
        x, y, speed, period = 0.0, 0.0, speed_now, 0
        for step in range(len(span)):
            drive, c, s, aside_x, aside_y, yaw = courses[rows[i], step]
            change = acceleration * span[step]
            after = min(max(drive * aim[i], speed - change), speed + change)
            mean = (speed + after) / 2
            x += (c * mean + aside_x) * span[step]
            y += (s * mean + aside_y) * span[step]
            speed = after
            if step == whole[0]:
                first[i] = speed
            if step == whole[period]:
                poses[i, period, 0] = x
                poses[i, period, 1] = y
                poses[i, period, 2] = yaw
                period += 1
    return poses, first
