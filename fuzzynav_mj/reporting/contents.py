"""What a report speaks of: its worlds and planners in order, what each is given, and their sums."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import PurePath

from fuzzynav_mj.disturbance import PERFECT, Disturbance
from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.planners import make_planner
from fuzzynav_mj.planners.base import Requirements
from fuzzynav_mj.planners.own import is_file_name
from fuzzynav_mj.reporting.folder import BenchFolder
from fuzzynav_mj.results import Row, disturbance_of
from fuzzynav_mj.scenarios import PAPER_SCENARIOS
from fuzzynav_mj.summary import GroupSummary, summarise
from fuzzynav_mj.types import Outcome

ORDER = (
    "fuzzy", "multilayer", "bug", "dwa", "orca", "mppi", "rrt", "prm", "static", "straight",
)  # fmt: skip
"""The paper's planner first; planners that are not here follow by name."""

UNKNOWN = "unknown"


@dataclass(frozen=True, eq=False)
class Contents:
    """A benchmark in a reader's order.

    Attributes:
        folder: the benchmark.
        scenarios: names, the paper's four first.
        planners: names; the variants of an ablation only where there is nothing else.
        variants: names of planners with options, and what they vary.
        disturbance: of the episodes that the report is about; perfect senses if the folder has
            such episodes, else the one of which it has most.
    """

    folder: BenchFolder
    scenarios: tuple[str, ...]
    planners: tuple[str, ...]
    variants: tuple[str, ...]
    disturbance: Disturbance

    @cached_property
    def rows(self) -> tuple[Row, ...]:
        """The episodes with this disturbance."""
        return tuple(row for row in self.folder.rows if disturbance_of(row) == self.disturbance)

    @cached_property
    def summaries(self) -> dict[tuple[str, str], GroupSummary]:
        """By scenario and planner; no entry where nothing was run."""
        return {(s.scenario, s.planner): s for s in summarise(self.rows)}

    @cached_property
    def others(self) -> dict[tuple[str, str, Disturbance], GroupSummary]:
        """Of every disturbance in the folder, by scenario, planner and disturbance."""
        return {(s.scenario, s.planner, s.disturbance): s for s in summarise(self.folder.rows)}

    @cached_property
    def requirements(self) -> dict[str, Requirements | None]:
        """What each planner asks for; None for one that can no longer be made."""
        return {name: _requirements(name) for name in (*self.planners, *self.variants)}

    @cached_property
    def labels(self) -> dict[str, str]:
        """What the page calls each planner: without the folder of its file where that is clear."""
        names = (*self.planners, *self.variants)
        short = {name: PurePath(name).name if is_file_name(name) else name for name in names}
        count = Counter(short[name] for name in dict.fromkeys(names))
        return {name: short[name] if count[short[name]] == 1 else name for name in names}

    def given(self, planner: str) -> str:
        """What a planner is given besides pose, twist and goal, in two or three words."""
        return given_text(self.requirements[planner])

    def rows_of(self, scenario: str, planner: str) -> list[Row]:
        """The episodes of one group, by seed."""
        return [
            row for row in self.rows if (row["scenario"], row["planner"]) == (scenario, planner)
        ]

    def reached(self, scenario: str, planner: str) -> dict[int, Row]:
        """The episodes of one group that reached the goal without contact, by seed."""
        return {
            row["seed"]: row
            for row in self.rows_of(scenario, planner)
            if row["outcome"] == Outcome.GOAL_REACHED.value
        }


def contents_of(folder: BenchFolder) -> Contents:
    """Put a benchmark in order."""
    with_options = [name for name in folder.planners if _is_variant(name)]
    plain = [name for name in folder.planners if not _is_variant(name)]
    numbers = Counter(disturbance_of(row) for row in folder.rows)
    whole = [name for name in ("fuzzy", "multilayer") if name in plain] if with_options else []
    return Contents(
        folder=folder,
        scenarios=tuple(_sorted(folder.scenarios, PAPER_SCENARIOS)),
        planners=tuple(_sorted(plain or with_options, ORDER)),
        variants=(*whole, *sorted(with_options)),
        disturbance=PERFECT if PERFECT in numbers else numbers.most_common(1)[0][0],
    )


def given_text(needs: Requirements | None) -> str:
    """What planners that require this are given besides pose, twist and goal."""
    if needs is None:
        return UNKNOWN
    given = ["obstacles"] if needs.obstacles else ["scan"] if needs.scan else []
    given += ["static map"] if needs.static_map else []
    return " + ".join(given) or "nothing more"


def _is_variant(name: str) -> bool:
    return name.startswith(("fuzzy:", "multilayer:"))


def _sorted(names: Sequence[str], first: Sequence[str]) -> list[str]:
    rank = {name: index for index, name in enumerate(first)}
    return sorted(names, key=lambda name: (rank.get(name, len(first)), name))


def _requirements(name: str) -> Requirements | None:
    try:
        return make_planner(name).requires
    except FuzzyNavError:
        return None
