"""`fuzzynav report`: a benchmark's folder as a page for readers."""

from contextlib import closing
from pathlib import Path

from fuzzynav_mj.benchmark import run_parallel
from fuzzynav_mj.commands.progress import note, progress_bar
from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.reporting.contents import contents_of
from fuzzynav_mj.reporting.folder import read_folder
from fuzzynav_mj.reporting.page import html_page, markdown_page
from fuzzynav_mj.reporting.replays import differences, replay_jobs
from fuzzynav_mj.reporting.sections import TITLE, sections
from fuzzynav_mj.reporting.traces import Trace, trace_job
from fuzzynav_mj.results import FailedEpisode, replace_file

FOLDER = "report"
HTML, MARKDOWN = "report.html", "report.md"


def report(folder: Path, out: Path | None, processes: int) -> int:
    """Write the report of a benchmark, and print where it is.

    One episode of every world and planner is played once more for the pictures.

    Args:
        folder: that `fuzzynav bench` has written.
        out: folder for the report; `report` in `folder` where None.
        processes: how many episodes at a time.

    Returns:
        The exit status, 0.

    Raises:
        FuzzyNavError: there are no episodes, or the report cannot be written.
    """
    contents = contents_of(read_folder(folder))
    target = folder / FOLDER if out is None else out
    try:
        target.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FuzzyNavError(
            f"{target}: --out: given a folder that cannot be used ({error.strerror}); "
            "allowed is one that can be written"
        ) from None
    jobs, notes = replay_jobs(contents)
    if jobs:
        note(f"playing {len(jobs)} of the episodes once more for the pictures")
    played: dict[object, Trace] = {}
    lost: list[FailedEpisode] = []
    progress = progress_bar("ways", len(jobs))
    with closing(run_parallel(jobs, processes, trace_job)) as results, progress as advance:
        for result in results:
            if isinstance(result, FailedEpisode):
                lost.append(result)
            else:
                played[result.job.key] = result
            advance()
    traces = [played[job.key] for job in jobs if job.key in played]
    notes += [f"No way of {each.key}: {each.reason}." for each in sorted(lost, key=str)]
    notes += differences(contents, traces)
    parts = sections(contents, traces, notes, target)
    replace_file(target / MARKDOWN, markdown_page(TITLE, parts).encode())
    replace_file(target / HTML, html_page(TITLE, parts).encode())
    print(f"report: {target / HTML}, {target / MARKDOWN}")
    return 0
