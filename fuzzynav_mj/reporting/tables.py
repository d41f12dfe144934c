"""The report's tables: the paper's Tables 2 and 3 remade, and what they leave out."""

from collections.abc import Callable, Iterator
from statistics import fmean, stdev

from fuzzynav_mj.metrics import wilson_interval
from fuzzynav_mj.reporting.contents import Contents
from fuzzynav_mj.reporting.published import (
    EPISODES,
    ODDITIES,
    OPTIMALITY_PERCENT,
    TABLE_2,
    Published,
    published,
)
from fuzzynav_mj.reporting.table import Table
from fuzzynav_mj.results import IMPOSSIBLE, POSSIBLE
from fuzzynav_mj.summary import GroupSummary, rate_text, spread_text
from fuzzynav_mj.types import Outcome

EMPTY = "-"
THEIRS = "paper's"
PAPER_NOTE = (
    f"The paper's columns are its own numbers of {EPISODES} runs in its own worlds, whose measures "
    "are not published: compare orders, not sizes."
)
REACHED_NOTE = (
    "Means ± standard deviations over the episodes that reached the goal without contact; a "
    "planner that fails often is averaged over the easier episodes only."
)

Cell = Callable[[GroupSummary], str]
PaperCell = Callable[[Published], str]


def comparison_tables(contents: Contents) -> list[Table]:
    """The planners beside each other and beside the paper."""
    return [
        *_own_planner(contents),
        _failures(contents),
        _paths(contents),
        _optimality(contents),
        *_paired(contents),
        _simulated_time(contents),
        _decision_time(contents),
        _endings(contents),
        *_possible(contents),
    ]


def _own_planner(contents: Contents) -> Iterator[Table]:
    """The paper's Table 2."""
    name = "fuzzy"
    if name not in contents.planners:
        return
    rows = []
    for scenario in contents.scenarios:
        group = contents.summaries.get((scenario, name))
        if group is None:
            continue
        theirs = TABLE_2.get(scenario)
        rows.append(
            (
                scenario,
                str(group.episodes),
                failures_text(group),
                EMPTY if theirs is None else f"{theirs.failures:g}",
                spread_text(group.path_length, 2),
                EMPTY if theirs is None else f"{theirs.path:.2f} ± {theirs.path_std:.2f}",
                spread_text(group.optimality, 1, 100.0),
                spread_text(group.sim_time, 1),
                EMPTY if theirs is None else f"{theirs.run_time:.2f} ± {theirs.run_time_std:.2f}",
                decision_text(group),
            )
        )
    yield Table(
        title=f"Table 2: planner {name}, given {contents.given(name)}",
        headings=(
            "world", "episodes", "failures % [95 %]", f"{THEIRS} failures %", "path m",
            f"{THEIRS} path", "optimality %", "simulated time s", f"{THEIRS} run time s",
            "decision ms, median / 99th",
        ),
        rows=tuple(rows),
        notes=(REACHED_NOTE, PAPER_NOTE),
        theirs=frozenset({3, 5, 8}),
    )  # fmt: skip


def _failures(contents: Contents) -> Table:
    """The failures of the paper's Table 3."""
    return _by_world(
        contents,
        "Table 3, failures: episodes that did not reach the goal without contact, % [95 %]",
        failures_text,
        lambda theirs: f"{theirs.failures:g}",
        ("With Wilson's 95 % interval.",),
        (PAPER_NOTE,),
    )


def _paths(contents: Contents) -> Table:
    """The path lengths of the paper's Table 3."""
    return _by_world(
        contents,
        "Table 3, path length, m",
        lambda group: spread_text(group.path_length, 2),
        lambda theirs: f"{theirs.path:.2f}",
        (REACHED_NOTE,),
        (PAPER_NOTE, *([ODDITIES] if {"rrt", "bug"} & set(contents.planners) else [])),
    )


def _optimality(contents: Contents) -> Table:
    return _by_world(
        contents,
        "Optimality: shortest path in hindsight over path travelled, %",
        lambda group: spread_text(group.optimality, 1, 100.0),
        None,
        (
            REACHED_NOTE,
            f"The paper gives one number, for its own planner: {OPTIMALITY_PERCENT:g} % on average "
            "over its four worlds.",
        ),
    )


def _simulated_time(contents: Contents) -> Table:
    return _by_world(
        contents,
        "Table 3, run time: simulated s from start to goal",
        lambda group: spread_text(group.sim_time, 1),
        lambda theirs: f"{theirs.run_time:.2f}",
        (REACHED_NOTE,),
        ("What the paper's run time measures it does not say.",),
    )


def _decision_time(contents: Contents) -> Table:
    return _by_world(
        contents,
        "Time of one decision, ms: median / 99th percentile",
        decision_text,
        None,
        (
            "From the scan to the next position, perception included; medians over the episodes, "
            "measured while the other processes were running.",
        ),
    )


def _paired(contents: Contents) -> Iterator[Table]:
    """Path lengths on the same episodes, which is the fair comparison."""
    name = "fuzzy"
    others = [planner for planner in contents.planners if planner != name]
    if name not in contents.planners or not others:
        return

    def cell(scenario: str, planner: str) -> str:
        ours, theirs = contents.reached(scenario, name), contents.reached(scenario, planner)
        longer = [
            100.0 * (theirs[seed]["path_length_m"] / ours[seed]["path_length_m"] - 1.0)
            for seed in sorted(ours.keys() & theirs.keys())
        ]
        if not longer:
            return EMPTY
        std = f"{stdev(longer):.1f}" if len(longer) > 1 else EMPTY
        return f"{fmean(longer):+.1f} ± {std} ({len(longer)})"

    yield Table(
        title=f"Path longer than that of {name} on the same episodes, %",
        headings=("planner", "given", *contents.scenarios),
        rows=tuple(
            (
                *head(contents, planner),
                *(cell(s, planner) for s in contents.scenarios),
            )
            for planner in others
        ),
        notes=(
            "Mean ± standard deviation over the seeds on which both reached the goal; their number "
            "in brackets.",
        ),
    )


def _endings(contents: Contents) -> Table:
    """What the episodes came to."""
    rows = []
    for planner in contents.planners:
        own = [row for row in contents.rows if row["planner"] == planner]
        counts = {kind: sum(row["outcome"] == kind.value for row in own) for kind in Outcome}
        standing = sum(not str(row.get("contact_with")).startswith("moving") for row in own
                       if row["outcome"] == Outcome.CONTACT.value)  # fmt: skip
        fault = sum(bool(row.get("contact_at_fault")) for row in own)
        rows.append(
            (
                *head(contents, planner),
                str(len(own)),
                str(counts[Outcome.GOAL_REACHED]),
                str(counts[Outcome.CONTACT] - standing),
                str(standing),
                str(fault),
                *(str(counts[kind]) for kind in (Outcome.TIMEOUT, Outcome.STUCK)),
                *(str(counts[kind]) for kind in (Outcome.NO_PATH, Outcome.DIVERGED)),
            )
        )
    return Table(
        title="How the episodes ended, all worlds together",
        headings=(
            "planner", "given", "episodes", "goal reached", "contact with a mover",
            "contact with what stands", "of both, robot moving", "time up", "stuck",
            "no path found", "diverged",
        ),
        rows=tuple(rows),
    )  # fmt: skip


def _possible(contents: Contents) -> Iterator[Table]:
    """Success against what a planner that knows every motion could do."""
    if not any(group.judged for group in contents.summaries.values()):
        return
    worlds = []
    for scenario in contents.scenarios:
        verdicts = {
            row["seed"]: row["possible"]
            for row in contents.rows
            if row["scenario"] == scenario and row.get("possible") is not None
        }
        possible = sum(verdict == POSSIBLE for verdict in verdicts.values())
        impossible = sum(verdict == IMPOSSIBLE for verdict in verdicts.values())
        doubtful = len(verdicts) - possible - impossible
        worlds.append(f"{possible} yes, {doubtful} unknown, {impossible} no")

    def cell(scenario: str, planner: str) -> str:
        group = contents.summaries.get((scenario, planner))
        if group is None or group.possible == 0:
            return EMPTY
        rate = rate_text(group.possible_successes, group.possible, group.possible_interval)
        return f"{group.possible_successes} / {group.possible}: {rate}"

    yield Table(
        title="Success in the episodes that are possible, % [95 %]",
        headings=("planner", "given", *contents.scenarios),
        rows=(
            ("possible?", "every motion", *worlds),
            *(
                (
                    contents.labels[planner],
                    contents.given(planner),
                    *(cell(s, planner) for s in contents.scenarios),
                )
                for planner in contents.planners
            ),
        ),
        notes=(
            "Possible are episodes for which a search that knows every motion has found a run "
            "without contact. The first line counts the seeds.",
        ),
    )


def _by_world(
    contents: Contents,
    title: str,
    cell: Cell,
    theirs: PaperCell | None,
    notes: tuple[str, ...],
    paper_notes: tuple[str, ...] = (),
) -> Table:
    """Planners down, worlds across, with the paper's number beside each of the paper's worlds.

    `paper_notes` are about these numbers.
    """
    headings, columns = ["planner", "given"], []
    for scenario in contents.scenarios:
        paper = theirs is not None and any(published(p, scenario) for p in contents.planners)
        columns.append((scenario, paper))
        headings += [scenario, THEIRS] if paper else [scenario]
    rows = []
    for planner in contents.planners:
        cells = [*head(contents, planner)]
        for scenario, paper in columns:
            group = contents.summaries.get((scenario, planner))
            cells.append(EMPTY if group is None else cell(group))
            if paper and theirs is not None:
                printed = published(planner, scenario)
                cells.append(EMPTY if printed is None else theirs(printed))
        rows.append(tuple(cells))
    return Table(
        title=title,
        headings=tuple(headings),
        rows=tuple(rows),
        notes=notes + (paper_notes if THEIRS in headings else ()),
        theirs=frozenset(i for i, heading in enumerate(headings) if heading == THEIRS),
    )


def head(contents: Contents, planner: str) -> tuple[str, str]:
    """The first cells of a planner's line: its name and what it is given."""
    return contents.labels[planner], contents.given(planner)


def failures_text(group: GroupSummary) -> str:
    """Failures in percent with Wilson's interval."""
    failures = group.episodes - group.successes
    return rate_text(failures, group.episodes, wilson_interval(failures, group.episodes))


def decision_text(group: GroupSummary) -> str:
    """Median and 99th percentile of a decision's time, ms."""
    if group.plan_ms_p50 != group.plan_ms_p50:
        return EMPTY
    return f"{group.plan_ms_p50:.1f} / {group.plan_ms_p99:.1f}"
