"""`fuzzynav bench`: many episodes, on disk one by one, and their table."""

import sys
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from importlib.resources import files
from pathlib import Path

from fuzzynav_mj.benchmark import (
    EpisodeJob,
    WorldJob,
    episode_jobs,
    judge_job,
    run_jobs,
    run_parallel,
)
from fuzzynav_mj.commands.progress import note, progress_bar
from fuzzynav_mj.disturbance import PERFECT, Disturbance
from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.planners import make_planner
from fuzzynav_mj.planners.own import file_digest
from fuzzynav_mj.results import (
    SUMMARY,
    TABLE,
    EpisodeKey,
    EpisodeLog,
    FailedEpisode,
    Row,
    keep_scenario,
    key_of,
    possibility_columns,
    replace_file,
    write_table,
)
from fuzzynav_mj.runner import versions
from fuzzynav_mj.scenarios import PAPER_SCENARIOS, library_names, load_scenario
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.summary import headings, markdown, summarise, table_cells

INTERRUPTED = 130
FAILURES_SHOWN = 10


@dataclass(frozen=True, eq=False)
class Plan:
    """A benchmark to run.

    Attributes:
        scenarios: what to drive through.
        files: content of each scenario's file, by the scenario's name.
        planner_digests: SHA-256 of each planner's file, by its name; None for those that are no
            file of the user's own.
        jobs: the episodes.
    """

    scenarios: Sequence[Scenario]
    files: Mapping[str, bytes]
    planner_digests: Mapping[str, str | None]
    jobs: Sequence[EpisodeJob]

    @cached_property
    def scenario_digests(self) -> dict[str, str]:
        """SHA-256 of each scenario's file, by the scenario's name."""
        return {name: sha256(content).hexdigest() for name, content in self.files.items()}

    def missing(self, log: EpisodeLog) -> list[EpisodeJob]:
        """The episodes that are not in the log."""
        return [job for job in self.jobs if job.key not in log.rows]


def bench(
    names: Sequence[str],
    planners: Sequence[str],
    seeds: range,
    processes: int,
    folder: Path,
    resume: bool,
    oracle: bool = False,
    disturbance: Disturbance = PERFECT,
) -> int:
    """Run episodes, and write and print what they say.

    Args:
        names: names or files of scenarios; the paper's four where empty.
        planners: their names, or FILE.py:CLASS.
        seeds: one episode each.
        processes: how many episodes at a time.
        folder: for the results.
        resume: keep the episodes that the folder holds and run what is missing.
        oracle: judge whether each world leaves a contact-free run at all; of episodes that the
            folder holds from the same scenario files too.
        disturbance: what is wrong with the sensors and the floor.

    Returns:
        The exit status: 0 if every episode was run, 1 if some failed, 130 after Ctrl-C.

    Raises:
        FuzzyNavError: bad input.
    """
    plan = plan_benchmark(names, planners, seeds, disturbance)
    with EpisodeLog(folder, resume) as log:
        begin(plan, log)
        interrupted = False
        try:
            play(plan.missing(log), plan, processes, log)
            if oracle:
                judge(plan, processes, log)
        except KeyboardInterrupt:
            interrupted = True
            note("interrupted; --resume runs what is missing")
        conclude(log)
    if interrupted:
        return INTERRUPTED
    return 1 if plan.missing(log) else 0


def plan_benchmark(
    names: Sequence[str], planners: Sequence[str], seeds: range, disturbance: Disturbance = PERFECT
) -> Plan:
    """What `bench` runs for the same arguments.

    Raises:
        FuzzyNavError: bad input.
    """
    scenarios, contents = _load(names or PAPER_SCENARIOS)
    chosen = list(dict.fromkeys(planners))
    for planner in chosen:
        make_planner(planner)
    return Plan(
        scenarios=scenarios,
        files=contents,
        planner_digests={name: file_digest(name) for name in chosen},
        jobs=episode_jobs(scenarios, chosen, seeds, disturbance),
    )


def begin(plan: Plan, log: EpisodeLog) -> None:
    """Say what is different from the episodes that the folder holds, and keep the scenarios."""
    _mention_differences(log, plan)
    for name, content in plan.files.items():
        keep_scenario(log.folder, name, content)
    held = len(plan.jobs) - len(plan.missing(log))
    if held:
        note(f"{held} of {len(plan.jobs)} episodes are in {log.folder} already")


def _load(names: Sequence[str]) -> tuple[list[Scenario], dict[str, bytes]]:
    """The scenarios, and the content of each one's file by the scenario's name."""
    scenarios: list[Scenario] = []
    contents: dict[str, bytes] = {}
    given: dict[str, str] = {}
    for name in dict.fromkeys(names):
        scenario = load_scenario(name)
        if scenario.name in given:
            raise FuzzyNavError(
                f"{name}: name: given {scenario.name!r}, as in {given[scenario.name]}; "
                "allowed are different names in one benchmark"
            )
        given[scenario.name] = name
        scenarios.append(scenario)
        in_library = name in library_names()
        file = files("fuzzynav_mj.scenarios") / "library" / f"{name}.toml"
        content = file.read_bytes() if in_library else Path(name).read_bytes()
        contents[scenario.name] = content
    return scenarios, contents


def play(jobs: Sequence[EpisodeJob], plan: Plan, processes: int, log: EpisodeLog) -> None:
    """Run episodes of the plan and log each as it is finished."""
    progress = progress_bar("episodes", len(jobs))
    with closing(run_jobs(jobs, processes)) as results, progress as advance:
        for result in results:
            key = key_of(result)
            digests = plan.scenario_digests[key.scenario], plan.planner_digests[key.planner]
            log.add(result, *digests)
            advance()


def judge(plan: Plan, processes: int, log: EpisodeLog) -> None:
    """Complete the finished episodes by what the oracle says, once for every world."""
    digests = plan.scenario_digests
    by_name = {scenario.name: scenario for scenario in plan.scenarios}
    episodes: dict[tuple[str, int], list[EpisodeKey]] = {}
    for key, row in sorted(log.rows.items()):
        same_file = row.get("scenario_sha256") == digests.get(key.scenario)
        if same_file and row.get("possible") is None:
            episodes.setdefault((key.scenario, key.seed), []).append(key)
    jobs = [WorldJob(by_name[name], seed) for name, seed in episodes]
    progress = progress_bar("worlds", len(jobs))
    with closing(run_parallel(jobs, processes, judge_job)) as results, progress as advance:
        for result in results:
            if isinstance(result, FailedEpisode):
                note(f"the oracle failed: {result.key}: {result.reason}")
            else:
                job, found = result
                columns: Row = possibility_columns(found)
                of_world = episodes[job.scenario.name, job.seed]
                log.complete(dict.fromkeys(of_world, columns))
            advance()


def _mention_differences(log: EpisodeLog, plan: Plan) -> None:
    present = {f"version_{name}": text for name, text in versions().items()}
    others = {
        _versions_text({name: str(row.get(name)) for name in present}) for row in log.rows.values()
    } - {_versions_text(present)}
    for text in sorted(others):
        note(f"{log.folder} holds episodes of {text}; now {_versions_text(present)}")
    known = {"scenario": plan.scenario_digests, "planner": plan.planner_digests}
    for kind, by_name in known.items():
        for name, digest in by_name.items():
            held = (row for row in log.rows.values() if row[kind] == name)
            if any(row.get(f"{kind}_sha256") != digest for row in held):
                note(f"{log.folder} holds episodes of {name} from before its file was changed")


def _versions_text(row_versions: dict[str, str]) -> str:
    return ", ".join(
        f"{name.removeprefix('version_')} {text}" for name, text in row_versions.items()
    )


def conclude(log: EpisodeLog) -> None:
    """Write the table and the summary, and print the latter."""
    rows = log.sorted_rows()
    write_table(rows, log.folder / TABLE)
    summaries = summarise(rows)
    columns = [f"version_{name}" for name in versions()]
    ran_on = {_versions_text({name: str(row.get(name)) for name in columns}) for row in rows}
    page = markdown(summaries, log.failures, sorted(ran_on), rows)
    replace_file(log.folder / SUMMARY, page.encode())
    if sys.stdout.isatty():
        _print_table(headings(summaries), table_cells(summaries))
    else:
        print(page)
    print(f"results: {log.folder / TABLE}, {log.folder / SUMMARY}")
    failed = sorted(log.failures)
    for key in failed[:FAILURES_SHOWN]:
        note(f"failed: {key}: {log.failures[key]}")
    if len(failed) > FAILURES_SHOWN:
        note(f"failed: {len(failed) - FAILURES_SHOWN} more, see {log.folder / SUMMARY}")


def _print_table(names: Sequence[str], lines: Sequence[Sequence[str]]) -> None:
    """Print as many of the columns as the terminal is wide; the summary's file has them all."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    console = Console(highlight=False)
    columns = list(zip(names, *lines, strict=True))
    while sum(max(map(len, column)) + 3 for column in columns) + 1 > console.width:
        columns.pop()
    table = Table(box=SIMPLE_HEAD)
    for index, column in enumerate(columns):
        table.add_column(column[0], justify="left" if index < 2 else "right", no_wrap=True)
    for cells in zip(*(column[1:] for column in columns), strict=True):
        table.add_row(*cells)
    console.print(table)
