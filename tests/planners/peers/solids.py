"""What a robot sees of solid shapes."""

from math import pi

import numpy as np
import shapely

from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.types import LaserScan, Pose2D

RANGE = DEFAULT_ROBOT.sensor_range
RAYS = DEFAULT_ROBOT.ray_count
BEARINGS = np.arange(RAYS) * (2 * pi / RAYS) - pi


def scan_of(solid: shapely.Geometry, pose: Pose2D) -> LaserScan:
    """The scan at a pose outside of the solid."""
    angle = BEARINGS + pose.yaw
    place = np.array([pose.x, pose.y])
    ends = place + RANGE * np.column_stack((np.cos(angle), np.sin(angle)))
    rays = shapely.linestrings(np.stack((np.broadcast_to(place, ends.shape), ends), axis=1))
    gaps = shapely.distance(shapely.Point(place), shapely.intersection(rays, solid))
    ranges = np.where(np.isnan(gaps), RANGE, gaps)
    return LaserScan(0.0, BEARINGS, ranges, ranges < RANGE, RANGE)
