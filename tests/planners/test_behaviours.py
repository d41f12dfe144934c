"""Every behaviour of the record, each in a scene that calls for it."""

from dataclasses import replace
from math import cos, hypot, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest
from short_episodes import HEADER, box, disc, play

from fuzzynav_mj.episode import Episode, run_episode
from fuzzynav_mj.planners import make_planner
from fuzzynav_mj.planners.base import NavigationProblem, Observation
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.types import Behaviour, Decision, Outcome, StepRecord


def behaviours(episode: Episode) -> list[Behaviour]:
    """What the robot did, step by step."""
    return [step.decision.behaviour for step in episode.steps]


def check_names(episode: Episode) -> None:
    """What a behaviour's name says of the decision, at every step."""
    for step in episode.steps:
        decision, perception = step.decision, step.perception
        candidates = decision.candidates
        assert candidates is not None and perception is not None
        mine = (candidates.positions == decision.next_position).all(axis=1)
        moving = [obstacle for obstacle in perception.obstacles if obstacle.dynamic]
        if decision.behaviour is Behaviour.EVASION:
            assert not candidates.admissible.any()
        else:
            assert candidates.admissible[mine].any()
        if decision.behaviour is Behaviour.DYNAMIC_AVOIDANCE:
            assert any(obstacle.approaching for obstacle in moving)
        if decision.behaviour is Behaviour.MOVING_AWAY:
            assert moving and not any(obstacle.approaching for obstacle in moving)


def arrived(episode: Episode) -> None:
    """The goal was reached, and the names are right."""
    assert episode.record.outcome is Outcome.GOAL_REACHED
    check_names(episode)


def test_goal_seeking_on_open_ground(tmp_path: Path) -> None:
    episode = play(tmp_path, start=(0.5, 1.0, 0.0), goal=(2.5, 1.0))
    arrived(episode)
    assert set(behaviours(episode)) == {Behaviour.GOAL_SEEKING}
    # 1.9 m at the top speed and a quarter of a second to reach it, to the next decision.
    assert episode.record.sim_time_s <= 1.9 / 0.5 + 0.125 + 0.2
    assert episode.record.path_length_m == pytest.approx(1.9, abs=0.06)
    assert max(abs(step.pose.y - 1.0) for step in episode.steps) < 2e-3


def test_static_avoidance_round_a_block(tmp_path: Path) -> None:
    block = box(1.2, 0.6, 1.5, 1.3)
    episode = play(tmp_path, block, start=(0.5, 1.0, 0.0), goal=(2.5, 1.0))
    arrived(episode)
    assert Behaviour.STATIC_AVOIDANCE in behaviours(episode)
    beside = [step.pose.y for step in episode.steps if 1.2 < step.pose.x < 1.5]
    assert beside and all(y < 0.5 or y > 1.4 for y in beside)


def test_boundary_following_out_of_a_trap(tmp_path: Path) -> None:
    trap = (box(2.5, 0.8, 2.6, 3.2), box(1.3, 3.1, 2.6, 3.2), box(1.3, 0.8, 2.6, 0.9))
    episode = play(tmp_path, *trap, start=(1.8, 2.0, 0.0), goal=(4.0, 2.0), size=(5.0, 4.0))
    arrived(episode)
    following = [
        step.pose for step in episode.steps
        if step.decision.behaviour is Behaviour.BOUNDARY_FOLLOWING
    ]  # fmt: skip
    away = [hypot(4.0 - pose.x, 2.0 - pose.y) for pose in following]
    assert len(away) > 10 and max(away) > away[0] + 0.3  # it led away from the goal


def test_dynamic_avoidance_of_one_that_comes_head_on(tmp_path: Path) -> None:
    oncoming = disc(0.15, 0.5, (4.5, 2.0), (0.3, 2.0))
    episode = play(tmp_path, oncoming, start=(0.5, 2.0, 0.0), goal=(4.5, 2.2), size=(5.0, 4.0))
    arrived(episode)
    assert Behaviour.DYNAMIC_AVOIDANCE in behaviours(episode)
    assert max(abs(step.pose.y - 2.0) for step in episode.steps) > 0.15


def test_moving_away_behind_a_slow_leader(tmp_path: Path) -> None:
    """In a corridor too narrow to overtake: the one ahead hinders, but does not come nearer."""
    corridor = (box(0.0, 0.0, 4.0, 0.7), box(0.0, 1.3, 4.0, 2.0))
    leader = disc(0.15, 0.2, (1.2, 1.0), (3.8, 1.0))
    episode = play(
        tmp_path, *corridor, leader, start=(0.4, 1.0, 0.0), goal=(2.6, 1.0), size=(4.0, 2.0)
    )
    arrived(episode)
    assert behaviours(episode).count(Behaviour.MOVING_AWAY) > 10
    # At the end it moves at the leader's pace.
    assert np.mean([step.twist.v for step in episode.steps[-20:]]) == pytest.approx(0.2, abs=0.05)


def test_waiting_for_one_that_crosses_the_exit(tmp_path: Path) -> None:
    corridor = (box(0.0, 0.0, 1.4, 0.75), box(0.0, 1.25, 1.4, 2.0))
    crossing = disc(0.3, 0.2, (1.85, 0.35), (1.85, 1.65), repeat="reverse")
    episode = play(tmp_path, *corridor, crossing, start=(0.4, 1.0, 0.0), goal=(2.6, 1.0))
    arrived(episode)
    waiting = [step for step in episode.steps if step.decision.behaviour is Behaviour.WAITING]
    assert waiting
    for step in waiting:
        assert step.perception is not None
        assert any(obstacle.dynamic for obstacle in step.perception.obstacles)


def test_evasion_in_a_dead_end(tmp_path: Path) -> None:
    """What comes in leaves no admissible motion; it turns round a hand's breadth away."""
    dead_end = (box(0.0, 0.0, 1.4, 0.78), box(0.0, 1.22, 1.4, 2.0))
    intruder = disc(0.15, 0.3, (2.4, 1.0), (0.45, 1.0), (2.4, 1.0), (2.4, 0.3))
    episode = play(
        tmp_path, *dead_end, intruder, start=(0.2, 1.0, 0.0), goal=(2.6, 1.0), time_limit=9.0
    )
    assert Behaviour.EVASION in behaviours(episode)
    check_names(episode)


@pytest.mark.parametrize("goal_yaw", [pi / 2, -2.0, pi])
def test_turning_on_the_goal(tmp_path: Path, goal_yaw: float) -> None:
    episode = play(tmp_path, start=(0.5, 1.0, 0.0), goal=(2.0, 1.0, goal_yaw))
    arrived(episode)
    turning = [
        step for step in episode.steps if step.decision.behaviour is Behaviour.TURNING_ON_GOAL
    ]
    assert turning
    assert behaviours(episode)[-1] is Behaviour.TURNING_ON_GOAL
    for step in turning:
        assert hypot(step.pose.x - 2.0, step.pose.y - 1.0) < 0.25
    assert abs((turning[-1].pose.yaw - goal_yaw + pi) % (2 * pi) - pi) < 0.5


class Parked:
    """The planner with the robot's own place as its goal."""

    def __init__(self, name: str) -> None:
        self._planner = make_planner(name)
        self.requires = self._planner.requires

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode; where that is, the first observation tells."""
        self._problem, self._rng = problem, rng
        self._begun = False

    def decide(self, observation: Observation) -> Decision:
        """The planner's decision."""
        if not self._begun:
            here = (observation.pose.x, observation.pose.y)
            self._planner.reset(replace(self._problem, goal=here), self._rng)
            self._begun = True
        return self._planner.decide(observation)


def park(folder: Path, mover: str, yaw: float, time_limit: float) -> Episode:
    """An episode of a robot that would rather stay in the middle of a room of 6 m."""
    path = folder / "world.toml"
    header = HEADER.format(
        name="parked", width=6.0, height=6.0, time_limit=time_limit,
        start=[3.0, 3.0, yaw], goal=[5.5, 5.5],
    )  # fmt: skip
    path.write_text(header + mover)
    simulation = EpisodeSimulation(load_scenario(str(path)), 0)
    return run_episode(simulation, Parked("fuzzy"), "parked", simulation.planner_rng, 1.0, {})


def nearest_approach(steps: tuple[StepRecord, ...]) -> float:
    """How near the mover would have come to the parking place, m."""
    return min(float(np.hypot(*(step.mover_positions[0] - 3.0))) for step in steps)


@pytest.mark.parametrize("aside", [0.0, 0.1])
@pytest.mark.parametrize("degrees", [0.0, 50.0, 130.0, 180.0, 260.0])
def test_parked_robot_makes_way(tmp_path: Path, degrees: float, aside: float) -> None:
    """Run into at the robot's own top speed, from all sides: it gets out of the way in time."""
    c, s = cos(radians(degrees)), sin(radians(degrees))
    begin = (3.0 + 1.2 * c - aside * s, 3.0 + 1.2 * s + aside * c)
    end = (3.0 - 2.2 * c - aside * s, 3.0 - 2.2 * s + aside * c)
    episode = park(tmp_path, disc(0.15, 0.5, begin, end), yaw=0.0, time_limit=6.5)
    assert episode.record.outcome is Outcome.TIMEOUT
    assert not episode.record.contacts and episode.record.min_clearance_m > 0.0
    assert nearest_approach(episode.steps) < 0.15
    # And back to its place when the way is clear.
    last = episode.steps[-1].pose
    assert hypot(last.x - 3.0, last.y - 3.0) < 0.3


@pytest.mark.parametrize("aside", [-0.15, 0.0, 0.07])
@pytest.mark.parametrize("start", [0.5, 0.72, 0.95])
def test_head_on_in_the_open(tmp_path: Path, start: float, aside: float) -> None:
    oncoming = disc(0.15, 0.5, (5.5, 2.0 + aside), (0.3, 2.0 + aside))
    episode = play(tmp_path, oncoming, start=(start, 2.0, 0.0), goal=(5.5, 2.0), size=(6.0, 4.0))
    arrived(episode)
    assert episode.record.min_clearance_m > 0.0


@pytest.mark.parametrize("start", [0.6, 0.9, 1.2, 1.5, 1.8])
def test_crossing_in_the_open(tmp_path: Path, start: float) -> None:
    crossing = disc(0.15, 0.5, (3.0, 0.3), (3.0, 3.7), repeat="reverse")
    episode = play(tmp_path, crossing, start=(start, 2.0, 0.0), goal=(5.0, 2.0), size=(6.0, 4.0))
    arrived(episode)
    assert episode.record.min_clearance_m > 0.0
