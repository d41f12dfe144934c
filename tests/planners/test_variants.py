"""Planners with options in their names: each changes what it says and nothing else."""

from collections.abc import Callable

import numpy as np
import pytest
from perceived import mover, standing

from fuzzynav_mj.cli import main
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.metrics import record_to_json
from fuzzynav_mj.planners import make_planner
from fuzzynav_mj.planners.base import Observation, Planner
from fuzzynav_mj.planners.variants import OPTIONS, WithoutPrediction
from fuzzynav_mj.runner import play_episode
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.types import (
    Behaviour,
    Decision,
    LaserScan,
    Perception,
    Pose2D,
    Twist2D,
    VisibilityMatrix,
)

CROSSING = """
[[moving]]
circle = 0.1
waypoints = [[0.9, 1.0], [0.9, 0.2]]
speed = 0.3
"""
PILLAR = "[[static]]\ncircle = [0.85, 0.75, 0.05]\n"


def played(scenario: str, planner: str) -> dict[str, object]:
    """The record of seed 0 without the planner's name and the times that were measured."""
    record = record_to_json(play_episode(load_scenario(scenario), planner, 0).record)
    dropped = ("plan_ms_p50", "plan_ms_p99", "wall_s", "planner")
    return {name: value for name, value in record.items() if name not in dropped}


def gate_of(name: str) -> RiskGate | None:
    """The gate of a planner of the multilayer family."""
    gate: RiskGate | None = make_planner(name)._gate  # type: ignore[attr-defined]
    return gate


def test_options_at_their_defaults_change_nothing(write_scenario: Callable[..., str]) -> None:
    scenario = write_scenario("crossing", CROSSING)
    options = "gate=76,rules=completed,prediction=on"
    assert played(scenario, f"fuzzy:{options}") == played(scenario, "fuzzy")
    assert played(scenario, "multilayer:prediction=on") == played(scenario, "multilayer")


def test_each_option_sets_what_it_names() -> None:
    assert gate_of("fuzzy:gate=60") == RiskGate(limit=60.0)
    assert gate_of("fuzzy:gate=90.5") == RiskGate(limit=90.5)
    assert gate_of("fuzzy:rules=paper") == RiskGate(profile="paper")
    assert gate_of("fuzzy:rules=strict,gate=60") == RiskGate(profile="strict", limit=60.0)
    assert gate_of("multilayer:prediction=on") is None


class Witness:
    """Keeps what it is given."""

    requires = WithoutPrediction.requires

    def reset(self, problem: object, rng: np.random.Generator) -> None:
        self.draws = rng.integers(100)

    def decide(self, observation: Observation) -> Decision:
        self.given = observation
        return Decision((0.0, 0.0), Behaviour.WAITING)


def test_without_prediction_movers_stand_where_they_are_seen() -> None:
    scan = LaserScan(0.0, np.zeros(1), np.ones(1), np.zeros(1, dtype=bool), 0.8)
    visible = VisibilityMatrix(
        np.zeros((4, 1), dtype=bool), np.zeros(4, dtype=int), np.zeros(4, dtype=int)
    )
    moves = mover(
        [[0.5, 0.1], [0.5, 0.0]],
        (-0.3, 0.0),
        turn_rate=0.5,
        closing_sigma=0.1,
        drift_sigma=0.1,
        unsure=(0.0, 0.2),
    )
    stands = standing([[0.0, 0.4]])
    seen = Observation(
        1.0, Pose2D(1.0, 2.0, 0.0), Twist2D(0.1, 0.0), scan,
        Perception(scan, (moves, stands), visible),
    )  # fmt: skip
    witness = Witness()
    planner: Planner = WithoutPrediction(witness)
    planner.decide(seen)
    assert witness.given.perception is not None
    assert not witness.given.perception.anything_moves
    told, other = witness.given.perception.obstacles
    assert told.points is moves.points and told.distance == moves.distance
    assert (told.velocity.tolist(), told.turn_rate, told.closing_sigma) == ([0.0, 0.0], 0.0, 0.0)
    assert not told.approaching and told.drift_sigma == 0.0
    assert told.unsure.tolist() == [0.0, 0.0]
    assert other.points is stands.points
    assert witness.given.scan is scan
    assert (witness.given.pose, witness.given.twist) == (seen.pose, seen.twist)


def test_where_nothing_moves_prediction_makes_no_difference(
    write_scenario: Callable[..., str],
) -> None:
    scenario = write_scenario("still", PILLAR)
    assert played(scenario, "fuzzy:prediction=off") == played(scenario, "fuzzy")


GATE = "allowed is a risk from 0 to 100"
FUZZY = "; ".join(f"{option}={values}" for option, values in OPTIONS["fuzzy"].items())


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("fuzzy:", f"given option ''; allowed are {FUZZY}"),
        ("fuzzy:rule=paper", f"given option 'rule'; allowed are {FUZZY}"),
        ("fuzzy:gate=60,gate=60", f"given option 'gate' again; allowed are {FUZZY}"),
        ("multilayer:gate=60", "given option 'gate'; allowed are prediction=on or off"),
        ("fuzzy:gate", f"gate: given ''; {GATE}"),
        ("fuzzy:gate=101", f"gate: given '101'; {GATE}"),
        ("fuzzy:gate=nan", f"gate: given 'nan'; {GATE}"),
        (
            "fuzzy:rules=all",
            "rules: given 'all'; allowed is completed or front_close_vh or paper or strict",
        ),
        ("fuzzy:prediction=", "prediction: given ''; allowed is on or off"),
        ("maze:x=1", "given options for 'maze'; allowed are options for fuzzy and multilayer"),
    ],
)
def test_bad_options_are_one_line(
    capsys: pytest.CaptureFixture[str], name: str, expected: str
) -> None:
    assert main(["bench", "convex", "--planner", name]) == 2
    assert capsys.readouterr().err == f"fuzzynav: planner {name!r}: {expected}\n"
