"""Benchmarks: rows that depend on the episodes alone, and nothing lost on the way to the disk."""

import json
import os
import signal
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from multiprocessing import active_children
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from fuzzynav_mj import runner
from fuzzynav_mj.benchmark import (
    RETRIES,
    THREADS,
    EpisodeJob,
    WorldJob,
    episode_jobs,
    play_job,
    run_jobs,
    run_parallel,
)
from fuzzynav_mj.cli import main
from fuzzynav_mj.commands import bench as bench_command
from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.metrics import record_to_row
from fuzzynav_mj.results import (
    COLUMNS,
    LOG,
    SUMMARY,
    TABLE,
    EpisodeKey,
    EpisodeLog,
    FailedEpisode,
    write_table,
)
from fuzzynav_mj.runner import versions
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.summary import markdown, summarise, table_cells
from fuzzynav_mj.types import Contact, EpisodeRecord, Outcome

DRAWN = """
[[random_moving]]
count = [1, 2]
radius = [0.05, 0.06]
vertices = [3, 5]
concave_fraction = 0.0
speed = [0.05, 0.1]
region = [[1.4, 0.1], [1.9, 0.1], [1.9, 1.1], [1.4, 1.1]]
"""

TIMINGS = ("plan_ms_p50", "plan_ms_p99", "wall_s")

RECORD = EpisodeRecord(
    scenario="a",
    planner="fuzzy",
    seed=0,
    outcome=Outcome.GOAL_REACHED,
    sim_time_s=4.0,
    path_length_m=2.0,
    shortest_path_m=1.0,
    optimality=0.5,
    min_clearance_m=0.1,
    contacts=(),
    risk_max=None,
    risk_mean=None,
    gate_vetoes=3,
    decisions=40,
    plan_ms_p50=1.0,
    plan_ms_p99=2.0,
    wall_s=0.1,
    physics_steps=800,
    tracking_rms_m=0.01,
    slip_max_mps=0.0,
    versions=versions(),
)


def play_nothing(job: EpisodeJob) -> EpisodeRecord:
    return replace(RECORD, scenario=job.scenario.name, planner=job.planner, seed=job.seed)


def die(folder: Path, seed: int, deaths: int, job: EpisodeJob) -> EpisodeRecord:
    """Kills its own process the first `deaths` times that it is given `seed`."""
    marks = list(folder.glob("death*"))
    if job.seed == seed and len(marks) < deaths:
        (folder / f"death{len(marks)}").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return play_nothing(job)


def linger(folder: Path, job: EpisodeJob) -> EpisodeRecord:
    """Takes half a minute, but for seed 0."""
    if job.seed > 0:
        time.sleep(30.0)
        (folder / f"finished{job.seed}").touch()
    return play_nothing(job)


def threads(job: WorldJob) -> tuple[str | None, ...]:
    """What the process that it runs in was told."""
    return tuple(os.environ.get(name) for name in THREADS)


def keys(results: Sequence[EpisodeRecord | FailedEpisode]) -> list[int]:
    return sorted(r.key.seed if isinstance(r, FailedEpisode) else r.seed for r in results)


@pytest.fixture
def played(monkeypatch) -> list[EpisodeKey]:
    """Replaces the pool of processes; lists the episodes that it was given."""
    given: list[EpisodeKey] = []

    def run(jobs: Sequence[EpisodeJob], processes: int) -> Iterator[EpisodeRecord]:
        for job in jobs:
            given.append(job.key)
            yield play_nothing(job)

    monkeypatch.setattr(bench_command, "run_jobs", run)
    return given


# Processes -------------------------------------------------------------------------------------


def test_rows_do_not_depend_on_the_number_of_processes(write_scenario, tmp_path, capsys):
    scenarios = [write_scenario("zig", DRAWN), write_scenario("ant", DRAWN)]

    def rows(jobs: int, names: list[str]) -> list[dict]:
        out = tmp_path / f"jobs{jobs}"
        options = ["--episodes", "2", "--seed", "5", "--jobs", str(jobs), "--out", str(out)]
        assert main(["bench", *names, *options]) == 0
        return pq.read_table(out / TABLE).drop_columns(list(TIMINGS)).to_pylist()

    one = rows(1, scenarios)
    assert [(row["scenario"], row["seed"]) for row in one] == [
        ("ant", 5), ("ant", 6), ("zig", 5), ("zig", 6),
    ]  # fmt: skip
    assert rows(2, scenarios[::-1]) == one
    assert capsys.readouterr().err == ""


def test_a_killed_process_costs_nothing_in_the_end(write_scenario, tmp_path):
    scenario = load_scenario(write_scenario("a"))
    jobs = episode_jobs([scenario], ["fuzzy"], range(5))
    results = list(run_jobs(jobs, 2, partial(die, tmp_path, 1, 1)))
    assert keys(results) == [0, 1, 2, 3, 4]
    assert all(isinstance(result, EpisodeRecord) for result in results)


def test_an_episode_that_kills_every_process_fails_by_name_and_alone(write_scenario, tmp_path):
    scenario = load_scenario(write_scenario("a"))
    jobs = episode_jobs([scenario], ["fuzzy"], range(4))
    results = list(run_jobs(jobs, 2, partial(die, tmp_path, 1, 99)))
    assert keys(results) == [0, 1, 2, 3]
    assert [result for result in results if isinstance(result, FailedEpisode)] == [
        FailedEpisode(EpisodeKey("a", "fuzzy", 1), "its process died 3 times")
    ]
    assert len(list(tmp_path.glob("death*"))) == 1 + RETRIES


def test_closing_stops_the_processes_in_the_middle_of_their_episodes(write_scenario, tmp_path):
    scenario = load_scenario(write_scenario("a"))
    results = run_jobs(episode_jobs([scenario], ["fuzzy"], range(9)), 1, partial(linger, tmp_path))
    assert next(results).seed == 0
    results.close()
    assert active_children() == []
    assert list(tmp_path.glob("finished*")) == []


def test_processes_do_linear_algebra_in_one_thread_or_as_the_user_says(write_scenario, monkeypatch):
    job = WorldJob(load_scenario(write_scenario("a")), 0)
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    before = dict(os.environ)
    assert list(run_parallel([job], 1, threads)) == [("1", "3")]
    assert dict(os.environ) == before


def test_an_error_in_an_episode_is_its_own(monkeypatch, write_scenario):
    def broken(*_):
        raise ZeroDivisionError("by\nzero")

    job = EpisodeJob(load_scenario(write_scenario("a")), "fuzzy", 3)
    monkeypatch.setattr(runner, "play_episode", broken)
    assert play_job(job) == FailedEpisode(job.key, "ZeroDivisionError: by zero")


# The command -----------------------------------------------------------------------------------


def test_resume_runs_what_is_missing_and_nothing_else(write_scenario, tmp_path, played, capsys):
    scenario, out = write_scenario("a"), tmp_path / "out"
    options = ["bench", scenario, "--planner", "multilayer", "fuzzy", "--out", str(out)]
    assert main([*options, "--episodes", "2"]) == 0
    log = (out / LOG).read_bytes()
    (out / LOG).write_bytes(log[: log.rindex(b'"seed"')])  # as a process leaves it that died
    played.clear()
    capsys.readouterr()
    assert main([*options, "--episodes", "3", "--resume"]) == 0
    assert played == [
        EpisodeKey("a", "multilayer", 2), EpisodeKey("a", "fuzzy", 1), EpisodeKey("a", "fuzzy", 2),
    ]  # fmt: skip
    assert capsys.readouterr().err == f"fuzzynav: 3 of 6 episodes are in {out} already\n"
    rows = pq.read_table(out / TABLE).to_pylist()
    assert [(row["planner"], row["seed"]) for row in rows] == [
        (planner, seed) for planner in ("fuzzy", "multilayer") for seed in range(3)
    ]
    assert len((out / LOG).read_text().splitlines()) == 6


def test_a_folder_with_results_is_refused_without_resume(write_scenario, tmp_path, played, capsys):
    options = ["bench", write_scenario("a"), "--episodes", "1", "--out", str(tmp_path / "out")]
    assert main(options) == 0
    played.clear()
    capsys.readouterr()
    assert main(options) == 2
    assert capsys.readouterr().err == (
        f"fuzzynav: {tmp_path / 'out'}: --out: given a folder that holds results; "
        "allowed is one without, or --resume to add what is missing\n"
    )
    assert played == []


def test_every_episode_is_on_disk_before_the_next_is_taken(write_scenario, tmp_path, monkeypatch):
    out, seen = tmp_path / "out", []

    def run(jobs: Sequence[EpisodeJob], processes: int) -> Iterator[EpisodeRecord]:
        for job in jobs:
            seen.append(len((out / LOG).read_text().splitlines()))
            yield play_nothing(job)

    monkeypatch.setattr(bench_command, "run_jobs", run)
    assert main(["bench", write_scenario("a"), "--episodes", "3", "--out", str(out)]) == 0
    assert seen == [0, 1, 2]


def test_an_interrupt_leaves_table_and_summary(write_scenario, tmp_path, monkeypatch, capsys):
    def run(jobs: Sequence[EpisodeJob], processes: int) -> Iterator[EpisodeRecord]:
        yield play_nothing(jobs[0])
        raise KeyboardInterrupt

    monkeypatch.setattr(bench_command, "run_jobs", run)
    out = tmp_path / "out"
    assert main(["bench", write_scenario("a"), "--out", str(out)]) == 130
    assert capsys.readouterr().err == "fuzzynav: interrupted; --resume runs what is missing\n"
    assert pq.read_table(out / TABLE).num_rows == 1
    assert "| a | fuzzy | 1 / 1 |" in (out / SUMMARY).read_text()


def test_a_failed_episode_is_reported_by_name_and_run_again(
    write_scenario, tmp_path, monkeypatch, capsys
):
    def run(jobs: Sequence[EpisodeJob], processes: int) -> Iterator[EpisodeRecord | FailedEpisode]:
        for job in jobs:
            yield FailedEpisode(job.key, "it broke") if job.seed == fails else play_nothing(job)

    monkeypatch.setattr(bench_command, "run_jobs", run)
    out = tmp_path / "out"
    options = ["bench", write_scenario("a"), "--episodes", "3", "--out", str(out)]
    fails = 1
    assert main(options) == 1
    assert capsys.readouterr().err == "fuzzynav: failed: a, fuzzy, seed 1: it broke\n"
    assert pq.read_table(out / TABLE).column("seed").to_pylist() == [0, 2]
    assert "- a, fuzzy, seed 1: it broke\n" in (out / SUMMARY).read_text()
    fails = -1
    assert main([*options, "--resume"]) == 0
    assert pq.read_table(out / TABLE).column("seed").to_pylist() == [0, 1, 2]
    assert "it broke" not in (out / SUMMARY).read_text()


def test_resuming_says_what_has_changed_since(write_scenario, tmp_path, played, capsys):
    out = tmp_path / "out"
    options = ["bench", write_scenario("a"), "--episodes", "1", "--out", str(out)]
    assert main(options) == 0
    log = (out / LOG).read_text()
    (out / LOG).write_text(log.replace(f'"{versions()["numpy"]}"', '"1.0"'))
    write_scenario("a", time_limit=20.0)
    capsys.readouterr()
    assert main([*options, "--resume"]) == 0
    ran_on, changed, held = capsys.readouterr().err.splitlines()
    assert ran_on.startswith(f"fuzzynav: {out} holds episodes of fuzzynav_mj ")
    assert "numpy 1.0; now fuzzynav_mj " in ran_on
    assert changed == f"fuzzynav: {out} holds episodes of a from before its file was changed"
    assert held == f"fuzzynav: 1 of 1 episodes are in {out} already"


def test_two_scenarios_of_one_name_are_refused(write_scenario, tmp_path, played, capsys):
    first, copy = write_scenario("a"), tmp_path / "copy.toml"
    copy.write_bytes(Path(first).read_bytes())
    assert main(["bench", first, str(copy), "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err == (
        f"fuzzynav: {copy}: name: given 'a', as in {first}; "
        "allowed are different names in one benchmark\n"
    )
    assert not (tmp_path / "out").exists()


def test_without_a_scenario_the_papers_four_are_run(tmp_path, played):
    assert main(["bench", "--episodes", "1", "--out", str(tmp_path / "out")]) == 0
    assert [key.scenario for key in played] == ["concave", "convex", "maze", "narrow"]


def test_an_unusable_folder_is_one_line(tmp_path, played, capsys):
    (tmp_path / "file").touch()
    assert main(["bench", "concave", "--out", str(tmp_path / "file")]) == 2
    assert capsys.readouterr().err == (
        f"fuzzynav: {tmp_path}/file: --out: given a folder that cannot be used (File exists); "
        "allowed is one that can be written\n"
    )


# The folder ------------------------------------------------------------------------------------


def test_a_torn_last_line_is_dropped_and_the_next_episode_starts_a_line(tmp_path):
    with EpisodeLog(tmp_path, resume=False) as log:
        log.add(RECORD, "0")
    whole = (tmp_path / LOG).read_bytes()
    (tmp_path / LOG).write_bytes(whole + whole[:-1])  # all of a line but its end
    with EpisodeLog(tmp_path, resume=True) as log:
        assert list(log.rows) == [EpisodeKey("a", "fuzzy", 0)]
        log.add(replace(RECORD, seed=1), "0")
    lines = (tmp_path / LOG).read_text().splitlines()
    assert [json.loads(line)["seed"] for line in lines] == [0, 1]


@pytest.mark.parametrize("line", ["{", "[]", "1", '{"scenario": "a"}', '{"seed": null}', "\xff"])
def test_a_bad_line_elsewhere_is_named(tmp_path, line):
    with EpisodeLog(tmp_path, resume=False) as log:
        log.add(RECORD, "0")
    whole = (tmp_path / LOG).read_bytes()
    (tmp_path / LOG).write_bytes(whole + line.encode("latin-1") + b"\n" + whole)
    with pytest.raises(FuzzyNavError) as caught:
        EpisodeLog(tmp_path, resume=True)
    assert str(caught.value) == (
        f"{tmp_path / LOG}: line 2: given text that is not an episode; "
        "allowed is one JSON object with scenario, planner and seed"
    )


def test_the_table_has_every_column_of_a_row_with_its_type(tmp_path):
    contact = Contact(time_s=1.0, with_="wall", robot_speed_mps=0.5, at_fault=True)
    touched = replace(RECORD, contacts=(contact,), outcome=Outcome.CONTACT)
    assert set(COLUMNS) == {
        *record_to_row(RECORD), "scenario_sha256", "planner_sha256", "possible",
        "earliest_arrival_s",
    }  # fmt: skip
    for record in (RECORD, touched):
        row = record_to_row(record) | {"scenario_sha256": "0", "planner_sha256": None}
        row |= {"possible": "yes", "earliest_arrival_s": 3.5}
        write_table([row], tmp_path / TABLE)
        table = pq.read_table(tmp_path / TABLE)
        assert tuple(table.column_names) == COLUMNS
        assert table.to_pylist() == [row]
        types = {name: str(table.schema.field(name).type) for name in COLUMNS}
        assert types["contact_at_fault"] == "bool"
        assert {types[n] for n in ("scenario", "contact_with", "version_numpy")} == {"string"}
        assert {types[n] for n in ("seed", "contacts_count", "decisions")} == {"int64"}
        assert {types[n] for n in ("risk_max", "optimality", "wall_s")} == {"double"}


def test_the_summary_counts_and_averages_by_hand():
    contact = Contact(time_s=1.0, with_="moving:0", robot_speed_mps=0.0, at_fault=False)
    rows = [
        record_to_row(RECORD),
        record_to_row(replace(RECORD, path_length_m=4.0, optimality=0.25, sim_time_s=6.0)),
        record_to_row(
            replace(RECORD, outcome=Outcome.CONTACT, contacts=(contact,), optimality=None)
        ),
        record_to_row(
            replace(
                RECORD, outcome=Outcome.TIMEOUT, gate_vetoes=0, plan_ms_p99=9.0, optimality=None
            )
        ),
    ]
    (group,) = summarise(rows)
    assert (group.episodes, group.successes) == (4, 2)
    # Wilson for 2 of 4: 0.5 -+ 1.96 sqrt(1/16 + 1.96^2 / 64) / (1 + 1.96^2 / 4)
    assert group.interval == (pytest.approx(0.1500, abs=1e-4), pytest.approx(0.8500, abs=1e-4))
    assert (group.path_length.mean, group.path_length.std) == (3.0, pytest.approx(2**0.5))
    assert (group.optimality.mean, group.sim_time.mean) == (0.375, 5.0)
    assert (group.contacts, group.contacts_at_fault) == (1, 0)
    assert (group.vetoes, group.plan_ms_p50, group.plan_ms_p99) == (2.25, 1.0, 2.0)
    assert table_cells([group]) == [
        (
            "a", "fuzzy", "2 / 4", "50.0 [15.0, 85.0]", "3.00 ± 1.41", "5.0 ± 1.4",
            "1 (0 at fault)", "37.5 ± 17.7", "2.2", "1.0 / 2.0",
        )
    ]  # fmt: skip


def test_a_group_without_success_has_no_path(tmp_path):
    row = record_to_row(replace(RECORD, outcome=Outcome.STUCK, optimality=None))
    (cells,) = table_cells(summarise([row]))
    assert cells[2:6] == ("0 / 1", "0.0 [0.0, 79.3]", "-", "-")
    page = markdown(summarise([row]), {EpisodeKey("a", "fuzzy", 7): "it broke"}, ["x 1.0"])
    assert "Ran on x 1.0." in page
    assert "- a, fuzzy, seed 7: it broke" in page
