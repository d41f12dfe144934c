"""The rules of a scenario file that concern several values at once, and its geometry."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import shapely
from shapely.affinity import translate
from shapely.geometry.base import BaseGeometry

from fuzzynav_mj.geometry import footprint, is_simple_polygon
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.scenarios.file_format import (
    SIMPLE_POLYGON,
    MovingTable,
    RandomMovingTable,
    ScenarioFile,
)
from fuzzynav_mj.scenarios.messages import Problem, shown
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.types import Pose2D


def value_problems(file: ScenarioFile, robot: RobotSpec) -> Iterator[Problem]:
    """Yield what is wrong within each table of `file`."""
    x_min, y_min, x_max, y_max = file.bounds
    if not (x_min < x_max and y_min < y_max):
        yield Problem(
            "bounds",
            shown(list(file.bounds)),
            "x_min, y_min, x_max, y_max with each minimum below its maximum",
        )
    for index, static in enumerate(file.static):
        yield from _one_shape(f"static.{index}", static.polygon, static.circle)
    for index, moving in enumerate(file.moving):
        key = f"moving.{index}"
        yield from _one_shape(key, moving.polygon, moving.circle)
        yield from _route(key, moving)
        if moving.speed is not None:
            yield from _speed(f"{key}.speed", moving.speed, file.allow_faster, robot)
    for index, drawn in enumerate(file.random_moving):
        key = f"random_moving.{index}"
        yield from _ranges(key, drawn)
        yield from _polygon(f"{key}.region", drawn.region)
        yield from _speed(f"{key}.speed", drawn.speed[1], file.allow_faster, robot)


def placement_problems(scenario: Scenario, robot: RobotSpec) -> Iterator[Problem]:
    """Yield what stands where the robot starts or where it is to go."""
    start, goal = scenario.start, scenario.goal
    at_start = footprint(start, robot.half_side)
    if scenario.goal_yaw is None:
        at_goal = shapely.buffer(shapely.Point(goal), robot.half_side)
        goal_given = shown(list(goal))
    else:
        at_goal = footprint(Pose2D(*goal, scenario.goal_yaw), robot.half_side)
        goal_given = shown([*goal, scenario.goal_yaw])
    start_given = shown([start.x, start.y, start.yaw])
    yield from _free(scenario, "robot.start", at_start, start_given)
    yield from _free(scenario, "robot.goal", at_goal, goal_given)
    for index, mover in enumerate(scenario.moving):
        if index in scenario.random_phases:
            continue
        x, y = mover.motion.positions(np.zeros(1))[0]
        if shapely.intersects(translate(mover.shape.footprint, x, y), at_start):
            yield Problem(
                f"moving.{index}",
                f"a motion that begins at {shown([round(float(x), 3), round(float(y), 3)])}",
                f"one that does not touch the robot at its start {start_given} at time 0",
            )


def _free(scenario: Scenario, key: str, place: BaseGeometry, given: str) -> Iterator[Problem]:
    if not shapely.contains_properly(shapely.box(*scenario.bounds), place):
        yield Problem(
            key, given, f"a place where the robot fits inside the bounds {list(scenario.bounds)}"
        )
    for index, shape in enumerate(scenario.static):
        if shapely.intersects(shape.footprint, place):
            yield Problem(key, given, f"a place where the robot does not touch static.{index}")


def _one_shape(
    key: str, polygon: list[tuple[float, float]] | None, circle: object
) -> Iterator[Problem]:
    if (polygon is None) == (circle is None):
        given = "neither polygon nor circle" if polygon is None else "both polygon and circle"
        yield Problem(key, given, "exactly one of polygon and circle")
    if polygon is not None:
        yield from _polygon(f"{key}.polygon", polygon)


def _polygon(key: str, corners: list[tuple[float, float]]) -> Iterator[Problem]:
    if not is_simple_polygon(np.array(corners)):
        yield Problem(key, shown([list(corner) for corner in corners]), SIMPLE_POLYGON)


def _route(key: str, moving: MovingTable) -> Iterator[Problem]:
    if (moving.waypoints is None) == (moving.keyframes is None):
        neither = moving.waypoints is None
        given = "neither waypoints nor keyframes" if neither else "both waypoints and keyframes"
        yield Problem(key, given, "exactly one of waypoints (with speed) and keyframes")
        return
    if moving.waypoints is not None:
        if moving.speed is None:
            yield Problem(f"{key}.speed", "nothing", "a number not below 0 (m/s)")
        if moving.interpolation is not None:
            yield Problem(f"{key}.interpolation", shown(moving.interpolation), "keyframes only")
        if len(set(moving.waypoints)) == 1:
            yield Problem(f"{key}.waypoints", "one point only", "at least 2 different points")
    if moving.keyframes is not None:
        if moving.speed is not None:
            yield Problem(f"{key}.speed", shown(moving.speed), "waypoints only")
        times = [row[0] for row in moving.keyframes]
        for index, (before, after) in enumerate(pairwise(times), start=1):
            if after <= before:
                yield Problem(
                    f"{key}.keyframes.{index}", f"the time {after}", f"a time above {before}"
                )


def _speed(key: str, speed: float, allow_faster: bool, robot: RobotSpec) -> Iterator[Problem]:
    # Keyframes state times instead of a speed and are taken as they are.
    if speed > robot.max_speed and not allow_faster:
        yield Problem(
            key,
            shown(speed),
            f"at most the robot's {robot.max_speed} m/s, or more with allow_faster = true",
        )


def _ranges(key: str, drawn: RandomMovingTable) -> Iterator[Problem]:
    ranges = {
        "count": drawn.count,
        "radius": drawn.radius,
        "vertices": drawn.vertices,
        "speed": drawn.speed,
    }
    for name, (low, high) in ranges.items():
        if low > high:
            yield Problem(f"{key}.{name}", shown([low, high]), "the smaller number first")
    if drawn.concave_fraction > 0.0 and drawn.vertices[1] < 4:
        yield Problem(
            f"{key}.concave_fraction",
            shown(drawn.concave_fraction),
            "0 where vertices end at 3: a triangle is convex",
        )
