"""Scans of bodies at given places, worked out without a simulation."""

import numpy as np

from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.types import FloatArray, LaserScan, Pose2D

RAYS = 180
REACH = 0.8
PERIOD = 0.1
HERE = Pose2D(0.0, 0.0, 0.0)


def square(x: float, y: float, half: float = 0.1) -> FloatArray:
    corners = np.array([[-half, -half], [half, -half], [half, half], [-half, half]])
    return corners + np.array([x, y])


def scan_of(bodies: list[FloatArray], stamp: float, pose: Pose2D = HERE) -> LaserScan:
    """What rays from a pose meet of bodies (k, 2), in the order of their corners."""
    bearings = ray_bearings(RAYS)
    directions = np.stack((np.cos(bearings + pose.yaw), np.sin(bearings + pose.yaw)), axis=1)
    ranges = np.full(RAYS, REACH)
    for body in bodies:
        for start, end in zip(body, np.roll(body, -1, axis=0), strict=True):
            a, edge = start - [pose.x, pose.y], end - start
            across = directions[:, 0] * edge[1] - directions[:, 1] * edge[0]
            with np.errstate(divide="ignore", invalid="ignore"):
                reach = (a[0] * edge[1] - a[1] * edge[0]) / across
                along = (a[0] * directions[:, 1] - a[1] * directions[:, 0]) / across
            met = (reach > 0.0) & (along >= 0.0) & (along <= 1.0)
            ranges = np.where(met, np.minimum(ranges, reach), ranges)
    return LaserScan(stamp, bearings, ranges, ranges < REACH, REACH)
