"""From a scenario's name or file to a checked Scenario."""

import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from fuzzynav_mj.errors import UnknownNameError
from fuzzynav_mj.geometry import counter_clockwise
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.checks import placement_problems, value_problems
from fuzzynav_mj.scenarios.file_format import (
    MovingTable,
    RandomMovingTable,
    ScenarioFile,
    StaticTable,
)
from fuzzynav_mj.scenarios.messages import Problem, problems_of, scenario_error
from fuzzynav_mj.scenarios.motion import Mover, keyframe_motion, waypoint_motion
from fuzzynav_mj.scenarios.schema import RandomMovingSpec, Scenario
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.types import Pose2D

SUFFIX = ".toml"


def library_names() -> tuple[str, ...]:
    """Return the names of the scenarios that come with the package, sorted."""
    folder = files("fuzzynav_mj.scenarios") / "library"
    names = (entry.name for entry in folder.iterdir())
    return tuple(sorted(name.removesuffix(SUFFIX) for name in names if name.endswith(SUFFIX)))


def load_scenario(name_or_path: str) -> Scenario:
    """Read and check a scenario.

    Args:
        name_or_path: a name of the library, or the path of a TOML file.

    Raises:
        UnknownNameError: neither a library name nor a path.
        ScenarioError: the file cannot be used; one line names the file, the key, what was given
            and what is allowed.
    """
    names = library_names()
    if name_or_path in names:
        entry = files("fuzzynav_mj.scenarios") / "library" / (name_or_path + SUFFIX)
        return parse_scenario(entry.read_bytes(), entry.name)
    is_path = name_or_path.endswith(SUFFIX) or "/" in name_or_path or "\\" in name_or_path
    if not is_path:
        raise UnknownNameError("scenario", name_or_path, names)
    try:
        content = Path(name_or_path).read_bytes()
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        problem = Problem("file", f"a path that cannot be read ({reason})", "a readable .toml file")
        raise scenario_error(name_or_path, [problem]) from None
    return parse_scenario(content, name_or_path)


def parse_scenario(content: bytes, source: str) -> Scenario:
    """Check the content of a scenario file; `source` is its name in messages.

    Raises:
        ScenarioError: as `load_scenario`.
    """
    document = _read_toml(content, source)
    try:
        file = ScenarioFile.model_validate(document)
    except ValidationError as error:
        raise scenario_error(source, problems_of(error)) from None
    problems = list(value_problems(file, DEFAULT_ROBOT))
    if problems:
        raise scenario_error(source, problems)
    scenario = _scenario(file, source)
    problems = list(placement_problems(scenario, DEFAULT_ROBOT))
    if problems:
        raise scenario_error(source, problems)
    return scenario


def _read_toml(content: bytes, source: str) -> dict[str, Any]:
    try:
        return tomllib.loads(content.decode("utf-8"))
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        problem = Problem(f"line {line}", "bytes that are not UTF-8", "TOML, which is UTF-8 text")
    except ValueError as error:  # a TOMLDecodeError, or an integer of thousands of digits
        problem = Problem("syntax", f"text that is not TOML ({error})", "TOML 1.0")
    except RecursionError:
        problem = Problem("syntax", "too many levels of nesting", "the levels of a scenario file")
    raise scenario_error(source, [problem])


def _scenario(file: ScenarioFile, source: str) -> Scenario:
    goal = file.robot.goal
    return Scenario(
        name=file.name,
        description=file.description,
        bounds=file.bounds,
        walls=file.walls,
        time_limit=file.time_limit,
        allow_faster=file.allow_faster,
        start=Pose2D(*file.robot.start),
        goal=(goal[0], goal[1]),
        goal_yaw=goal[2] if len(goal) == 3 else None,
        goal_tolerance=file.robot.goal_tolerance,
        static=tuple(_static(table) for table in file.static),
        moving=tuple(_moving(table) for table in file.moving),
        random_moving=tuple(_random_moving(table) for table in file.random_moving),
        source=source,
        random_phases=frozenset(i for i, table in enumerate(file.moving) if table.phase is None),
    )


def _static(table: StaticTable) -> Shape:
    if table.polygon is None:
        return Shape(None, table.circle)
    return Shape(counter_clockwise(np.array(table.polygon)), None)


def _moving(table: MovingTable) -> Mover:
    if table.polygon is not None:
        shape = Shape(counter_clockwise(np.array(table.polygon)), None)
    else:
        assert table.circle is not None
        shape = Shape(None, (0.0, 0.0, table.circle))
    phase = table.phase or 0.0
    if table.keyframes is not None:
        interpolation = table.interpolation or "linear"
        motion = keyframe_motion(table.keyframes, interpolation, table.repeat, phase)
    else:
        assert table.waypoints is not None and table.speed is not None
        motion = waypoint_motion(np.array(table.waypoints), table.speed, table.repeat, phase)
    return Mover(shape, motion)


def _random_moving(table: RandomMovingTable) -> RandomMovingSpec:
    return RandomMovingSpec(
        count=table.count,
        radius=table.radius,
        vertices=table.vertices,
        concave_fraction=table.concave_fraction,
        speed=table.speed,
        acceleration=table.acceleration,
        region=counter_clockwise(np.array(table.region)),
    )
