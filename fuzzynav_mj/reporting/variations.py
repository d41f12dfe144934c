"""Tables of the planner with parts taken away, and of imperfect senses."""

from collections.abc import Iterator

from fuzzynav_mj.disturbance import PERFECT, Disturbance
from fuzzynav_mj.reporting.contents import Contents
from fuzzynav_mj.reporting.table import Table
from fuzzynav_mj.reporting.tables import EMPTY, REACHED_NOTE, head
from fuzzynav_mj.summary import GroupSummary, rate_text, spread_text


def variation_tables(contents: Contents) -> list[Table]:
    """The planner with parts taken away, and imperfect senses, as far as the folder has them."""
    return [*_ablation(contents), *_disturbed(contents)]


def _ablation(contents: Contents) -> Iterator[Table]:
    """The paper's planner with parts taken away."""
    if not contents.variants:
        return

    def cell(scenario: str, planner: str) -> str:
        group = contents.summaries.get((scenario, planner))
        if group is None:
            return EMPTY
        return f"{_success(group)}; {spread_text(group.path_length, 2)}; {group.vetoes:.1f}"

    yield Table(
        title="Ablation: reached / episodes: % [95 %]; path, m; vetoes per episode",
        headings=("planner", "differs in", "given", *contents.scenarios),
        rows=tuple(
            (
                name,
                differs_in(name),
                contents.given(name),
                *(cell(scenario, name) for scenario in contents.scenarios),
            )
            for name in contents.variants
        ),
        notes=(REACHED_NOTE,),
    )


def _disturbed(contents: Contents) -> Iterator[Table]:
    """Success with imperfect sensors and floors."""
    lines = sorted({(p, d) for _, p, d in contents.others}, key=lambda line: (line[1], line[0]))
    disturbances = {disturbance for _, disturbance in lines}
    if disturbances == {PERFECT}:
        return

    def cell(scenario: str, planner: str, disturbance: Disturbance) -> str:
        group = contents.others.get((scenario, planner, disturbance))
        if group is None:
            return EMPTY
        return _success(group)

    yield Table(
        title="Success with imperfect sensors and floor, % [95 %]",
        headings=("disturbance", "planner", "given", *contents.scenarios),
        rows=tuple(
            (
                str(disturbance),
                *head(contents, planner),
                *(cell(scenario, planner, disturbance) for scenario in contents.scenarios),
            )
            for planner, disturbance in lines
        ),
        notes=(f"Everything else on this page is of disturbance: {contents.disturbance}.",),
    )


def _success(group: GroupSummary) -> str:
    rate = rate_text(group.successes, group.episodes, group.interval)
    return f"{group.successes} / {group.episodes}: {rate}"


def differs_in(name: str) -> str:
    """What a planner with options changes, in words."""
    base, _, text = name.partition(":")
    words = ["no fuzzy gate"] if base == "multilayer" else []
    for part in filter(None, text.split(",")):
        option, _, value = part.partition("=")
        if option == "gate":
            words.append(f"gate at {value}")
        elif option == "prediction":
            words.append("movers taken as standing" if value == "off" else "movers predicted")
        elif option == "rules":
            words.append("the 28 published rules alone" if value == "paper" else f"rules {value}")
    return ", ".join(words) or "nothing: the whole method"
