"""Candidate motions: directions times speeds, rolled out under the robot's limits.

A candidate turns towards its direction and drives on in it. How the heading turns depends only on
the present yaw rate, so headings come from a table; speeds and places are rolled out each time.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import pi

import numpy as np

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


@dataclass(frozen=True, slots=True, eq=False)
class Motions:
    """Rolled-out candidates, robot frame of the present pose.

    Attributes:
        poses: (m, HORIZON, 3) float32; x, y of the footprint's centre and yaw, after each period.
        speed: (m,) speed aimed at, m/s, negative in reverse.
        direction: (m,) direction of travel aimed at, rad.
        brake_steps: (m,) periods it takes to stop from that speed, rounded up.
        on_the_spot: (m,) True for the one that turns without driving. The last one stops.
    """

    poses: np.ndarray
    speed: FloatArray
    direction: FloatArray
    brake_steps: IntArray
    on_the_spot: BoolArray


def candidate_motions(wanted: float, twist: Twist2D, spec: RobotSpec) -> Motions:
    """Candidates around a wanted direction of travel (rad, robot frame), a turn on the spot to it,
    and the one that stops."""
    ahead = (round(wanted / TURN_STEP) + FORWARD_OFFSETS) % TURNS
    back = REVERSE_OFFSETS % TURNS
    rows = np.concatenate(
        (
            np.tile(ahead, len(FORWARD_SPEEDS)),
            np.tile(back, len(REVERSE_SPEEDS)),
            [ahead[0], NO_TURN],
        )
    )
    direction = np.concatenate(
        (
            np.tile(ahead * TURN_STEP, len(FORWARD_SPEEDS)),
            np.tile(back * TURN_STEP + pi, len(REVERSE_SPEEDS)),
            [ahead[0] * TURN_STEP, 0.0],
        )
    )
    speed, brake_steps = _aims(spec)
    on_the_spot = np.arange(len(rows)) == len(rows) - 2
    poses = _roll(rows, speed, twist, spec)
    return Motions(poses, speed, direction, brake_steps, on_the_spot)


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
        yaw: (classes, rows, steps) heading in the middle of each step.
        rate: (classes, rows, steps) mean yaw rate in it.
        drive: (classes, rows, steps) share of the speed aimed at, at its end.
        after: (classes, rows, HORIZON) heading after each decision period.
        whole: (HORIZON,) the step that each decision period ends with.
    """

    span: FloatArray
    yaw: FloatArray
    rate: FloatArray
    drive: FloatArray
    after: FloatArray
    whole: IntArray


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
    middle, mean, drive, after = [], [], [], []
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
    return _Headings(
        span=span,
        yaw=np.stack(middle[::2], axis=2),
        rate=np.stack(mean, axis=2),
        drive=np.stack(drive, axis=2),
        after=np.stack(after, axis=2)[:, :, whole],
        whole=whole,
    )


def _roll(rows: IntArray, aim: FloatArray, twist: Twist2D, spec: RobotSpec) -> np.ndarray:
    """(m, HORIZON, 3) float32 poses for rows (m,) of the heading table and speeds aimed at (m,)."""
    table = _headings(spec)
    classes = round(spec.max_yaw_rate / YAW_RATE_CLASS)
    kind = min(max(round(twist.omega / YAW_RATE_CLASS), -classes), classes) + classes
    wanted = table.drive[kind, rows] * aim[:, None]
    speed = np.full(len(rows), twist.v)
    means = np.empty_like(wanted)
    for step, span in enumerate(table.span.tolist()):
        change = spec.max_acceleration * span
        new = np.minimum(np.maximum(wanted[:, step], speed - change), speed + change)
        means[:, step] = (speed + new) / 2
        speed = new
    yaw = table.yaw[kind, rows]
    c, s = np.cos(yaw), np.sin(yaw)
    side = spec.axle_offset * table.rate[kind, rows]
    x = np.cumsum((c * means - s * side) * table.span, axis=1)[:, table.whole]
    y = np.cumsum((s * means + c * side) * table.span, axis=1)[:, table.whole]
    return np.stack((x, y, table.after[kind, rows]), axis=2).astype(np.float32)
