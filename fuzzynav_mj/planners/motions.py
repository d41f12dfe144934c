"""Candidate motions: directions times speeds, rolled out under the robot's limits.

A candidate turns towards its direction and drives on in it. Roll-outs depend only on the speeds
that the robot has now, so they are computed once per speed class and looked up afterwards.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import pi

import numpy as np

from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray, IntArray, Twist2D

HORIZON = 16  # steps of one decision period each
TURN_STEP = pi / 90  # directions are held in steps of two degrees
TURNS = round(2 * pi / TURN_STEP)
SPEED_CLASS = 0.1  # m/s
YAW_RATE_CLASS = 1.0  # rad/s
TURN_TIME = 0.2  # s: time constant of the turn towards the direction
FORWARD_SPEEDS = (1.0, 0.5, 0.2)  # fractions of the top speed
REVERSE_SPEEDS = (1.0, 0.4)
_SUBSTEPS = 4

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
    """

    poses: np.ndarray
    speed: FloatArray
    direction: FloatArray
    brake_steps: IntArray


def candidate_motions(wanted: float, twist: Twist2D, spec: RobotSpec) -> Motions:
    """Candidates around a wanted direction of travel (rad, robot frame), and the one that stops."""
    v_class = round(twist.v / SPEED_CLASS)
    omega_class = round(twist.omega / YAW_RATE_CLASS)
    forward, reverse, stop = _rollouts(v_class, omega_class, spec)
    turns = (round(wanted / TURN_STEP) + FORWARD_OFFSETS) % TURNS
    poses = np.concatenate(
        (
            forward[:, turns].reshape(-1, HORIZON, 3),
            reverse[:, REVERSE_OFFSETS % TURNS].reshape(-1, HORIZON, 3),
            stop[None],
        )
    )
    speed, brake_steps = _aims(spec)
    direction = np.concatenate(
        (
            np.tile(turns * TURN_STEP, len(FORWARD_SPEEDS)),
            np.tile(REVERSE_OFFSETS * TURN_STEP + pi, len(REVERSE_SPEEDS)),
            [0.0],
        )
    )
    return Motions(poses, speed, direction, brake_steps)


@lru_cache(maxsize=8)
def _aims(spec: RobotSpec) -> tuple[FloatArray, IntArray]:
    forward = np.repeat(np.array(FORWARD_SPEEDS), len(FORWARD_OFFSETS))
    reverse = np.repeat(-np.array(REVERSE_SPEEDS), len(REVERSE_OFFSETS))
    speed = np.concatenate((forward, reverse, [0.0])) * spec.max_speed
    time = np.abs(speed) / spec.max_acceleration
    return speed, np.ceil(time / spec.decision_period - 1e-9).astype(np.intp)


@lru_cache(maxsize=1024)
def _rollouts(
    v_class: int, omega_class: int, spec: RobotSpec
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All roll-outs from one class of speeds: (speeds, TURNS, HORIZON, 3) forward and reverse,
    and (HORIZON, 3) for stopping."""
    v, omega = v_class * SPEED_CLASS, omega_class * YAW_RATE_CLASS
    turns = np.arange(TURNS) * TURN_STEP
    turns = np.where(turns > pi, turns - 2 * pi, turns)
    forward = np.stack([_roll(v, omega, turns, f * spec.max_speed, spec) for f in FORWARD_SPEEDS])
    reverse = np.stack([_roll(v, omega, turns, -f * spec.max_speed, spec) for f in REVERSE_SPEEDS])
    return forward, reverse, _roll(v, omega, np.zeros(1), 0.0, spec)[0]


def _roll(v: float, omega: float, turns: FloatArray, aim: float, spec: RobotSpec) -> np.ndarray:
    """(len(turns), HORIZON, 3) poses while turning by `turns` and driving at `aim`."""
    dt = spec.decision_period / _SUBSTEPS
    speed, rate = np.full(len(turns), v), np.full(len(turns), omega)
    x, y, yaw = np.zeros((3, len(turns)))
    poses = np.empty((len(turns), HORIZON, 3), dtype=np.float32)
    turning = 1.0 if aim else 0.0
    for step in range(HORIZON):
        for _ in range(_SUBSTEPS):
            error = turns - yaw
            wanted_rate = turning * np.clip(
                error / TURN_TIME, -spec.max_yaw_rate, spec.max_yaw_rate
            )
            # Drive while roughly on course; turn on the spot otherwise.
            wanted_speed = aim * np.maximum(np.cos(np.clip(error, -pi / 2, pi / 2)), 0.0) ** 2
            change, turn = spec.max_acceleration * dt, spec.max_yaw_acceleration * dt
            speed = speed + np.clip(wanted_speed - speed, -change, change)
            rate = rate + np.clip(wanted_rate - rate, -turn, turn)
            middle = yaw + rate * (dt / 2)
            side = spec.axle_offset * rate
            x = x + (np.cos(middle) * speed - np.sin(middle) * side) * dt
            y = y + (np.sin(middle) * speed + np.cos(middle) * side) * dt
            yaw = yaw + rate * dt
        poses[:, step] = np.stack((x, y, yaw), axis=1)
    return poses
