"""Bars of all planners in all worlds, with the paper's numbers as open diamonds."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import ceil, floor, log10
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from fuzzynav_mj.recording.colours import VERMILLION
from fuzzynav_mj.reporting.contents import Contents, given_text
from fuzzynav_mj.reporting.published import Published, published
from fuzzynav_mj.reporting.style import FillStyle, Picture, fill_style, hex_colour, look, new_figure
from fuzzynav_mj.results import IMPOSSIBLE, POSSIBLE
from fuzzynav_mj.summary import GroupSummary

PER_ROW = 4  # worlds beside each other
DIAMOND: dict[str, Any] = {
    "marker": "D",
    "markersize": 5.5,
    "markerfacecolor": "white",
    "markeredgecolor": hex_colour(VERMILLION),
    "markeredgewidth": 1.4,
}


@dataclass(frozen=True, slots=True)
class Bar:
    """A length with its error bar, both ends of it as values."""

    value: float
    low: float
    high: float


def bar_pictures(contents: Contents) -> Iterator[Picture]:
    """The paper's figures 11 and 12, success, and time per decision."""
    yield Picture(
        "path_length",
        "Path length (as figure 11)",
        "Mean path length of the episodes that reached the goal, with the standard deviation; "
        "the dotted line is the shortest path in hindsight. Diamonds: the paper's numbers, of its "
        "own worlds. Planners that never reached the goal have no bar.",
        _figure(contents, "path length, m", _path, lambda p: p.path, line=_shortest),
    )
    yield Picture(
        "optimality",
        "Optimality (as figure 12)",
        "Shortest path in hindsight over the path travelled, mean and standard deviation of the "
        "episodes that reached the goal. The paper prints no numbers beside its figure 12.",
        _figure(contents, "optimality, %", _optimality, None, limit=100.0),
    )
    yield Picture(
        "success",
        "Success",
        "Share of the episodes that reached the goal without contact, with Wilson's 95 % interval. "
        "Diamonds: 100 % less the paper's failures. Where the oracle was asked, the dashed line is "
        "the share of episodes that are possible for certain and the dotted one of those that are "
        "not impossible.",
        _figure(
            contents, "success, %", _success, lambda p: 100.0 - p.failures, 100.0, _possible_lines
        ),
    )
    yield Picture(
        "decision_time",
        "Time of one decision",
        "Dot: median of one decision, perception included; its line reaches to the 99th "
        "percentile. Medians over the episodes; logarithmic scale.",
        _figure(contents, "time of a decision, ms", _decision_time, None, log=True),
    )


Line = tuple[float, str, str]  # where, dash pattern, label


def _figure(
    contents: Contents,
    label: str,
    bar: Callable[[GroupSummary], Bar | None],
    theirs: Callable[[Published], float] | None,
    limit: float | None = None,
    line: Callable[[Contents, str], list[Line]] | None = None,
    log: bool = False,
) -> Figure:
    """A panel for each world, a bar for each planner."""
    scenarios, planners = contents.scenarios, contents.planners
    columns = min(PER_ROW, len(scenarios))
    rows = -(-len(scenarios) // columns)
    names = [contents.labels[planner] for planner in planners]
    labels = max(map(len, names)) * 0.075 + 0.3
    with look():
        figure = new_figure(
            max(5.0, labels + 2.3 * columns), rows * (0.26 * len(planners) + 0.75) + 0.75
        )
        grid = figure.subplots(rows, columns, squeeze=False, sharey=True, sharex=True)
        drawn: set[str] = set()
        for axes, scenario in zip(grid.flat, scenarios, strict=False):
            axes.set_title(scenario)
            axes.set_xlabel(label)
            axes.tick_params(labelbottom=True)
            for index, planner in enumerate(planners):
                group = contents.summaries.get((scenario, planner))
                found = None if group is None else bar(group)
                fill = fill_style(contents.requirements[planner])
                if found is None:
                    place = axes.get_yaxis_transform()
                    axes.text(0.02, index, "none", va="center", transform=place)
                else:
                    _draw(axes, index, found, fill, log)
                printed = published(planner, scenario)
                if theirs is not None and printed is not None:
                    axes.plot(theirs(printed), index, linestyle="", **DIAMOND)
                    drawn.add("paper")
            for where, dashes, name in line(contents, scenario) if line is not None else []:
                axes.axvline(where, color="black", linestyle=dashes, linewidth=1.0)
                drawn.add(name)
            _finish(axes, names, limit)
            if log:
                _log_scale(axes, contents)
        for axes in list(grid.flat)[len(scenarios) :]:
            axes.set_visible(False)
        figure.legend(
            handles=_legend(contents, drawn), loc="outside lower center", ncols=4, frameon=False
        )
    return figure


def _draw(axes: Axes, index: int, bar: Bar, fill: FillStyle, log: bool) -> None:
    if log:  # a bar on a logarithmic scale would begin at no place of its own
        axes.plot(bar.value, index, "o", color=fill.colour, markeredgecolor="black", markersize=7)
    else:
        axes.barh(
            index, bar.value, height=0.72, color=fill.colour, hatch=fill.hatch, alpha=0.75,
            edgecolor="black", linewidth=0.6,
        )  # fmt: skip
    reach = [[max(0.0, bar.value - bar.low)], [max(0.0, bar.high - bar.value)]]
    axes.errorbar(
        bar.value, index, xerr=reach, color="black", capsize=2.5, linewidth=1.0, fmt="none"
    )


def _log_scale(axes: Axes, contents: Contents) -> None:
    """Whole decades around all times, written out."""
    times = [t for g in contents.summaries.values() for t in (g.plan_ms_p50, g.plan_ms_p99)]
    known = [time for time in times if time > 0.0] or [1.0]
    low, high = floor(log10(min(known))), ceil(log10(max(known)))
    decades = [10.0**n for n in range(low, max(high, low + 1) + 1)]
    axes.set_xscale("log")
    axes.set_xlim(decades[0], decades[-1])
    axes.set_xticks(decades, [f"{decade:g}" for decade in decades])


def _finish(axes: Axes, names: list[str], limit: float | None) -> None:
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)  # the first planner at the top
    axes.grid(axis="x", linewidth=0.4, color="0.8")
    axes.set_axisbelow(True)
    if limit is not None:
        axes.set_xlim(0.0, limit * 1.04)


def _legend(contents: Contents, drawn: set[str]) -> list[Patch | Line2D]:
    needs_by_text = {given_text(needs): needs for needs in contents.requirements.values()}
    handles: list[Patch | Line2D] = []
    for text in sorted({contents.given(name) for name in contents.planners}):
        fill = fill_style(needs_by_text[text])
        handles.append(
            Patch(
                facecolor=fill.colour,
                hatch=fill.hatch,
                edgecolor="black",
                alpha=0.75,
                label=f"given {text}",
            )
        )
    if "paper" in drawn:
        handles.append(Line2D([], [], linestyle="", label="paper's number", **DIAMOND))
    for name, dashes in LINES.items():
        if name in drawn:
            handles.append(Line2D([], [], color="black", linestyle=dashes, label=name))
    return handles


SHORTEST, POSSIBLE_LINE, NOT_IMPOSSIBLE = "shortest in hindsight", "possible", "not impossible"
LINES = {SHORTEST: ":", POSSIBLE_LINE: "--", NOT_IMPOSSIBLE: ":"}


def _shortest(contents: Contents, scenario: str) -> list[Line]:
    lengths = {
        row["shortest_path_m"]
        for row in contents.rows
        if row["scenario"] == scenario and row.get("shortest_path_m") is not None
    }
    return [(float(length), LINES[SHORTEST], SHORTEST) for length in sorted(lengths)[:1]]


def _possible_lines(contents: Contents, scenario: str) -> list[Line]:
    verdicts = {
        row["seed"]: row["possible"]
        for row in contents.rows
        if row["scenario"] == scenario and row.get("possible") is not None
    }
    if not verdicts:
        return []
    possible = sum(verdict == POSSIBLE for verdict in verdicts.values()) / len(verdicts)
    at_most = sum(verdict != IMPOSSIBLE for verdict in verdicts.values()) / len(verdicts)
    lines = [(100.0 * possible, LINES[POSSIBLE_LINE], POSSIBLE_LINE)]
    if at_most != possible:
        lines.append((100.0 * at_most, LINES[NOT_IMPOSSIBLE], NOT_IMPOSSIBLE))
    return lines


def _path(group: GroupSummary) -> Bar | None:
    return _around(group.path_length.mean, group.path_length.std)


def _optimality(group: GroupSummary) -> Bar | None:
    return _around(100.0 * group.optimality.mean, 100.0 * group.optimality.std)


def _success(group: GroupSummary) -> Bar | None:
    low, high = group.interval
    return Bar(100.0 * group.successes / group.episodes, 100.0 * low, 100.0 * high)


def _decision_time(group: GroupSummary) -> Bar | None:
    median, high = group.plan_ms_p50, group.plan_ms_p99
    return None if median != median else Bar(median, median, high)


def _around(mean: float, std: float) -> Bar | None:
    if mean != mean:
        return None
    spread = 0.0 if std != std else std
    return Bar(mean, mean - spread, mean + spread)
