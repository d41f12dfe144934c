"""The multilayer decision of the paper's section 3, with or without the fuzzy gate of section 4.

Layers, in order: guidance names a subgoal; candidates (directions times steps) are rolled out and
held against the scan and against the predicted motion of what moves; the three priorities choose;
the gate judges the chosen next position and may have the alternative of lowest risk taken instead.
"""

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin
from typing import ClassVar

import numpy as np

from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Requirements
from fuzzynav_mj.planners.clearance import moving_clearance, static_clearance
from fuzzynav_mj.planners.guidance import Guidance, Heading
from fuzzynav_mj.planners.motions import HORIZON, Motions, candidate_motions
from fuzzynav_mj.planners.prediction import displacements
from fuzzynav_mj.planners.sectors import as_fuzzy_inputs, sector_distances
from fuzzynav_mj.planners.sight import Sight, thin
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import (
    Behaviour,
    BoolArray,
    CandidateSet,
    Decision,
    FloatArray,
    Perception,
    Pose2D,
)


MOVER_SPACING = 0.10  # as `sight.SPACING`, for movers: their margins are wider


@dataclass(frozen=True, slots=True)
class DecisionSettings:
    """Margins (m) and weights of the decision.

    Attributes:
        static_margin: smallest gap kept to what stands, when creeping ...
        static_margin_growth: ... and per m/s of speed.
        moving_margin: smallest gap kept to what moves, now ...
        moving_margin_growth: ... and per second of prediction.
        contact_gap: a smaller predicted gap counts as contact.
        static_recovery: gap to regain per metre travelled where there is less than the margin.
        comfortable_gap: gap to standing obstacles below which a candidate costs more.
        static_weight: cost per metre missing of it.
        moving_gap: gap to movers below which a candidate costs more, now ...
        moving_gap_growth: ... and per second of prediction, which grows ever less certain ...
        moving_gap_time: ... up to this time, s.
        moving_weight: cost per metre missing of it, at the worst moment.
        reverse_cost: what driving backwards costs.
        change_cost: cost per radian of a new direction of travel.
        progress_steps: decision periods after which the progress counts.
        stuck_time: s without leaving a circle of `stuck_radius` m.
    """

    static_margin: float = 0.015
    static_margin_growth: float = 0.05
    moving_margin: float = 0.06
    moving_margin_growth: float = 0.03
    contact_gap: float = 0.01
    static_recovery: float = 0.15
    comfortable_gap: float = 0.10
    static_weight: float = 1.5
    moving_gap: float = 0.10
    moving_gap_growth: float = 0.10
    moving_gap_time: float = 1.0
    moving_weight: float = 1.0
    reverse_cost: float = 0.10
    change_cost: float = 0.02
    progress_steps: int = 8
    stuck_time: float = 45.0
    stuck_radius: float = 0.3


class MultilayerPlanner:
    """The paper's planner. `gate=None` leaves the fuzzy gate out."""

    requires: ClassVar[Requirements] = Requirements(perception=True)

    def __init__(
        self, gate: RiskGate | None = None, settings: DecisionSettings | None = None
    ) -> None:
        self._gate = gate
        self._settings = settings or DecisionSettings()

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode. The planner draws nothing at random."""
        del rng
        self._problem = problem
        self._spec = problem.spec
        self._guidance = Guidance(problem.goal, problem.goal_tolerance)
        self._travel: float | None = None
        self._anchor: tuple[float, float, float] | None = None

    def decide(self, observation: Observation) -> Decision:
        """The next position, and why."""
        pose, perception = observation.pose, observation.perception
        assert perception is not None
        place = (pose.x, pose.y)
        surroundings = _surroundings(perception, pose, self._spec)
        heading = self._guidance.head(place, surroundings.sight)
        target = self._target(heading, pose)
        bearing = atan2(target[1], target[0]) - pose.yaw
        motions = candidate_motions(bearing, observation.twist, self._spec)
        outlook = self._outlook(motions, surroundings, pose)
        goal_ahead = _to_robot(np.array([target]), pose)[0]
        cost = self._cost(motions, outlook, goal_ahead, pose)
        chosen = self._choose(cost, outlook)
        candidates, risks = self._candidates(motions, outlook, cost, pose), None
        vetoed = False
        if self._gate is not None:
            travel = self._travel_of(motions, pose)
            chosen, risks, rows, vetoed = self._judge(
                chosen, candidates, travel, perception, cost, outlook
            )
            candidates = CandidateSet(
                candidates.positions,
                candidates.admissible,
                candidates.clearance,
                candidates.cost,
                risks,
            )
        position = candidates.positions[chosen]
        self._travel = float(motions.direction[chosen]) + pose.yaw
        behaviour = self._behaviour(chosen, motions, outlook, cost, heading, perception)
        return Decision(
            next_position=(float(position[0]), float(position[1])),
            behaviour=behaviour,
            inputs=as_fuzzy_inputs(rows) if self._gate is not None else None,
            risk=float(risks[chosen]) if risks is not None else float("nan"),
            vetoed=vetoed,
            candidates=candidates,
            subgoal=(pose.x + target[0], pose.y + target[1]),
            give_up=self._give_up(observation, heading),
        )

    def _target(self, heading: Heading, pose: Pose2D) -> tuple[float, float]:
        return (heading.subgoal[0] - pose.x, heading.subgoal[1] - pose.y)

    def _outlook(self, motions: Motions, around: "_Surroundings", pose: Pose2D) -> "_Outlook":
        """Rolls the candidates on against what stands and what moves."""
        settings, spec = self._settings, self._spec
        standing = _to_robot(around.sight.points, pose)
        here = np.zeros((1, 1, 3), dtype=np.float32)
        gap_now = float(static_clearance(here, standing, spec.half_side)[0, 0])
        margin = settings.static_margin + settings.static_margin_growth * np.abs(motions.speed)
        # Closer than that already: any speed will do that makes room at once.
        times = _times(spec)
        regained = gap_now - 0.002 + settings.static_recovery * np.abs(motions.speed)[:, None] * times
        margin = np.minimum(margin[:, None], regained)
        static = static_clearance(motions.poses, standing, spec.half_side)
        # Drive on until just before what stands, then stop there.
        touching = static < margin
        first = np.where(touching.any(axis=1), touching.argmax(axis=1), HORIZON)
        last = first - 1 - motions.brake_steps
        stops = np.where(first == HORIZON, HORIZON - 1, np.maximum(last, 0))
        steps = np.minimum(np.arange(HORIZON)[None], stops[:, None])
        rows = np.arange(len(stops))[:, None]
        poses = motions.poses[rows, steps]
        static_ok = (last >= 0) | (first == HORIZON)
        c, s = cos(pose.yaw), sin(pose.yaw)
        to_robot = np.array([[c, s], [-s, c]])
        moving = moving_clearance(poses, to_robot @ around.moving, spec.half_side)
        berth = settings.moving_gap + settings.moving_gap_growth * np.minimum(
            times, settings.moving_gap_time
        )
        wanted = settings.moving_margin + settings.moving_margin_growth * times
        close = moving < wanted
        hit = moving < settings.contact_gap
        contact = np.where(hit.any(axis=1), hit.argmax(axis=1), HORIZON)
        return _Outlook(
            poses=poses,
            static=static[rows, steps].min(axis=1),
            moving=moving.min(axis=1),
            crowding=np.maximum(berth - moving, 0.0).max(axis=1),
            static_ok=static_ok,
            contact_step=contact,
            soon=static[:, :4].min(axis=1),
            admissible=static_ok & ~close.any(axis=1),
        )

    def _cost(
        self, motions: Motions, outlook: "_Outlook", target: FloatArray, pose: Pose2D
    ) -> FloatArray:
        """(m,) the priorities as one cost, m: progress first, then room, then keeping on."""
        settings = self._settings
        offset = outlook.poses[:, : settings.progress_steps, :2] - target
        left_over = np.sqrt((offset**2).sum(axis=2)).min(axis=1)
        tight = np.maximum(settings.comfortable_gap - outlook.static, 0.0)
        near = outlook.crowding
        cost = left_over + settings.static_weight * tight + settings.moving_weight * near
        cost = cost + settings.reverse_cost * (motions.speed < 0)
        if self._travel is not None:
            turn = np.abs((motions.direction + pose.yaw - self._travel + pi) % (2 * pi) - pi)
            cost = cost + settings.change_cost * turn
        return cost.astype(np.float64)

    def _choose(self, cost: FloatArray, outlook: "_Outlook") -> int:
        """The cheapest admissible candidate; none: the one that stays clear the longest."""
        if outlook.admissible.any():
            return int(np.where(outlook.admissible, cost, np.inf).argmin())
        if outlook.static_ok.any():
            room = np.minimum(outlook.static, outlook.moving)
            order = np.lexsort((cost, -room.round(2), -outlook.contact_step))
            return int(order[outlook.static_ok[order]][0])
        return int(outlook.soon.argmax())

    def _judge(
        self,
        chosen: int,
        candidates: CandidateSet,
        travel: FloatArray,
        perception: Perception,
        cost: FloatArray,
        outlook: "_Outlook",
    ) -> tuple[int, FloatArray, FloatArray, bool]:
        """Applies the gate: the choice, all risks known, its inputs, and whether it changed."""
        assert self._gate is not None
        period, reach = self._spec.decision_period, self._spec.sensor_range
        pick = np.array([chosen])
        inputs = sector_distances(
            candidates.positions[pick], travel[pick], perception.obstacles, period, reach
        )
        risks = np.full(len(cost), np.nan)
        risks[chosen] = self._gate.risk(as_fuzzy_inputs(inputs[0]))
        if self._gate.accepts(float(risks[chosen])) or not outlook.admissible.any():
            return chosen, risks, inputs[0], False
        pool = np.flatnonzero(outlook.admissible)
        if not any(obstacle.dynamic for obstacle in perception.obstacles):
            # Nothing moves: the gate may slow the robot, but a way back out is no alternative.
            stop_cost = cost[-1]
            onward = pool[cost[pool] <= (cost[chosen] + stop_cost) / 2]
            pool = onward if len(onward) else pool
        alternatives = sector_distances(
            candidates.positions[pool], travel[pool], perception.obstacles, period, reach
        )
        risks[pool] = self._gate.risks(alternatives)
        worth = np.where(np.isnan(risks[pool]), np.inf, risks[pool])
        best = int(np.lexsort((cost[pool], worth.round(1)))[0])
        return int(pool[best]), risks, alternatives[best], int(pool[best]) != chosen

    def _travel_of(self, motions: Motions, pose: Pose2D) -> FloatArray:
        """(m,) direction in which each candidate moves, world frame."""
        return motions.direction + pose.yaw

    def _candidates(
        self, motions: Motions, outlook: "_Outlook", cost: FloatArray, pose: Pose2D
    ) -> CandidateSet:
        first = motions.poses[:, 0, :2].astype(np.float64)
        c, s = cos(pose.yaw), sin(pose.yaw)
        positions = np.stack(
            (
                pose.x + c * first[:, 0] - s * first[:, 1],
                pose.y + s * first[:, 0] + c * first[:, 1],
            ),
            axis=1,
        )
        return CandidateSet(
            positions=positions,
            admissible=outlook.admissible,
            clearance=np.minimum(outlook.static, outlook.moving).astype(np.float64),
            cost=np.where(outlook.admissible, cost, np.inf),
            risk=np.full(len(cost), np.nan),
        )

    def _behaviour(
        self,
        chosen: int,
        motions: Motions,
        outlook: "_Outlook",
        cost: FloatArray,
        heading: Heading,
        perception: Perception,
    ) -> Behaviour:
        if not outlook.admissible[chosen]:
            return Behaviour.EVASION
        if motions.speed[chosen] == 0.0:
            return Behaviour.WAITING
        unhindered = int(np.where(outlook.static_ok, cost, np.inf).argmin())
        if not outlook.admissible[unhindered]:
            approaching = any(o.approaching for o in perception.obstacles)
            return Behaviour.DYNAMIC_AVOIDANCE if approaching else Behaviour.MOVING_AWAY
        if heading.mode == "boundary":
            return Behaviour.BOUNDARY_FOLLOWING
        return Behaviour.GOAL_SEEKING if heading.direct else Behaviour.STATIC_AVOIDANCE

    def _give_up(self, observation: Observation, heading: Heading) -> "str | None":
        if heading.closed_loops >= 2:
            return "no_path"
        x, y = observation.pose.x, observation.pose.y
        anchor = self._anchor
        if anchor is None or hypot(x - anchor[0], y - anchor[1]) > self._settings.stuck_radius:
            self._anchor = (x, y, observation.stamp)
        elif observation.stamp - anchor[2] > self._settings.stuck_time:
            return "stuck"
        return None


@dataclass(frozen=True, slots=True, eq=False)
class _Surroundings:
    """What stands, and where what moves will be: (T, 2, k) points at the end of each period to
    come; robot-centred, axes parallel to the world's."""

    sight: Sight
    moving: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Outlook:
    """What becomes of each candidate: see `MultilayerPlanner._outlook`."""

    poses: np.ndarray
    static: FloatArray
    moving: FloatArray
    crowding: FloatArray
    static_ok: BoolArray
    contact_step: FloatArray
    soon: FloatArray
    admissible: BoolArray


def _surroundings(perception: Perception, pose: Pose2D, spec: RobotSpec) -> _Surroundings:
    here = np.array([pose.x, pose.y])
    standing = [o.points for o in perception.obstacles if not o.dynamic]
    movers = [o for o in perception.obstacles if o.dynamic]
    points = thin(np.concatenate(standing) - here) if standing else np.empty((0, 2))
    scan, times = perception.scan, _times(spec)
    ranges, bearings = scan.ranges, scan.bearings + pose.yaw
    if movers:
        ranges = _seen_through(ranges, bearings, movers, here, scan.max_range)
    places = [
        thin(mover.points - here, MOVER_SPACING).T[None] + way[:, :, None]
        for mover in movers
        for way in displacements(mover, here, times)
    ]
    moving = np.concatenate(places, axis=2) if places else np.empty((HORIZON, 2, 0))
    return _Surroundings(Sight(points, bearings, ranges, scan.max_range), moving)


def _times(spec: RobotSpec) -> FloatArray:
    """(HORIZON,) ends of the decision periods to come, s from now."""
    return (np.arange(HORIZON) + 1) * spec.decision_period


def _seen_through(ranges, bearings, movers, here, max_range):  # type: ignore[no-untyped-def]
    """Ranges with the rays that movers stop taken as free: movers go away."""
    ranges = ranges.copy()
    count = len(bearings)
    for mover in movers:
        offset = mover.points - here
        angle = np.arctan2(offset[:, 1], offset[:, 0]) - bearings[0]
        rays = np.rint(angle * (count / (2 * pi))).astype(int) % count
        ranges[rays] = max_range
    return ranges


def _to_robot(points: FloatArray, pose: Pose2D) -> FloatArray:
    """Robot-centred points (k, 2) turned into the robot frame."""
    return _rotate(points, pose)


def _rotate(vectors: FloatArray, pose: Pose2D) -> FloatArray:
    c, s = cos(pose.yaw), sin(pose.yaw)
    return np.stack(
        (c * vectors[:, 0] + s * vectors[:, 1], c * vectors[:, 1] - s * vectors[:, 0]), axis=1
    )
