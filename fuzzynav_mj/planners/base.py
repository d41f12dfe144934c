"""What a planner is, what it may ask for, and what it is given."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import Decision, FloatArray, LaserScan, Perception, Pose2D, Twist2D


@dataclass(frozen=True, slots=True)
class Requirements:
    """What a planner is given besides its own pose, its twist and the goal; the rest is withheld.

    Attributes:
        scan: the range readings.
        obstacles: the obstacles perceived in them, with their velocities; includes the scan.
        static_map: the polygons of the static obstacles.
    """

    scan: bool = True
    obstacles: bool = True
    static_map: bool = False


def given_to(needs: Requirements) -> tuple[str, ...]:
    """What a planner is given, for a reader."""
    given = ["pose, twist and goal"]
    given += ["scan"] if needs.scan or needs.obstacles else []
    given += ["perceived obstacles and their velocities"] if needs.obstacles else []
    given += ["map of the static obstacles"] if needs.static_map else []
    return tuple(given)


@dataclass(frozen=True, slots=True, eq=False)
class NavigationProblem:
    """What is known before the first step.

    Attributes:
        goal: (x, y) in the world frame, m.
        goal_yaw: heading to turn to on arrival, rad; None where any will do.
        goal_tolerance: m.
        spec: the robot's parameters.
        static_map: polygons (k, 2) of obstacles and walls; None unless the planner requires it.
    """

    goal: tuple[float, float]
    goal_yaw: float | None
    goal_tolerance: float
    spec: RobotSpec
    static_map: tuple[FloatArray, ...] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Observation:
    """What is known at one decision.

    Attributes:
        stamp: simulated time, s.
        pose: of the footprint's centre.
        twist: that the robot was told to have by now; its wheels follow closely.
        scan: None unless the planner requires the scan or the obstacles.
        perception: None unless the planner requires the obstacles.
    """

    stamp: float
    pose: Pose2D
    twist: Twist2D
    scan: LaserScan | None
    perception: Perception | None


class Planner(Protocol):
    """Chooses the next position, once per decision period."""

    @property
    def requires(self) -> Requirements:
        """What it is given. Declare it as an attribute of the class."""

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode."""

    def decide(self, observation: Observation) -> Decision:
        """The next position, and why."""
