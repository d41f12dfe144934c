"""Names of the model resolved to indices, and views of the simulation's arrays.

They are looked up once for each compilation, for looking up names at every step costs more than the
step.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from dm_control import mjcf

from fuzzynav_mj.tasks.robot import DiffDrive
from fuzzynav_mj.types import FloatArray, IntArray

DIVERGENCE = slice(  # of position, speed and acceleration
    int(mujoco.mjtWarning.mjWARN_BADQPOS), int(mujoco.mjtWarning.mjWARN_BADQACC) + 1
)


@dataclass(frozen=True, slots=True, eq=False)
class Handles:
    """Of one compiled model and its data. Arrays are views: what is written to them takes effect.

    Attributes:
        place: (7,) position and quaternion of the chassis.
        speed: (nv,) all speeds.
        twist_at: where the chassis' are in it.
        wheel_dofs: (2,) numbers of the left and the right wheel's in it.
        ctrl: (2,) rad/s.
        wheel_of: (2,) the wheel behind each actuator.
        hit: (1,) the contact sensor.
        hull: number of the geom that touches obstacles.
        mocap: (movers, 3) places of the moving obstacles' bodies.
        mover_of: (movers,) the mover behind each of these.
        warnings: (3,) numbers of warnings that tell of divergence.
    """

    place: FloatArray
    speed: FloatArray
    twist_at: slice
    wheel_dofs: IntArray
    ctrl: FloatArray
    wheel_of: IntArray
    hit: FloatArray
    hull: int
    mocap: FloatArray
    mover_of: IntArray
    warnings: np.ndarray


def find_handles(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    robot: DiffDrive,
    movers: Sequence[mjcf.Element],
) -> Handles:
    """The handles of a model that has the robot and the bodies of the movers in it."""
    parts = robot.mjcf_model
    joint = model.joint(mjcf.get_attachment_frame(parts).full_identifier)
    start, speed = int(joint.qposadr[0]), int(joint.dofadr[0])
    wheels = [
        model.joint(parts.find("joint", f"wheel_{side}").full_identifier)
        for side in ("left", "right")
    ]
    actuators = [model.actuator(a.full_identifier).id for a in robot.actuators]
    hit = int(model.sensor(parts.find("sensor", "hit").full_identifier).adr[0])
    mocap_ids = [int(model.body_mocapid[model.body(body.full_identifier).id]) for body in movers]
    return Handles(
        place=data.qpos[start : start + 7],
        speed=data.qvel,
        twist_at=slice(speed, speed + 6),
        wheel_dofs=np.array([int(wheel.dofadr[0]) for wheel in wheels]),
        ctrl=data.ctrl,
        wheel_of=np.argsort(actuators),
        hit=data.sensordata[hit : hit + 1],
        hull=model.geom(parts.find("geom", "hull").full_identifier).id,
        mocap=data.mocap_pos,
        mover_of=np.argsort(mocap_ids),
        warnings=data.warning.number[DIVERGENCE],
    )


def set_friction(
    model: mujoco.MjModel, robot: DiffDrive, floor: mjcf.Element, friction: float
) -> None:
    """Sets the sliding friction between wheels and floor; MuJoCo takes the larger of the two
    geoms' coefficients."""
    touching = [robot.mjcf_model.find("geom", f"wheel_{side}") for side in ("left", "right")]
    for geom in (*touching, floor):
        model.geom_friction[model.geom(geom.full_identifier).id, 0] = friction
