"""Records that pass between the stages of the pipeline.

SI units and radians. World frame: right-handed, z up. Robot frame: origin at the footprint's
centre, x forward, y left. Arrays are float64 unless said otherwise and are never written to
after the record is made.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from math import nan
from typing import Literal

import numpy as np
import numpy.typing as npt

from fuzzynav_mj.disturbance import PERFECT, Disturbance

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Pose2D:
    """Pose of the footprint's centre in the world frame: m, m, rad."""

    x: float
    y: float
    yaw: float


@dataclass(frozen=True, slots=True)
class Twist2D:
    """Forward speed (m/s) and yaw rate (rad/s), in the robot frame."""

    v: float
    omega: float


@dataclass(frozen=True, slots=True)
class WheelSpeeds:
    """Angular speeds of the two driven wheels, rad/s, positive forwards."""

    left: float
    right: float


@dataclass(frozen=True, slots=True, eq=False)
class LaserScan:
    """One ring of range readings from the footprint's centre.

    Attributes:
        stamp: simulated time, s.
        bearings: (n,) ray directions in the robot frame, rad, increasing in [-pi, pi).
        ranges: (n,) distance of the first hit, m; exactly `max_range` where nothing was hit.
        hit: (n,) True where the ray hit something within range.
        max_range: the sensor's range, m.
    """

    stamp: float
    bearings: FloatArray
    ranges: FloatArray
    hit: BoolArray
    max_range: float


@dataclass(frozen=True, slots=True, eq=False)
class PerceivedObstacle:
    """One obstacle as two or more looks show it.

    Attributes:
        points: (k, 2) hit points in the world frame, in ray order.
        nearest_point: (2,) the hit nearest to the robot, world frame.
        distance: from the footprint's centre to `nearest_point`, m.
        bearing: of `nearest_point` in the robot frame, rad.
        dynamic: True if the looks show that it moves.
        approaching: True if it moves and its motion brings it closer to the robot's place.
        velocity: (2,) m/s in the world frame; zero for a static obstacle.
        turn_rate: rate at which the velocity turns, rad/s, counter-clockwise positive.
        closing_sigma: uncertainty (one sigma) of the speed towards the robot, m/s.
        drift_sigma: the same across the direction that it moves in, where the ranges are noisy.
        unsure: (2,) the direction in which least is known of the velocity, as long as its
            uncertainty (one sigma) there, m/s, where the ranges are noisy: a flat side does not
            show how it moves along itself.
    """

    points: FloatArray
    nearest_point: FloatArray
    distance: float
    bearing: float
    dynamic: bool
    approaching: bool
    velocity: FloatArray
    turn_rate: float = 0.0
    closing_sigma: float = 0.0
    drift_sigma: float = 0.0
    unsure: FloatArray = field(default_factory=lambda: np.zeros(2))


@dataclass(frozen=True, slots=True, eq=False)
class VisibilityMatrix:
    """Rings x bearings of the paper's section 3, with its counts per quarter, Eqs. (10), (11).

    Quarters are the paper's q1 (front right), q2 (front left), q3 (rear left), q4 (rear right).

    Attributes:
        occupied: (rings, n) True where the ring's point on that bearing lies in an obstacle.
        counts: (4,) intersection points per quarter in this look.
        previous_counts: (4,) the same for the previous look, its points seen from the present pose.
    """

    occupied: BoolArray
    counts: IntArray
    previous_counts: IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Perception:
    """What the planner knows of its surroundings after one look."""

    scan: LaserScan
    obstacles: tuple[PerceivedObstacle, ...]
    visibility: VisibilityMatrix

    @property
    def anything_moves(self) -> bool:
        """True if a moving obstacle is in sight."""
        return any(obstacle.dynamic for obstacle in self.obstacles)


@dataclass(frozen=True, slots=True)
class FuzzyInputs:
    """Distances (m, in [0, 1]; 1 = nothing in range) to the nearest left, front and right static
    and dynamic obstacle, Eqs. (18)-(23)."""

    LS: float
    FS: float
    RS: float
    LD: float
    FD: float
    RD: float


class Behaviour(StrEnum):
    """What the robot is doing; the names of the paper's section 3, and what it leaves open."""

    GOAL_SEEKING = "goal_seeking"
    STATIC_AVOIDANCE = "static_avoidance"
    DYNAMIC_AVOIDANCE = "dynamic_avoidance"
    MOVING_AWAY = "moving_away"
    BOUNDARY_FOLLOWING = "boundary_following"
    WAITING = "waiting"
    EVASION = "evasion"
    TURNING_ON_GOAL = "turning_on_goal"


@dataclass(frozen=True, slots=True, eq=False)
class CandidateSet:
    """The next positions that one decision weighed.

    Attributes:
        positions: (m, 2) next positions of the footprint's centre, world frame.
        admissible: (m,) True where the whole roll-out including the stop keeps clear.
        clearance: (m,) smallest predicted gap along the roll-out, m.
        cost: (m,) score of the priorities, smaller is better; inf where not admissible.
        risk: (m,) fuzzy risk 0..100; nan where it was not evaluated.
    """

    positions: FloatArray
    admissible: BoolArray
    clearance: FloatArray
    cost: FloatArray
    risk: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """One decision: the next position and why.

    Attributes:
        next_position: (x, y) of the footprint's centre one decision period later, world frame.
        behaviour: what the robot is doing.
        inputs: the fuzzy inputs at the accepted next position; None for planners without a gate.
        risk: risk of the accepted next position, 0..100; nan for planners without a gate.
        vetoed: True if the gate changed the next position.
        candidates: what was weighed; None for planners without candidates.
        subgoal: (x, y) the point in sight that the robot heads for, world frame.
        give_up: set when the planner has found that no way leads on.
        note: one short clause for the record's reader.
    """

    next_position: tuple[float, float]
    behaviour: Behaviour
    inputs: FuzzyInputs | None = None
    risk: float = float("nan")
    vetoed: bool = False
    candidates: CandidateSet | None = None
    subgoal: tuple[float, float] | None = None
    give_up: Literal["no_path", "stuck"] | None = None
    note: str = ""


class Outcome(StrEnum):
    """How an episode ended."""

    GOAL_REACHED = "goal_reached"
    CONTACT = "contact"
    TIMEOUT = "timeout"
    STUCK = "stuck"
    NO_PATH = "no_path"
    DIVERGED = "diverged"


@dataclass(frozen=True, slots=True)
class Contact:
    """A touch between the robot and anything but the floor."""

    time_s: float
    with_: str  # "wall", "static:3", "moving:1"
    robot_speed_mps: float
    at_fault: bool


@dataclass(frozen=True, slots=True, eq=False)
class StepRecord:
    """One decision period as it happened; truth that no planner saw is marked (truth).

    Attributes:
        time: simulated time of the decision, s.
        pose: of the footprint's centre (truth).
        twist: of the robot (truth).
        scan: as the planner was told; None for planners that declared none.
        perception: None for planners that declared no obstacles.
        decision: what the planner decided.
        mover_positions: (movers, 2) origins of the moving obstacles (truth).
        wheel_command: wheel speeds commanded at the end of the period.
        wheel_actual: wheel speeds at the end of the period (truth).
        clearance: gap between footprint and nearest obstacle at `time`, m (truth).
        plan_time: wall time of perception and decision together, s.
        estimate: where the planner believed the robot to be, which its perception and decision
            refer to; None where nothing is known of it.
    """

    time: float
    pose: Pose2D
    twist: Twist2D
    scan: LaserScan | None
    perception: Perception | None
    decision: Decision
    mover_positions: FloatArray
    wheel_command: WheelSpeeds
    wheel_actual: WheelSpeeds
    clearance: float
    plan_time: float
    estimate: Pose2D | None = None


@dataclass(frozen=True, slots=True)
class EpisodeRecord:
    """The contract's episode record; see its page for every field."""

    scenario: str
    planner: str
    seed: int
    outcome: Outcome
    sim_time_s: float
    path_length_m: float
    shortest_path_m: float
    optimality: float | None
    min_clearance_m: float
    contacts: tuple[Contact, ...]
    risk_max: float | None
    risk_mean: float | None
    gate_vetoes: int
    decisions: int
    plan_ms_p50: float
    plan_ms_p99: float
    wall_s: float
    physics_steps: int
    tracking_rms_m: float
    slip_max_mps: float
    versions: Mapping[str, str] = field(default_factory=dict)
    disturbance: Disturbance = PERFECT
    goal_distance_m: float = nan
