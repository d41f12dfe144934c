"""The episode's loop: what a planner is told, and what the record keeps."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from math import hypot, isnan
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from fuzzynav_mj.episode import Episode, run_episode
from fuzzynav_mj.planners import PLANNERS, make_planner
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Requirements
from fuzzynav_mj.runner import play_episode
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.types import (
    Behaviour,
    Decision,
    LaserScan,
    Outcome,
    PerceivedObstacle,
    Perception,
    Pose2D,
    Twist2D,
    VisibilityMatrix,
)

PILLAR = "[[static]]\npolygon = [[1.5, 0.9], [1.7, 0.9], [1.6, 1.1]]\n"


@dataclass
class Witness:
    """Drives straight at the goal, and keeps all that it was told."""

    requires: Requirements
    give_up_at: float = float("inf")

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode."""
        self.problem, self.rng = problem, rng
        self.observations: list[Observation] = []

    def decide(self, observation: Observation) -> Decision:
        """A step of 4 cm."""
        self.observations.append(observation)
        pose, (x, y) = observation.pose, self.problem.goal
        away = max(hypot(x - pose.x, y - pose.y), 1e-9)
        step = (pose.x + 0.04 * (x - pose.x) / away, pose.y + 0.04 * (y - pose.y) / away)
        give_up = "stuck" if observation.stamp >= self.give_up_at else None
        return Decision(step, Behaviour.GOAL_SEEKING, give_up=give_up)


def watch(path: str, witness: Witness) -> Episode:
    """One episode under a witness."""
    simulation = EpisodeSimulation(load_scenario(path), 0)
    return run_episode(simulation, witness, "witness", simulation.planner_rng, 0.5, {"a": "1"})


Writer = Callable[..., str]


# What a planner is told -----------------------------------------------------------------------


def test_planner_that_asks_for_nothing_is_told_nothing(write_scenario: Writer) -> None:
    witness = Witness(Requirements(scan=False, obstacles=False))
    episode = watch(write_scenario("blind", PILLAR), witness)
    assert witness.problem.static_map is None
    assert witness.observations
    assert all(observation.scan is None for observation in witness.observations)
    assert all(observation.perception is None for observation in witness.observations)
    assert all(step.scan is None and step.perception is None for step in episode.steps)
    assert episode.record.outcome is Outcome.GOAL_REACHED


def test_planner_that_asks_for_the_scan_gets_it_bare(write_scenario: Writer) -> None:
    witness = Witness(Requirements(scan=True, obstacles=False))
    episode = watch(write_scenario("scanning", PILLAR), witness)
    for observation, step in zip(witness.observations, episode.steps, strict=True):
        assert observation.perception is None
        assert observation.scan is not None and observation.scan is step.scan
        assert observation.scan.stamp == pytest.approx(observation.stamp)


def test_planner_that_asks_for_obstacles_gets_the_scan_of_the_moment(
    write_scenario: Writer,
) -> None:
    witness = Witness(Requirements(obstacles=True))
    episode = watch(write_scenario("seeing", PILLAR), witness)
    assert witness.problem.static_map is None
    for observation, step in zip(witness.observations, episode.steps, strict=True):
        assert observation.perception is not None
        assert observation.perception is step.perception
        assert observation.perception.scan is observation.scan
        assert observation.perception.scan.stamp == pytest.approx(observation.stamp)


def test_static_map_is_given_on_request_only(write_scenario: Writer) -> None:
    witness = Witness(Requirements(scan=False, obstacles=False, static_map=True))
    mover = "[[moving]]\ncircle = 0.1\nwaypoints = [[1.5, 0.2], [1.7, 0.2]]\nspeed = 0.1\n"
    watch(write_scenario("mapped", PILLAR + mover), witness)
    outlines = witness.problem.static_map
    assert outlines is not None and len(outlines) == 2  # the pillar and the bounds, no mover
    corners = {tuple(corner) for corner in outlines[0].tolist()}
    assert corners == {(1.5, 0.9), (1.7, 0.9), (1.6, 1.1)}
    assert outlines[1].min(axis=0).tolist() == [0.0, 0.0]
    assert outlines[1].max(axis=0).tolist() == [2.0, 1.2]


@pytest.mark.parametrize("name", PLANNERS)
def test_mapless_planners_ask_for_no_map(name: str) -> None:
    """The paper's planner, with and without its gate, knows its place and the goal, and looks."""
    planner = make_planner(name)
    if name in ("fuzzy", "multilayer"):
        assert planner.requires == Requirements(scan=True, obstacles=True, static_map=False)


def names(record: type) -> set[str]:
    """Names of a record's fields."""
    return {field.name for field in fields(record)}


def test_no_record_given_to_a_planner_has_room_for_the_truth() -> None:
    """A new field here is a new thing that planners are told: think twice."""
    assert names(Observation) == {"stamp", "pose", "twist", "scan", "perception"}
    assert names(NavigationProblem) == {
        "goal", "goal_yaw", "goal_tolerance", "spec", "static_map",
    }  # fmt: skip
    assert names(Perception) == {"scan", "obstacles", "visibility"}
    assert names(LaserScan) == {"stamp", "bearings", "ranges", "hit", "max_range"}
    assert names(VisibilityMatrix) == {"occupied", "counts", "previous_counts"}
    assert names(PerceivedObstacle) == {
        "points", "nearest_point", "distance", "bearing", "dynamic", "approaching",
        "velocity", "turn_rate", "closing_sigma", "drift_sigma", "unsure",
    }  # fmt: skip
    assert names(Pose2D) == {"x", "y", "yaw"} and names(Twist2D) == {"v", "omega"}


@pytest.mark.parametrize("planner", ["fuzzy", "multilayer"])
def test_what_is_out_of_sight_changes_nothing(write_scenario: Writer, planner: str) -> None:
    """Obstacles and movers that never come within range leave every decision as it is."""
    unseen = (
        "[[static]]\ncircle = [3.5, 0.6, 0.2]\n"
        "[[moving]]\ncircle = 0.1\nwaypoints = [[2.6, 0.3], [2.9, 0.9]]\nspeed = 0.4\n"
    )
    wide = ("bounds = [0.0, 0.0, 2.0, 1.2]", "bounds = [0.0, 0.0, 4.0, 1.2]")
    made = []
    for name, rest in (("alone", ""), ("among_others", unseen)):
        path = write_scenario(name, PILLAR + rest)
        Path(path).write_text(Path(path).read_text().replace(*wide))
        made.append(play_episode(load_scenario(path), planner, 0))
    alone, among = made
    assert len(alone.steps) == len(among.steps) > 5
    for one, other in zip(alone.steps, among.steps, strict=True):
        assert one.decision.next_position == other.decision.next_position
        assert one.decision.behaviour is other.decision.behaviour


# What the record keeps ------------------------------------------------------------------------


def test_record_repeats_what_happened(write_scenario: Writer) -> None:
    witness = Witness(Requirements(scan=False, obstacles=False))
    episode = watch(write_scenario("plain"), witness)
    record, steps = episode.record, episode.steps
    assert (record.scenario, record.planner, record.seed) == ("plain", "witness", 0)
    assert record.outcome is Outcome.GOAL_REACHED and record.contacts == ()
    assert record.decisions == len(steps) == len(witness.observations)
    times = [step.time for step in steps]
    np.testing.assert_allclose(times, 0.1 * np.arange(len(steps)), atol=1e-9)
    assert record.sim_time_s == pytest.approx(0.005 * record.physics_steps)
    assert times[-1] < record.sim_time_s <= times[-1] + 0.1 + 1e-9
    # A straight line of 0.6 m up to the tolerance.
    assert record.path_length_m == pytest.approx(0.5, abs=0.02)
    assert record.shortest_path_m == 0.5 and record.versions == {"a": "1"}
    assert record.optimality == pytest.approx(0.5 / record.path_length_m)
    assert record.min_clearance_m == pytest.approx(0.4, abs=2e-3)  # start, to the left wall
    assert record.min_clearance_m <= min(step.clearance for step in steps) + 1e-9
    assert record.tracking_rms_m < 0.02
    assert (record.risk_max, record.risk_mean, record.gate_vetoes) == (None, None, 0)
    assert 0.0 < record.plan_ms_p50 <= record.plan_ms_p99 and record.wall_s > 0.0


def test_observations_are_the_steps_poses(write_scenario: Writer) -> None:
    witness = Witness(Requirements(scan=False, obstacles=False))
    episode = watch(write_scenario("poses"), witness)
    for observation, step in zip(witness.observations, episode.steps, strict=True):
        assert (observation.stamp, observation.pose) == (step.time, step.pose)
        assert abs(observation.twist.v - step.twist.v) < 0.05
        assert abs(observation.twist.omega - step.twist.omega) < 0.3
    assert episode.steps[0].pose == Pose2D(0.5, 0.6, 0.0)
    assert witness.problem.goal == (1.1, 0.6) and witness.problem.goal_yaw is None


def test_contact_ends_the_episode(write_scenario: Writer) -> None:
    block = "[[static]]\npolygon = [[0.85, 0.4], [0.95, 0.4], [0.95, 0.8], [0.85, 0.8]]\n"
    witness = Witness(Requirements(scan=False, obstacles=False))
    record = watch(write_scenario("blocked", block), witness).record
    assert record.outcome is Outcome.CONTACT and record.optimality is None
    (contact,) = record.contacts
    assert contact.with_ == "static:0" and contact.at_fault
    assert contact.time_s == pytest.approx(record.sim_time_s)
    assert record.min_clearance_m == 0.0
    # It drove up to the block's face with its front side.
    assert record.path_length_m == pytest.approx(0.25, abs=0.01)


@pytest.mark.parametrize("at", [0.0, 0.35])
def test_planner_may_give_up(write_scenario: Writer, at: float) -> None:
    """At once too; the decision that gives up is not driven."""
    witness = Witness(Requirements(scan=False, obstacles=False), give_up_at=at)
    episode = watch(write_scenario("given_up"), witness)
    record = episode.record
    assert record.outcome is Outcome.STUCK and record.optimality is None
    assert record.decisions == len(episode.steps) == len(witness.observations) - 1
    assert record.sim_time_s == pytest.approx(0.1 * record.decisions)
    if at == 0.0:
        assert record.path_length_m == 0.0 and isnan(record.tracking_rms_m)


def test_time_runs_out(write_scenario: Writer) -> None:
    witness = Witness(Requirements(scan=False, obstacles=False))
    record = watch(write_scenario("short", time_limit=0.5), witness).record
    assert record.outcome is Outcome.TIMEOUT and record.decisions == 5
    assert record.sim_time_s == pytest.approx(0.5) and record.physics_steps == 100


def test_risk_of_the_record_is_that_of_the_decisions(write_scenario: Writer) -> None:
    episode = play_episode(load_scenario(write_scenario("risky", PILLAR)), "fuzzy", 0)
    risks = [step.decision.risk for step in episode.steps]
    assert episode.record.risk_max == max(risks)
    assert episode.record.risk_mean == pytest.approx(np.mean(risks))
    assert episode.record.gate_vetoes == sum(step.decision.vetoed for step in episode.steps)


class Restless:
    """A planner that draws from its random stream."""

    requires: ClassVar[Requirements] = Requirements(scan=False, obstacles=False)

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode."""
        self._rng = rng

    def decide(self, observation: Observation) -> Decision:
        """A random step."""
        dx, dy = self._rng.uniform(-0.02, 0.02, 2)
        place = (observation.pose.x + dx, observation.pose.y + dy)
        return Decision(place, Behaviour.GOAL_SEEKING)


def test_planner_draws_from_the_episodes_own_stream(write_scenario: Writer) -> None:
    scenario = load_scenario(write_scenario("random", time_limit=1.0))

    def places(seed: int) -> list[tuple[float, float]]:
        simulation = EpisodeSimulation(scenario, seed)
        episode = run_episode(simulation, Restless(), "restless", simulation.planner_rng, 1.0, {})
        return [step.decision.next_position for step in episode.steps]

    assert places(3) == places(3)
    assert places(3) != places(4)
