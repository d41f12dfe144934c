"""Hand-made observations for peers: a robot at the origin that faces +x, and what it sees."""

from math import pi

import numpy as np
import numpy.typing as npt

from fuzzynav_mj.planners.base import NavigationProblem, Observation
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.types import (
    FloatArray,
    LaserScan,
    PerceivedObstacle,
    Perception,
    Pose2D,
    Twist2D,
    VisibilityMatrix,
)

RANGE = DEFAULT_ROBOT.sensor_range
RAYS = DEFAULT_ROBOT.ray_count


def towards(x: float, y: float, goal_yaw: float | None = None) -> NavigationProblem:
    """The task of reaching (x, y)."""
    return NavigationProblem((x, y), goal_yaw, 0.1, DEFAULT_ROBOT)


def discs_scan(*discs: tuple[float, float, float]) -> LaserScan:
    """The scan of discs (x, y, radius)."""
    # Half a step off, so that rays come in mirror images about the x axis.
    bearings = (np.arange(RAYS) + 0.5) * (2 * pi / RAYS) - pi
    ranges = np.full(RAYS, RANGE)
    for x, y, radius in discs:
        along = x * np.cos(bearings) + y * np.sin(bearings)
        across = x * np.sin(bearings) - y * np.cos(bearings)
        depth = np.maximum(radius**2 - across**2, 0.0)
        met = (across**2 < radius**2) & (along > 0.0)
        ranges = np.where(met, np.minimum(ranges, along - np.sqrt(depth)), ranges)
    hit = ranges < RANGE
    return LaserScan(0.0, bearings, ranges, hit, RANGE)


def hit_points(scan: LaserScan) -> FloatArray:
    """(k, 2) hits, robot frame."""
    unit = np.stack((np.cos(scan.bearings), np.sin(scan.bearings)), axis=1)
    points: FloatArray = (unit * scan.ranges[:, None])[scan.hit]
    return points


def observe(
    scan: LaserScan | None = None,
    twist: Twist2D | None = None,
    obstacles: tuple[PerceivedObstacle, ...] = (),
) -> Observation:
    """What the robot knows; without a scan nothing is in range."""
    scan = discs_scan() if scan is None else scan
    counts = np.zeros(4, dtype=np.intp)
    nothing = VisibilityMatrix(np.zeros((4, RAYS), dtype=bool), counts, counts)
    return Observation(
        stamp=0.0,
        pose=Pose2D(0.0, 0.0, 0.0),
        twist=Twist2D(0.0, 0.0) if twist is None else twist,
        scan=scan,
        perception=Perception(scan, obstacles, nothing),
    )


def seen_obstacle(
    points: npt.ArrayLike, velocity: tuple[float, float] | None = None
) -> PerceivedObstacle:
    """What is perceived of an obstacle with hits (k, 2); it stands if it has no velocity."""
    spots = np.array(points, dtype=float)
    speed = np.zeros(2) if velocity is None else np.array(velocity)
    nearest = spots[np.hypot(*spots.T).argmin()]
    return PerceivedObstacle(
        points=spots,
        nearest_point=nearest,
        distance=float(np.hypot(*nearest)),
        bearing=float(np.arctan2(nearest[1], nearest[0])),
        dynamic=velocity is not None,
        approaching=bool(speed @ nearest < 0.0),
        velocity=speed,
    )


def round_mover(x: float, y: float, velocity: tuple[float, float]) -> PerceivedObstacle:
    """A disc of radius 8 cm of which the half towards -x is seen."""
    angle = np.linspace(np.pi / 2, 3 * np.pi / 2, 7)
    rim = 0.08 * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    return seen_obstacle(rim + np.array([x, y]), velocity)
