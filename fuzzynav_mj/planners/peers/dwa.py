"""The dynamic window approach, on the scan alone.

D. Fox, W. Burgard, S. Thrun, "The Dynamic Window Approach to Collision Avoidance", IEEE Robotics
and Automation Magazine 4(1), 1997. Every hit of the scan stands; the robot is its square.
"""

from dataclasses import dataclass
from math import pi
from typing import ClassVar

import numpy as np
from scipy.ndimage import uniform_filter

from fuzzynav_mj.geometry import wrap_angle
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Requirements
from fuzzynav_mj.planners.clearance import static_clearance
from fuzzynav_mj.planners.peers.arrival import point_to_reach, turn_on_goal
from fuzzynav_mj.planners.peers.rollout import roll_out, to_robot_frame, to_world_frame
from fuzzynav_mj.planners.sight import thin
from fuzzynav_mj.planners.steering import position_after
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import (
    Behaviour,
    BoolArray,
    CandidateSet,
    Decision,
    FloatArray,
    LaserScan,
    Twist2D,
)

CELL_V = 0.05  # m/s: spacing of the velocities tried
CELL_OMEGA = 0.15  # rad/s
SAMPLES = 24  # footprints along a curvature
TOUCHING = 1e-3  # m


@dataclass(frozen=True, slots=True)
class DwaSettings:
    """Weights of the objective, Fox et al.'s Eq. (13), and what is kept clear.

    Attributes:
        heading: alpha.
        clearance: beta.
        velocity: gamma.
        margin: the footprint may come no closer than this to a hit, m, when creeping ...
        margin_growth: ... and per m/s of speed.
        look_ahead: way of the footprint's rim along a curvature that is checked, m.
        way_out: free way straight ahead at which a turn on the spot ends, m.
        turn_rate: of that turn, rad/s.
        back_up: speed at which the robot backs up where it cannot turn, m/s.
    """

    heading: float = 2.0
    clearance: float = 0.2
    velocity: float = 0.2
    margin: float = 0.02
    margin_growth: float = 0.1
    look_ahead: float = 0.8
    way_out: float = 0.3
    turn_rate: float = 1.0
    back_up: float = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Window:
    """The velocities that can be reached within one decision period.

    Attributes:
        v: (m,) forward speed, m/s; in blocks of one speed each ...
        omega: (m,) yaw rate, rad/s.
        shape: ... so that these and all that belongs to them form a grid of this shape.
    """

    v: FloatArray
    omega: FloatArray
    shape: tuple[int, int]


@dataclass(frozen=True, slots=True, eq=False)
class Prospects:
    """What becomes of each velocity of a window.

    Attributes:
        places: (m, 2) the footprint's centre after one period, robot frame, m.
        gap: (m,) smallest gap between footprint and hits along the curvature, m.
        distance: (m,) free way along the curvature after that period, m, at most `look_ahead`.
        admissible: (m,) True where the robot can stop on that way.
        objective: (m,) the weighted sum, smoothed; not admissible: -inf.
        unhindered: the velocity that would be chosen if there were no hits.
    """

    places: FloatArray
    gap: FloatArray
    distance: FloatArray
    admissible: BoolArray
    objective: FloatArray
    unhindered: int


class DynamicWindowPlanner:
    """Fox, Burgard and Thrun's method, towards the goal."""

    requires: ClassVar[Requirements] = Requirements(scan=True, obstacles=False)

    def __init__(self, settings: DwaSettings | None = None) -> None:
        self._settings = settings or DwaSettings()

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode. The planner draws nothing at random."""
        del rng
        self._problem = problem
        self._turning = 0.0  # side to which the robot turns out of a dead end; 0: it does not

    def decide(self, observation: Observation) -> Decision:
        """The next position, and why."""
        turn = turn_on_goal(self._problem, observation)
        if turn is not None:
            return turn
        scan, pose, twist = observation.scan, observation.pose, observation.twist
        assert scan is not None
        spec, settings = self._problem.spec, self._settings
        goal = point_to_reach(self._problem, pose)
        target = to_robot_frame(np.array([goal]), pose)[0]
        window = dynamic_window(twist, spec, settings.back_up if self._turning else 0.0)
        prospects = look_along(window, hits(scan), target, twist, spec, settings)
        chosen = int(prospects.objective.argmax())
        v, omega = float(window.v[chosen]), float(window.omega[chosen])
        behaviour, note = Behaviour.GOAL_SEEKING, ""
        if self._must_turn(window, prospects, chosen):
            v, omega, note = self._turn(window, prospects)
            behaviour = Behaviour.EVASION if self._turning else Behaviour.WAITING
        elif prospects.distance[prospects.unhindered] < settings.look_ahead:
            behaviour = Behaviour.STATIC_AVOIDANCE
        return Decision(
            next_position=position_after(v, omega, pose, twist, spec),
            behaviour=behaviour,
            candidates=CandidateSet(
                positions=to_world_frame(prospects.places, pose),
                admissible=prospects.admissible,
                clearance=prospects.gap,
                cost=-prospects.objective,
                risk=np.full(len(window.v), np.nan),
            ),
            subgoal=goal,
            note=note,
        )

    def _must_turn(self, window: Window, prospects: Prospects, chosen: int) -> bool:
        """True where no admissible velocity leads on, or the best one is to stand still; once
        turning, until there is a way straight ahead."""
        onward = prospects.admissible & (window.v > 0.0)
        if self._turning:
            straight = onward & (np.abs(window.omega) < CELL_OMEGA)
            if (prospects.distance[straight] >= self._settings.way_out).any():
                self._turning = 0.0
            return self._turning != 0.0
        return not onward.any() or not (window.v[chosen] or window.omega[chosen])

    def _turn(self, window: Window, prospects: Prospects) -> tuple[float, float, str]:
        """Speeds for the turn on the spot, to the side where the curvatures are freer; where the
        square has no room to turn, for backing up."""
        v, omega, admissible = window.v, window.omega, prospects.admissible
        if not self._turning:
            room = [float(prospects.distance[side * omega > 0].sum()) for side in (1, -1)]
            self._turning = 1.0 if room[0] >= room[1] else -1.0
        slowest = float(v[np.abs(v).argmin()])
        wish = self._turning * self._settings.turn_rate
        ways = (
            ("no way on: turning on the spot", (v == slowest) & (self._turning * omega > 0), wish),
            ("no way on and no room to turn: backing up", v < 0.0, 0.0),
        )
        for note, fitting, rate in ways:
            allowed = np.flatnonzero(fitting & admissible)
            if len(allowed):
                best = allowed[np.lexsort((v[allowed], np.abs(omega[allowed] - rate)))[0]]
                return float(v[best]), float(omega[best]), note
        return 0.0, 0.0, "no admissible velocity: stopping"


def hits(scan: LaserScan) -> FloatArray:
    """(k, 2) thinned hits of the scan, robot frame, m."""
    reach, bearing = scan.ranges[scan.hit], scan.bearings[scan.hit]
    return thin(np.stack((reach * np.cos(bearing), reach * np.sin(bearing)), axis=1))


def dynamic_window(twist: Twist2D, spec: RobotSpec, back_up: float = 0.0) -> Window:
    """The velocities within reach: multiples of the cells, backwards up to the speed `back_up`."""
    period = spec.decision_period
    speeds = _within(twist.v, spec.max_acceleration * period, CELL_V, -back_up, spec.max_speed)
    top = spec.max_yaw_rate
    rates = _within(twist.omega, spec.max_yaw_acceleration * period, CELL_OMEGA, -top, top)
    return Window(
        np.repeat(speeds, len(rates)), np.tile(rates, len(speeds)), (len(speeds), len(rates))
    )


def _within(now: float, reach: float, cell: float, lowest: float, highest: float) -> FloatArray:
    first = np.ceil(max(now - reach, lowest) / cell - 1e-6)
    last = np.floor(min(now + reach, highest) / cell + 1e-6)
    if last < first:  # driven beyond a limit, for instance backwards: the nearest that is allowed
        return np.array([min(max(now, lowest), highest)])
    multiples: FloatArray = np.arange(first, last + 1.0) * cell
    return multiples


def look_along(
    window: Window,
    points: FloatArray,
    target: FloatArray,
    twist: Twist2D,
    spec: RobotSpec,
    settings: DwaSettings,
) -> Prospects:
    """Looks along the curvature of every velocity of the window; the objective is Eq. (13).

    Args:
        window: the velocities.
        points: (k, 2) hits, robot frame.
        target: (2,) robot frame.
        twist: present speeds.
        spec: the robot's parameters.
        settings: weights and margins.
    """
    v, omega = window.v, window.omega
    first = roll_out(np.stack((v, omega))[None], twist, spec)[:, 0]
    # Standing still is the slow end of driving straight ahead, and sees as far.
    pace = np.where((v == 0.0) & (omega == 0.0), 1.0, v)
    rim = np.abs(pace) + np.abs(omega) * spec.half_diagonal
    times = settings.look_ahead / rim * (np.arange(SAMPLES)[:, None] / (SAMPLES - 1))
    poses = _along(first, pace, omega, times, spec)
    gaps = static_clearance(poses, points, spec.half_side).T.astype(np.float64)
    present = static_clearance(np.zeros((1, 1, 3), dtype=np.float32), points, spec.half_side)
    margin = settings.margin + settings.margin_growth * np.abs(v)
    met = gaps < np.minimum(margin, max(0.8 * float(present[0, 0]), TOUCHING))
    free = ~met.any(axis=0)
    until = np.take_along_axis(times, np.maximum(met.argmax(axis=0) - 1, 0)[None], 0)[0]
    until = np.where(met[0], 0.0, until)
    distance = np.where(free, settings.look_ahead, np.minimum(rim * until, settings.look_ahead))
    # v <= sqrt(2 distance acceleration) and the like for the yaw rate, Eq. (14) there.
    stops = np.abs(v) <= np.sqrt(2 * np.abs(v) * until * spec.max_acceleration) + 1e-9
    stops &= np.abs(omega) <= np.sqrt(2 * np.abs(omega) * until * spec.max_yaw_acceleration) + 1e-9
    admissible = free | (stops & ~met[0])
    wish = _heading_and_velocity(window, first, target, spec, settings)
    value = wish + settings.clearance * distance / settings.look_ahead
    smooth = uniform_filter(
        np.where(admissible, value, 0.0).reshape(window.shape), size=3, mode="nearest"
    )
    return Prospects(
        places=first[:, :2].astype(np.float64),
        gap=gaps.min(axis=0),
        distance=distance,
        admissible=admissible,
        objective=np.where(admissible, smooth.ravel(), -np.inf),
        unhindered=int(wish.argmax()),
    )


def _along(
    first: np.ndarray, v: FloatArray, omega: FloatArray, times: FloatArray, spec: RobotSpec
) -> np.ndarray:
    """(m, T, 3) float32 poses on the curvatures, `times` (T, m) after the poses `first` (m, 3)."""
    x, y, yaw = first.T.astype(np.float64)
    turned = omega * times
    chord = v * times * np.sinc(turned / (2 * pi))  # of the axle's arc
    after = yaw + turned
    poses = np.empty((3, *times.shape), dtype=np.float32)
    offset = spec.axle_offset
    poses[0] = x + chord * np.cos(yaw + turned / 2) + offset * (np.cos(after) - np.cos(yaw))
    poses[1] = y + chord * np.sin(yaw + turned / 2) + offset * (np.sin(after) - np.sin(yaw))
    poses[2] = after
    return poses.T


def _heading_and_velocity(
    window: Window, first: np.ndarray, target: FloatArray, spec: RobotSpec, settings: DwaSettings
) -> FloatArray:
    """(m,) heading and velocity, each from 0 to 1 and weighted."""
    x, y, yaw = first.T.astype(np.float64)
    # The heading counts where the robot has stopped turning as fast as it can.
    yaw = yaw + window.omega * np.abs(window.omega) / (2 * spec.max_yaw_acceleration)
    off = np.abs(wrap_angle(np.arctan2(target[1] - y, target[0] - x) - yaw))
    wish: FloatArray = (
        settings.heading * (1.0 - off / pi) + settings.velocity * window.v / spec.max_speed
    )
    return wish
