"""What is on a report's page, in order."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.reporting.bars import bar_pictures
from fuzzynav_mj.reporting.contents import Contents
from fuzzynav_mj.reporting.fuzzy_figures import fuzzy_pictures
from fuzzynav_mj.reporting.page import Section
from fuzzynav_mj.reporting.risk_figure import risk_picture
from fuzzynav_mj.reporting.style import Picture
from fuzzynav_mj.reporting.table import Table
from fuzzynav_mj.reporting.tables import comparison_tables
from fuzzynav_mj.reporting.traces import Trace
from fuzzynav_mj.reporting.trajectories import frame_picture, trajectory_pictures
from fuzzynav_mj.reporting.variations import variation_tables
from fuzzynav_mj.robot import DEFAULT_ROBOT

TITLE = "Navigation among moving obstacles: planners compared"
SHOWN = "fuzzy"  # the planner of the pictures of one run
PAPER = (
    "Beside our numbers stand those of F. Kamil and M. Y. Moghrabiah, Multilayer Decision-Based "
    "Fuzzy Logic Model to Navigate Mobile Robot in Unknown Dynamic Environments, Fuzzy Information "
    "and Engineering 14(1), 2022, doi 10.1080/16168658.2021.2019432. They are set in italics "
    'under "paper\'s", and drawn as open diamonds.'
)


def sections(
    contents: Contents, traces: Sequence[Trace], notes: Sequence[str], out: Path
) -> list[Section]:
    """Every section; the pictures are written to `out`.

    Raises:
        FuzzyNavError: a picture cannot be written.
    """

    def written(pictures: Iterable[Picture]) -> list[tuple[Picture, bytes]]:
        return [(picture, picture.write(out)) for picture in pictures]

    gate = RiskGate()
    found = [_what_was_run(contents)]
    found.append(Section("Comparison", (), comparison_tables(contents)))
    found.append(Section("Comparison in pictures", (), written(bar_pictures(contents))))
    ways = written(trajectory_pictures(traces, contents.planners, contents.labels))
    if ways:
        found.append(Section("Ways", (), ways))
    shown = [trace for trace in traces if trace.job.planner == SHOWN and len(trace.times)]
    if shown:
        found.append(Section("One run", (), written(_one_run(shown[0], gate))))
    found.append(
        Section(
            "The fuzzy system",
            ("The same for every run: it depends on the program alone.",),
            written(fuzzy_pictures(gate)),
        )
    )
    variations = variation_tables(contents)
    if variations:
        found.append(Section("Variations", (), variations))
    remarks = [*notes, *_lost(contents)]
    if remarks:
        found.append(Section("Notes", remarks))
    return found


def _one_run(trace: Trace, gate: RiskGate) -> Iterator[Picture]:
    yield frame_picture(trace)
    risk = risk_picture(trace, gate)
    if risk is not None:
        yield risk


def _lost(contents: Contents) -> Iterator[str]:
    """A sentence for every world and planner with episodes that came to no end of their own."""
    groups: dict[tuple[str, str], list[str]] = {}
    for key, reason in sorted(contents.folder.failures.items()):
        groups.setdefault((key.scenario, key.planner), []).append(reason)
    for (scenario, planner), reasons in groups.items():
        yield (
            f"{scenario}, {planner}: {len(reasons)} episodes came to no end of their own and "
            f"count nowhere on this page; the first for: {reasons[0]}."
        )


def _what_was_run(contents: Contents) -> Section:
    seeds = [row["seed"] for row in contents.rows]
    numbers = [summary.episodes for summary in contents.summaries.values()]
    each = str(min(numbers)) if min(numbers) == max(numbers) else f"{min(numbers)}-{max(numbers)}"
    versions = sorted({_versions(row) for row in contents.rows})
    lines = (
        f"{len(contents.rows)} episodes, {each} for each world and planner, seeds {min(seeds)} to "
        f"{max(seeds)}. Disturbance of sensors and floor: {contents.disturbance}.",
        *(f"Ran on {text}." for text in versions if text),
        PAPER,
        "Planners that are given more are no equals of those that are given less. All know the "
        "robot's pose and twist and the goal. Scan: "
        f"{DEFAULT_ROBOT.ray_count} ranges of up to {DEFAULT_ROBOT.sensor_range:g} m. Obstacles: "
        "those perceived in the scan, with their velocities. Static map: the outlines of "
        "everything that stands, known beforehand.",
    )
    rows = tuple(
        (contents.labels[name], contents.given(name), str(_episodes(contents, name)), name)
        for name in dict.fromkeys((*contents.planners, *contents.variants))
    )
    table = Table("Planners", ("planner", "given", "episodes", "as --planner"), rows)
    return Section("What was run", lines, (table,))


def _episodes(contents: Contents, planner: str) -> int:
    return sum(row["planner"] == planner for row in contents.rows)


def _versions(row: dict[str, object]) -> str:
    return ", ".join(
        f"{name.removeprefix('version_')} {text}"
        for name, text in sorted(row.items())
        if name.startswith("version_") and text is not None
    )
