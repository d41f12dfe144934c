"""`fuzzynav reproduce`: what it runs, in which order, and that nothing is run twice."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from test_benchmark import RECORD

from fuzzynav_mj.benchmark import EpisodeJob
from fuzzynav_mj.cli import main
from fuzzynav_mj.commands import bench as bench_command
from fuzzynav_mj.commands import reproduce as reproduce_command
from fuzzynav_mj.commands.reproduce import duration_text, expected_seconds
from fuzzynav_mj.planners import PLANNERS
from fuzzynav_mj.results import EpisodeKey, EpisodeLog
from fuzzynav_mj.scenarios import PAPER_SCENARIOS, load_scenario
from fuzzynav_mj.types import EpisodeRecord

PACE = {"fuzzy": 3.0, "multilayer": 1.0}  # s of an episode


class Stage:
    """Stands in for the processes, the oracle and the report."""

    def __init__(self) -> None:
        self.played: list[EpisodeKey] = []
        self.reported: list[Path] = []
        self.stop_after: int | None = None

    def run(self, jobs: Sequence[EpisodeJob], processes: int) -> Iterator[EpisodeRecord]:
        for job in jobs:
            if len(self.played) == self.stop_after:
                raise KeyboardInterrupt
            self.played.append(job.key)
            yield replace(
                RECORD, scenario=job.scenario.name, planner=job.planner, seed=job.seed,
                wall_s=PACE.get(job.planner, 2.0),
            )  # fmt: skip

    def report(self, folder: Path, out: Path | None, processes: int) -> int:
        self.reported.append(folder)
        return 0


@pytest.fixture
def stage(monkeypatch: pytest.MonkeyPatch) -> Stage:
    made = Stage()
    monkeypatch.setattr(bench_command, "run_jobs", made.run)
    monkeypatch.setattr(reproduce_command, "judge", lambda *_: None)
    monkeypatch.setattr(reproduce_command, "report", made.report)
    return made


def command(out: Path, *more: str) -> list[str]:
    planners = ["--planner", "fuzzy", "multilayer"]
    return ["reproduce", "--seed", "7", "--jobs", "2", "--out", str(out), *planners, *more]


def test_the_first_seed_tells_the_time_and_the_rest_goes_seed_by_seed(
    tmp_path: Path, stage: Stage, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(command(out, "--episodes", "31")) == 0
    groups = [(world, planner) for world in PAPER_SCENARIOS for planner in ("fuzzy", "multilayer")]
    assert stage.played == [
        EpisodeKey(world, planner, seed) for seed in range(7, 38) for world, planner in groups
    ]
    assert stage.reported == [out]
    # 30 seeds left, in each four worlds at 3 s and four at 1 s, two at a time: 240 s
    assert capsys.readouterr().err.splitlines() == [
        "fuzzynav: playing 8 of 248 episodes to tell how long all will take; "
        "Ctrl-C keeps what is finished",
        "fuzzynav: 240 episodes to play, 2 at a time: about 4 min",
    ]


def test_every_built_in_planner_and_the_papers_worlds_by_default(
    tmp_path: Path, stage: Stage
) -> None:
    assert main(["reproduce", "--episodes", "1", "--out", str(tmp_path / "out")]) == 0
    assert sorted(stage.played) == sorted(
        EpisodeKey(world, planner, 1000) for world in PAPER_SCENARIOS for planner in PLANNERS
    )


def test_an_interrupted_run_says_how_to_go_on_and_goes_on(
    tmp_path: Path, stage: Stage, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    stage.stop_after = 13
    assert main(command(out, "--episodes", "2")) == 130
    assert capsys.readouterr().err.splitlines()[-1] == (
        "fuzzynav: interrupted with 3 of 16 episodes to go; the same command goes on, "
        f"`fuzzynav report {out}` makes a page of what is there"
    )
    assert (out / "summary.md").is_file() and (out / "episodes.parquet").is_file()
    assert stage.reported == []
    stage.stop_after = None
    before = list(stage.played)
    assert main(command(out, "--episodes", "2")) == 0
    assert len(stage.played) == 16 and len(set(stage.played)) == 16
    assert stage.played[:13] == before
    assert capsys.readouterr().err.splitlines() == [
        f"fuzzynav: 13 of 16 episodes are in {out} already",
        "fuzzynav: 3 episodes to play, 2 at a time: about 2 s",  # 1 + 3 + 1 s by two
    ]
    assert main(command(out, "--episodes", "2")) == 0
    assert len(stage.played) == 16
    assert stage.reported == [out, out]


def test_an_unknown_planner_is_found_before_anything_is_run(
    tmp_path: Path, stage: Stage, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["reproduce", "--planner", "fuzy", "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err.startswith("fuzzynav: unknown planner 'fuzy': allowed are ")
    assert not (tmp_path / "out").exists() and stage.played == []


def test_times_of_unknown_groups_are_those_of_the_planner_or_of_all(
    tmp_path: Path, write_scenario: Callable[..., str]
) -> None:
    worlds = [load_scenario(write_scenario(name)) for name in ("a", "b")]
    with EpisodeLog(tmp_path / "out", resume=False) as log:
        jobs = [EpisodeJob(worlds[0], "fuzzy", 5)]
        assert expected_seconds(jobs, log) == 0.0
        for planner, seed, seconds in (("fuzzy", 0, 2.0), ("fuzzy", 1, 4.0), ("bug", 0, 9.0)):
            log.add(replace(RECORD, planner=planner, seed=seed, wall_s=seconds), "0")
        assert expected_seconds(jobs, log) == 3.0
        assert expected_seconds([*jobs, EpisodeJob(worlds[1], "bug", 0)], log) == 12.0
        assert expected_seconds([EpisodeJob(worlds[1], "orca", 0)], log) == 5.0


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.0, "1 s"), (89.4, "89 s"), (90.0, "2 min"), (5369.0, "89 min"), (12_000.0, "3 h 20 min")],
)
def test_durations_are_said_plainly(seconds: float, text: str) -> None:
    assert duration_text(seconds) == text
