"""The task as the simulation that the episode runner knows."""

import mujoco
import numpy as np
from dm_control import mjcf

from fuzzynav_mj.episode import BlockTruth
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.world import World
from fuzzynav_mj.tasks.navigation import NavigateToGoal
from fuzzynav_mj.types import Contact, FloatArray, LaserScan, Outcome, Pose2D, Twist2D, WheelSpeeds


class EpisodeSimulation:
    """One episode of the task, without the environment around it.

    Args:
        scenario: what to drive through.
        seed: of everything random in the episode.
        friction: sliding friction coefficient between wheels and floor; None for the model's.
    """

    def __init__(self, scenario: Scenario, seed: int, friction: float | None = None) -> None:
        self._task = NavigateToGoal(scenario, seed, friction=friction)
        # What the environment does at its first reset, but with one compilation instead of two.
        self._physics = mjcf.Physics.from_mjcf_model(self._task.root_entity.mjcf_model)
        unused = np.random.RandomState(0)
        self._task.after_compile(self._physics, unused)
        with self._physics.reset_context():
            self._task.initialize_episode(self._physics, unused)

    @property
    def world(self) -> World:
        """The obstacles of this episode."""
        return self._task.world

    @property
    def spec(self) -> RobotSpec:
        """The robot's parameters."""
        return self._task.spec

    @property
    def seed(self) -> int:
        """The episode's seed."""
        return self._task.seed

    @property
    def physics(self) -> tuple[mujoco.MjModel, mujoco.MjData]:
        """What is simulated: the compiled model and its state."""
        return self._task.physics

    @property
    def planner_rng(self) -> np.random.Generator:
        """The planner's own random stream."""
        return self._task.streams.planner

    @property
    def sensor_rng(self) -> np.random.Generator:
        """The sensors' own random stream."""
        return self._task.streams.sensor

    @property
    def pose(self) -> Pose2D:
        """Present pose of the footprint's centre."""
        return self._task.pose

    @property
    def commanded(self) -> Twist2D:
        """Speeds commanded at the end of the last period."""
        return self._task.commanded

    @property
    def twist(self) -> Twist2D:
        """Present forward speed and yaw rate."""
        return self._task.twist

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self._task.time

    @property
    def scan(self) -> LaserScan:
        """The scan of the present state."""
        return self._task.scan

    @property
    def mover_positions(self) -> FloatArray:
        """(movers, 2) present origins of the moving obstacles."""
        return self._task.mover_positions

    @property
    def outcome(self) -> Outcome | None:
        """How the episode ended; None while it goes on."""
        return self._task.outcome

    @property
    def contact(self) -> Contact | None:
        """The contact that ended the episode, if one did."""
        return self._task.contact

    @property
    def wheel_command(self) -> WheelSpeeds:
        """The wheel speeds commanded last."""
        return self._task.wheel_command

    def drive(self, next_position: tuple[float, float]) -> BlockTruth:
        """Simulates one decision period towards the next position."""
        # What the environment's step adds is for agents: observations, rewards, resets.
        self._task.aim(*next_position)
        return self._task.advance()
