"""`fuzzynav bench`: many episodes, on disk one by one, and their table."""

import sys
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
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
from fuzzynav_mj.commands.progress import progress_bar
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


@dataclass(frozen=True, slots=True)
class Digests:
    """SHA-256 of the files that episodes depend on.

    Attributes:
        scenarios: by the scenario's name.
        planners: by the planner's name; None for those that are no file of the user's own.
    """

    scenarios: Mapping[str, str]
    planners: Mapping[str, str | None]


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
    scenarios, contents = _load(names or PAPER_SCENARIOS)
    scenario_digests = {name: sha256(content).hexdigest() for name, content in contents.items()}
    chosen = list(dict.fromkeys(planners))
    for planner in chosen:
        make_planner(planner)
    digests = Digests(scenario_digests, {name: file_digest(name) for name in chosen})
    with EpisodeLog(folder, resume) as log:
        _mention_differences(log, digests)
        for name, content in contents.items():
            keep_scenario(folder, name, content)
        jobs = episode_jobs(scenarios, chosen, seeds, disturbance)
        missing = [job for job in jobs if job.key not in log.rows]
        if len(missing) < len(jobs):
            _note(f"{len(jobs) - len(missing)} of {len(jobs)} episodes are in {folder} already")
        interrupted = False
        try:
            _run(missing, processes, log, digests)
            if oracle:
                _judge(scenarios, processes, log, scenario_digests)
        except KeyboardInterrupt:
            interrupted = True
            _note("interrupted; --resume runs what is missing")
        _report(log)
    if interrupted:
        return INTERRUPTED
    return 0 if all(job.key in log.rows for job in jobs) else 1


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


def _run(jobs: Sequence[EpisodeJob], processes: int, log: EpisodeLog, digests: Digests) -> None:
    progress = progress_bar("episodes", len(jobs))
    with closing(run_jobs(jobs, processes)) as results, progress as advance:
        for result in results:
            key = key_of(result)
            log.add(result, digests.scenarios[key.scenario], digests.planners[key.planner])
            advance()


def _judge(
    scenarios: Sequence[Scenario], processes: int, log: EpisodeLog, digests: dict[str, str]
) -> None:
    """Complete the finished episodes by what the oracle says, once for every world."""
    by_name = {scenario.name: scenario for scenario in scenarios}
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
                _note(f"the oracle failed: {result.key}: {result.reason}")
            else:
                job, found = result
                columns: Row = possibility_columns(found)
                of_world = episodes[job.scenario.name, job.seed]
                log.complete(dict.fromkeys(of_world, columns))
            advance()


def _mention_differences(log: EpisodeLog, digests: Digests) -> None:
    present = {f"version_{name}": text for name, text in versions().items()}
    others = {
        _versions_text({name: str(row.get(name)) for name in present}) for row in log.rows.values()
    } - {_versions_text(present)}
    for text in sorted(others):
        _note(f"{log.folder} holds episodes of {text}; now {_versions_text(present)}")
    known = {"scenario": digests.scenarios, "planner": digests.planners}
    for kind, by_name in known.items():
        for name, digest in by_name.items():
            held = (row for row in log.rows.values() if row[kind] == name)
            if any(row.get(f"{kind}_sha256") != digest for row in held):
                _note(f"{log.folder} holds episodes of {name} from before its file was changed")


def _versions_text(row_versions: dict[str, str]) -> str:
    return ", ".join(
        f"{name.removeprefix('version_')} {text}" for name, text in row_versions.items()
    )


def _report(log: EpisodeLog) -> None:
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
        _note(f"failed: {key}: {log.failures[key]}")
    if len(failed) > FAILURES_SHOWN:
        _note(f"failed: {len(failed) - FAILURES_SHOWN} more, see {log.folder / SUMMARY}")


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


def _note(text: str) -> None:
    print(f"fuzzynav: {text}", file=sys.stderr)
