"""Episodes and benchmarks with imperfect sensors: what arrives where, and messages."""

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from math import hypot, radians

import numpy as np
import pyarrow.parquet as pq
import pytest
from test_benchmark import play_nothing
from test_episode import PILLAR, Witness
from test_same_seed import compare

from fuzzynav_mj.benchmark import EpisodeJob
from fuzzynav_mj.cli import main
from fuzzynav_mj.commands import bench as bench_command
from fuzzynav_mj.disturbance import PERFECT, Disturbance
from fuzzynav_mj.episode import Episode, run_episode
from fuzzynav_mj.planners.base import Requirements
from fuzzynav_mj.results import LOG, SUMMARY, TABLE, EpisodeKey
from fuzzynav_mj.runner import play_episode
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.sensing.disturbed import Sensors
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.tasks.streams import episode_streams
from fuzzynav_mj.types import EpisodeRecord

Writer = Callable[..., str]
EVERYTHING = Disturbance(0.01, 0.02, 1, 0.02, radians(5.0), 0.7)


def watch(path: str, disturbance: Disturbance) -> tuple[Episode, Witness]:
    """One episode under a witness of scan and obstacles."""
    witness = Witness(Requirements())
    simulation = EpisodeSimulation(load_scenario(path), 0, disturbance.friction)
    sensors = Sensors(disturbance, simulation.sensor_rng)
    rng = simulation.planner_rng
    return run_episode(simulation, witness, "witness", rng, 0.5, {}, sensors), witness


# The episode -----------------------------------------------------------------------------------


def test_perfect_sensors_are_the_default_to_the_last_bit(write_scenario: Writer) -> None:
    scenario = load_scenario(write_scenario("a", PILLAR))
    assert (
        compare(play_episode(scenario, "fuzzy", 3), play_episode(scenario, "fuzzy", 3, PERFECT))
        == ""
    )


def test_same_seed_same_episode_with_everything_disturbed(write_scenario: Writer) -> None:
    scenario = load_scenario(write_scenario("a", PILLAR))
    first, again, other = (play_episode(scenario, "fuzzy", seed, EVERYTHING) for seed in (3, 3, 4))
    assert compare(first, again) == ""
    assert first.steps[1].scan is not None and other.steps[1].scan is not None
    assert first.steps[1].scan.ranges.tobytes() != other.steps[1].scan.ranges.tobytes()


def test_delayed_planner_is_told_the_old_scan_and_the_present_pose(write_scenario: Writer) -> None:
    path = write_scenario("a", PILLAR)
    episode, witness = watch(path, Disturbance(delay_periods=1))
    stamps = [observation.scan.stamp for observation in witness.observations if observation.scan]
    times = [observation.stamp for observation in witness.observations]
    assert stamps == [0.0, *times[:-1]]
    for observation, step in zip(witness.observations, episode.steps, strict=True):
        assert observation.pose == step.pose == step.estimate
    first, second, third = witness.observations[:3]
    # The first scan is told twice; what it showed is brought up to the time each time.
    assert first.scan is second.scan is not third.scan
    assert first.perception is not None and second.perception is not None
    assert first.perception.visibility is second.perception.visibility


def test_obstacles_lie_where_the_robot_saw_them_from(write_scenario: Writer) -> None:
    """A late scan put at the present pose would lay the pillar up to 4 cm too far ahead."""
    _, witness = watch(write_scenario("a", PILLAR), Disturbance(delay_periods=1))
    left = [
        float(obstacle.points[:, 0].min())
        for observation in witness.observations
        if observation.perception
        for obstacle in observation.perception.obstacles
        if 1.4 < obstacle.nearest_point[0] < 1.75
    ]
    assert len(left) > 3
    assert min(left) > 1.5 - 1e-6 and min(left) == pytest.approx(1.5, abs=0.01)


def test_drifting_planner_is_told_dead_reckoning_and_the_wheels_follow_it(
    write_scenario: Writer,
) -> None:
    """The sensors' own law on the true poses; tracking is judged against what the wheels meant."""
    drift = Disturbance(drift_distance=0.1, drift_turn_rad=radians(10.0))
    episode, witness = watch(write_scenario("a"), drift)
    replayed = Sensors(drift, episode_streams(0).sensor)
    for observation, step in zip(witness.observations, episode.steps, strict=True):
        assert observation.pose == step.estimate == replayed.look(step.pose, None).estimate
    first, last = episode.steps[0], episode.steps[-1]
    assert first.estimate == first.pose and last.estimate is not None
    assert hypot(last.estimate.x - last.pose.x, last.estimate.y - last.pose.y) > 0.01
    assert 0.0 < episode.record.goal_distance_m <= 0.1  # the goal's tolerance, on the truth
    perfect, _ = watch(write_scenario("a"), PERFECT)
    assert episode.record.tracking_rms_m == pytest.approx(perfect.record.tracking_rms_m, abs=5e-4)


def test_distance_from_the_goal_is_told_where_it_was_not_reached(write_scenario: Writer) -> None:
    """Time for a start only: 0.6 m away, less the way driven straight at it."""
    episode, _ = watch(write_scenario("a", time_limit=0.5), PERFECT)
    left = 0.6 - episode.record.path_length_m
    assert episode.record.goal_distance_m == pytest.approx(left, abs=1e-3)


def test_friction_reaches_the_episode(write_scenario: Writer) -> None:
    path = write_scenario("a")
    slips = [watch(path, Disturbance(friction=f))[0].record.slip_max_mps for f in (1.0, 0.1)]
    assert slips[1] > 10 * slips[0]


# The command line ------------------------------------------------------------------------------


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> list[EpisodeKey]:
    """Plays nothing; lists the episodes that were asked for."""
    given: list[EpisodeKey] = []

    def run(jobs: Sequence[EpisodeJob], processes: int) -> Iterator[EpisodeRecord]:
        for job in jobs:
            given.append(job.key)
            yield replace(play_nothing(job), disturbance=job.disturbance)

    monkeypatch.setattr(bench_command, "run_jobs", run)
    return given


def test_the_record_says_what_was_wrong(write_scenario: Writer, capsys) -> None:
    options = ["--range-noise", "0.01", "--dropouts", "0.02", "--delay", "1", "--friction", "0.7"]
    options += ["--odometry-drift", "0.02", "5"]
    main(["run", write_scenario("a"), *options, "--json"])
    assert json.loads(capsys.readouterr().out)["disturbance"] == asdict(EVERYTHING)


def test_one_folder_holds_a_table_of_disturbances(
    write_scenario: Writer, tmp_path, played: list[EpisodeKey], capsys
) -> None:
    out = tmp_path / "out"
    command = ["bench", write_scenario("a"), "--episodes", "2", "--out", str(out), "--resume"]
    noisy = ["--range-noise", "0.01"]
    for options in (noisy, [], noisy):
        assert main([*command, *options]) == 0
    assert played == [
        EpisodeKey("a", "fuzzy", seed, Disturbance(range_noise_m=noise))
        for noise in (0.01, 0.0)
        for seed in (0, 1)
    ]
    rows = pq.read_table(out / TABLE).to_pylist()
    assert [(row["range_noise_m"], row["seed"]) for row in rows] == [
        (0.0, 0), (0.0, 1), (0.01, 0), (0.01, 1),
    ]  # fmt: skip
    assert {(row["dropouts"], row["delay_periods"], row["friction"]) for row in rows} == {
        (0.0, 0, 1.0)
    }
    summary = (out / SUMMARY).read_text()
    assert "| scenario | planner | disturbance |" in summary
    assert "| a | fuzzy | none | 2 / 2 |" in summary
    assert "| a | fuzzy | noise 0.01 m | 2 / 2 |" in summary


def test_rows_without_the_columns_were_played_with_perfect_sensors(
    write_scenario: Writer, tmp_path, played: list[EpisodeKey]
) -> None:
    out = tmp_path / "out"
    command = ["bench", write_scenario("a"), "--episodes", "1", "--out", str(out), "--resume"]
    assert main(command) == 0
    row = json.loads((out / LOG).read_text())
    older = {name: value for name, value in row.items() if name not in asdict(PERFECT)}
    (out / LOG).write_text(json.dumps(older) + "\n")
    assert main(command) == 0 and len(played) == 1
    assert "disturbance" not in (out / SUMMARY).read_text()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ["--range-noise", "0.2"],
            "argument --range-noise: given '0.2'; allowed is a number from 0 to 0.1 "
            "(see fuzzynav run --help)",
        ),
        (
            ["--dropouts", "2%"],
            "argument --dropouts: given '2%'; allowed is a number from 0 to 0.5 "
            "(see fuzzynav run --help)",
        ),
        (
            ["--delay", "2"],
            "argument --delay: given '2'; allowed is a whole number from 0 to 1 "
            "(see fuzzynav run --help)",
        ),
        (
            ["--odometry-drift", "0.01", "90"],
            "argument --odometry-drift: given '90'; allowed is FRACTION from 0 to 0.1 and DEG "
            "from 0 to 10 (see fuzzynav run --help)",
        ),
        (
            ["--friction", "nan"],
            "argument --friction: given 'nan'; allowed is a number from 0.1 to 1 "
            "(see fuzzynav run --help)",
        ),
    ],
)
def test_values_out_of_range_are_one_line(options: list[str], message: str, capsys) -> None:
    assert main(["run", "concave", *options]) == 2
    assert capsys.readouterr().err == f"fuzzynav: {message}\n"


def test_noise_reaches_the_planner_with_the_stated_size(write_scenario: Writer) -> None:
    """The pillar and the walls as a parked robot sees them: told ranges minus the true ones."""
    path = write_scenario("a", PILLAR)
    simulation = EpisodeSimulation(load_scenario(path), 0)
    truth = simulation.scan
    told, _ = watch(path, Disturbance(range_noise_m=0.02))
    scan = told.steps[0].scan
    assert scan is not None
    both = truth.hit & scan.hit
    errors = scan.ranges[both] - truth.ranges[both]
    assert errors.std() == pytest.approx(0.02, rel=4 / np.sqrt(2 * both.sum()))
