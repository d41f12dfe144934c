"""The multilayer decision of the paper's section 3, with or without the fuzzy gate of section 4.

Layers, in order: guidance names a subgoal; candidates (directions times steps) are rolled out and
held against the scan and against the predicted motion of what moves; the three priorities choose;
the gate judges the chosen next position and may have the alternative of lowest risk taken instead.
"""

from math import atan2, cos, sin
from typing import ClassVar, Literal

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.planners.arrival import Docking, docking
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Requirements
from fuzzynav_mj.planners.evasion import lasting
from fuzzynav_mj.planners.guidance import Guidance, Heading
from fuzzynav_mj.planners.lingering import Lingering
from fuzzynav_mj.planners.motions import Motions, candidate_motions, places_after
from fuzzynav_mj.planners.outlook import Outlook, look_ahead
from fuzzynav_mj.planners.passing import Passing, ways_past
from fuzzynav_mj.planners.priorities import (
    cheapest,
    costs_alone,
    costs_among_movers,
    secondary_costs,
)
from fuzzynav_mj.planners.scene import Scene, scene_around
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.planners.steering import position_after
from fuzzynav_mj.planners.surroundings import as_if_standing, surroundings
from fuzzynav_mj.planners.verdict import verdict_on
from fuzzynav_mj.types import (
    Behaviour,
    BoolArray,
    CandidateSet,
    Decision,
    FloatArray,
    Perception,
    Pose2D,
)

EVASION_BONUS = 0.3  # periods
SAME_EVASION = 0.8  # cosine of the largest angle between directions of one evasion
SAME_COURSE = 0.94  # cosine of an angle between directions of travel, and ...
SAME_SPEED = 0.15  # m/s: ... a difference in speed, that are not put down to movers
DRIVEN_OFF = 3.0  # s: for so long a mover that was in sight may have driven the robot off


class MultilayerPlanner:
    """The paper's planner. `gate=None` leaves the fuzzy gate out."""

    requires: ClassVar[Requirements] = Requirements(scan=True, obstacles=True)

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
        self._evading = False
        self._lingering = Lingering(self._settings)

    def decide(self, observation: Observation) -> Decision:
        """The next position, and why."""
        pose, perception = observation.pose, observation.perception
        assert perception is not None
        place, stamp, lingering = (pose.x, pose.y), observation.stamp, self._lingering
        around = surroundings(perception, pose, self._spec)
        movers = perception.anything_moves
        if movers:
            lingering.note_movers(perception, stamp)
        ahead = around
        if lingering.impatient(place, stamp):
            ahead = as_if_standing(around, perception, pose, lingering.trails(stamp))
        among_movers = lingering.mover_seen_within(DRIVEN_OFF, stamp)
        heading = self._guidance.head(place, ahead.sight, among_movers)
        dock = docking(self._problem, pose) if heading.direct else None
        subgoal = heading.subgoal if dock is None else dock.target
        way_out = lingering.way_out(stamp)
        subgoal = subgoal if way_out is None else way_out
        target = _in_robot_frame(subgoal, pose)
        wanted = atan2(target[1], target[0])
        if dock is not None and dock.turn_to is not None:
            wanted = dock.turn_to - pose.yaw
        motions = candidate_motions(wanted, observation.twist, self._spec)
        scene = scene_around(around, pose, self._spec, self._settings)
        outlook = look_ahead(motions, scene, self._spec, self._settings)
        passing = None
        if movers:
            aim = np.array([subgoal[0] - pose.x, subgoal[1] - pose.y])
            passing = ways_past(ahead.sight, ahead.expected, aim, self._settings)
        cost, alone = self._costs(motions, outlook, target, pose, dock, passing)
        candidates = _candidates(motions, outlook, cost, pose)
        first = self._choose(cost, outlook, scene, passing, self._kept(motions, pose), pose.yaw)
        travel = motions.direction + pose.yaw
        verdict = verdict_on(first, candidates, travel, perception, self._spec, self._gate)
        chosen = verdict.chosen
        self._travel = float(travel[chosen])
        self._evading = not outlook.admissible[chosen]
        v, omega = motions.speeds[chosen].tolist()
        next_position = position_after(v, omega, pose, observation.twist, self._spec)
        candidates.positions[chosen] = next_position  # to the last digit
        return Decision(
            next_position=next_position,
            behaviour=_behaviour(chosen, motions, outlook, alone, heading, dock, perception),
            inputs=verdict.inputs,
            risk=float(candidates.risk[chosen]),
            vetoed=verdict.vetoed,
            candidates=candidates,
            subgoal=subgoal,
            give_up=self._give_up(observation, heading),
        )

    def _costs(
        self,
        motions: Motions,
        outlook: Outlook,
        target: tuple[float, float],
        pose: Pose2D,
        dock: Docking | None,
        passing: Passing | None,
    ) -> tuple[FloatArray, FloatArray]:
        """(m,) the priorities as one cost, m, and (m,) the same as if nothing moved.

        Progress first, then room, then keeping on. Progress towards the subgoal is Eq. (13); near
        movers it is what the place reached is worth. Crowding keeps next positions off the
        predicted trajectories, Eq. (14). Guidance itself sees to the return to the line to the
        goal.
        """
        settings = self._settings
        other = secondary_costs(
            outlook.static,
            motions.speed,
            motions.direction,
            pose.yaw,
            self._travel or 0.0,
            settings.comfortable_gap,
            settings.static_weight,
            settings.reverse_cost,
            0.0 if self._travel is None else settings.change_cost,
        )
        if dock is not None and dock.turn_to is not None:
            other += ~motions.on_the_spot
        # As near to the goal as this the fastest way is taken.
        near_enough = 0.0 if dock is not None else self._problem.goal_tolerance / 2
        # Waiting is for movers: among what stands it would last for ever.
        waiting = settings.waiting_cost if passing is None else 0.0
        alone = costs_alone(
            outlook.poses, other, target, near_enough, settings.progress_steps, waiting
        )
        if passing is None:
            return alone, alone
        cost = costs_among_movers(
            outlook, passing, other, pose.yaw,
            settings.passing_length, settings.moving_weight, settings.contact_cost,
        )  # fmt: skip
        return cost, alone

    def _choose(
        self,
        cost: FloatArray,
        outlook: Outlook,
        scene: Scene,
        passing: Passing | None,
        kept: BoolArray,
        yaw: float,
    ) -> int:
        """The cheapest admissible candidate; none: the one that stays clear the longest.

        Who evades keeps on (m,) `kept` unless another way can be expected to stay clear for longer
        by `EVASION_BONUS`: turning to and fro between ways out takes away the time for any.
        """
        best = cheapest(cost, outlook.admissible)
        if best >= 0:
            return best
        # Where nothing moves, whatever can stop is admissible.
        if passing is not None and outlook.static_ok.any():
            bonus = np.where(kept, EVASION_BONUS, 0.0)
            lasts = lasting(outlook, scene, passing, bonus, yaw, self._spec, self._settings)
            return int(lasts.argmax())
        return int(outlook.soon.argmax())

    def _kept(self, motions: Motions, pose: Pose2D) -> BoolArray:
        """(m,) True for the candidates that go on as the robot is evading now."""
        if self._travel is None or not self._evading:
            return np.zeros(len(motions.speed), dtype=bool)
        alike = np.cos(motions.direction + pose.yaw - self._travel) > SAME_EVASION
        kept: BoolArray = alike & (motions.speed != 0.0)
        return kept

    def _give_up(
        self, observation: Observation, heading: Heading
    ) -> Literal["no_path", "stuck"] | None:
        if heading.closed_loops >= 2:
            return "no_path"
        place = (observation.pose.x, observation.pose.y)
        if self._lingering.stuck(place, observation.stamp):
            return "stuck"
        return None


def _candidates(motions: Motions, outlook: Outlook, cost: FloatArray, pose: Pose2D) -> CandidateSet:
    """The candidates' next positions, Eq. (12), with what the decision knows of them."""
    admissible = outlook.admissible
    positions, clearance, allowed, risk = _weighed(
        motions.poses, pose.x, pose.y, pose.yaw, outlook.static, outlook.moving, admissible, cost
    )
    return CandidateSet(positions, admissible, clearance, allowed, risk)


@compiled
def _weighed(
    poses: FloatArray,
    x: float,
    y: float,
    yaw: float,
    static: FloatArray,
    moving: FloatArray,
    admissible: BoolArray,
    cost: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """`positions`, `clearance`, `cost` and `risk` of the candidates, the latter not known yet."""
    return (
        places_after(poses, x, y, yaw),
        np.minimum(static, moving),
        np.where(admissible, cost, np.inf),
        np.full(len(cost), np.nan),
    )


def _behaviour(
    chosen: int,
    motions: Motions,
    outlook: Outlook,
    alone: FloatArray,
    heading: Heading,
    dock: Docking | None,
    perception: Perception,
) -> Behaviour:
    """The name of what the robot does, for the record."""
    if not outlook.admissible[chosen]:
        return Behaviour.EVASION
    if dock is not None and dock.turn_to is not None:
        return Behaviour.TURNING_ON_GOAL
    if motions.speed[chosen] == 0.0:
        return Behaviour.WAITING
    unhindered = max(cheapest(alone, outlook.static_ok), 0)
    deviates = (
        cos(motions.direction[chosen] - motions.direction[unhindered]) < SAME_COURSE
        or motions.speed[chosen] < motions.speed[unhindered] - SAME_SPEED
    )
    if perception.anything_moves and (deviates or not outlook.admissible[unhindered]):
        approaching = any(obstacle.approaching for obstacle in perception.obstacles)
        return Behaviour.DYNAMIC_AVOIDANCE if approaching else Behaviour.MOVING_AWAY
    if heading.mode == "boundary":
        return Behaviour.BOUNDARY_FOLLOWING
    return Behaviour.GOAL_SEEKING if heading.direct else Behaviour.STATIC_AVOIDANCE


def _in_robot_frame(point: tuple[float, float], pose: Pose2D) -> tuple[float, float]:
    dx, dy = point[0] - pose.x, point[1] - pose.y
    c, s = cos(pose.yaw), sin(pose.yaw)
    return (c * dx + s * dy, c * dy - s * dx)
