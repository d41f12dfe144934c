"""Where an episode's time goes, stage by stage, beside bare physics; and what a decision costs."""

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

import numpy as np

from fuzzynav_mj.episode import run_episode
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.planners.multilayer import MultilayerPlanner
from fuzzynav_mj.rehearsal import settle
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.timed import BareSteps, Clock, Stopwatch, TimedGate, TimedPlanner, TimedSimulation
from fuzzynav_mj.types import FuzzyInputs, Outcome, Pose2D

STAGES = ("physics", "rays", "prediction", "candidates", "fuzzy", "record")
"""Drive and physics steps; the scan; perception of what moves; the decision without its gate; the
gate's risks; and the rest: the loop, and the record with its clearances at the end."""

SINGLE_RISKS = 200  # evaluations of the gate that are timed at a time
FEW, MANY = 30, 300  # static obstacles whose decisions are compared
CROWD_DECISIONS = 60
CROWD_SIDE = 14.0  # m
CROWD_RADIUS = 0.05  # m


@dataclass(frozen=True, slots=True)
class EpisodeSpeed:
    """Times of one scenario's episode; medians over its repeats, s.

    Attributes:
        scenario: its name.
        outcome: how the episode ended.
        sim_time: simulated.
        total: of the whole episode without start-up.
        bare: of as many steps of MuJoCo with the same model and nothing else.
        ratio: of `total` over `bare`.
        stages: by name, as in `STAGES`; they add up to `total` but for the medians.
        decisions: number of decisions.
        decision_p50: median time of a decision, from the scan to the next position.
        decision_p99: 99th percentile.
        first_decision: time of the first one.
    """

    scenario: str
    outcome: Outcome
    sim_time: float
    total: float
    bare: float
    ratio: float
    stages: dict[str, float]
    decisions: int
    decision_p50: float
    decision_p99: float
    first_decision: float

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds in one of the clock's."""
        return self.sim_time / self.total


def time_episode(scenario: Scenario, seed: int, repeats: int, clock: Clock) -> EpisodeSpeed:
    """Times episodes of planner `fuzzy`, each in turns with bare physics."""
    settle()
    runs = [_time_once(scenario, seed, clock) for _ in range(repeats)]
    first = runs[0]

    def middle(value: Callable[[EpisodeSpeed], float]) -> float:
        return median(value(run) for run in runs)

    return EpisodeSpeed(
        scenario=first.scenario,
        outcome=first.outcome,
        sim_time=first.sim_time,
        total=middle(lambda run: run.total),
        bare=middle(lambda run: run.bare),
        ratio=middle(lambda run: run.ratio),
        stages={name: median(run.stages[name] for run in runs) for name in STAGES},
        decisions=first.decisions,
        decision_p50=middle(lambda run: run.decision_p50),
        decision_p99=middle(lambda run: run.decision_p99),
        first_decision=first.first_decision,
    )


def _time_once(scenario: Scenario, seed: int, clock: Clock) -> EpisodeSpeed:
    watch = Stopwatch(clock)
    steps = BareSteps(scenario, seed, watch)
    simulation = TimedSimulation(scenario, seed, watch, steps)
    planner = TimedPlanner(MultilayerPlanner(TimedGate.make(watch)), watch)
    began = clock()
    episode = run_episode(simulation, planner, "fuzzy", simulation.planner_rng, 0.0, {})
    whole = clock() - began
    total = whole - watch.spent["bare"]
    steps.take()
    spent = dict(watch.spent)
    bare = spent.pop("bare")
    spent["candidates"] -= spent.get("fuzzy", 0.0)
    spent["record"] = total - sum(spent.values())
    return EpisodeSpeed(
        scenario=scenario.name,
        outcome=episode.record.outcome,
        sim_time=episode.record.sim_time_s,
        total=total,
        bare=bare,
        ratio=total / bare,
        stages={name: spent.get(name, 0.0) for name in STAGES},
        decisions=len(watch.decisions),
        decision_p50=float(np.percentile(watch.decisions, 50)),
        decision_p99=float(np.percentile(watch.decisions, 99)),
        first_decision=watch.decisions[0],
    )


def time_single_risk(repeats: int, clock: Clock) -> float:
    """Time of the gate's risk of one next position, s: median over `repeats` times 200 of them."""
    gate = RiskGate()
    inputs = [FuzzyInputs(*row) for row in np.random.default_rng(0).random((SINGLE_RISKS, 6))]
    means = []
    for _ in range(max(repeats, 3) + 1):
        began = clock()
        for row in inputs:
            gate.risk(row)
        means.append((clock() - began) / SINGLE_RISKS)
    return median(means[1:])  # the first round fills tables


def time_crowds(repeats: int, clock: Clock) -> tuple[float, float]:
    """Median time of a decision, s, among 30 and among 300 pillars in the same arena."""
    times: dict[int, list[float]] = {FEW: [], MANY: []}
    for _ in range(repeats):
        for count, found in times.items():
            watch = Stopwatch(clock)
            scenario = crowd(count)
            simulation = TimedSimulation(scenario, 0, watch)
            planner = TimedPlanner(MultilayerPlanner(TimedGate.make(watch)), watch)
            run_episode(simulation, planner, "fuzzy", simulation.planner_rng, 0.0, {})
            found.append(float(np.percentile(watch.decisions, 50)))
    return median(times[FEW]), median(times[MANY])


def crowd(count: int) -> Scenario:
    """An arena with this many equal pillars strewn over it, none within 0.5 m of the start."""
    middle = CROWD_SIDE / 2
    rng = np.random.default_rng(1)
    cells = int(np.ceil(np.sqrt(MANY))) + 1
    places = (np.indices((cells, cells)).reshape(2, -1).T + 0.5) * (CROWD_SIDE / cells)
    places += rng.uniform(-0.12, 0.12, places.shape)
    places = places[np.hypot(*(places - 1.0).T) > 0.5]
    chosen = rng.permutation(len(places))[:count]
    return Scenario(
        name=f"{count}_pillars",
        description="",
        bounds=(0.0, 0.0, CROWD_SIDE, CROWD_SIDE),
        walls=True,
        time_limit=CROWD_DECISIONS * DEFAULT_ROBOT.decision_period,
        allow_faster=False,
        start=Pose2D(1.0, 1.0, np.pi / 4),
        goal=(middle, middle),
        goal_yaw=None,
        goal_tolerance=0.1,
        static=tuple(Shape(None, (x, y, CROWD_RADIUS)) for x, y in places[chosen].tolist()),
        moving=(),
        random_moving=(),
        source="speed",
    )
