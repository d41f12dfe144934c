"""Planners of the user's own: found by file or by entry point, and held to the protocol."""

from collections.abc import Callable
from importlib.metadata import EntryPoint
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from fuzzynav_mj.cli import main
from fuzzynav_mj.planners import make_planner, own, planner_names
from fuzzynav_mj.planners.base import Requirements
from fuzzynav_mj.results import TABLE
from fuzzynav_mj.runner import play_episode
from fuzzynav_mj.scenarios import load_scenario

AHEAD = """\
from dataclasses import dataclass
from fuzzynav_mj.planners.base import Requirements
from fuzzynav_mj.types import Behaviour, Decision

made = []

@dataclass
class Step:
    length: float = 0.05

class Ahead:
    requires = Requirements(scan=False, obstacles=False)

    def __init__(self):
        made.append(self)

    def reset(self, problem, rng):
        self.goal = problem.goal

    def decide(self, observation):
        x, y = observation.pose.x, observation.pose.y
        return Decision((min(x + Step().length, self.goal[0]), y), Behaviour.GOAL_SEEKING)
"""

Writer = Callable[[str], str]


@pytest.fixture
def write(tmp_path: Path) -> Writer:
    """A function that writes a planner's file and returns its path."""

    def put(text: str) -> str:
        path = tmp_path / "mine.py"
        path.write_text(text)
        return str(path)

    return put


def line_of(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """The one line on standard error of a command that ends with status 2."""
    assert main(list(arguments)) == 2
    output = capsys.readouterr()
    assert output.out == ""
    (line,) = output.err.splitlines()
    return line.removeprefix("fuzzynav: ")


def test_a_class_in_a_file_drives_to_the_goal_under_the_name_as_given(
    write: Writer, write_scenario: Callable[..., str]
) -> None:
    name = f"{write(AHEAD)}:Ahead"
    record = play_episode(load_scenario(write_scenario("open")), name, 3).record
    assert (record.planner, record.outcome.value) == (name, "goal_reached")
    assert make_planner(name).requires == Requirements(scan=False, obstacles=False)


def test_nothing_lasts_from_one_planner_to_the_next(write: Writer) -> None:
    """The file is run anew for every episode, so what it keeps in its module is new too."""
    name = f"{write(AHEAD)}:Ahead"
    for _ in range(2):
        inner = make_planner(name)._planner  # type: ignore[attr-defined]
        assert len(inner.__init__.__globals__["made"]) == 1


def test_planners_of_the_same_file_name_stay_apart_in_a_benchmark(
    tmp_path: Path, write_scenario: Callable[..., str], capsys: pytest.CaptureFixture[str]
) -> None:
    backwards = AHEAD.replace("x + Step", "x - Step")
    names = []
    for folder, text in (("a", AHEAD), ("b", backwards)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "mine.py").write_text(text)
        names.append(f"{tmp_path}/{folder}/mine.py:Ahead")
    out = tmp_path / "out"
    command = ["bench", write_scenario("open"), "--planner", *names, "--out", str(out)]
    assert main([*command, "--episodes", "1", "--jobs", "1"]) == 0
    rows = pq.read_table(out / TABLE).to_pylist()
    assert [(row["planner"], row["outcome"]) for row in rows] == [
        (names[0], "goal_reached"), (names[1], "contact"),
    ]  # fmt: skip
    assert rows[0]["planner_sha256"] != rows[1]["planner_sha256"]
    (tmp_path / "a" / "mine.py").write_text(AHEAD + "# changed\n")
    capsys.readouterr()
    assert main([*command, "--episodes", "1", "--jobs", "1", "--resume"]) == 0
    assert capsys.readouterr().err.splitlines() == [
        f"fuzzynav: {out} holds episodes of {names[0]} from before its file was changed",
        f"fuzzynav: 2 of 2 episodes are in {out} already",
    ]


def test_a_registered_planner_goes_by_its_name(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    points = [
        EntryPoint("mine", "fuzzynav_mj.planners.multilayer:MultilayerPlanner", own.GROUP),
        EntryPoint("gone", "no_such_package:Planner", own.GROUP),
        EntryPoint("fuzzy", "no_such_package:Planner", own.GROUP),
    ]
    monkeypatch.setattr(own, "entry_points", lambda group: points if group == own.GROUP else [])
    assert {"fuzzy", "gone", "mine"} <= set(planner_names())
    assert make_planner("mine").requires.obstacles
    make_planner("fuzzy")  # a built-in planner is not replaced
    assert line_of(capsys, "run", "convex", "--planner", "gone") == (
        "gone: entry point 'no_such_package:Planner' cannot be imported: "
        "ModuleNotFoundError: No module named 'no_such_package'"
    )
    assert main(["list", "planners"]) == 0
    lines = {line.split()[0]: line.split(maxsplit=1)[1] for line in
             capsys.readouterr().out.splitlines()}  # fmt: skip
    assert lines["mine"] == lines["multilayer"]
    assert lines["gone"].startswith("cannot be used: gone: entry point")


@pytest.mark.parametrize(
    ("text", "suffix", "expected"),
    [
        (AHEAD, "", "{file}: --planner: given a file without a class; allowed is FILE.py:CLASS"),
        (
            AHEAD, ":Behind",
            "{file}: --planner: given class 'Behind'; allowed is a class of this file: Step, Ahead",
        ),
        (
            "x = 1", ":x",
            "{file}: --planner: given class 'x'; allowed is a class of this file: it has none",
        ),
        (
            AHEAD, ":Step",
            "{file}:Step: given a class Step without requires, reset, decide; "
            "allowed is a class with requires, reset and decide",
        ),
        (
            AHEAD.replace("requires = Requirements(scan=False, obstacles=False)", "requires = 1"),
            ":Ahead",
            "{file}:Ahead: requires: given a value of type int; "
            "allowed is a fuzzynav_mj.planners.base.Requirements",
        ),
        (
            "import os\nimport nothing_here\n", ":X",
            "{file}: cannot be imported: line 2: "
            "ModuleNotFoundError: No module named 'nothing_here'",
        ),
        ("raise ValueError('one\\ntwo')", ":X",
         "{file}: cannot be imported: line 1: ValueError: one"),
        ("raise SystemExit", ":X", "{file}: cannot be imported: line 1: SystemExit"),
        ("\n\nclass X", ":X", "{file}: cannot be imported: line 3: SyntaxError: expected ':'"),
        (
            AHEAD.replace("made.append(self)", "1 / 0"), ":Ahead",
            "{file}:Ahead: cannot be made without arguments: "
            "line 15: ZeroDivisionError: division by zero",
        ),
        (
            AHEAD.replace("self.goal = problem.goal", "problem.aim"), ":Ahead",
            "{file}:Ahead: reset: line 18: "
            "AttributeError: 'NavigationProblem' object has no attribute 'aim'",
        ),
        (
            AHEAD.replace("x, y = obs", "assert False, 'no'; x, y = obs"), ":Ahead",
            "{file}:Ahead: decide: line 21: AssertionError: no",
        ),
        (
            AHEAD.replace("return Decision", "Decision"), ":Ahead",
            "{file}:Ahead: decide: given None; allowed is a fuzzynav_mj.types.Decision",
        ),
        (
            AHEAD.replace("length: float = 0.05", "length: float = float('nan')"), ":Ahead",
            "{file}:Ahead: decide: next_position: given (nan, 0.6); "
            "allowed are two finite numbers x, y in m",
        ),
    ],
)  # fmt: skip
def test_mistakes_are_one_line(
    write: Writer,
    write_scenario: Callable[..., str],
    capsys: pytest.CaptureFixture[str],
    text: str,
    suffix: str,
    expected: str,
) -> None:
    file = write(text)
    line = line_of(capsys, "run", write_scenario("open"), "--planner", file + suffix)
    assert line == expected.format(file=file)


def test_a_missing_file_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = f"{tmp_path}/none.py"
    assert line_of(capsys, "bench", "convex", "--planner", f"{file}:X") == (
        f"{file}: --planner: given a file that cannot be read (No such file or directory); "
        "allowed is FILE.py:CLASS"
    )


def test_an_unknown_name_is_told_of_files(capsys: pytest.CaptureFixture[str]) -> None:
    line = line_of(capsys, "run", "convex", "--planner", "mine")
    assert line == (
        f"unknown planner 'mine': allowed are {', '.join(planner_names())}, or FILE.py:CLASS."
    )
