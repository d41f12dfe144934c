"""What a benchmark's episodes say together: a line for every scenario, planner and disturbance."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import nan
from statistics import fmean, median, stdev

from fuzzynav_mj.disturbance import PERFECT, Disturbance
from fuzzynav_mj.metrics import wilson_interval
from fuzzynav_mj.results import IMPOSSIBLE, POSSIBLE, UNKNOWN, EpisodeKey, Row, disturbance_of
from fuzzynav_mj.types import Outcome

HEADINGS = (
    "scenario", "planner", "reached", "success % [95 %]", "path m", "time s", "contacts",
    "optimality %", "vetoes", "plan ms",
)  # fmt: skip
"""The table's columns; a narrow terminal does without the last ones."""

DISTURBANCE = "disturbance"
"""A column after the planner, where the sensors or the floor were not always perfect."""

OF_POSSIBLE = "of the possible %"
"""A column after the success, where the oracle was asked."""

NOTE = (
    "Success is reaching the goal without contact, with its Wilson 95 % interval. Path, optimality "
    "and simulated time are mean ± standard deviation over the successful episodes; vetoes are the "
    "mean number per episode; planning times are the median and the 99th percentile of one "
    "decision, medians over the episodes, measured while the other processes were running."
)


ORACLE_NOTE = (
    "Of the possible: the same for the episodes alone whose world leaves a contact-free run for "
    "certain, as a search finds that knows every motion."
)


@dataclass(frozen=True, slots=True)
class Spread:
    """Mean and sample standard deviation; nan where there are too few values."""

    mean: float
    std: float


@dataclass(frozen=True, slots=True)
class GroupSummary:
    """The episodes of one scenario, planner and disturbance.

    Attributes:
        scenario: its name.
        planner: its name.
        disturbance: what was wrong with the sensors and the floor.
        episodes: finished episodes.
        successes: episodes that reached the goal without contact.
        interval: Wilson 95 % interval of the success rate.
        path_length: of the successful episodes, m.
        optimality: of the successful episodes, 0..1.
        sim_time: of the successful episodes, s.
        contacts: episodes that ended in contact.
        contacts_at_fault: those where the robot moved.
        vetoes: mean number per episode.
        plan_ms_p50: median over the episodes of the median time of a decision, ms.
        plan_ms_p99: median over the episodes of the 99th percentile, ms.
        judged: episodes whose world the oracle has judged.
        possible: episodes whose world leaves a contact-free run for certain.
        possible_successes: those of them that reached the goal without contact.
        possible_interval: Wilson 95 % interval of that rate.
    """

    scenario: str
    planner: str
    disturbance: Disturbance
    episodes: int
    successes: int
    interval: tuple[float, float]
    path_length: Spread
    optimality: Spread
    sim_time: Spread
    contacts: int
    contacts_at_fault: int
    vetoes: float
    plan_ms_p50: float
    plan_ms_p99: float
    judged: int
    possible: int
    possible_successes: int
    possible_interval: tuple[float, float]


def summarise(rows: Iterable[Row]) -> list[GroupSummary]:
    """One summary for every scenario, planner and disturbance; `rows` sorted by these."""
    return [
        _summarise_group(scenario, planner, disturbance, list(group))
        for (scenario, planner, disturbance), group in groupby(
            rows, key=lambda row: (row["scenario"], row["planner"], disturbance_of(row))
        )
    ]


def headings(summaries: Iterable[GroupSummary]) -> tuple[str, ...]:
    """`HEADINGS`, and what else there is to tell of these summaries."""
    summaries = list(summaries)
    disturbed = any(group.disturbance != PERFECT for group in summaries)
    judged = any(group.judged for group in summaries)
    return (
        *HEADINGS[:2], *([DISTURBANCE] if disturbed else []),
        *HEADINGS[2:4], *([OF_POSSIBLE] if judged else []),
        *HEADINGS[4:],
    )  # fmt: skip


def table_cells(summaries: Sequence[GroupSummary]) -> list[tuple[str, ...]]:
    """The summaries as the texts under their `headings`."""
    columns = headings(summaries)
    return [
        (
            group.scenario,
            group.planner,
            *([str(group.disturbance)] if DISTURBANCE in columns else []),
            f"{group.successes} / {group.episodes}",
            rate_text(group.successes, group.episodes, group.interval),
            *([_possible_text(group)] if OF_POSSIBLE in columns else []),
            spread_text(group.path_length, 2),
            spread_text(group.sim_time, 1),
            f"{group.contacts} ({group.contacts_at_fault} at fault)" if group.contacts else "0",
            spread_text(group.optimality, 1, 100.0),
            f"{group.vetoes:.1f}",
            f"{_number(group.plan_ms_p50, 1)} / {_number(group.plan_ms_p99, 1)}",
        )
        for group in summaries
    ]


def markdown(
    summaries: Sequence[GroupSummary],
    failures: Mapping[EpisodeKey, str],
    versions: Sequence[str],
    rows: Iterable[Row] = (),
) -> str:
    """The summaries as a page of Markdown.

    Args:
        summaries: the table's lines.
        failures: reason by episode, of those that have no row.
        versions: what the episodes ran on, one text for each set of versions among them.
        rows: the episodes; those that the oracle did not find possible are listed.
    """
    columns = headings(summaries)
    lines = ["# Benchmark", "", *(f"Ran on {text}." for text in versions), ""]
    lines += ["| " + " | ".join(columns) + " |", "|" + " --- |" * len(columns)]
    for cells in table_cells(summaries):
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    lines += ["", NOTE, ""]
    if OF_POSSIBLE in columns:
        lines += [ORACLE_NOTE, ""]
    rows = list(rows)
    lines += _worlds_section(
        rows, IMPOSSIBLE, "Impossible worlds", "No contact-free run exists in them."
    )
    lines += _worlds_section(
        rows, UNKNOWN, "Doubtful worlds", "Whether a contact-free run exists in them is not known."
    )
    if failures:
        lines += ["## Failed episodes", "", "They have no row and count nowhere above.", ""]
        lines += [f"- {key}: {failures[key]}" for key in sorted(failures)] + [""]
    return "\n".join(lines)


def _worlds_section(rows: Iterable[Row], verdict: str, title: str, text: str) -> list[str]:
    worlds = sorted(
        {(row["scenario"], row["seed"]) for row in rows if row.get("possible") == verdict}
    )
    if not worlds:
        return []
    return (
        [f"## {title}", "", text, ""] + [f"- {name}, seed {seed}" for name, seed in worlds] + [""]
    )


def _summarise_group(
    scenario: str, planner: str, disturbance: Disturbance, rows: Sequence[Row]
) -> GroupSummary:
    reached = [row for row in rows if row["outcome"] == Outcome.GOAL_REACHED.value]
    possible = sum(row.get("possible") == POSSIBLE for row in rows)
    of_possible = sum(row.get("possible") == POSSIBLE for row in reached)
    return GroupSummary(
        scenario=scenario,
        planner=planner,
        disturbance=disturbance,
        episodes=len(rows),
        successes=len(reached),
        interval=wilson_interval(len(reached), len(rows)),
        path_length=_spread(_values(reached, "path_length_m")),
        optimality=_spread(_values(reached, "optimality")),
        sim_time=_spread(_values(reached, "sim_time_s")),
        contacts=sum(row["outcome"] == Outcome.CONTACT.value for row in rows),
        contacts_at_fault=sum(bool(row.get("contact_at_fault")) for row in rows),
        vetoes=fmean(_values(rows, "gate_vetoes")),
        plan_ms_p50=_median(_values(rows, "plan_ms_p50")),
        plan_ms_p99=_median(_values(rows, "plan_ms_p99")),
        judged=sum(row.get("possible") is not None for row in rows),
        possible=possible,
        possible_successes=of_possible,
        possible_interval=wilson_interval(of_possible, possible),
    )


def _values(rows: Iterable[Row], column: str) -> list[float]:
    values = (row.get(column) for row in rows)
    return [float(value) for value in values if value is not None]


def _spread(values: Sequence[float]) -> Spread:
    return Spread(
        mean=fmean(values) if values else nan,
        std=stdev(values) if len(values) > 1 else nan,
    )


def _median(values: Sequence[float]) -> float:
    return median(values) if values else nan


def _possible_text(group: GroupSummary) -> str:
    if group.possible == 0:
        return "-"
    rate = rate_text(group.possible_successes, group.possible, group.possible_interval)
    return f"{group.possible_successes} / {group.possible}: {rate}"


def rate_text(count: int, trials: int, interval: tuple[float, float]) -> str:
    """A share of the trials in percent, with its interval."""
    low, high = interval
    return f"{100 * count / trials:.1f} [{100 * low:.1f}, {100 * high:.1f}]"


def spread_text(spread: Spread, digits: int, scale: float = 1.0) -> str:
    """Mean ± standard deviation times `scale`; a dash for what there is none of."""
    if spread.mean != spread.mean:
        return "-"
    return f"{scale * spread.mean:.{digits}f} ± {_number(scale * spread.std, digits)}"


def _number(value: float, digits: int) -> str:
    return "-" if value != value else f"{value:.{digits}f}"
