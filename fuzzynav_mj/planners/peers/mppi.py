"""Model predictive path integral control, on the scan and the perceived velocities.

G. Williams, N. Wagener, B. Goldfain, P. Drews, J. M. Rehg, B. Boots, E. A. Theodorou, "Information
Theoretic MPC for Model-Based Reinforcement Learning", ICRA 2017, with the robot's own kinematics
for the model. The controls are the speeds aimed at, one pair for each decision period.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import hypot
from typing import ClassVar

import numpy as np

from fuzzynav_mj.planners.base import NavigationProblem, Observation, Requirements
from fuzzynav_mj.planners.clearance import moving_clearance, static_clearance
from fuzzynav_mj.planners.peers.arrival import point_to_reach, turn_on_goal
from fuzzynav_mj.planners.peers.rollout import roll_out, to_robot_frame, within_limits
from fuzzynav_mj.planners.sight import thin
from fuzzynav_mj.planners.steering import position_after
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import Behaviour, Decision, FloatArray, Perception, Pose2D, Twist2D

MOVER_SPACING = 0.10  # hits of movers are thinned out to this, per metre of distance
STANDING = 0.02  # m/s


@dataclass(frozen=True, slots=True)
class MppiSettings:
    """Samples, costs and their weights. Costs are in m, summed over the periods.

    Attributes:
        samples: control sequences drawn for each decision.
        periods: their length.
        sigma_v: standard deviation of the noise of the speed aimed at, m/s.
        sigma_omega: of the yaw rate aimed at, rad/s.
        keeping: correlation of the noise of one period with that of the next.
        temperature: lambda; cost by which a sequence may be worse and still count.
        goal: weight of the distance to the goal at each period ...
        goal_at_end: ... and at the last one.
        static_gap: gap to what stands below which a place costs, m ...
        static_weight: ... for each metre missing.
        moving_gap: the same for movers, now ...
        moving_gap_growth: ... and per second of prediction, m/s.
        moving_weight: for each metre missing of it.
        contact_gap: a smaller gap counts as contact ...
        contact: ... and costs this much for each period.
        reverse: what each metre driven backwards costs.
        effort: gamma; weight of the plan times what is added to it, both over sigma.
    """

    samples: int = 500
    periods: int = 36
    sigma_v: float = 0.15
    sigma_omega: float = 1.0
    keeping: float = 0.7
    temperature: float = 0.1
    goal: float = 0.5
    goal_at_end: float = 5.0
    static_gap: float = 0.05
    static_weight: float = 5.0
    moving_gap: float = 0.15
    moving_gap_growth: float = 0.10
    moving_weight: float = 5.0
    contact_gap: float = 0.015
    contact: float = 10.0
    reverse: float = 0.5
    effort: float = 0.0005


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What the samples are held against, robot frame, m.

    Attributes:
        target: (2,) where to go.
        standing: (k, 2) hits of what stands.
        moving: (T, 2, j) where the hits of movers will be after each period.
    """

    target: FloatArray
    standing: FloatArray
    moving: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Costs:
    """(m,) cost of each sample, and what of it is due to the way left to go, to being close to
    movers and to what stands, and to touching either."""

    total: FloatArray
    progress: FloatArray
    moving: FloatArray
    static: FloatArray
    contact: FloatArray


class MppiPlanner:
    """Williams et al.'s method, towards the goal."""

    requires: ClassVar[Requirements] = Requirements(scan=True, obstacles=True)

    def __init__(self, settings: MppiSettings | None = None) -> None:
        self._settings = settings or MppiSettings()

    @property
    def plan(self) -> FloatArray:
        """(T, 2, 1) the speeds aimed at from the last decision on."""
        return self._plan

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode. All noise comes from `rng`."""
        self._problem = problem
        self._rng = rng
        self._plan = np.zeros((self._settings.periods, 2, 1))

    def decide(self, observation: Observation) -> Decision:
        """The next position, and why."""
        turn = turn_on_goal(self._problem, observation)
        if turn is not None:
            return turn
        pose, twist, perception = observation.pose, observation.twist, observation.perception
        assert perception is not None
        spec, settings = self._problem.spec, self._settings
        goal = point_to_reach(self._problem, pose)
        target = to_robot_frame(np.array([goal]), pose)[0]
        around = scene(target, perception, pose, settings.periods, spec)
        plan = np.concatenate((self._plan[1:], self._plan[-1:]))
        controls = sample(plan, twist, self._rng, spec, settings)
        costs = evaluate(controls, plan, around, twist, spec, settings)
        share = weights(costs.total, settings.temperature)
        self._plan = (controls * share).sum(axis=2, keepdims=True)
        v, omega = within_limits(self._plan, twist, spec)[0, :, 0].tolist()
        best = int(costs.total.argmin())
        return Decision(
            position_after(v, omega, pose, twist, spec),
            _behaviour(costs, best, v, omega),
            subgoal=goal,
            note=f"{1.0 / float((share**2).sum()):.0f} of {settings.samples} samples count",
        )


def sample(
    plan: FloatArray,
    twist: Twist2D,
    rng: np.random.Generator,
    spec: RobotSpec,
    settings: MppiSettings,
) -> FloatArray:
    """(T, 2, m) control sequences within the robot's limits around a plan (T, 2, 1): the first one
    is the plan itself, the last one brakes, the others are the plan and noise."""
    sigma = np.array([[settings.sigma_v], [settings.sigma_omega]])
    noise = sigma * rng.standard_normal((*plan.shape[:2], settings.samples))
    fresh = (1.0 - settings.keeping**2) ** 0.5
    for before, now in pairwise(noise):
        now *= fresh
        now += settings.keeping * before
    aims = plan + noise
    aims[:, :, 0] = plan[:, :, 0]
    aims[:, :, -1] = 0.0
    return within_limits(aims, twist, spec)


def scene(
    target: FloatArray, perception: Perception, pose: Pose2D, periods: int, spec: RobotSpec
) -> Scene:
    """What is around the robot at `pose`; movers go on as they go now."""
    ahead = Pose2D(0.0, 0.0, pose.yaw)
    times = np.arange(1, periods + 1)[:, None, None] * spec.decision_period
    standing, moving = [np.empty((0, 2))], [np.empty((periods, 2, 0))]
    for obstacle in perception.obstacles:
        points = to_robot_frame(obstacle.points, pose)
        if obstacle.dynamic:
            velocity = to_robot_frame(obstacle.velocity[None], ahead).T
            moving.append(thin(points, MOVER_SPACING).T + times * velocity)
        else:
            standing.append(thin(points))
    return Scene(target, np.concatenate(standing), np.concatenate(moving, axis=2))


def evaluate(
    controls: FloatArray,
    plan: FloatArray,
    around: Scene,
    twist: Twist2D,
    spec: RobotSpec,
    settings: MppiSettings,
) -> Costs:
    """What control sequences (T, 2, m), within the limits and around a plan (T, 2, 1), cost."""
    poses = roll_out(controls, twist, spec)
    x, y, _ = poses.T
    left_over = np.sqrt((x - around.target[0]) ** 2 + (y - around.target[1]) ** 2)
    times = np.arange(1, len(controls) + 1)[:, None] * spec.decision_period
    berth = settings.moving_gap + settings.moving_gap_growth * times
    standing = static_clearance(poses, around.standing, spec.half_side).T
    moving = moving_clearance(poses, around.moving, spec.half_side).T
    static_cost = settings.static_weight * np.maximum(settings.static_gap - standing, 0.0)
    moving_cost = settings.moving_weight * np.maximum(berth - moving, 0.0)
    touches = np.minimum(standing, moving) < settings.contact_gap
    progress = settings.goal * left_over.mean(axis=0) + settings.goal_at_end * left_over[-1]
    backwards = np.maximum(-controls[:, 0], 0.0).sum(axis=0) * spec.decision_period
    contact = settings.contact * touches.sum(axis=0)
    variance = np.array([[settings.sigma_v], [settings.sigma_omega]]) ** 2
    effort = settings.effort * (plan / variance * (controls - plan)).sum(axis=(0, 1))
    static_sum, moving_sum = static_cost.sum(axis=0), moving_cost.sum(axis=0)
    total = progress + settings.reverse * backwards + effort + static_sum + moving_sum + contact
    parts = (total, progress, moving_sum, static_sum, contact)
    return Costs(*(part.astype(np.float64) for part in parts))


def weights(costs: FloatArray, temperature: float) -> FloatArray:
    """(m,) shares of samples of costs (m,) in the next plan; their sum is one."""
    share: FloatArray = np.exp((costs.min() - costs) / temperature)
    share /= share.sum()
    return share


def _behaviour(costs: Costs, best: int, v: float, omega: float) -> Behaviour:
    """The name of what the robot does, for the record."""
    if costs.contact[best] > 0.0:
        return Behaviour.EVASION
    if hypot(v, omega) < STANDING:
        return Behaviour.WAITING
    unhindered = int(costs.progress.argmin())
    if costs.moving[unhindered] > 0.0:
        return Behaviour.DYNAMIC_AVOIDANCE
    blocked = costs.static[unhindered] > 0.0 or costs.contact[unhindered] > 0.0
    return Behaviour.STATIC_AVOIDANCE if blocked else Behaviour.GOAL_SEEKING
