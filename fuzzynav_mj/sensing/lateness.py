"""Brings what a late scan showed up to the present: where things are by now, seen from here."""

from dataclasses import replace
from math import atan2, ceil, cos, floor, hypot, pi, sin, sqrt

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import (
    BoolArray,
    FloatArray,
    LaserScan,
    PerceivedObstacle,
    Perception,
    Pose2D,
)


def brought_up(perception: Perception, pose: Pose2D, age: float) -> Perception:
    """The same obstacles some time later.

    What moves has gone on, and turned, as it did. The scan is what the sensor would show of all
    obstacles from the present pose: rays that meet none of them count as free, as in any scan.

    Args:
        perception: as the scan showed it.
        pose: of the robot now.
        age: of the scan, s.
    """
    obstacles = tuple(_later(obstacle, pose, age) for obstacle in perception.obstacles)
    scan = _scan_from(pose, obstacles, perception.scan)
    return replace(perception, scan=scan, obstacles=obstacles)


def _later(obstacle: PerceivedObstacle, pose: Pose2D, age: float) -> PerceivedObstacle:
    vx, vy = obstacle.velocity.tolist()
    mean_x, mean_y = _turned(vx, vy, obstacle.turn_rate * age / 2)
    points = obstacle.points + age * np.array([mean_x, mean_y])
    vx, vy = _turned(vx, vy, obstacle.turn_rate * age)
    x, y = points[:, 0] - pose.x, points[:, 1] - pose.y
    nearest = int((x * x + y * y).argmin())
    dx, dy = float(x[nearest]), float(y[nearest])
    return replace(
        obstacle,
        points=points,
        nearest_point=points[nearest],
        distance=hypot(dx, dy),
        bearing=(atan2(dy, dx) - pose.yaw + pi) % (2 * pi) - pi,
        approaching=obstacle.dynamic and vx * dx + vy * dy < 0.0,
        velocity=np.array([vx, vy]),
    )


def _turned(x: float, y: float, angle: float) -> tuple[float, float]:
    c, s = cos(angle), sin(angle)
    return c * x - s * y, s * x + c * y


def _scan_from(
    pose: Pose2D, obstacles: tuple[PerceivedObstacle, ...], seen: LaserScan
) -> LaserScan:
    ranges = np.full(len(seen.ranges), seen.max_range)
    hit = np.zeros(len(ranges), dtype=bool)
    c, s = cos(pose.yaw), sin(pose.yaw)
    to_robot = np.array([[c, -s], [s, c]])
    for obstacle in obstacles:
        points = (obstacle.points - np.array([pose.x, pose.y])) @ to_robot
        _cast(np.ascontiguousarray(points), ranges, hit)
    return replace(seen, ranges=ranges, hit=hit)


@compiled
def _cast(points: FloatArray, ranges: FloatArray, hit: BoolArray) -> None:
    """Shortens the rays that an outline (k, 2), robot frame, stops.

    Each of its points stops the ray nearest to it, and the lines between them all rays that they
    cross.
    """
    count = len(ranges)
    rays_per_radian = count / (2 * pi)
    before = 0.0
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        place = (atan2(y, x) + pi) * rays_per_radian
        ray = round(place) % count
        distance = sqrt(x * x + y * y)
        if distance < ranges[ray]:
            ranges[ray], hit[ray] = distance, True
        if k > 0:
            turn = (place - before + count / 2) % count - count / 2
            low, high = (before, before + turn) if turn > 0.0 else (before + turn, before)
            dx, dy = x - points[k - 1, 0], y - points[k - 1, 1]
            for crossed in range(ceil(low), floor(high) + 1):
                bearing = crossed / rays_per_radian - pi
                ux, uy = cos(bearing), sin(bearing)
                across = ux * dy - uy * dx
                if abs(across) > 1e-9:
                    reach = (x * dy - y * dx) / across
                    if 0.0 < reach < ranges[crossed % count]:
                        ranges[crossed % count], hit[crossed % count] = reach, True
        before = place
