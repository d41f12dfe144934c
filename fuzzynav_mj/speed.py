"""Where an episode's time goes: stages timed from outside, and bare physics beside them.

Simulation, planner and gate are wrapped; nothing in them knows of it. Episode and bare physics are
timed in turns, a second of simulated time each: a machine's speed may change from one moment to the
next, and then only what was measured at the same time can be compared.
"""

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import ClassVar

import mujoco
import numpy as np

from fuzzynav_mj.episode import BlockTruth, run_episode
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Planner, Requirements
from fuzzynav_mj.planners.multilayer import MultilayerPlanner
from fuzzynav_mj.rehearsal import settle
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.types import (
    Decision,
    FloatArray,
    FuzzyInputs,
    LaserScan,
    Outcome,
    Pose2D,
)

Clock = Callable[[], float]

STAGES = ("physics", "rays", "prediction", "candidates", "fuzzy", "record")
"""Drive and physics steps; the scan; perception of what moves; the decision without its gate; the
gate's risks; and the rest: the loop, and the record with its clearances at the end."""

SINGLE_RISKS = 200  # evaluations of the gate that are timed at a time
FEW, MANY = 30, 300  # static obstacles whose decisions are compared
IN_TURNS = 200  # physics steps
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


class Stopwatch:
    """Adds up times by name.

    Args:
        clock: seconds; only differences count.
    """

    def __init__(self, clock: Clock) -> None:
        self.clock = clock
        self.spent: defaultdict[str, float] = defaultdict(float)
        self.decisions: list[float] = []
        self.looked = 0.0  # when the scan was done

    def add(self, name: str, began: float) -> float:
        """Book the time since `began` on `name`; returns the present time."""
        now = self.clock()
        self.spent[name] += now - began
        return now


class BareSteps:
    """MuJoCo's steps alone, timed as "bare": the episode's model, the robot parked, one call each.

    Args:
        scenario, seed: of the episode.
        watch: where they are booked.
    """

    def __init__(self, scenario: Scenario, seed: int, watch: Stopwatch) -> None:
        self._model, self._data = EpisodeSimulation(scenario, seed).physics
        self._watch = watch
        self._owed = 0

    def owe(self, steps: int) -> None:
        """Notes steps of the episode; takes as many once they are enough."""
        self._owed += steps
        if self._owed >= IN_TURNS:
            self.take()

    def take(self) -> None:
        """Takes all that are owed."""
        began = self._watch.clock()
        for _ in range(self._owed):
            mujoco.mj_step(self._model, self._data)
        self._watch.add("bare", began)
        self._owed = 0


class TimedSimulation(EpisodeSimulation):
    """An episode's physics, timed: stages "physics" and "rays"; bare steps in turns with it."""

    def __init__(
        self, scenario: Scenario, seed: int, watch: Stopwatch, bare: BareSteps | None = None
    ) -> None:
        super().__init__(scenario, seed)
        self._watch, self._bare = watch, bare

    @property
    def scan(self) -> LaserScan:
        """The scan of the present state."""
        began = self._watch.clock()
        scan = super().scan
        self._watch.looked = self._watch.add("rays", began)
        return scan

    def drive(self, next_position: tuple[float, float]) -> BlockTruth:
        """Simulates one decision period towards the next position."""
        began = self._watch.clock()
        block = super().drive(next_position)
        self._watch.add("physics", began)
        if self._bare is not None:
            self._bare.owe(len(block.poses))
        return block


class TimedGate(RiskGate):
    """The fuzzy gate, timed: stage "fuzzy"."""

    watch: Stopwatch

    @staticmethod
    def make(watch: Stopwatch) -> "TimedGate":
        """A gate as planner `fuzzy` has it."""
        gate = TimedGate()
        object.__setattr__(gate, "watch", watch)  # the gate's own fields are frozen
        return gate

    def risk(self, inputs: FuzzyInputs) -> float:
        """Risk in [0, 100], or nan."""
        began = self.watch.clock()
        risk = RiskGate.risk(self, inputs)
        self.watch.add("fuzzy", began)
        return risk

    def risks(self, distances: FloatArray) -> FloatArray:
        """Risks (n,) of distances (n, 6)."""
        began = self.watch.clock()
        risks = RiskGate.risks(self, distances)
        self.watch.add("fuzzy", began)
        return risks


class TimedPlanner:
    """A planner, timed: stages "candidates", the gate's share included, and "prediction".

    Perception comes between scan and decision, so that is what the time between them is.
    """

    requires: ClassVar[Requirements] = MultilayerPlanner.requires

    def __init__(self, planner: Planner, watch: Stopwatch) -> None:
        self._planner, self._watch = planner, watch

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode."""
        self._planner.reset(problem, rng)

    def decide(self, observation: Observation) -> Decision:
        """The next position, and why."""
        watch = self._watch
        began = watch.add("prediction", watch.looked)
        decision = self._planner.decide(observation)
        ended = watch.add("candidates", began)
        watch.decisions.append(ended - watch.looked)
        return decision


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
