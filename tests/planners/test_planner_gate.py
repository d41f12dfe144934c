"""The fuzzy gate inside the decision: what it refuses, and what is taken instead."""

from dataclasses import dataclass, field
from math import inf, isnan, nan
from pathlib import Path

import numpy as np
import pytest
from perceived import mover, standing
from short_episodes import box, disc, play

from fuzzynav_mj.episode import Episode
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.planners.base import NavigationProblem, Observation
from fuzzynav_mj.planners.multilayer import MultilayerPlanner
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.runner import play_episode
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.types import (
    CandidateSet,
    Decision,
    FloatArray,
    FuzzyInputs,
    LaserScan,
    Outcome,
    PerceivedObstacle,
    Perception,
    Pose2D,
    Twist2D,
    VisibilityMatrix,
)

LIMIT = 76.0
RAYS = DEFAULT_ROBOT.ray_count


@dataclass
class ScriptedGate:
    """A gate that knows the risks beforehand, and notes what it is asked."""

    first: float
    others: FloatArray | None = None
    asked: list[FuzzyInputs] = field(default_factory=list)

    def risk(self, inputs: FuzzyInputs) -> float:
        """The risk of the position chosen by the priorities."""
        self.asked.append(inputs)
        return self.first

    def risks(self, distances: FloatArray) -> FloatArray:
        """The alternatives' risks."""
        assert self.others is not None, "an accepted position was not left alone"
        return np.resize(self.others, len(distances))

    def accepts(self, risk: float) -> bool:
        """As the real one."""
        return RiskGate().accepts(risk)


def perceive(*obstacles: PerceivedObstacle) -> Perception:
    """What a robot at the origin that faces +x would perceive, its rays free."""
    scan = LaserScan(
        stamp=0.0,
        bearings=np.arange(RAYS) * (2 * np.pi / RAYS) - np.pi,
        ranges=np.full(RAYS, DEFAULT_ROBOT.sensor_range),
        hit=np.zeros(RAYS, dtype=bool),
        max_range=DEFAULT_ROBOT.sensor_range,
    )
    counts = np.zeros(4, dtype=np.intp)
    return Perception(scan, obstacles, VisibilityMatrix(np.zeros((4, RAYS), bool), counts, counts))


def decide(gate: ScriptedGate | RiskGate | None, *obstacles: PerceivedObstacle) -> Decision:
    """One decision at the origin, the goal ahead, nothing near enough to hinder."""
    planner = MultilayerPlanner(gate)  # type: ignore[arg-type]
    problem = NavigationProblem((3.0, 0.0), None, 0.1, DEFAULT_ROBOT)
    planner.reset(problem, np.random.default_rng(0))
    seen = perceive(*obstacles)
    pose, twist = Pose2D(0.0, 0.0, 0.0), Twist2D(0.3, 0.0)
    return planner.decide(Observation(0.0, pose, twist, seen.scan, seen))


def weighed(decision: Decision) -> CandidateSet:
    """The candidates of a decision."""
    assert decision.candidates is not None
    return decision.candidates


def taken(decision: Decision) -> FloatArray:
    """(m,) True for the candidates at the accepted next position."""
    same: FloatArray = (weighed(decision).positions == decision.next_position).all(axis=1)
    return same


LEAVING = mover([(-0.7, 0.0), (-0.7, 0.05)], (-0.3, 0.0))


def test_accepted_position_is_left_alone() -> None:
    decision = decide(ScriptedGate(LIMIT), LEAVING)
    assert not decision.vetoed and decision.risk == LIMIT
    risks = weighed(decision).risk
    assert np.count_nonzero(~np.isnan(risks)) == 1
    assert weighed(decision).cost[taken(decision)].min() == weighed(decision).cost.min()


@pytest.mark.parametrize("risk", [LIMIT + 1e-6, 100.0, nan])
def test_refused_position_gives_way_to_the_lowest_risk(risk: float) -> None:
    """Too high a risk, or none that can be told: of all alternatives the least risky is taken."""
    others = 90.0 - np.arange(200) % 37
    decision = decide(ScriptedGate(risk, others), LEAVING)
    candidates = weighed(decision)
    assert decision.vetoed
    assert decision.risk == np.nanmin(candidates.risk)
    assert candidates.admissible[taken(decision)].any()
    refused = candidates.positions[int(candidates.cost.argmin())]
    assert tuple(refused.tolist()) != decision.next_position


def test_unknown_risk_is_the_worst_of_all() -> None:
    """One alternative is known to be all but certain trouble, of the others nothing is known."""
    others = np.full(200, nan)
    others[3] = 99.0
    decision = decide(ScriptedGate(nan, others), LEAVING)
    assert decision.vetoed and decision.risk == 99.0


def test_of_equal_risks_the_cheapest_is_taken() -> None:
    others = np.array([80.0, 80.0, 60.0])
    decision = decide(ScriptedGate(90.0, others), LEAVING)
    candidates = weighed(decision)
    least = candidates.risk == 60.0
    assert least.sum() >= 3
    assert candidates.cost[taken(decision)].min() == candidates.cost[least].min()


@pytest.mark.parametrize("seen", [LEAVING, standing([(-0.5, 0.0), (-0.5, 0.05)])])
def test_alternatives_lead_on(seen: PerceivedObstacle) -> None:
    """None costs more than midway between the refused one and standing still, the last one."""
    decision = decide(ScriptedGate(90.0, np.full(200, 80.0)), seen)
    candidates = weighed(decision)
    judged = ~np.isnan(candidates.risk)
    midway = (candidates.cost.min() + candidates.cost[-1]) / 2
    assert judged.sum() > 5
    assert (judged == (candidates.cost <= midway)).all()


def test_gate_judges_the_next_position_not_the_present_one() -> None:
    """The wall is 0.6 m ahead now, and less at the next position."""
    gate = ScriptedGate(10.0)
    decision = decide(gate, standing([(0.6, y) for y in np.linspace(-0.1, 0.1, 9)]))
    (inputs,) = gate.asked
    assert decision.inputs == inputs
    x, y = decision.next_position
    offset = np.array([(0.6 - x, dy - y) for dy in np.linspace(-0.1, 0.1, 9)])
    # Judged on the roll-out, which knows speeds at half periods only.
    assert abs(inputs.FS - np.hypot(*offset.T).min()) < 2e-3
    assert inputs.FS < 0.59
    assert (inputs.LS, inputs.RS, inputs.LD, inputs.FD, inputs.RD) == (1.0,) * 5


def test_without_a_gate_nothing_is_judged() -> None:
    decision = decide(None, LEAVING)
    assert isnan(decision.risk) and decision.inputs is None and not decision.vetoed
    assert np.isnan(weighed(decision).risk).all()


def check_gate(episode: Episode) -> None:
    """The gate's laws, at every step of an episode."""
    gate = RiskGate()
    for step in episode.steps:
        decision = step.decision
        candidates = weighed(decision)
        mine = taken(decision)
        assert mine.any()
        assert decision.inputs is not None
        # The record explains itself; alternatives are judged in one batch, which rounds otherwise.
        assert decision.risk == pytest.approx(gate.risk(decision.inputs), abs=1e-9)
        assert 0.0 <= decision.risk <= 100.0
        assert np.any(candidates.risk[mine] == decision.risk)
        assert np.array_equal(candidates.cost == inf, ~candidates.admissible)
        if not candidates.admissible.any():
            assert not decision.vetoed
            continue
        assert candidates.admissible[mine].any()
        lowest = np.nanmin(candidates.risk)
        if decision.risk > LIMIT:
            # Refused, and no alternative is better but by rounding.
            assert decision.risk <= lowest + 0.1
        cheapest = int(candidates.cost.argmin())
        if decision.vetoed:
            assert not gate.accepts(float(candidates.risk[cheapest]))
            assert decision.risk <= lowest + 0.1
        elif decision.risk <= LIMIT:
            assert candidates.cost[mine].min() == candidates.cost[cheapest]


@pytest.mark.parametrize("start_y", [1.0, 0.5])
def test_gap_of_0_35_m_between_standing_walls_is_passed(tmp_path: Path, start_y: float) -> None:
    """Straight ahead and from the side: no veto of the gate keeps the robot out."""
    wall = (box(1.4, 0.0, 1.6, 0.825), box(1.4, 1.175, 1.6, 2.0))
    episode = play(tmp_path, *wall, start=(0.5, start_y, 0.0), goal=(2.5, 1.0))
    assert episode.record.outcome is Outcome.GOAL_REACHED
    assert episode.record.risk_max is not None
    check_gate(episode)
    inside = [step for step in episode.steps if 1.4 < step.pose.x < 1.6]
    assert len(inside) >= 3
    # Both walls are Close there: 0.2 m and less from the centre.
    assert any(
        step.decision.inputs is not None
        and step.decision.inputs.LS < 0.21
        and step.decision.inputs.RS < 0.21
        for step in inside
    )
    if start_y == 1.0:  # from the side, no alternative in the mouth of the gap is lower
        for step in episode.steps:
            assert step.decision.risk <= LIMIT or step.decision.vetoed


def test_gate_keeps_its_laws_among_movers(tmp_path: Path) -> None:
    wall = (box(1.4, 0.0, 1.6, 0.75), box(1.4, 1.25, 1.6, 2.0))
    movers = (
        disc(0.12, 0.3, (1.9, 0.3), (1.9, 1.7), repeat="reverse"),
        disc(0.12, 0.25, (1.1, 1.7), (1.1, 0.3), repeat="reverse"),
    )
    episode = play(tmp_path, *wall, *movers, start=(0.4, 1.0, 0.0), goal=(2.6, 1.0))
    assert episode.record.outcome is Outcome.GOAL_REACHED
    assert episode.record.decisions == len(episode.steps)
    check_gate(episode)


def test_gate_keeps_its_laws_in_the_narrow_world() -> None:
    episode = play_episode(load_scenario("narrow"), "fuzzy", 2)
    check_gate(episode)
    assert episode.record.gate_vetoes == sum(step.decision.vetoed for step in episode.steps)


def test_planner_without_a_gate_records_no_risk(tmp_path: Path) -> None:
    crossing = disc(0.15, 0.4, (1.3, 0.2), (1.3, 1.8), repeat="reverse")
    episode = play(tmp_path, crossing, start=(0.5, 1.0, 0.0), goal=(2.5, 1.0), planner="multilayer")
    record = episode.record
    assert record.outcome is Outcome.GOAL_REACHED
    assert (record.risk_max, record.risk_mean, record.gate_vetoes) == (None, None, 0)
    for step in episode.steps:
        candidates = weighed(step.decision)
        if candidates.admissible.any():
            assert candidates.cost[taken(step.decision)].min() == candidates.cost.min()
