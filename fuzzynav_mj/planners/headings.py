"""How the heading of a candidate turns, for every direction and every yaw rate at its beginning.

It depends on nothing else, so it is worked out once.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import pi

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.steering import TURN_TIME
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray, IntArray

HORIZON = 16  # steps of one decision period each
TURN_STEP = pi / 90  # directions are held in steps of two degrees
TURNS = round(2 * pi / TURN_STEP)
NO_TURN = TURNS  # the row of the table in which the robot stops turning
YAW_RATE_CLASS = 0.1  # rad/s
FINE_STEPS = 4  # so many half periods are rolled out first, where speeds still change fast


@dataclass(frozen=True, slots=True, eq=False)
class Headings:
    """Headings over time for each class of yaw rate and each row of turns.

    Attributes:
        span: (steps,) length of each time step, s.
        whole: (HORIZON,) the step that each decision period ends with.
        rate: (classes, rows) yaw rate after the first period, rad/s.
        courses: (classes, rows, steps, 8) share of the speed aimed at, at each step's end; x and y
            of the heading in its middle; x and y of the centre's mean velocity about the axle,
            m/s; and the heading at its end, with its x and y.
    """

    span: FloatArray
    whole: IntArray
    rate: FloatArray
    courses: FloatArray


@lru_cache(maxsize=8)
def headings(spec: RobotSpec) -> Headings:
    """The table of a robot with these limits."""
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
    ends = after, np.cos(after), np.sin(after)
    courses = np.stack((drive, c, s, -s * side, c * side, *ends), axis=-1)
    courses = np.ascontiguousarray(courses.transpose(1, 2, 0, 3))
    return Headings(span, whole, rates[whole[0]], courses)


@compiled
def rate_class(omega: float, classes: int) -> int:
    """The class of `Headings` for a yaw rate, rad/s, of an odd number of them."""
    most = classes // 2
    return min(max(round(omega / YAW_RATE_CLASS), -most), most) + most
