"""The paper's planner with other settings, by name: `fuzzy:gate=60`, `multilayer:prediction=off`.

They are what an ablation compares; each option takes one part of the method away or moves one of
its numbers.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import ClassVar

import numpy as np

from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.fuzzy.completion import PROFILES
from fuzzynav_mj.fuzzy.membership import RISK_MAX
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Planner, Requirements
from fuzzynav_mj.planners.multilayer import MultilayerPlanner
from fuzzynav_mj.types import Decision, PerceivedObstacle

OPTIONS = {
    "fuzzy": {
        "gate": f"a risk from 0 to {RISK_MAX:g}",
        "rules": " or ".join(sorted(PROFILES)),
        "prediction": "on or off",
    },
    "multilayer": {"prediction": "on or off"},
}
"""What each planner's options may be set to."""


class WithoutPrediction:
    """A planner that is told of every moving obstacle that it stands where it is seen now."""

    requires: ClassVar[Requirements] = Requirements(scan=True, obstacles=True)

    def __init__(self, planner: Planner) -> None:
        self._planner = planner

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode."""
        self._planner.reset(problem, rng)

    def decide(self, observation: Observation) -> Decision:
        """The planner's decision among standing obstacles."""
        perception = observation.perception
        assert perception is not None
        stopped = tuple(_stopped(obstacle) for obstacle in perception.obstacles)
        return self._planner.decide(
            replace(observation, perception=replace(perception, obstacles=stopped))
        )


def has_options(name: str) -> bool:
    """True if `name` has the form of a planner with options."""
    return ":" in name


def make_variant(name: str) -> Planner:
    """A fresh planner of the form `PLANNER:OPTION=VALUE,OPTION=VALUE`.

    Raises:
        FuzzyNavError: the planner takes no options, or not this one, or not this value.
    """
    base, _, text = name.partition(":")
    if base not in OPTIONS:
        raise FuzzyNavError(
            f"planner {name!r}: given options for {base!r}; "
            f"allowed are options for {' and '.join(OPTIONS)}"
        )
    options = dict(_options(name, base, text))
    gate = None
    if base == "fuzzy":
        default = RiskGate()
        limit = float(options.get("gate", default.limit))
        gate = RiskGate(options.get("rules", default.profile), limit)
    planner = MultilayerPlanner(gate)
    return WithoutPrediction(planner) if options.get("prediction") == "off" else planner


def _options(name: str, base: str, text: str) -> Iterator[tuple[str, str]]:
    allowed = OPTIONS[base]
    seen: set[str] = set()
    for part in text.split(","):
        option, _, value = part.partition("=")
        if option not in allowed or option in seen:
            again = " again" if option in seen else ""
            raise FuzzyNavError(
                f"planner {name!r}: given option {option!r}{again}; allowed are "
                + "; ".join(f"{key}={values}" for key, values in allowed.items())
            )
        if not _is_allowed(option, value):
            raise FuzzyNavError(
                f"planner {name!r}: {option}: given {value!r}; allowed is {allowed[option]}"
            )
        seen.add(option)
        yield option, value


def _is_allowed(option: str, value: str) -> bool:
    if option == "rules":
        return value in PROFILES
    if option == "prediction":
        return value in ("on", "off")
    try:
        return 0.0 <= float(value) <= RISK_MAX
    except ValueError:
        return False


def _stopped(obstacle: PerceivedObstacle) -> PerceivedObstacle:
    return replace(
        obstacle,
        dynamic=False,
        approaching=False,
        velocity=np.zeros(2),
        turn_rate=0.0,
        closing_sigma=0.0,
        drift_sigma=0.0,
        unsure=np.zeros(2),
    )
