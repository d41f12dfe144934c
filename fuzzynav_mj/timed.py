"""An episode's parts, timed from outside: nothing in simulation, planner and gate knows of it.

Episode and bare physics are timed in turns, a second of simulated time each: a machine may change
its speed from one moment to the next, and then only what was measured at the same time can be
compared.
"""

from collections import defaultdict
from collections.abc import Callable
from typing import ClassVar

import mujoco
import numpy as np

from fuzzynav_mj.episode import BlockTruth
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Planner, Requirements
from fuzzynav_mj.planners.multilayer import MultilayerPlanner
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.types import Decision, FloatArray, FuzzyInputs, LaserScan

Clock = Callable[[], float]

IN_TURNS = 200  # physics steps


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
