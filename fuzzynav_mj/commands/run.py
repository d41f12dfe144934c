"""`fuzzynav run`: one episode, its summary, and its recording."""

import contextlib
import json
import math
import shlex
import shutil
import sys
import tempfile
from pathlib import Path

from fuzzynav_mj.disturbance import PERFECT, Disturbance
from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.metrics import record_to_json
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.runner import play_episode
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.types import EpisodeRecord, Outcome

LABEL_WIDTH = 15


def run(
    scenario: str,
    planner: str,
    seed: int,
    recording: Path | None = None,
    as_json: bool = False,
    quiet: bool = False,
    disturbance: Disturbance = PERFECT,
) -> int:
    """Simulate one episode and print what became of it.

    Args:
        scenario: name or file.
        planner: name.
        seed: of the episode.
        recording: Rerun file to write.
        as_json: print the episode record as one JSON object, and nothing else.
        quiet: print nothing but that.
        disturbance: what is wrong with the sensors and the floor.

    Returns:
        The exit status: 0 if the goal was reached without contact, else 1.

    Raises:
        FuzzyNavError: bad input.
    """
    checked = load_scenario(scenario)
    if recording is not None:
        check_recording_target(recording)
    episode = play_episode(checked, planner, seed, disturbance)
    record = episode.record
    if recording is not None:
        from fuzzynav_mj.rerun_log import write_recording

        write_recording(recording, episode.world, episode.steps, record, DEFAULT_ROBOT)
    if as_json:
        print(json.dumps(record_to_json(record), allow_nan=False))
    elif not quiet:
        _print_summary(record, recording)
    return 0 if record.outcome is Outcome.GOAL_REACHED and not record.contacts else 1


def check_recording_target(path: Path) -> None:
    """Find out before an episode whether its recording can be written after it.

    Raises:
        FuzzyNavError: it cannot.
    """
    given = None
    try:
        if path.exists() and not path.is_file():
            given = "something else than a file"
        elif not path.parent.is_dir():
            given = f"a file in {path.parent}, which is not a folder"
        else:
            with tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}."):
                pass
    except OSError as error:
        given = f"a file that cannot be written ({error.strerror})"
    if given is not None:
        raise FuzzyNavError(
            f"{path}: --rrd: given {given}; allowed is a file in a folder that can be written"
        )


def summary_lines(record: EpisodeRecord, recording: Path | None) -> list[tuple[str, str]]:
    """The summary of an episode as pairs of a label and a text."""
    pace = record.sim_time_s / record.wall_s if record.wall_s > 0.0 else math.nan
    risk = "not judged by this planner"
    if record.risk_max is not None and record.risk_mean is not None:
        risk = f"max {record.risk_max:.1f}, mean {record.risk_mean:.1f} of 100"
    shortest = "none exists"
    if math.isfinite(record.shortest_path_m):
        shortest = f"{record.shortest_path_m:.2f} m"
    optimality = (
        "" if record.optimality is None else f", optimality {100 * record.optimality:.1f} %"
    )
    lines = [
        ("simulated time", f"{record.sim_time_s:.2f} s, in {record.wall_s:.1f} s ({pace:.0f} x)"),
        ("path", f"{record.path_length_m:.2f} m, shortest {shortest}{optimality}"),
        ("min clearance", f"{record.min_clearance_m:.3f} m"),
    ]
    for contact in record.contacts:
        fault = "the robot's fault" if contact.at_fault else "not the robot's fault"
        lines.append(
            (
                "contact",
                f"with {contact.with_} at {contact.time_s:.2f} s, robot at "
                f"{contact.robot_speed_mps:.2f} m/s: {fault}",
            )
        )
    lines += [
        ("risk", f"{risk}; {record.gate_vetoes} vetoes in {record.decisions} decisions"),
        ("planning", f"{record.plan_ms_p50:.1f} ms median, {record.plan_ms_p99:.1f} ms 99th pct."),
    ]
    if record.disturbance != PERFECT:
        lines.append(("disturbance", str(record.disturbance)))
    if recording is not None:
        viewer = shlex.join([_viewer(), str(recording)])
        lines += [("recording", str(recording)), ("open it with", viewer)]
    return lines


def _print_summary(record: EpisodeRecord, recording: Path | None) -> None:
    what = f"{record.scenario}, planner {record.planner}, seed {record.seed}"
    outcome = record.outcome.value.replace("_", " ")
    lines = summary_lines(record, recording)
    if not sys.stdout.isatty():
        print(f"{what}: {outcome}")
        for label, text in lines:
            print(f"  {label:<{LABEL_WIDTH}} {text}")
        return
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(highlight=False)
    style = "bold green" if record.outcome is Outcome.GOAL_REACHED else "bold red"
    console.print(Text.assemble(f"{what}: ", (outcome, style)))
    table = Table.grid(padding=(0, 1))
    table.add_column(style="dim", width=LABEL_WIDTH + 2, no_wrap=True)
    table.add_column(overflow="fold")
    for label, text in lines:
        table.add_row(Text(f"  {label}"), Text(text))
    console.print(table)


def _viewer() -> str:
    """How to start the viewer: it may be installed beside this Python without being on PATH."""
    if shutil.which("rerun") is None:
        beside = Path(sys.executable).with_name("rerun")
        if beside.exists():
            with contextlib.suppress(ValueError):
                beside = beside.relative_to(Path.cwd())
            return str(beside)
    return "rerun"
