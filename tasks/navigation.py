"""The navigation task: next position in, wheel speeds, moving obstacles, contact checks."""

from collections import OrderedDict
from math import atan2, cos, hypot, isfinite, pi, sin

import mujoco
import numpy as np
from dm_control import composer, mjcf
from dm_control.composer.observation import observable
from dm_env import specs

from fuzzynav_mj.control import SpeedProfile, drive_towards, wheel_speeds, wheel_table
from fuzzynav_mj.episode import BlockTruth
from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.geometry import wrap_angle
from fuzzynav_mj.robot import DEFAULT_ROBOT, RobotSpec
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.world import World, make_world
from fuzzynav_mj.sensing.lidar import Lidar
from fuzzynav_mj.tasks.arena import NavigationArena
from fuzzynav_mj.tasks.handles import Handles, find_handles, set_friction
from fuzzynav_mj.tasks.mover_places import MoverPlaces
from fuzzynav_mj.tasks.robot import DiffDrive
from fuzzynav_mj.tasks.stepping import native, take_steps
from fuzzynav_mj.tasks.streams import episode_streams
from fuzzynav_mj.types import (
    Contact,
    FloatArray,
    LaserScan,
    Outcome,
    Pose2D,
    Twist2D,
    WheelSpeeds,
)

AT_FAULT_SPEED = 0.02  # m/s: slower than this the robot stood still when it was touched
GOAL_YAW_TOLERANCE = 0.1  # rad


class NavigateToGoal(composer.Task):
    """Drives the robot from start to goal through one scenario.

    Observations: `ranges` (ray_count,) m, the sensor's range where nothing is hit; `pose` (3,)
    x, y, yaw in the world frame; `twist` (2,) forward speed and yaw rate; `goal` (2,) x, y.
    Reward: 1 on reaching the goal, -1 on contact, else 0. The discount is 0 after either, and 1
    when the time is up.

    Args:
        scenario: what to drive through.
        seed: of the first episode; the k-th reset plays seed + k.
        spec: the robot's parameters.
        friction: sliding friction coefficient between wheels and floor; None for the model's.
    """

    def __init__(
        self,
        scenario: Scenario,
        seed: int,
        spec: RobotSpec = DEFAULT_ROBOT,
        friction: float | None = None,
    ) -> None:
        self.scenario = scenario
        self.spec = spec
        self._friction = friction
        self.seed = seed - 1  # the first reset advances it to the given one
        self.streams = episode_streams(seed)
        self.world: World = make_world(scenario, self.streams.scenario)
        self._drawn_seed = seed
        self._arena = NavigationArena(self.world)
        self._robot = DiffDrive()
        self._arena.add_free_entity(self._robot)
        self.set_timesteps(spec.decision_period, spec.physics_period)
        self._observables = OrderedDict(
            ranges=observable.Generic(lambda physics: self.scan.ranges),
            pose=observable.Generic(lambda physics: self._pose_vector()),
            twist=observable.Generic(lambda physics: self._twist_vector()),
            goal=observable.Generic(lambda physics: np.array(scenario.goal)),
        )
        for item in self._observables.values():
            item.enabled = True

    @property
    def root_entity(self) -> NavigationArena:
        """The arena."""
        return self._arena

    @property
    def task_observables(self) -> OrderedDict[str, observable.Observable]:
        """What an agent sees."""
        return self._observables

    @property
    def redraws(self) -> bool:
        """True if every seed has moving obstacles of its own."""
        return bool(self.scenario.random_moving)

    @property
    def physics_steps_per_control_step(self) -> int:
        """One: `advance` takes all physics steps of a decision period in a single block."""
        return 1

    def action_spec(self, physics: mjcf.Physics) -> specs.BoundedArray:
        """Next position (x, y), world frame, m, within the scenario's bounds."""
        x_min, y_min, x_max, y_max = self.scenario.bounds
        return specs.BoundedArray(
            shape=(2,),
            dtype=np.float64,
            minimum=(x_min, y_min),
            maximum=(x_max, y_max),
            name="next_position_x\tnext_position_y",
        )

    # Episode start -------------------------------------------------------------------------

    def initialize_episode_mjcf(self, random_state: np.random.RandomState) -> None:
        """Draws the moving obstacles of the next seed."""
        del random_state
        if self.redraws and self.seed + 1 != self._drawn_seed:
            self._draw(self.seed + 1)
            self._arena.set_movers(self.world.movers)

    def _draw(self, seed: int) -> None:
        self.streams = episode_streams(seed)
        self.world = make_world(self.scenario, self.streams.scenario)
        self._drawn_seed = seed

    def after_compile(self, physics: mjcf.Physics, random_state: np.random.RandomState) -> None:
        """Resolves names to indices and caches views, once per compilation."""
        del random_state
        model, data = physics.model.ptr, physics.data.ptr
        self._model, self._data = model, data
        self._lidar = Lidar(
            model,
            self._robot.mjcf_model.find("site", "lidar").full_identifier,
            self.spec.ray_count,
            self.spec.sensor_range,
        )
        movers = self._arena.mover_bodies
        self._handles: Handles = find_handles(model, data, self._robot, movers)
        if self._friction is not None:
            floor = self._arena.mjcf_model.find("geom", "floor")
            set_friction(model, self._robot, floor, self._friction)
        self._natives = native("mj_step2"), native("mj_step1"), model._address, data._address
        self._scan: LaserScan | None = None
        self._pose: Pose2D | None = None

    def initialize_episode(
        self, physics: mjcf.Physics, random_state: np.random.RandomState
    ) -> None:
        """Places the robot and the moving obstacles."""
        del physics, random_state
        self.seed += 1
        if self.seed != self._drawn_seed:
            self._draw(self.seed)
        self._contact: Contact | None = None
        self._diverged = False
        self._movers = MoverPlaces(self.world.movers, self.spec.physics_period)
        self._step = 0
        self._commanded = Twist2D(0.0, 0.0)
        start, handles = self.scenario.start, self._handles
        handles.place[:] = (
            start.x, start.y, 0.0, cos(start.yaw / 2), 0.0, 0.0, sin(start.yaw / 2)
        )  # fmt: skip
        handles.mocap[:, :2] = self._movers.rows(0, 1)[0].take(handles.mover_of, axis=0)
        self._pose = self._scan = None

    # One decision period -------------------------------------------------------------------

    def before_step(
        self, physics: mjcf.Physics, action: FloatArray, random_state: np.random.RandomState
    ) -> None:
        """Turns the next position into wheel speeds inside the acceleration limits."""
        del physics, random_state
        self.aim(float(action[0]), float(action[1]))

    def aim(self, x: float, y: float) -> None:
        """Plans the wheel speeds of one decision period towards the next position (x, y).

        Raises:
            FuzzyNavError: the next position is not finite.
        """
        if not (isfinite(x) and isfinite(y)):
            raise FuzzyNavError(f"action: given ({x}, {y}); allowed is a finite next position, m")
        self.profile: SpeedProfile = drive_towards((x, y), self.pose, self._commanded, self.spec)
        self._commanded = self.profile.final

    def advance(self) -> BlockTruth:
        """Takes the physics steps of one decision period, or fewer where contact ends them.

        Obstacles move and contact is checked on every step, as `take_steps` says.
        """
        spec, handles = self.spec, self._handles
        movers = self._movers.rows(self._step + 1, spec.substeps)
        poses, rates, slip = take_steps(
            *self._natives,
            handles.ctrl,
            wheel_table(self.profile, spec),
            handles.wheel_of,
            handles.mocap,
            movers,
            handles.mover_of,
            handles.hit,
            handles.place,
            handles.speed,
            handles.twist_at.start,
            handles.wheel_dofs,
            spec.track,
            spec.wheel_radius,
            spec.axle_offset,
        )
        taken = len(poses)
        self._step += taken
        if handles.hit.item() > 0.0:
            self._contact = self._read_contact()
        # Warnings tell of numbers that are too large, not only of those that are not finite.
        self._diverged = any(handles.warnings.tolist())
        self._pose = self._scan = None
        return BlockTruth(poses, movers[:taken], rates, slip)

    def _read_contact(self) -> Contact:
        data, hull = self._data, self._handles.hull
        velocity = self._handles.speed[self._handles.twist_at]
        speed = hypot(float(velocity[0]), float(velocity[1]))
        for first, second in data.contact.geom.tolist():
            if hull in (first, second):
                other = second if first == hull else first
                name = self._model.geom(other).name.rsplit("/", 1)[-1]
                kind, number, *_ = name.split("_")
                label = "wall" if kind == "wall" else f"{kind}:{number}"
                return Contact(float(data.time), label, speed, speed > AT_FAULT_SPEED)
        raise RuntimeError("the contact sensor fired without a contact of the hull")

    @property
    def physics(self) -> tuple[mujoco.MjModel, mujoco.MjData]:
        """What is simulated: the compiled model and its state."""
        return self._model, self._data

    # What is seen, and how it ends ---------------------------------------------------------

    @property
    def pose(self) -> Pose2D:
        """Present pose of the footprint's centre."""
        if self._pose is None:
            x, y, _, w, _, _, z = self._handles.place.tolist()
            yaw = 2.0 * atan2(z, w)
            self._pose = Pose2D(x, y, (yaw + pi) % (2 * pi) - pi)
        return self._pose

    @property
    def twist(self) -> Twist2D:
        """Present forward speed and yaw rate."""
        velocity = self._handles.speed[self._handles.twist_at].tolist()
        yaw = self.pose.yaw
        return Twist2D(velocity[0] * cos(yaw) + velocity[1] * sin(yaw), velocity[5])

    @property
    def scan(self) -> LaserScan:
        """The scan of the present state; the rays are cast once per decision."""
        if self._scan is None:
            self._scan = self._lidar.scan(self._data)
        return self._scan

    @property
    def mover_positions(self) -> FloatArray:
        """(movers, 2) present origins of the moving obstacles."""
        positions: FloatArray = self._movers.rows(self._step, 1)[0].copy()
        return positions

    @property
    def contact(self) -> Contact | None:
        """The contact that ended the episode, if one did."""
        return self._contact

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return float(self._data.time)

    @property
    def commanded(self) -> Twist2D:
        """Speeds commanded at the end of the last period."""
        return self._commanded

    @property
    def wheel_command(self) -> WheelSpeeds:
        """The wheel speeds commanded at the end of the last period."""
        return wheel_speeds(self._commanded.v, self._commanded.omega, self.spec)

    def at_goal(self) -> bool:
        """True within the goal's tolerance, and turned to the goal's yaw if it has one."""
        pose, scenario = self.pose, self.scenario
        x, y = scenario.goal
        if hypot(pose.x - x, pose.y - y) > scenario.goal_tolerance:
            return False
        if scenario.goal_yaw is None:
            return True
        return abs(float(wrap_angle(pose.yaw - scenario.goal_yaw))) <= GOAL_YAW_TOLERANCE

    @property
    def outcome(self) -> Outcome | None:
        """How the episode ended; None while it goes on."""
        if self._diverged:
            return Outcome.DIVERGED
        if self._contact is not None:
            return Outcome.CONTACT
        if self.at_goal():
            return Outcome.GOAL_REACHED
        if self._data.time >= self.scenario.time_limit - self.spec.physics_period / 2:
            return Outcome.TIMEOUT
        return None

    def should_terminate_episode(self, physics: mjcf.Physics) -> bool:
        """True once the episode has an outcome."""
        del physics
        return self.outcome is not None

    def get_reward(self, physics: mjcf.Physics) -> float:
        """1 on reaching the goal, -1 on contact, else 0."""
        del physics
        outcome = self.outcome
        return float(outcome is Outcome.GOAL_REACHED) - float(outcome is Outcome.CONTACT)

    def get_discount(self, physics: mjcf.Physics) -> float:
        """0 after goal or contact; 1 otherwise, also when the time is up."""
        del physics
        return 0.0 if self.outcome in (Outcome.GOAL_REACHED, Outcome.CONTACT) else 1.0

    def _pose_vector(self) -> FloatArray:
        pose = self.pose
        return np.array([pose.x, pose.y, pose.yaw])

    def _twist_vector(self) -> FloatArray:
        twist = self.twist
        return np.array([twist.v, twist.omega])
