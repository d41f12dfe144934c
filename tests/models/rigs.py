"""The robot in the model files' own words: compiled scenes, wheel commands, what came of them."""

from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np

from fuzzynav_mj.assets import model_path
from fuzzynav_mj.control import wheel_speeds
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.types import FloatArray

DT = DEFAULT_ROBOT.physics_period


def scene(worldbody: str = "", asset: str = "") -> mujoco.MjModel:
    """The room and the robot of the model files, with more elements of the test's own."""
    with model_path("arenas/room.xml") as room, model_path("robots/diff_drive.xml") as robot:
        return mujoco.MjModel.from_xml_string(
            f'<mujoco><include file="{room}"/><include file="{robot}"/>'
            f"<asset>{asset}</asset><worldbody>{worldbody}</worldbody></mujoco>"
        )


def place(data: mujoco.MjData, x: float, y: float, yaw: float) -> None:
    """Put the robot at a pose and bring everything that follows from it up to date."""
    data.qpos[:7] = (x, y, 0.0, np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2))
    mujoco.mj_forward(data.model, data)


@dataclass(frozen=True, eq=False)
class Drive:
    """What happened, one row per physics step.

    Attributes:
        xy: (n, 2) footprint's centre, m.
        yaw: (n,) not wrapped, rad.
        tilt: (n,) angle between the robot's axis and the vertical, rad.
        velocity: (n, 3) vx, vy, yaw rate, in the robot's frame, m/s and rad/s.
        wheels: (n, 2) left and right wheel speed, rad/s.
        castor_gap: (n,) height of the castor's lowest point over the floor, m.
        castor_touches: (n,) True where the castor is in contact with the floor.
    """

    xy: FloatArray
    yaw: FloatArray
    tilt: FloatArray
    velocity: FloatArray
    wheels: FloatArray
    castor_gap: FloatArray
    castor_touches: FloatArray

    @property
    def slip(self) -> FloatArray:
        """(n, 2) how much faster each wheel's rim runs than the robot above it, m/s."""
        half = self.velocity[:, 2:] * (DEFAULT_ROBOT.track / 2) * np.array([-1.0, 1.0])
        return self.wheels * DEFAULT_ROBOT.wheel_radius - (self.velocity[:, :1] + half)


def drive(command: Callable[[float], tuple[float, float]], duration: float) -> Drive:
    """Drive for `duration` s with the wheels told `command(time)`: forward speed and yaw rate."""
    model = scene()
    data = mujoco.MjData(model)
    castor, radius = model.geom("castor").id, float(model.geom("castor").size[0])
    rows = []
    for step in range(round(duration / DT)):
        speeds = wheel_speeds(*command(step * DT), DEFAULT_ROBOT)
        data.ctrl[:] = (speeds.left, speeds.right)
        mujoco.mj_step(model, data)
        w, i, j, k = data.qpos[3:7]
        turn = 2.0 * np.arctan2(k, w)
        c, s = np.cos(turn), np.sin(turn)
        vx, vy = data.qvel[:2]
        touches = any(castor in pair for pair in data.contact.geom.tolist())
        rows.append(
            (
                *data.qpos[:2],
                turn,
                2.0 * np.arcsin(min(1.0, np.hypot(i, j))),
                c * vx + s * vy,
                c * vy - s * vx,
                data.qvel[5],
                *data.qvel[6:8],
                data.geom_xpos[castor][2] - radius,
                float(touches),
            )
        )
    table = np.array(rows)
    return Drive(
        xy=table[:, :2],
        yaw=np.unwrap(table[:, 2]),
        tilt=table[:, 3],
        velocity=table[:, 4:7],
        wheels=table[:, 7:9],
        castor_gap=table[:, 9],
        castor_touches=table[:, 10] > 0.0,
    )


def ramped(v: float, omega: float) -> Callable[[float], tuple[float, float]]:
    """Speed up from rest to (v, omega) as fast as the robot's limits allow, then keep on."""
    spec = DEFAULT_ROBOT

    def command(time: float) -> tuple[float, float]:
        gain = min(spec.max_acceleration * time, abs(v))
        turn = min(spec.max_yaw_acceleration * time, abs(omega))
        return float(np.copysign(gain, v)), float(np.copysign(turn, omega))

    return command
