"""Which episodes a report plays once more, and from which scenario files."""

from collections.abc import Iterator
from hashlib import sha256
from importlib.resources import files
from pathlib import Path

from fuzzynav_mj.benchmark import EpisodeJob
from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.reporting.contents import Contents
from fuzzynav_mj.reporting.traces import Trace
from fuzzynav_mj.results import SCENARIOS, Row
from fuzzynav_mj.scenarios import library_names
from fuzzynav_mj.scenarios.loading import parse_scenario
from fuzzynav_mj.scenarios.schema import Scenario

SAME_LENGTH = 1e-6  # m


def replay_jobs(contents: Contents) -> tuple[list[EpisodeJob], list[str]]:
    """The first seed of every world with every planner that has an episode of it.

    Returns:
        The episodes, and a sentence for each world that cannot be played.
    """
    jobs: list[EpisodeJob] = []
    notes: list[str] = []
    for name in contents.scenarios:
        rows = [row for row in contents.rows if row["scenario"] == name]
        seed = min(row["seed"] for row in rows)
        first = next(row for row in rows if row["seed"] == seed)
        try:
            scenario = _scenario_of(contents.folder.path, first)
        except FuzzyNavError as error:
            notes.append(f"No ways through {name}: {error}.")
            continue
        present = {row["planner"] for row in rows}
        jobs += [
            EpisodeJob(scenario, planner, seed, contents.disturbance)
            for planner in contents.planners
            if planner in present
        ]
    return jobs, notes


def differences(contents: Contents, traces: list[Trace]) -> Iterator[str]:
    """A sentence for each episode that did not come out as its row says."""
    rows = {(row["scenario"], row["planner"], row["seed"]): row for row in contents.rows}
    for trace in traces:
        job = trace.job
        row = rows.get((job.scenario.name, job.planner, job.seed))
        if row is None:
            continue
        apart = abs(row["path_length_m"] - trace.path_length_m)
        if row["outcome"] != trace.outcome.value or apart > SAME_LENGTH:
            yield (
                f"{job.key}: played once more it ended with {trace.outcome.value} after "
                f"{trace.path_length_m:.2f} m, but its row says {row['outcome']} after "
                f"{row['path_length_m']:.2f} m; the program or the planner has changed since."
            )


def _scenario_of(folder: Path, row: Row) -> Scenario:
    """The scenario of a row, from the copy that the benchmark keeps or from the library."""
    digest, name = row.get("scenario_sha256"), row["scenario"]
    for copy in sorted((folder / SCENARIOS).glob("*.toml")):
        content = copy.read_bytes()
        if sha256(content).hexdigest() == digest:
            return parse_scenario(content, str(copy))
    if name not in library_names():
        raise FuzzyNavError(f"its file is not in {folder / SCENARIOS}")
    content = (files("fuzzynav_mj.scenarios") / "library" / f"{name}.toml").read_bytes()
    if sha256(content).hexdigest() != digest:
        raise FuzzyNavError("the library's file has changed since")
    return parse_scenario(content, f"{name}.toml")
