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
    """Points (k, 2) that stand, in free sight, and two movers: one that surely is where it is
    expected, (OUTLOOK, k, 2), and one that is far away but may be here, (HORIZON, j, 2), with a
    likelihood of a fifth."""
    ranges = np.full(SPEC.ray_count, SPEC.sensor_range)
    sight = Sight(standing, BEARINGS, ranges, SPEC.sensor_range, np.zeros(len(ranges), dtype=bool))
    count, others = expected.shape[1], possible.shape[1]
    far_away = np.full((len(expected), others, 2), 99.0)
    around = Surroundings(
        sight,
        np.concatenate((expected, far_away), axis=1),
        possible,
        np.array([[count, 1], [others, 2]]),
        np.array([1.0, 0.8, 0.2]),
        doubt,
    )
    return scene_around(around, Pose2D(0.0, 0.0, 0.0), SPEC, SETTINGS)
