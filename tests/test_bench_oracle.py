"""Benchmarks with the oracle: every world judged once, and success among the possible."""

import json
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from test_benchmark import RECORD, play_nothing

from fuzzynav_mj.benchmark import EpisodeJob, WorldJob, judge_job
from fuzzynav_mj.cli import main
from fuzzynav_mj.commands import bench as bench_command
from fuzzynav_mj.metrics import record_to_row
from fuzzynav_mj.oracle import Possibility
from fuzzynav_mj.results import LOG, SUMMARY, TABLE, FailedEpisode, Row, possibility_columns
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.summary import HEADINGS, headings, markdown, summarise, table_cells
from fuzzynav_mj.types import EpisodeRecord, Outcome

Writer = Callable[..., str]

# Across the arena between start and goal; the second leaves 0.26 m, which fits a square of 0.20 m
# in some yaws but not the disc around it, 0.28 m across.
CLOSED = "[[static]]\npolygon = [[0.8, -0.1], [0.82, -0.1], [0.82, 1.3], [0.8, 1.3]]\n"
TIGHT = """
[[static]]
polygon = [[0.8, 0.0], [0.82, 0.0], [0.82, 0.47], [0.8, 0.47]]
[[static]]
polygon = [[0.8, 0.73], [0.82, 0.73], [0.82, 1.2], [0.8, 1.2]]
"""


@pytest.fixture
def judged(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, int]]:
    """Plays nothing, judges in this process, and lists the worlds that were judged."""
    worlds: list[tuple[str, int]] = []

    def play(jobs: Sequence[EpisodeJob], processes: int) -> Iterator[EpisodeRecord]:
        yield from map(play_nothing, jobs)

    def judge(
        jobs: Sequence[WorldJob], processes: int, work: Callable[[WorldJob], object]
    ) -> Iterator[object]:
        for job in jobs:
            worlds.append((job.scenario.name, job.seed))
            yield work(job)

    monkeypatch.setattr(bench_command, "run_jobs", play)
    monkeypatch.setattr(bench_command, "run_parallel", judge)
    return worlds


def columns(folder: Path) -> list[tuple[object, ...]]:
    rows = pq.read_table(folder / TABLE).to_pylist()
    names = ("scenario", "planner", "seed", "possible", "earliest_arrival_s")
    return [tuple(row[name] for name in names) for row in rows]


def test_verdicts_of_worlds_known_by_hand(write_scenario: Writer) -> None:
    """0.6 m straight ahead less the tolerance of 0.1 m at 0.5 m/s: 1 s."""
    found = {}
    for name, rest in (("free", ""), ("closed", CLOSED), ("tight", TIGHT)):
        job = WorldJob(load_scenario(write_scenario(name, rest)), 0)
        result = judge_job(job)
        assert not isinstance(result, FailedEpisode) and result[0] is job
        found[name] = possibility_columns(result[1])
    assert found["free"] == {"possible": "yes", "earliest_arrival_s": pytest.approx(1.0)}
    assert found["closed"] == {"possible": "no", "earliest_arrival_s": None}
    assert found["tight"] == {"possible": "unknown", "earliest_arrival_s": None}


def test_every_world_is_judged_once_for_all_planners(
    write_scenario: Writer, tmp_path: Path, judged: list[tuple[str, int]]
) -> None:
    names = [write_scenario("free"), write_scenario("closed", CLOSED)]
    options = ["--planner", "fuzzy", "multilayer", "--episodes", "2", "--out", str(tmp_path / "o")]
    assert main(["bench", *names, *options, "--oracle"]) == 0
    assert judged == [("closed", 0), ("closed", 1), ("free", 0), ("free", 1)]
    assert columns(tmp_path / "o") == [
        (name, planner, seed, verdict, arrival)
        for name, verdict, arrival in (("closed", "no", None), ("free", "yes", 1.0))
        for planner in ("fuzzy", "multilayer")
        for seed in (0, 1)
    ]
    summary = (tmp_path / "o" / SUMMARY).read_text()
    assert "## Impossible worlds" in summary
    assert "- closed, seed 0\n- closed, seed 1\n" in summary
    assert "free, seed" not in summary


def test_without_the_oracle_nothing_is_judged(
    write_scenario: Writer, tmp_path: Path, judged: list[tuple[str, int]]
) -> None:
    out = tmp_path / "o"
    assert main(["bench", write_scenario("free"), "--episodes", "1", "--out", str(out)]) == 0
    assert judged == [] and columns(out) == [("free", "fuzzy", 0, None, None)]
    assert "possible" not in (out / SUMMARY).read_text()


def test_resume_judges_what_is_missing_and_runs_nothing(
    write_scenario: Writer, tmp_path: Path, judged: list[tuple[str, int]]
) -> None:
    out = tmp_path / "o"
    command = ["bench", write_scenario("free"), "--out", str(out), "--resume"]
    assert main([*command, "--episodes", "2"]) == 0
    assert main([*command, "--episodes", "3", "--oracle"]) == 0
    assert judged == [("free", 0), ("free", 1), ("free", 2)]
    assert columns(out) == [("free", "fuzzy", seed, "yes", 1.0) for seed in range(3)]
    assert main([*command, "--episodes", "3", "--oracle"]) == 0
    assert len(judged) == 3
    # The last line of an episode counts: three as they were run, three with the verdict.
    assert [json.loads(line)["seed"] for line in (out / LOG).read_text().splitlines()] == [
        0, 1, 2, 0, 1, 2,
    ]  # fmt: skip


def test_episodes_of_another_file_are_not_judged_by_this_one(
    write_scenario: Writer, tmp_path: Path, judged: list[tuple[str, int]]
) -> None:
    out = tmp_path / "o"
    command = ["bench", write_scenario("a"), "--episodes", "1", "--out", str(out), "--resume"]
    assert main(command) == 0
    write_scenario("a", CLOSED)
    assert main([*command, "--oracle"]) == 0
    assert judged == [] and columns(out) == [("a", "fuzzy", 0, None, None)]


def test_an_oracle_that_fails_leaves_the_rows_as_they_are(
    write_scenario: Writer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    def fail(jobs: Sequence[WorldJob], processes: int, work: object) -> Iterator[FailedEpisode]:
        yield from (FailedEpisode(job.key, "it broke") for job in jobs)

    def play(jobs: Sequence[EpisodeJob], processes: int) -> Iterator[EpisodeRecord]:
        yield from map(play_nothing, jobs)

    monkeypatch.setattr(bench_command, "run_jobs", play)
    monkeypatch.setattr(bench_command, "run_parallel", fail)
    out = tmp_path / "o"
    command = ["bench", write_scenario("a"), "--episodes", "1", "--out", str(out), "--oracle"]
    assert main(command) == 0
    assert capsys.readouterr().err == "fuzzynav: the oracle failed: a, oracle, seed 0: it broke\n"
    assert columns(out) == [("a", "fuzzy", 0, None, None)]


def judged_row(outcome: Outcome, possible: str | None) -> Row:
    return record_to_row(replace(RECORD, outcome=outcome)) | {"possible": possible}


def test_success_among_the_possible_by_hand() -> None:
    reached, contact = Outcome.GOAL_REACHED, Outcome.CONTACT
    rows = [
        judged_row(reached, "yes"), judged_row(reached, "yes"), judged_row(contact, "yes"),
        judged_row(contact, "no"), judged_row(reached, "unknown"), judged_row(contact, None),
    ]  # fmt: skip
    (group,) = summarise(rows)
    assert (group.episodes, group.successes, group.judged) == (6, 3, 5)
    assert (group.possible, group.possible_successes) == (3, 2)
    # Wilson for 2 of 3: centre (2/3 + z^2/6) / (1 + z^2/3), half width likewise.
    assert group.possible_interval == (
        pytest.approx(0.2077, abs=1e-4), pytest.approx(0.9385, abs=1e-4),
    )  # fmt: skip
    assert headings([group]) == (*HEADINGS[:4], "of the possible %", *HEADINGS[4:])
    (cells,) = table_cells([group])
    assert cells[2:5] == ("3 / 6", "50.0 [18.8, 81.2]", "2 / 3: 66.7 [20.8, 93.9]")
    page = markdown([group], {}, [], rows)
    assert "## Impossible worlds" in page and "## Doubtful worlds" in page


def test_columns_of_a_verdict() -> None:
    assert possibility_columns(Possibility(True, True, 12.5, 10.0)) == {
        "possible": "yes", "earliest_arrival_s": 12.5,
    }  # fmt: skip
    assert possibility_columns(Possibility(True, False, math.inf, 10.0))["possible"] == "unknown"
    assert possibility_columns(Possibility(False, False, math.inf, math.inf))["possible"] == "no"
