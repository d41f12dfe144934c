"""`fuzzynav report` from outside: which files it writes, what is on the page, and its errors."""

import json
import re
from base64 import b64decode
from html.parser import HTMLParser
from pathlib import Path

import pytest
from hand_made import row, write_log

from fuzzynav_mj.cli import main
from fuzzynav_mj.commands import report as report_command
from fuzzynav_mj.reporting import sections
from fuzzynav_mj.results import LOG, TABLE

OBSTACLES = """
[[static]]
circle = [0.85, 0.75, 0.05]
[[moving]]
circle = 0.1
waypoints = [[1.5, 0.3], [1.5, 0.9]]
speed = 0.3
"""

DRAWN_WITHOUT_RUNS = {
    f"{name}.{kind}"
    for name in (
        "path_length", "optimality", "success", "decision_time", "memberships", "surfaces",
    )
    for kind in ("png", "svg")
}  # fmt: skip


class References(HTMLParser):
    """Collects what a page would load or leads to."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self.tags: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.found += [value or "" for name, value in attrs if name in ("src", "href", "data")]


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def error_line(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(list(arguments)) == 2
    output = capsys.readouterr()
    assert output.out == ""
    (line,) = output.err.splitlines()
    return line.removeprefix("fuzzynav: ")


@pytest.fixture(scope="module")
def benched(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A benchmark of a small world of the user's own, whose file is gone again."""
    folder = tmp_path_factory.mktemp("benched")
    file = folder / "small.toml"
    file.write_text(
        'schema = 1\nname = "small/world"\nbounds = [0.0, 0.0, 2.0, 1.2]\n'
        "[robot]\nstart = [0.5, 0.6, 0.0]\ngoal = [1.1, 0.6]\n" + OBSTACLES
    )
    options = ["--planner", "fuzzy", "multilayer", "--episodes", "1", "--seed", "4", "--jobs", "1"]
    assert main(["bench", str(file), *options, "--oracle", "--out", str(folder / "out")]) == 0
    file.unlink()
    return folder / "out"


def leave_out_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leaves out those that every report has: the tests of pictures are elsewhere."""
    for name in ("bar_pictures", "fuzzy_pictures"):
        monkeypatch.setattr(sections, name, lambda _: [])


def test_a_report_is_whole_repeatable_and_stands_alone(
    benched: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before = {path.name: path.read_bytes() for path in benched.iterdir() if path.is_file()}
    first, second = tmp_path / "first", tmp_path / "second"
    assert main(["report", str(benched), "--out", str(first), "--jobs", "1"]) == 0
    assert capsys.readouterr().out == f"report: {first}/report.html, {first}/report.md\n"
    runs = {f"{name}.{kind}" for name in ("ways_small_world", "frames_small_world", "risk")
            for kind in ("png", "svg")}  # fmt: skip
    assert names(first) == DRAWN_WITHOUT_RUNS | runs | {"report.html", "report.md"}
    with monkeypatch.context() as patch:
        leave_out_pictures(patch)
        assert main(["report", str(benched), "--out", str(second), "--jobs", "1"]) == 0
    for name in runs:
        assert (first / name).read_bytes() == (second / name).read_bytes(), name
    after = {path.name: path.read_bytes() for path in benched.iterdir() if path.is_file()}
    assert after == before

    page = (first / "report.html").read_text()
    references = References()
    references.feed(page)
    pictures = [reference.removeprefix("data:image/png;base64,") for reference in references.found]
    assert len(pictures) == len(DRAWN_WITHOUT_RUNS | runs) / 2
    assert all(b64decode(picture).startswith(b"\x89PNG") for picture in pictures)
    assert "url(" not in page and "@import" not in page
    assert not {"script", "link", "iframe"} & set(references.tags)
    assert "Notes" not in page  # every replayed episode is the one that was counted

    text = (first / "report.md").read_text()
    linked = re.findall(r"!\[[^]]*\]\(([^)]+)\)", text)
    assert len(linked) == len(pictures) and set(linked) <= names(first)
    assert "| small/world | 1 |" in text
    assert "seeds 4 to 4" in text


def test_without_runs_the_page_says_why(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    leave_out_pictures(monkeypatch)
    folder = write_log(
        tmp_path, row(scenario="lost"), row(planner="gone.py:P", outcome="contact"),
        {"scenario": "lost", "planner": "fuzzy", "seed": 1, "error": "it broke"},
    )  # fmt: skip
    assert main(["report", str(folder)]) == 0
    assert names(folder / "report") == {"report.html", "report.md"}
    notes = (folder / "report" / "report.md").read_text().split("## Notes")[1]
    assert f"No ways through lost: its file is not in {folder}/scenarios." in notes
    assert "No ways through concave: the library's file has changed since." in notes
    assert (
        "lost, fuzzy: 1 episodes came to no end of their own and count nowhere on this page; "
        "the first for: it broke." in notes
    )


def test_an_episode_that_comes_out_otherwise_is_named(
    benched: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    leave_out_pictures(monkeypatch)
    lines = [json.loads(line) for line in (benched / LOG).read_text().splitlines()]
    changed = [line | {"path_length_m": 9.0} for line in lines if line["planner"] == "fuzzy"]
    folder = write_log(tmp_path / "changed", *changed)
    (folder / "scenarios").mkdir()
    for copy in (benched / "scenarios").iterdir():
        (folder / "scenarios" / copy.name).write_bytes(copy.read_bytes())
    assert main(["report", str(folder), "--jobs", "1"]) == 0
    notes = (folder / "report" / "report.md").read_text().split("## Notes")[1]
    assert "small/world, fuzzy, seed 4: played once more it ended with goal_reached after" in notes
    assert "but its row says goal_reached after 9.00 m; the program or the planner has" in notes


def test_the_table_alone_will_do(
    benched: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    leave_out_pictures(monkeypatch)
    folder = tmp_path / "table"
    folder.mkdir()
    (folder / TABLE).write_bytes((benched / TABLE).read_bytes())
    assert main(["report", str(folder)]) == 0
    assert "| small/world | 1 |" in (folder / "report" / "report.md").read_text()


MADE_BY_BENCH = "allowed is one that fuzzynav bench has written"


def test_an_empty_or_missing_folder_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for folder in (tmp_path, tmp_path / "missing"):
        assert error_line(capsys, "report", str(folder)) == (
            f"{folder}: given a folder without episodes.jsonl and episodes.parquet; {MADE_BY_BENCH}"
        )


def test_episodes_that_all_failed_are_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    failed = {"scenario": "maze", "planner": "fuzzy", "seed": 1, "error": "it broke"}
    folder = write_log(tmp_path, failed)
    assert error_line(capsys, "report", str(folder)) == (
        f"{folder}: given a folder without a finished episode; allowed is one with at least one"
    )


def test_a_file_that_is_no_log_or_table_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / TABLE).write_text("x")
    assert error_line(capsys, "report", str(tmp_path)) == (
        f"{tmp_path}/episodes.parquet: given a file that is no table of episodes; {MADE_BY_BENCH}"
    )
    (tmp_path / LOG).write_text("x\n")
    assert error_line(capsys, "report", str(tmp_path)) == (
        f"{tmp_path}/episodes.jsonl: line 1: given text that is not an episode; "
        "allowed is one JSON object with scenario, planner and seed"
    )
    write_log(tmp_path, {"scenario": "maze", "planner": "fuzzy", "seed": 1})
    assert error_line(capsys, "report", str(tmp_path)) == (
        f"{tmp_path}: maze, fuzzy, seed 1: given an episode without outcome, path_length_m"
    )


def test_a_place_that_cannot_be_written_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = write_log(tmp_path / "bench", row())
    (tmp_path / "file").touch()

    def played(*_: object) -> None:
        raise AssertionError("an episode was played")

    monkeypatch.setattr(report_command, "run_parallel", played)
    assert error_line(capsys, "report", str(folder), "--out", str(tmp_path / "file")) == (
        f"{tmp_path}/file: --out: given a folder that cannot be used (File exists); "
        "allowed is one that can be written"
    )
