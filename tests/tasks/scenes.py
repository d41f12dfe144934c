"""Scenarios made for one test each, and where the geometry says that something happens."""

from math import pi

import numpy as np
import shapely

from fuzzynav_mj.scenarios.motion import Mover, waypoint_motion
from fuzzynav_mj.scenarios.schema import Bounds, RandomMovingSpec, Scenario
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.types import FloatArray, Pose2D


def scenario(
    *,
    start: tuple[float, float, float] = (0.0, 0.0, 0.0),
    goal: tuple[float, float] = (4.0, 4.0),
    goal_yaw: float | None = None,
    static: tuple[Shape, ...] = (),
    moving: tuple[Mover, ...] = (),
    random_moving: tuple[RandomMovingSpec, ...] = (),
    bounds: Bounds = (-5.0, -5.0, 5.0, 5.0),
    walls: bool = True,
    time_limit: float = 60.0,
) -> Scenario:
    """A scenario that needs no file."""
    return Scenario(
        name="made_for_a_test",
        description="",
        bounds=bounds,
        walls=walls,
        time_limit=time_limit,
        allow_faster=True,
        start=Pose2D(*start),
        goal=goal,
        goal_yaw=goal_yaw,
        goal_tolerance=0.1,
        static=static,
        moving=moving,
        random_moving=random_moving,
        source="test",
    )


def polygon(*corners: tuple[float, float]) -> Shape:
    """A polygon, its corners counter-clockwise."""
    return Shape(np.array(corners), None)


def circle(x: float, y: float, radius: float) -> Shape:
    """A circle."""
    return Shape(None, (x, y, radius))


def mover(
    shape: Shape, begin: tuple[float, float], end: tuple[float, float], speed: float
) -> Mover:
    """A shape that goes to and fro on a straight line."""
    return Mover(shape, waypoint_motion(np.array([begin, end]), speed))


def random_polygon(rng: np.random.Generator, radius: float, convex: bool) -> Shape:
    """A polygon within `radius` of the origin: convex, or a star that is nearly always concave."""
    count = int(rng.integers(3, 11))
    slots = 2 * pi * (np.arange(count) + rng.uniform(-0.3, 0.3, count)) / count
    reach = np.ones(count) if convex else rng.uniform(0.25, 1.0, count)
    corners = radius * reach[:, None] * np.stack((np.cos(slots), np.sin(slots)), axis=1)
    return Shape(corners, None)


def ray_ranges(
    obstacle: shapely.Geometry, pose: Pose2D, bearings: FloatArray, reach: float
) -> FloatArray:
    """(n,) exact distance of the first point of `obstacle` on each ray, or `reach`."""
    heading = bearings + pose.yaw
    ends = np.stack((pose.x + reach * np.cos(heading), pose.y + reach * np.sin(heading)), axis=1)
    begin = np.broadcast_to((pose.x, pose.y), ends.shape)
    lines = shapely.linestrings(np.stack((begin, ends), axis=1))
    ranges = shapely.distance(shapely.Point(pose.x, pose.y), shapely.intersection(lines, obstacle))
    exact: FloatArray = np.where(np.isnan(ranges), reach, ranges)
    return exact
