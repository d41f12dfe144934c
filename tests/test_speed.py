"""Timing from outside: it changes no bit, books every stage, and its figures add up."""

import json
from collections.abc import Callable
from itertools import count, pairwise
from math import ceil, hypot

import pytest
from test_same_seed import difference

from fuzzynav_mj import speed as speed_module
from fuzzynav_mj import timed as timed_module
from fuzzynav_mj.cli import main
from fuzzynav_mj.commands.speed import lines
from fuzzynav_mj.episode import run_episode
from fuzzynav_mj.planners.multilayer import MultilayerPlanner
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.runner import play_episode
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.speed import STAGES, EpisodeSpeed, crowd, time_episode
from fuzzynav_mj.timed import (
    IN_TURNS,
    BareSteps,
    Stopwatch,
    TimedGate,
    TimedPlanner,
    TimedSimulation,
)
from fuzzynav_mj.types import Outcome

Writer = Callable[..., str]
PILLAR = "[[static]]\npolygon = [[1.5, 0.9], [1.7, 0.9], [1.6, 1.1]]\n"


def ticks() -> Callable[[], float]:
    """A clock that advances by one second each time it is read."""
    counter = count()
    return lambda: float(next(counter))


def test_timing_changes_no_bit_of_the_episode(write_scenario: Writer) -> None:
    scenario = load_scenario(write_scenario("a", PILLAR))
    watch = Stopwatch(ticks())
    simulation = TimedSimulation(scenario, 3, watch)
    planner = TimedPlanner(MultilayerPlanner(TimedGate.make(watch)), watch)
    timed = run_episode(simulation, planner, "fuzzy", simulation.planner_rng, 0.0, {})
    assert difference(timed.steps, play_episode(scenario, "fuzzy", 3).steps) == ""


def test_every_stage_is_booked_by_a_clock_of_ticks(write_scenario: Writer) -> None:
    """One tick for each drive and each scan; three reads of the gate's clock at least; the rest
    adds up to the whole."""
    scenario = load_scenario(write_scenario("a", PILLAR))
    found = time_episode(scenario, 3, 1, ticks())
    record = play_episode(scenario, "fuzzy", 3).record
    assert (found.decisions, found.sim_time) == (record.decisions, record.sim_time_s)
    assert found.stages["physics"] == found.stages["rays"] == found.decisions
    assert found.stages["prediction"] == found.decisions
    assert found.stages["fuzzy"] >= found.decisions
    assert tuple(found.stages) == STAGES
    assert sum(found.stages.values()) == found.total
    assert found.bare == ceil(record.physics_steps / IN_TURNS)
    assert found.ratio == found.total / found.bare
    assert found.real_time_factor == found.sim_time / found.total


def test_bare_steps_are_as_many_as_the_episodes_and_taken_in_turns_with_them(
    write_scenario: Writer, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = load_scenario(write_scenario("a"))
    taken = []
    monkeypatch.setattr(timed_module.mujoco, "mj_step", lambda model, data: taken.append(data))
    bare = BareSteps(scenario, 0, Stopwatch(ticks()))
    bare.owe(IN_TURNS - 1)
    assert len(taken) == 0
    bare.owe(20)
    assert len(taken) == IN_TURNS + 19
    bare.owe(7)
    bare.take()
    assert len(taken) == IN_TURNS + 26
    taken.clear()
    time_episode(scenario, 3, 1, ticks())
    assert len(taken) == play_episode(scenario, "fuzzy", 3).record.physics_steps


@pytest.mark.parametrize("many", [30, 300])
def test_crowds_have_so_many_pillars_with_room_between_them(many: int) -> None:
    scenario = crowd(many)
    places = sorted(shape.circle[:2] for shape in scenario.static if shape.circle)
    assert len(places) == many
    x_min, y_min, x_max, y_max = scenario.bounds
    assert all(x_min < x < x_max and y_min < y < y_max for x, y in places)
    start = scenario.start
    assert min(hypot(x - start.x, y - start.y) for x, y in places) > 0.5
    gaps = [
        hypot(x - u, y - v) - 0.1
        for index, (x, y) in enumerate(places)
        for u, v in places[index + 1 :]
    ]
    assert min(gaps) > 2 * DEFAULT_ROBOT.half_diagonal


def test_the_smaller_crowd_is_part_of_the_larger() -> None:
    few, many = ({shape.circle for shape in crowd(n).static} for n in (30, 300))
    assert few < many


def test_text_gives_times_for_each_decision_period() -> None:
    """1.2 s in 400 decisions are 3 ms each; 100 s simulated in them are a factor of 83."""
    stages = dict.fromkeys(STAGES, 0.2)
    episode = EpisodeSpeed(
        "a", Outcome.GOAL_REACHED, 100.0, 1.2, 0.08, 15.0, stages, 400, 0.002, 0.004, 0.03
    )
    found = {"clock": "cpu", "repeats": 3, "seed": 7, "single_risk": 5e-6}
    found |= {"crowd_few": 0.001, "crowd_many": 0.0015, "crowd_ratio": 1.5}
    told = lines([episode], found)
    assert told[0] == (
        "ms of processor time for each decision period, median of 3; seed 7, planner fuzzy"
    )
    cells = {line[:20].strip(): line[20:].strip() for line in told[1:-2]}
    assert cells["physics"] == "0.500" and cells["whole episode"] == "3.000"
    assert cells["bare mj_step"] == "0.200" and cells["ratio of the two"] == "15.0"
    assert cells["real-time factor"] == "83"
    assert told[-2] == "one fuzzy risk: 5.0 us"
    assert told[-1] == "a decision among 300 static obstacles: 1.500 ms, 1.50 times one among 30"
    assert len({len(line) for line, _ in pairwise(told[2:-2])}) == 1


def test_json_is_one_object(
    write_scenario: Writer, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(speed_module, "CROWD_DECISIONS", 3)
    scenario = write_scenario("a")
    assert main(["speed", scenario, scenario, "--repeats", "1", "--cpu", "--json"]) == 0
    output = capsys.readouterr()
    found = json.loads(output.out)
    assert output.err == "" and len(output.out.splitlines()) == 1
    (episode,) = found["episodes"]
    assert (episode["scenario"], episode["outcome"]) == ("a", "goal_reached")
    assert sum(episode["stages"].values()) == pytest.approx(episode["total"])
    assert found["crowd_ratio"] == found["crowd_many"] / found["crowd_few"]
    assert (found["clock"], found["repeats"], found["seed"]) == ("cpu", 1, 0)


def test_bad_input_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["speed", "concave", "--repeats", "0"]) == 2
    assert capsys.readouterr().err == (
        "fuzzynav: argument --repeats: given '0'; allowed is a whole number from 1 to 100 "
        "(see fuzzynav speed --help)\n"
    )
