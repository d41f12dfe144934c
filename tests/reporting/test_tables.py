"""The tables' cells, worked out by hand."""

from pathlib import Path

import pytest
from hand_made import row, write_log

from fuzzynav_mj.metrics import wilson_interval
from fuzzynav_mj.reporting.contents import Contents, contents_of
from fuzzynav_mj.reporting.folder import read_folder
from fuzzynav_mj.reporting.table import Table
from fuzzynav_mj.reporting.tables import comparison_tables
from fuzzynav_mj.reporting.variations import differs_in, variation_tables
from fuzzynav_mj.results import Row


def contents(folder: Path, *rows: Row) -> Contents:
    return contents_of(read_folder(write_log(folder, *rows)))


def table(made: Contents, title: str) -> Table:
    """The one table whose title begins so."""
    (found,) = [
        t for t in (*comparison_tables(made), *variation_tables(made)) if t.title.startswith(title)
    ]
    return found


def line(made: Contents, title: str, *first: str) -> dict[str, str]:
    """The one line that begins so, by heading; the paper's columns after the world's name."""
    found = table(made, title)
    (cells,) = [cells for cells in found.rows if cells[: len(first)] == first]
    names, world = [], ""
    for heading in found.headings:
        names.append(f"{world}, {heading}" if heading == "paper's" else heading)
        world = heading
    return dict(zip(names, cells, strict=True))


def test_table_2_stands_beside_the_papers(tmp_path: Path) -> None:
    made = contents(
        tmp_path,
        row(seed=0, path=12.5),
        row(seed=1, path=20.0, sim_time_s=40.0),
        row(seed=2, outcome="contact", path=3.0),
        row(seed=3, outcome="timeout", path=60.0),
    )
    found = table(made, "Table 2")
    assert found.title == "Table 2: planner fuzzy, given obstacles"
    low, high = wilson_interval(2, 4)
    assert found.rows == (
        (
            "concave", "4", f"50.0 [{100 * low:.1f}, {100 * high:.1f}]", "0",
            "16.25 ± 5.30", "13.14 ± 0.60", "65.0 ± 21.2", "35.0 ± 7.1", "4.44 ± 0.33",
            "2.0 / 4.0",
        ),
    )  # fmt: skip
    assert [found.headings[i] for i in sorted(found.theirs)] == [
        "paper's failures %", "paper's path", "paper's run time s",
    ]  # fmt: skip


def test_table_3_has_ours_and_theirs_for_each_world(tmp_path: Path) -> None:
    made = contents(
        tmp_path, row(), row(scenario="trap"), row(planner="multilayer", outcome="stuck")
    )
    paths = table(made, "Table 3, path length")
    assert paths.headings == ("planner", "given", "concave", "paper's", "trap")
    assert paths.rows == (
        ("fuzzy", "obstacles", "12.50 ± -", "13.14", "12.50 ± -"),
        ("multilayer", "obstacles", "-", "13.64", "-"),
    )
    assert paths.theirs == {3}
    assert any(note.startswith("The paper's columns") for note in paths.notes)
    failures = line(made, "Table 3, failures", "multilayer")
    low, _ = wilson_interval(1, 1)
    assert failures["concave"] == f"100.0 [{100 * low:.1f}, 100.0]"
    assert failures["concave, paper's"] == "0"
    assert failures["trap"] == "-"


def test_every_table_of_planners_says_what_they_are_given(tmp_path: Path) -> None:
    made = contents(tmp_path, row(possible="yes"), row(planner="multilayer", possible="yes"),
                    row(planner="fuzzy:gate=60"), row(range_noise_m=0.01))  # fmt: skip
    for found in (*comparison_tables(made), *variation_tables(made)):
        if "planner" in found.headings:
            column = found.headings.index("given")
            planners = [c for c in found.rows if c[found.headings.index("planner")] != "possible?"]
            assert {cells[column] for cells in planners} == {"obstacles"}
        else:
            assert "given obstacles" in found.title


def test_paths_are_compared_on_the_seeds_that_both_reached(tmp_path: Path) -> None:
    made = contents(
        tmp_path,
        row(seed=0, path=10.0), row(seed=1, path=20.0), row(seed=2, path=10.0),
        row(seed=3, outcome="contact"),
        row(planner="multilayer", seed=0, path=11.0), row(planner="multilayer", seed=1, path=26.0),
        row(planner="multilayer", seed=2, outcome="contact"),
        row(planner="multilayer", seed=3, path=30.0),
    )  # fmt: skip
    # 10 and 30 per cent longer: mean 20, sample standard deviation 14.1
    assert line(made, "Path longer", "multilayer")["concave"] == "+20.0 ± 14.1 (2)"


def test_endings_are_counted(tmp_path: Path) -> None:
    made = contents(
        tmp_path,
        row(seed=0),
        row(seed=1, outcome="contact", contact_with="moving:2", contact_at_fault=True),
        row(seed=2, outcome="contact", contact_with="wall", contact_at_fault=True),
        row(seed=3, outcome="contact", contact_with="moving:0", contact_at_fault=False),
        row(seed=4, outcome="no_path"),
    )
    assert table(made, "How the episodes ended").rows == (
        ("fuzzy", "obstacles", "5", "1", "2", "1", "2", "0", "0", "1", "0"),
    )


def test_the_oracles_limit_appears_with_its_columns_only(tmp_path: Path) -> None:
    without = contents(tmp_path / "without", row())
    assert not [t for t in comparison_tables(without) if t.title.startswith("Success in")]
    made = contents(
        tmp_path / "with",
        row(seed=0, possible="yes"), row(seed=1, possible="yes", outcome="contact"),
        row(seed=2, possible="no", outcome="contact"), row(seed=3, possible="unknown"),
    )  # fmt: skip
    found = table(made, "Success in")
    assert found.rows[0] == ("possible?", "every motion", "2 yes, 1 unknown, 1 no")
    assert found.rows[1][2].startswith("1 / 2: 50.0 [")


def test_variants_have_a_table_of_their_own(tmp_path: Path) -> None:
    names = ("fuzzy", "multilayer", "fuzzy:gate=60", "fuzzy:prediction=off")
    made = contents(tmp_path, *(row(planner=name, gate_vetoes=3) for name in names))
    assert made.planners == ("fuzzy", "multilayer")
    assert [cells[:2] for cells in table(made, "Ablation").rows] == [
        ("fuzzy", "nothing: the whole method"),
        ("multilayer", "no fuzzy gate"),
        ("fuzzy:gate=60", "gate at 60"),
        ("fuzzy:prediction=off", "movers taken as standing"),
    ]
    assert line(made, "Ablation", "fuzzy:gate=60")["concave"] == (
        "1 / 1: 100.0 [20.7, 100.0]; 12.50 ± -; 3.0"
    )


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("fuzzy:rules=paper", "the 28 published rules alone"),
        ("fuzzy:gate=90,rules=strict", "gate at 90, rules strict"),
        ("multilayer:prediction=off", "no fuzzy gate, movers taken as standing"),
    ],
)
def test_what_a_variant_differs_in(name: str, words: str) -> None:
    assert differs_in(name) == words


def test_imperfect_senses_are_kept_apart(tmp_path: Path) -> None:
    made = contents(
        tmp_path, row(), row(range_noise_m=0.01, outcome="contact"), row(seed=1, range_noise_m=0.01)
    )
    assert table(made, "Table 2").rows[0][1] == "1"
    lines = table(made, "Success with imperfect").rows
    assert [cells[:2] for cells in lines] == [("none", "fuzzy"), ("noise 0.01 m", "fuzzy")]
    assert lines[1][3].startswith("1 / 2: 50.0 [")


def test_without_perfect_senses_the_most_frequent_ones_are_reported(tmp_path: Path) -> None:
    made = contents(
        tmp_path, row(dropouts=0.02), row(range_noise_m=0.01), row(range_noise_m=0.01, seed=1)
    )
    assert str(made.disturbance) == "noise 0.01 m"
    assert table(made, "Table 2").rows[0][1] == "2"


def test_failures_everywhere_leave_dashes(tmp_path: Path) -> None:
    made = contents(tmp_path, row(outcome="contact", plan_ms_p50=None, plan_ms_p99=None))
    cells = table(made, "Table 2").rows[0]
    assert (cells[4], cells[6], cells[7], cells[9]) == ("-", "-", "-", "-")


def test_the_papers_worlds_and_planner_come_first(tmp_path: Path) -> None:
    made = contents(
        tmp_path, row(scenario="a"), row(scenario="narrow"), row(scenario="convex"),
        row(scenario="a", planner="aaa.py:Mine"), row(scenario="a", planner="multilayer"),
    )  # fmt: skip
    assert made.scenarios == ("convex", "narrow", "a")
    assert made.planners == ("fuzzy", "multilayer", "aaa.py:Mine")
    assert made.given("aaa.py:Mine") == "unknown"  # the file is gone


def test_variants_alone_are_compared_as_planners(tmp_path: Path) -> None:
    made = contents(tmp_path, row(planner="fuzzy:gate=60"), row(planner="fuzzy:gate=90"))
    assert made.planners == ("fuzzy:gate=60", "fuzzy:gate=90")
    paths = table(made, "Table 3, path length")
    assert len(paths.rows) == 2
    assert not any("paper" in note for note in paths.notes)  # it has no numbers for them


def test_files_of_the_same_name_keep_their_folders(tmp_path: Path) -> None:
    names = ("a/mine.py:P", "b/mine.py:P", "b/other.py:P")
    made = contents(tmp_path, *(row(planner=name) for name in names))
    assert [made.labels[name] for name in names] == ["a/mine.py:P", "b/mine.py:P", "other.py:P"]


def test_markdown_and_html_mark_what_is_the_papers() -> None:
    shown = Table("A < B", ("x", "paper's"), (("a|b", "7"), ("<c>", "-")), ("Note & note.",),
                  frozenset({1}))  # fmt: skip
    assert shown.markdown().splitlines() == [
        "### A < B", "", "| x | *paper's* |", "| --- | --- |", "| a\\|b | *7* |", "| <c> | - |",
        "", "Note & note.",
    ]  # fmt: skip
    html = shown.html()
    assert "<h3>A &lt; B</h3>" in html
    assert '<td>a|b</td><td class="theirs">7</td>' in html
    assert "<td>&lt;c&gt;</td>" in html and "Note &amp; note." in html
