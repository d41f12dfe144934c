"""Scenes of points around a robot at the origin."""

from math import pi

import numpy as np

from fuzzynav_mj.planners.scene import Scene, scene_around
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.planners.sight import Sight
from fuzzynav_mj.planners.surroundings import Surroundings
from fuzzynav_mj.robot import DEFAULT_ROBOT as SPEC
from fuzzynav_mj.types import FloatArray, Pose2D

SETTINGS = DecisionSettings()
BEARINGS = np.linspace(-pi, pi, SPEC.ray_count, endpoint=False)


def scene_of(
    standing: FloatArray, expected: FloatArray, possible: FloatArray, doubt: float = 0.0
) -> Scene:
    """Points (k, 2) that stand, in free sight, and of movers, (OUTLOOK, k, 2) where they are
    expected and (HORIZON, k, 2) where they may be."""
    ranges = np.full(SPEC.ray_count, SPEC.sensor_range)
    sight = Sight(standing, BEARINGS, ranges, SPEC.sensor_range)
    around = Surroundings(sight, expected, possible, doubt)
    return scene_around(around, Pose2D(0.0, 0.0, 0.0), SPEC, SETTINGS)
