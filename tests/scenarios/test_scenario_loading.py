"""Scenario files: what loads, and the one line that everything else gets."""

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav_mj.errors import FuzzyNavError, ScenarioError, UnknownNameError
from fuzzynav_mj.geometry import signed_area
from fuzzynav_mj.scenarios import library_names, load_scenario
from fuzzynav_mj.scenarios.loading import parse_scenario
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.world import make_world
from fuzzynav_mj.types import Pose2D

EXAMPLE = """\
schema = 1
name = "example"
description = "One sentence."
bounds = [0.0, 0.0, 10.0, 10.0]
walls = true
time_limit = 90.0

[robot]
start = [0.8, 0.8, 0.785]
goal = [9.2, 9.2]
goal_tolerance = 0.15

[[static]]
polygon = [[2.0, 3.0], [2.0, 3.4], [4.0, 3.4], [4.0, 3.0]]
[[static]]
circle = [6.0, 5.0, 0.3]

[[moving]]
polygon = [[-0.2, -0.1], [0.2, -0.1], [0.0, 0.2]]
waypoints = [[3.0, 7.0], [7.0, 3.0]]
speed = 0.3
repeat = "loop"
phase = 2.0
[[moving]]
circle = 0.15
keyframes = [[0.0, 1.0, 9.0], [8.0, 4.0, 8.0], [20.0, 6.0, 9.0]]
interpolation = "linear"
repeat = "once"

[[random_moving]]
count = [6, 9]
radius = [0.12, 0.25]
vertices = [3, 7]
concave_fraction = 0.4
speed = [0.1, 0.5]
acceleration = 0.8
region = [[1.0, 1.0], [9.0, 1.0], [9.0, 9.0], [1.0, 9.0]]
"""

POLYGON = (
    "a simple polygon: at least 3 different corners [x, y] in m, with edges that meet only there"
)


def parse(text: str) -> Scenario:
    return parse_scenario(text.encode(), "file.toml")


def message(old: str, new: str) -> str:
    """Return the message that the example gets with `old` replaced by `new`."""
    assert EXAMPLE.count(old) == 1
    with pytest.raises(ScenarioError) as caught:
        parse(EXAMPLE.replace(old, new))
    return str(caught.value)


def test_every_key_arrives() -> None:
    scenario = parse(EXAMPLE)
    assert (scenario.name, scenario.description) == ("example", "One sentence.")
    assert (scenario.bounds, scenario.walls) == ((0.0, 0.0, 10.0, 10.0), True)
    assert (scenario.time_limit, scenario.goal_tolerance) == (90.0, 0.15)
    assert scenario.start == Pose2D(0.8, 0.8, 0.785)
    assert (scenario.goal, scenario.goal_yaw) == ((9.2, 9.2), None)
    assert scenario.source == "file.toml"
    assert not scenario.allow_faster
    polygon = scenario.static[0].polygon
    assert polygon is not None and signed_area(polygon) == pytest.approx(0.8)  # made ccw
    assert scenario.static[1].circle == (6.0, 5.0, 0.3)
    drawn = scenario.random_moving[0]
    assert (drawn.count, drawn.vertices, drawn.radius) == ((6, 9), (3, 7), (0.12, 0.25))
    assert (drawn.speed, drawn.acceleration, drawn.concave_fraction) == ((0.1, 0.5), 0.8, 0.4)
    first, second = scenario.moving
    np.testing.assert_allclose(first.motion.positions(np.array([-2.0]))[0], [3.0, 7.0])
    assert second.shape.circle == (0.0, 0.0, 0.15)
    np.testing.assert_allclose(second.motion.positions(np.array([8.0, 99.0])), [[4, 8], [6, 9]])


def test_defaults() -> None:
    scenario = parse(
        'schema = 1\nname = "least"\nbounds = [0, 0, 5, 5]\n'
        "[robot]\nstart = [1, 1, 0]\ngoal = [4, 4, 1.5]\n"
    )
    assert scenario.walls and not scenario.allow_faster
    assert (scenario.time_limit, scenario.goal_tolerance) == (120.0, 0.10)
    assert scenario.goal_yaw == 1.5
    assert scenario.static == scenario.moving == scenario.random_moving == ()


@pytest.mark.parametrize(
    ("old", "new", "rest"),
    [
        ("schema = 1", "schema = 2", "schema: given 2; allowed 1"),
        ("schema = 1", "schema = true", "schema: given true; allowed 1"),
        ("schema = 1\n", "", "schema: given nothing; allowed 1"),
        ('name = "example"', "name = 3", "name: given 3; allowed a text of at least 1 letter"),
        ("walls = true", "walls = 1", "walls: given 1; allowed true or false"),
        (
            "time_limit = 90.0",
            "time_limit = 0",
            "time_limit: given 0; allowed a number above 0 (s)",
        ),
        (
            "time_limit = 90.0",
            'time_limit = "90"',
            "time_limit: given '90'; allowed a number above 0 (s)",
        ),
        (
            "time_limit = 90.0",
            "time_limit = nan",
            "time_limit: given nan; allowed a number above 0 (s)",
        ),
        (
            "bounds = [0.0, 0.0, 10.0, 10.0]",
            "bounds = [0.0, 0.0, 0.0, 10.0]",
            "bounds: given [0.0, 0.0, 0.0, 10.0]; allowed x_min, y_min, x_max, y_max with each "
            "minimum below its maximum",
        ),
        (
            "goal = [9.2, 9.2]",
            "goal = [9.2]",
            "robot.goal: given [9.2]; allowed 2 numbers x, y or 3 numbers x, y, yaw",
        ),
        (
            "goal = [9.2, 9.2]",
            "gaol = [9.2, 9.2]",
            "robot.gaol: given an unknown key; allowed start, goal, goal_tolerance; "
            "did you mean 'goal'? (and 1 more)",
        ),
        (
            "start = [0.8, 0.8, 0.785]",
            "start = [0.8, true, inf]",
            "robot.start.1: given true; allowed 3 numbers x, y, yaw in m and rad (and 1 more)",
        ),
        (
            "circle = [6.0, 5.0, 0.3]",
            "circle = [6.0, 5.0]",
            "static.1.circle: given [6.0, 5.0]; allowed 3 numbers x, y, radius in m, the radius "
            "above 0",
        ),
        (
            "circle = [6.0, 5.0, 0.3]",
            "circle = [6.0, 5.0, -0.3]",
            "static.1.circle.2: given -0.3; allowed 3 numbers x, y, radius in m, the radius above "
            "0",
        ),
        (
            "circle = [6.0, 5.0, 0.3]",
            "",
            "static.1: given neither polygon nor circle; allowed exactly one of polygon and circle",
        ),
        (
            "circle = 0.15",
            "circle = 0.15\npolygon = [[0, 0], [1, 0], [0, 1]]",
            "moving.1: given both polygon and circle; allowed exactly one of polygon and circle",
        ),
        (
            "[2.0, 3.4], [4.0, 3.4]",
            "[4.0, 3.4], [2.0, 3.4]",
            "static.0.polygon: given [[2.0, 3.0], [4.0, 3.4], [2.0, 3.4], [4.0, 3.0]]; allowed "
            + POLYGON,
        ),
        (
            "region = [[1.0, 1.0], [9.0, 1.0], ",
            "region = [[1.0, 1.0], [1.0, 1.0], ",
            "random_moving.0.region: given [[1.0, 1.0], [1.0, 1.0], [9.0, 9.0], [1.0, 9.0]]; "
            "allowed " + POLYGON,
        ),
        (
            "speed = 0.3",
            "speed = -0.3",
            "moving.0.speed: given -0.3; allowed a number not below 0 (m/s), beside waypoints",
        ),
        (
            "speed = 0.3",
            "speed = 0.6",
            "moving.0.speed: given 0.6; allowed at most the robot's 0.5 m/s, or more with "
            "allow_faster = true",
        ),
        ("speed = 0.3\n", "", "moving.0.speed: given nothing; allowed a number not below 0 (m/s)"),
        (
            "speed = [0.1, 0.5]",
            "speed = [0.1, 0.9]",
            "random_moving.0.speed: given 0.9; allowed at most the robot's 0.5 m/s, or more with "
            "allow_faster = true",
        ),
        (
            'repeat = "loop"',
            'repeat = "again"',
            "moving.0.repeat: given 'again'; allowed 'reverse', 'loop' or 'once'",
        ),
        (
            'interpolation = "linear"',
            'interpolation = "cubic"',
            "moving.1.interpolation: given 'cubic'; allowed 'linear' or 'catmull-rom', beside "
            "keyframes",
        ),
        (
            "[8.0, 4.0, 8.0]",
            "[20.0, 4.0, 8.0]",
            "moving.1.keyframes.2: given the time 20.0; allowed a time above 20.0",
        ),
        (
            "waypoints = [[3.0, 7.0], [7.0, 3.0]]",
            "waypoints = [[3.0, 7.0], [3.0, 7.0]]",
            "moving.0.waypoints: given one point only; allowed at least 2 different points",
        ),
        (
            "waypoints = [[3.0, 7.0], [7.0, 3.0]]\n",
            "",
            "moving.0: given neither waypoints nor keyframes; allowed exactly one of waypoints "
            "(with speed) and keyframes",
        ),
        (
            'interpolation = "linear"',
            "speed = 0.2",
            "moving.1.speed: given 0.2; allowed waypoints only",
        ),
        (
            "count = [6, 9]",
            "count = [9, 6]",
            "random_moving.0.count: given [9, 6]; allowed the smaller number first",
        ),
        (
            "count = [6, 9]",
            "count = [6.0, 9]",
            "random_moving.0.count.0: given 6.0; allowed 2 integers, smallest and largest, in "
            "0..100",
        ),
        (
            "vertices = [3, 7]",
            "vertices = [3, 3]",
            "random_moving.0.concave_fraction: given 0.4; allowed 0 where vertices end at 3: a "
            "triangle is convex",
        ),
        (
            "start = [0.8, 0.8, 0.785]",
            "start = [0.12, 0.8, 0.785]",  # its centre is inside, a corner is not
            "robot.start: given [0.12, 0.8, 0.785]; allowed a place where the robot fits inside "
            "the bounds [0.0, 0.0, 10.0, 10.0]",
        ),
        (
            "goal = [9.2, 9.2]",
            "goal = [9.95, 9.2]",
            "robot.goal: given [9.95, 9.2]; allowed a place where the robot fits inside the bounds "
            "[0.0, 0.0, 10.0, 10.0]",
        ),
        (
            "circle = [6.0, 5.0, 0.3]",
            "circle = [1.2, 0.8, 0.3]",  # beyond half a side, within half a diagonal
            "robot.start: given [0.8, 0.8, 0.785]; allowed a place where the robot does not touch "
            "static.1",
        ),
        (
            "circle = [6.0, 5.0, 0.3]",
            "circle = [9.2, 8.9, 0.25]",
            "robot.goal: given [9.2, 9.2]; allowed a place where the robot does not touch static.1",
        ),
        (
            "[0.0, 1.0, 9.0]",
            "[0.0, 0.9, 0.9]",
            "moving.1: given a motion that begins at [0.9, 0.9]; allowed one that does not touch "
            "the robot at its start [0.8, 0.8, 0.785] at time 0",
        ),
        (
            "[robot]",
            "[robot",
            "syntax: given text that is not TOML (Expected ']' at the end of a table declaration "
            "(at line 8, column 7)); allowed TOML 1.0",
        ),
        (
            'name = "example"',
            'name = "example"\nname = "twice"',
            "syntax: given text that is not TOML (Cannot overwrite a value (at line 3, column 15));"
            " allowed TOML 1.0",
        ),
    ],
)
def test_message(old: str, new: str, rest: str) -> None:
    assert message(old, new) == f"file.toml: {rest}"


def test_faster_obstacles_load_once_they_are_allowed() -> None:
    faster = EXAMPLE.replace("speed = 0.3", "speed = 0.9")
    assert parse(faster.replace("walls", "allow_faster = true\nwalls")).allow_faster


def test_several_faults_are_counted_after_the_first() -> None:
    text = EXAMPLE.replace("speed = 0.3", "speed = 0.7").replace("count = [6, 9]", "count = [9, 6]")
    with pytest.raises(ScenarioError, match=r"moving\.0\.speed: given 0\.7; .* \(and 1 more\)$"):
        parse(text)


def test_scripted_obstacle_counts_with_its_phase() -> None:
    """It starts on the robot, and the phase has moved it on by time 0."""
    on_robot = EXAMPLE.replace("[[3.0, 7.0], [7.0, 3.0]]", "[[0.8, 0.8], [0.8, 7.0]]")
    assert parse(on_robot)
    with pytest.raises(
        ScenarioError, match=r"moving\.0: given a motion that begins at \[0\.8, 0\.8\]"
    ):
        parse(on_robot.replace("phase = 2.0", "phase = 0.0"))


def test_goal_yaw_asks_for_room_for_the_turned_square() -> None:
    beside_wall = EXAMPLE.replace("goal = [9.2, 9.2]", "goal = [9.88, 9.2{yaw}]")
    assert parse(beside_wall.replace("{yaw}", ""))
    assert parse(beside_wall.replace("{yaw}", ", 0.0"))
    with pytest.raises(ScenarioError, match=r"robot\.goal: given \[9\.88, 9\.2, 0\.785\]"):
        parse(beside_wall.replace("{yaw}", ", 0.785"))


def test_unusual_content_gets_one_line() -> None:
    for content, expected in [
        (b"name = '\xff'", "file.toml: line 1: given bytes that are not UTF-8"),
        (b"a = " + b"[" * 5000, "file.toml: syntax: given too many levels of nesting"),
        (b"schema = " + b"9" * 5000, "file.toml: syntax: given text that is not TOML"),
        (b"schema = 0x" + b"f" * 9000, "schema: given an integer of thousands of digits; allowed"),
        (b'"ke\\ny" = 1', r"file.toml: 'ke\ny': given an unknown key; allowed schema, name"),
        (b"", "file.toml: schema: given nothing; allowed 1 (and 3 more)"),
    ]:
        with pytest.raises(ScenarioError) as caught:
            parse_scenario(content, "file.toml")
        assert expected in str(caught.value)
        assert len(str(caught.value).splitlines()) == 1


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    folder = tmp_path / "folder.toml"
    folder.mkdir()
    allowed = "; allowed a readable .toml file"
    for path, reason in [
        (tmp_path / "missing.toml", "No such file or directory"),
        (folder, "Is a directory"),
        (tmp_path / "nul\0.toml", "embedded null byte"),
    ]:
        with pytest.raises(ScenarioError) as caught:
            load_scenario(str(path))
        given = f": file: given a path that cannot be read ({reason})"
        assert str(caught.value).endswith(given + allowed)


def test_unknown_name_lists_the_library() -> None:
    with pytest.raises(UnknownNameError) as caught:
        load_scenario("mazes")
    assert str(caught.value) == (
        f"unknown scenario 'mazes': allowed are {', '.join(library_names())}. Did you mean 'maze'?"
    )


def test_a_path_is_named_in_the_message(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(EXAMPLE.replace("speed = 0.3", "speed = -1"), encoding="utf-8")
    with pytest.raises(
        ScenarioError, match=rf"^{re.escape(str(path))}: moving\.0\.speed: given -1"
    ):
        load_scenario(str(path))
    path.write_text(EXAMPLE, encoding="utf-8")
    assert load_scenario(str(path)).source == str(path)


GARBAGE = st.sampled_from(
    ["nan", "inf", "-1", "0", "1e9", "1e400", "true", '"text"', '"random"', "[]", "[[]]", "{}",
     "[1, 2]", "[[0, 0], [1, 1], [2, 2]]", "1979-05-27", "{ x = 1 }", "'\\'", "", "]",
     "0x" + "f" * 5000]
)  # fmt: skip


@st.composite
def mutated_files(draw: st.DrawFn) -> bytes:
    """The example with lines deleted, doubled or swapped, values replaced, or bytes cut out."""
    lines = EXAMPLE.splitlines()
    for _ in range(draw(st.integers(1, 3))):
        at = draw(st.integers(0, len(lines) - 1))
        other = draw(st.integers(0, len(lines) - 1))
        kind = draw(st.sampled_from(["delete", "double", "swap", "value", "element", "key"]))
        if kind == "delete" and len(lines) > 1:
            del lines[at]
        elif kind == "double":
            lines.insert(other, lines[at])
        elif kind == "swap":
            lines[at], lines[other] = lines[other], lines[at]
        elif kind == "value" and " = " in lines[at]:
            lines[at] = lines[at].split(" = ")[0] + " = " + draw(GARBAGE)
        elif kind == "element":
            numbers = list(re.finditer(r"-?\d+\.?\d*", lines[at]))
            if numbers:
                number = draw(st.sampled_from(numbers))
                lines[at] = lines[at][: number.start()] + draw(GARBAGE) + lines[at][number.end() :]
        else:
            lines[at] = draw(st.text(max_size=5)) + lines[at]
    content = "\n".join(lines).encode("utf-8", "surrogatepass")
    if draw(st.booleans()):
        start, stop = sorted(draw(st.tuples(*[st.integers(0, len(content))] * 2)))
        content = content[:start] + draw(st.binary(max_size=3)) + content[stop:]
    return content


@settings(max_examples=400, deadline=None)
@given(mutated_files())
def test_any_file_loads_or_gets_exactly_one_line(content: bytes) -> None:
    try:
        scenario = parse_scenario(content, "file.toml")
        world = make_world(scenario, np.random.default_rng(0))
    except FuzzyNavError as error:
        text = str(error)
        assert len(text.splitlines()) == 1
        assert re.fullmatch(r"file\.toml: .+: given .+; allowed .+", text)
    else:
        assert world.static == scenario.static
