"""What every registered planner keeps to, over every world of the library.

All are shown the same few observations of a robot that sets out straight ahead.
"""

from functools import cache
from math import hypot, isfinite, isnan
from typing import Any

import numpy as np
import pytest

from fuzzynav_mj.episode import static_map
from fuzzynav_mj.planners import PLANNERS, make_planner
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Planner
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios import library_names, load_scenario
from fuzzynav_mj.sensing.perception import Perceiver
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.types import Behaviour, Decision

LOOKS = 5
# Forwards at full speed while the centre swings around the axle at the full yaw rate; 2 % more.
REACH = (
    1.02
    * DEFAULT_ROBOT.decision_period
    * hypot(DEFAULT_ROBOT.max_speed, DEFAULT_ROBOT.axle_offset * DEFAULT_ROBOT.max_yaw_rate)
)


class Guarded:
    """A record of which only some fields may be read."""

    def __init__(self, record: object, withheld: set[str]) -> None:
        self._record = record
        self._withheld = withheld

    def __getattr__(self, name: str) -> Any:
        assert name not in self._withheld, f"{name} was not asked for"
        return getattr(self._record, name)


@cache
def first_looks(scenario_name: str) -> tuple[NavigationProblem, tuple[Observation, ...]]:
    """The task and the first observations, with everything that a planner could ask for."""
    scenario = load_scenario(scenario_name)
    simulation = EpisodeSimulation(scenario, 0)
    problem = NavigationProblem(
        scenario.goal,
        scenario.goal_yaw,
        scenario.goal_tolerance,
        simulation.spec,
        static_map(simulation.world),
    )
    perceiver, looks = Perceiver(simulation.spec), []
    for number in range(LOOKS):
        pose, scan = simulation.pose, simulation.scan
        perception = perceiver.perceive(scan, pose)
        looks.append(Observation(simulation.time, pose, simulation.twist, scan, perception))
        step = 0.01 * (number + 1)
        ahead = (pose.x + step * np.cos(pose.yaw), pose.y + step * np.sin(pose.yaw))
        simulation.drive((float(ahead[0]), float(ahead[1])))
    return problem, tuple(looks)


def decisions(planner: Planner, scenario_name: str, seed: int) -> list[Decision]:
    """What the planner makes of the first looks, given what it declared and nothing else."""
    problem, looks = first_looks(scenario_name)
    requires = planner.requires
    unasked = set() if requires.static_map else {"static_map"}
    planner.reset(Guarded(problem, unasked), np.random.default_rng(seed))  # type: ignore[arg-type]
    unasked = set() if requires.obstacles else {"perception"}
    if not (requires.scan or requires.obstacles):
        unasked.add("scan")
    return [planner.decide(Guarded(look, unasked)) for look in looks]  # type: ignore[arg-type]


@pytest.mark.parametrize("name", sorted(PLANNERS))
@pytest.mark.parametrize("scenario", sorted(library_names()))
def test_decisions_are_valid_and_repeat_to_the_bit(name: str, scenario: str) -> None:
    first = decisions(make_planner(name), scenario, 7)
    for look, decision in zip(first_looks(scenario)[1], first, strict=True):
        x, y = decision.next_position
        assert isfinite(x) and isfinite(y)
        assert hypot(x - look.pose.x, y - look.pose.y) <= REACH
        assert decision.behaviour in Behaviour
        assert decision.give_up is None
        assert isnan(decision.risk) or 0.0 <= decision.risk <= 100.0
        assert decision.subgoal is None or np.isfinite(decision.subgoal).all()
    planner = make_planner(name)
    decisions(planner, "trap_movers", 8)  # another episode leaves no trace
    again = decisions(planner, scenario, 7)
    assert [d.next_position for d in again] == [d.next_position for d in first]
    assert [d.subgoal for d in again] == [d.subgoal for d in first]


def test_reading_what_was_not_asked_for_fails() -> None:
    problem, looks = first_looks("trap")
    with pytest.raises(AssertionError, match="static_map was not asked for"):
        _ = Guarded(problem, {"static_map"}).static_map
    assert Guarded(looks[0], {"scan"}).pose is looks[0].pose
