"""The physics steps of one decision period, taken in machine code.

Twenty steps from Python cost half as much again as the physics in them. Here compiled code calls
MuJoCo's own functions by their addresses and writes to the simulation's arrays.
"""

import ctypes
from collections.abc import Callable
from math import atan2, cos, hypot, pi, sin
from pathlib import Path

import mujoco
import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import FloatArray, IntArray

Native = Callable[[int, int], None]
"""A function of MuJoCo that takes the addresses of model and data."""


def native(name: str) -> Native:
    """MuJoCo's function of this name, to be called by compiled code.

    It must be one of those that take model and data and return nothing.
    """
    # Where a library's functions are not found through the bindings that link to it, it is named.
    named = Path(mujoco.__file__).with_name("mujoco.dll")
    library = ctypes.CDLL(str(named if named.exists() else mujoco._functions.__file__))
    function = library[name]
    function.argtypes, function.restype = (ctypes.c_int64, ctypes.c_int64), None
    return function


@compiled
def take_steps(
    step2: Native,
    step1: Native,
    model: int,
    data: int,
    ctrl: FloatArray,
    wheels: FloatArray,
    wheel_of: IntArray,
    mocap: FloatArray,
    movers: FloatArray,
    mover_of: IntArray,
    hit: FloatArray,
    place: FloatArray,
    speed: FloatArray,
    chassis: int,
    wheel_dofs: IntArray,
    track: float,
    wheel_radius: float,
    axle_offset: float,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Takes k steps, or fewer where a contact ends them; returns what `true_motion` tells of them.

    Each begins with the forces and ends with the positions, the contact sensor among them, of the
    state it leads to; so first contact is read before any force of it has acted.

    Args:
        step2, step1: MuJoCo's two halves of a step.
        model, data: addresses of both.
        ctrl: (2,) of the simulation, rad/s; `wheels` (k, 2) is written to it.
        wheel_of: (2,) the wheel behind each actuator.
        mocap: (movers, 3) of the simulation, m; `movers` (k, movers, 2) is written to it.
        mover_of: (movers,) the mover behind each mocap body.
        hit: (1,) the contact sensor.
        place: (7,) the simulation's position and quaternion of the chassis.
        speed: (nv,) of the simulation.
        chassis, wheel_dofs, track, wheel_radius, axle_offset: as in `true_motion`.
    """
    steps = len(wheels)
    places, speeds = np.empty((steps, len(place))), np.empty((steps, len(speed)))
    for k in range(steps):
        for i in range(len(ctrl)):
            ctrl[i] = wheels[k, wheel_of[i]]
        step2(model, data)
        for i in range(len(mocap)):
            mocap[i, 0], mocap[i, 1] = movers[k, mover_of[i], 0], movers[k, mover_of[i], 1]
        step1(model, data)
        places[k], speeds[k] = place, speed
        if hit[0] > 0.0:
            steps = k + 1
            break
    return true_motion(
        places[:steps], speeds[:steps], chassis, wheel_dofs, track, wheel_radius, axle_offset
    )


@compiled
def true_motion(
    places: FloatArray,
    speeds: FloatArray,
    chassis: int,
    wheel_dofs: IntArray,
    track: float,
    wheel_radius: float,
    axle_offset: float,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(k, 3) poses, (k, 2) wheel speeds and (k,) slip of a `BlockTruth`.

    Args:
        places: (k, 7) positions and quaternions of the chassis.
        speeds: (k, nv) of all degrees of freedom.
        chassis: number of the first of the chassis's.
        wheel_dofs: (2,) numbers of the left and the right wheel's.
        track, wheel_radius, axle_offset: of the robot, m.
    """
    count = len(places)
    poses, rates, slip = np.empty((count, 3)), np.empty((count, 2)), np.empty(count)
    for k in range(count):
        yaw = 2.0 * atan2(places[k, 6], places[k, 3])
        c, s = cos(yaw), sin(yaw)
        x, y, turning = speeds[k, chassis], speeds[k, chassis + 1], speeds[k, chassis + 5]
        forward = x * c + y * s
        aside = y * c - x * s - axle_offset * turning
        rates[k, 0], rates[k, 1] = speeds[k, wheel_dofs[0]], speeds[k, wheel_dofs[1]]
        left = abs(forward - turning * (track / 2) - rates[k, 0] * wheel_radius)
        right = abs(forward + turning * (track / 2) - rates[k, 1] * wheel_radius)
        slip[k] = hypot(max(left, right), aside)
        poses[k, 0], poses[k, 1] = places[k, 0], places[k, 1]
        poses[k, 2] = (yaw + pi) % (2 * pi) - pi
    return poses, rates, slip
