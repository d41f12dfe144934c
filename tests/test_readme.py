"""What the README and the pages beside it show can be run, and what they name exists."""

import re
import shlex
import tomllib
from pathlib import Path

import pytest

from fuzzynav_mj.cli import _parser, main
from fuzzynav_mj.commands.bench import PAPER_SCENARIOS
from fuzzynav_mj.fuzzy.completion import Origin, rule_table
from fuzzynav_mj.fuzzy.membership import DEFAULT_MEMBERSHIPS
from fuzzynav_mj.metrics import record_to_json, wilson_interval
from fuzzynav_mj.runner import play_episode
from fuzzynav_mj.scenarios import library_names, load_scenario
from fuzzynav_mj.scenarios.file_format import SECTIONS, ScenarioFile

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"
OWN_FILES = {"my_planner.py"}  # that the reader is told to write
PAGES = (README, *sorted((ROOT / "docs").glob("*.md")))


def blocks(page: Path, language: str) -> list[str]:
    """The fenced code blocks of one language."""
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.M | re.S)


def commands(program: str) -> list[str]:
    """Every command line of a program, in shell blocks and within the text, without comments."""
    found = []
    for page in PAGES:
        lines = [line for block in blocks(page, "sh") for line in block.splitlines()]
        lines += re.findall(
            r"`([^`\n]+)`", re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S)
        )
        for line in lines:
            words = shlex.split(line, comments=True)
            start = next((i for i, word in enumerate(words) if Path(word).name == program), None)
            if start is not None and len(words) > start + 1 and "..." not in words:
                found.append(shlex.join(words[start:]))
    return sorted(set(found))


def test_the_agent_reaches_the_goal(capsys: pytest.CaptureFixture[str]) -> None:
    code, _ = blocks(README, "python")
    exec(compile(code, str(README), "exec"), {})
    assert capsys.readouterr().out == "reward: 1.0\n"


def test_the_own_planner_reaches_the_goal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    _, code = blocks(README, "python")
    (tmp_path / "my_planner.py").write_text(code)
    monkeypatch.chdir(tmp_path)
    (command,) = (line for line in commands("fuzzynav") if line.startswith("fuzzynav run convex"))
    assert main(shlex.split(command)[1:]) == 0
    first = capsys.readouterr().out.splitlines()[0]
    assert first == "convex, planner my_planner.py:WidestGap, seed 5: goal reached"


@pytest.mark.parametrize("command", commands("fuzzynav"))
def test_every_command_is_understood(command: str) -> None:
    arguments = _parser().parse_args(shlex.split(command)[1:])
    named = [getattr(arguments, "scenario", None), *getattr(arguments, "scenarios", [])]
    known = {None, *library_names(), "my_room.toml"}
    assert set(named) <= known


def test_commands_are_found() -> None:
    assert {"run", "bench", "list", "check"} <= {line.split()[1] for line in commands("fuzzynav")}
    assert {"make demo", "make test"} <= set(commands("make"))


@pytest.mark.parametrize("command", commands("make"))
def test_every_make_target_exists(command: str) -> None:
    target = command.split()[1]
    assert re.search(rf"^{target}:", (ROOT / "Makefile").read_text(), re.M)


def test_the_own_world_is_good_and_the_robot_gets_through(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (text,) = blocks(README, "toml")
    (tmp_path / "my_room.toml").write_text(text)
    monkeypatch.chdir(tmp_path)
    assert main(["check", "my_room.toml"]) == 0
    assert capsys.readouterr().out == "my_room.toml: ok (my_room)\n"
    assert main(["run", "my_room.toml", "--quiet"]) == 0


def test_the_file_with_every_key_is_good_and_complete(tmp_path: Path) -> None:
    (text,) = blocks(ROOT / "docs" / "formats.md", "toml")
    file = tmp_path / "every_key.toml"
    file.write_text(text)
    assert load_scenario(str(file)).name == "every_key"
    table = tomllib.loads(text)
    assert set(table) == {field.alias or name for name, field in ScenarioFile.model_fields.items()}
    for section, model in SECTIONS.items():
        rows = table[section] if isinstance(table[section], list) else [table[section]]
        assert {key for row in rows for key in row} == set(model.model_fields)


def test_the_record_page_names_every_field(tmp_path: Path) -> None:
    page = (
        (ROOT / "docs" / "formats.md")
        .read_text()
        .split("## Episode record")[1]
        .split("| column |")[0]
    )
    described = [
        name
        for line in page.splitlines()
        if line.startswith("| `")
        for name in re.findall(r"`(\w+)`", line.split("|")[1])
    ]
    file = tmp_path / "here.toml"
    file.write_text(
        'schema = 1\nname = "here"\nbounds = [0, 0, 2, 2]\n'
        "[robot]\nstart = [1.0, 1.0, 0.0]\ngoal = [1.1, 1.0]\n"
    )
    record = play_episode(load_scenario(str(file)), "fuzzy", 0).record
    assert sorted(described) == sorted(record_to_json(record))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)]+)\)", page.read_text()):
        if not target.startswith("https://"):
            path, _, anchor = target.partition("#")
            file = page.parent / path
            assert file.is_file(), target
            headings = re.findall(r"^#+ (.+)$", file.read_text(), re.M) if anchor else []
            assert not anchor or anchor in {h.lower().replace(" ", "-") for h in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_files_named_exist(page: Path) -> None:
    for name in re.findall(r"\b[\w/]+(?:\.py|\.xml|/(?=[ `,;.]))", page.read_text()):
        roots = (ROOT, ROOT / "fuzzynav_mj", ROOT / "fuzzynav_mj" / "planners")
        assert name in OWN_FILES or any((root / name).exists() for root in roots), name


def test_the_breakpoints_are_those_in_use() -> None:
    page = (ROOT / "docs" / "assumptions.md").read_text()
    shown = [(float(a), float(b)) for a, b in re.findall(r"\| ([\d.]+) to ([\d.]+) (?=\|)", page)]
    distance = [ramp for ramp in shown if ramp[1] <= 1.0]
    risk = [ramp for ramp in shown if ramp[1] > 1.0]
    assert distance == list(DEFAULT_MEMBERSHIPS.distance_ramps)
    assert risk == list(DEFAULT_MEMBERSHIPS.risk_ramps)


def test_the_origins_of_the_rules_are_counted_right() -> None:
    page = (ROOT / "docs" / "assumptions.md").read_text()
    shown = [int(n) for n in re.findall(r"^\| (\d+) \|", page, re.M)]
    origin = rule_table().origin
    count = {kind: int((origin == kind).sum()) for kind in Origin}
    forced = count[Origin.FORCED] + count[Origin.FORCED_BY_ANCHOR]
    assert shown == [
        count[Origin.PUBLISHED],
        count[Origin.MIRROR],
        count[Origin.ANCHOR],
        forced,
        count[Origin.LOWER_BOUND],
        count[Origin.SMOOTHED],
    ]
    assert sum(shown) == origin.size


def test_the_intervals_of_the_results_belong_to_their_counts() -> None:
    rows = re.findall(
        r"^\| (\w+) \| (\d+) / (\d+) \| ([\d.]+) \[([\d.]+), ([\d.]+)\]", README.read_text(), re.M
    )
    assert {row[0] for row in rows} == set(PAPER_SCENARIOS)
    for _, reached, episodes, *shown in rows:
        low, high = wilson_interval(int(reached), int(episodes))
        share = int(reached) / int(episodes)
        assert shown == [f"{100 * value:.1f}" for value in (share, low, high)]
