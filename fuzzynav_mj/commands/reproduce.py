"""`fuzzynav reproduce`: the paper's comparison, from episodes to page, in one go."""

from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from statistics import fmean

from fuzzynav_mj.benchmark import EpisodeJob
from fuzzynav_mj.commands.bench import (
    INTERRUPTED,
    Plan,
    begin,
    conclude,
    judge,
    plan_benchmark,
    play,
)
from fuzzynav_mj.commands.progress import note
from fuzzynav_mj.commands.report import report
from fuzzynav_mj.planners import PLANNERS
from fuzzynav_mj.results import EpisodeLog


def reproduce(planners: Sequence[str], seeds: range, processes: int, folder: Path) -> int:
    """Run the paper's four worlds and report on them; go on where an earlier call ended.

    The first seed is played before the others, with every planner and world: it tells how long
    the rest will take. After that all are played seed by seed, so that planners can be compared
    however early the run is ended.

    Args:
        planners: their names; every built-in one where empty.
        seeds: one episode each.
        processes: how many episodes at a time.
        folder: for the results, which may hold some already, and the report.

    Returns:
        The exit status: 0 if every episode was run, 1 if some failed, 130 after Ctrl-C.

    Raises:
        FuzzyNavError: bad input.
    """
    plan = plan_benchmark((), planners or tuple(PLANNERS), seeds)
    with EpisodeLog(folder, resume=True) as log:
        begin(plan, log)
        interrupted = False
        try:
            _play_all(plan, processes, log)
        except KeyboardInterrupt:
            interrupted = True
        conclude(log)
        left = plan.missing(log)
    if interrupted:
        note(
            f"interrupted with {len(left)} of {len(plan.jobs)} episodes to go; the same command "
            f"goes on, `fuzzynav report {folder}` makes a page of what is there"
        )
        return INTERRUPTED
    report(folder, None, processes)
    return 1 if left else 0


def _play_all(plan: Plan, processes: int, log: EpisodeLog) -> None:
    missing = sorted(plan.missing(log), key=lambda job: job.seed)  # keeps the order within a seed
    first = _first_of_unknown(missing, log)
    if first and len(first) < len(missing):
        note(
            f"playing {len(first)} of {len(missing)} episodes to tell how long all will take; "
            "Ctrl-C keeps what is finished"
        )
        play(first, plan, processes, log)
        begun = {job.key for job in first}
        missing = [job for job in missing if job.key not in begun]
    if missing:
        seconds = expected_seconds(missing, log) / min(processes, len(missing))
        note(
            f"{len(missing)} episodes to play, {processes} at a time: "
            f"about {duration_text(seconds)}"
        )
        play(missing, plan, processes, log)
    judge(plan, processes, log)


def _first_of_unknown(missing: Sequence[EpisodeJob], log: EpisodeLog) -> list[EpisodeJob]:
    """One episode of each world and planner that the log has none of."""
    known = {(key.scenario, key.planner) for key in log.rows}
    first: dict[tuple[str, str], EpisodeJob] = {}
    for job in missing:
        group = job.scenario.name, job.planner
        if group not in known:
            first.setdefault(group, job)
    return list(first.values())


def expected_seconds(jobs: Sequence[EpisodeJob], log: EpisodeLog) -> float:
    """Computing time of the episodes one after the other, s, from those in the log.

    Of the same world and planner if there are any, else of the same planner, else of all; 0 where
    the log has none.
    """
    times: dict[tuple[str, str], list[float]] = defaultdict(list)
    for key, row in log.rows.items():
        if row.get("wall_s") is not None:
            for group in ((key.scenario, key.planner), ("", key.planner), ("", "")):
                times[group].append(float(row["wall_s"]))

    def expected(job: EpisodeJob) -> float:
        groups = ((job.scenario.name, job.planner), ("", job.planner), ("", ""))
        return next((fmean(times[group]) for group in groups if group in times), 0.0)

    return sum(map(expected, jobs))


def duration_text(seconds: float) -> str:
    """A duration as one would say it: `40 s`, `12 min`, `3 h 20 min`."""
    if seconds < 90.0:
        return f"{max(1, round(seconds))} s"
    minutes = round(seconds / 60.0)
    if minutes < 90:
        return f"{minutes} min"
    return f"{minutes // 60} h {minutes % 60} min"
