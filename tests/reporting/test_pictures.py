"""What the pictures draw: the engine's own numbers, well-formed files, the same bytes twice."""

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hand_made import row, write_log
from matplotlib.figure import Figure

from fuzzynav_mj.fuzzy.membership import DistanceTerm, RiskTerm
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.fuzzy.rules import INPUTS
from fuzzynav_mj.planners.base import Requirements
from fuzzynav_mj.reporting.bars import bar_pictures
from fuzzynav_mj.reporting.contents import contents_of
from fuzzynav_mj.reporting.folder import read_folder
from fuzzynav_mj.reporting.fuzzy_figures import PAIRS, fuzzy_pictures, surface
from fuzzynav_mj.reporting.style import Picture, fill_style, line_styles
from fuzzynav_mj.types import FuzzyInputs

GATE = RiskGate()


def bars(folder: Path, *rows: dict[str, object]) -> dict[str, Picture]:
    made = contents_of(read_folder(write_log(folder, *rows)))
    return {picture.name: picture for picture in bar_pictures(made)}


def lengths(figure: Figure, panel: int = 0) -> list[float]:
    return [bar.get_width() for bar in figure.axes[panel].patches]


@pytest.mark.parametrize("pair", PAIRS)
def test_a_surface_is_what_the_gate_says_of_each_pair(pair: tuple[str, str]) -> None:
    first, second = pair
    distances, risks = surface(GATE, first, second)
    for column, near in enumerate(distances[::10]):
        for line, other in enumerate(distances[::10]):
            clear = dict.fromkeys(INPUTS, 1.0)
            inputs = FuzzyInputs(**clear | {first: float(near), second: float(other)})
            assert risks[::10, ::10][line, column] == pytest.approx(GATE.risk(inputs), abs=1e-9)


def test_the_drawn_memberships_are_the_gates() -> None:
    memberships = next(iter(fuzzy_pictures(GATE))).figure
    left, right = memberships.axes
    x = np.linspace(0.0, 1.0, 201)
    drawn = [np.interp(x, *line.get_data()) for line in left.lines]
    grades = GATE.memberships.distance_grades(x)
    for line, term in zip(drawn, (DistanceTerm.C, DistanceTerm.M, DistanceTerm.F, DistanceTerm.VF),
                          strict=True):  # fmt: skip
        assert line == pytest.approx(grades[:, term], abs=1e-9)
    risk = np.linspace(0.0, 100.0, 201)
    for line, term in zip(right.lines, RiskTerm, strict=False):
        shown = np.interp(risk, *line.get_data())
        assert shown == pytest.approx(GATE.memberships.risk_grades(risk)[:, term], abs=1e-9)


def test_bars_are_the_means_of_the_episodes_that_reached_the_goal(tmp_path: Path) -> None:
    made = bars(
        tmp_path, row(seed=0, path=12.0), row(seed=1, path=16.0), row(seed=2, outcome="contact"),
        row(planner="multilayer", outcome="contact"),
    )  # fmt: skip
    assert lengths(made["path_length"].figure) == [14.0]  # none for the planner that never did
    assert lengths(made["optimality"].figure) == [pytest.approx(100 * (10 / 12 + 10 / 16) / 2)]
    assert lengths(made["success"].figure) == [pytest.approx(200 / 3), 0.0]


def test_the_papers_numbers_are_open_diamonds_in_its_own_worlds(tmp_path: Path) -> None:
    made = bars(tmp_path, row(), row(scenario="trap"))
    ours, other = made["path_length"].figure.axes
    diamonds = [line for line in ours.lines if line.get_marker() == "D"]
    assert [float(line.get_xdata()[0]) for line in diamonds] == [13.14]
    assert [line.get_markerfacecolor() for line in diamonds] == ["white"]
    assert not [line for line in other.lines if line.get_marker() == "D"]


def test_the_oracles_share_is_a_line(tmp_path: Path) -> None:
    made = bars(
        tmp_path, row(seed=0, possible="yes"), row(seed=1, possible="unknown"),
        row(seed=2, possible="no", outcome="contact"), row(seed=3, possible="yes"),
    )  # fmt: skip
    axes = made["success"].figure.axes[0]
    marks = {float(line.get_xdata()[0]) for line in axes.lines if line.get_marker() == "None"}
    assert {50.0, 75.0} <= marks


def test_planners_that_know_different_things_look_different_in_grey() -> None:
    kinds = [
        Requirements(scan, obstacles, static_map)
        for scan, obstacles in ((False, False), (True, False), (True, True))
        for static_map in (False, True)
    ]
    assert len({fill_style(kind).hatch for kind in (*kinds, None)}) == len(kinds) + 1
    styles = line_styles([str(n) for n in range(40)])
    assert len(set(styles.values())) == 40
    greyless = {(style.dashes, style.marker) for style in styles.values()}
    assert len(greyless) == 40


def test_files_are_well_formed_and_the_same_every_time(tmp_path: Path) -> None:
    folders = []
    for name in ("one", "two"):
        folders.append(tmp_path / name)
        for picture in bars(folders[-1], row(), row(scenario="odd & <$\\frac{>")).values():
            assert picture.write(folders[-1]).startswith(b"\x89PNG")
    pictures = sorted(path.name for path in folders[0].iterdir() if path.suffix != ".jsonl")
    assert len(pictures) == 8
    for name in pictures:
        content = (folders[0] / name).read_bytes()
        assert content == (folders[1] / name).read_bytes()
        if name.endswith(".svg"):
            assert ElementTree.fromstring(content).tag.endswith("svg")
