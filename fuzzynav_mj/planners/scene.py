"""What roll-outs are held against: the surroundings in the robot's frame, with the margins."""

from math import cos, sin
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.planners.motions import HORIZON
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.planners.surroundings import Surroundings, period_ends
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray, Pose2D


class Scene(NamedTuple):
    """Robot frame, over T periods; a named tuple, which compiled functions take as a whole.

    Attributes:
        standing: (k, 2) points of what stands.
        ranges: (n,) of the rays, m.
        turn: bearing of the robot's own axis from the first ray, rad.
        times: (T,) ends of the periods, s from now.
        expected: (2, k, T) points of movers as far as their motion can be foreseen ...
        possible: (2, j, T) ... and where else they may be.
        wanted: (T,) gap that an admissible candidate keeps to the former, m ...
        unlikely: (T,) ... and to the latter.
        berth: (T,) gap below which a candidate costs more.
    """

    standing: FloatArray
    ranges: FloatArray
    turn: float
    times: FloatArray
    expected: FloatArray
    possible: FloatArray
    wanted: FloatArray
    unlikely: FloatArray
    berth: FloatArray

    def later(self, periods: int) -> "Scene":
        """The scene without its first periods."""
        times = self.times[: len(self.times) - periods]
        moving = self.expected, self.possible, self.wanted, self.unlikely, self.berth
        left = [np.ascontiguousarray(each[..., periods:]) for each in moving]
        return Scene(self.standing, self.ranges, self.turn, times, *left)


def scene_around(
    around: Surroundings, pose: Pose2D, spec: RobotSpec, settings: DecisionSettings
) -> Scene:
    """The scene of the robot at `pose`."""
    c, s = cos(pose.yaw), sin(pose.yaw)
    to_robot = np.array([[c, s], [-s, c]])
    times = period_ends(spec)
    wanted = settings.moving_margin + settings.moving_margin_growth * times
    share = min(max(around.doubt / settings.doubtful, settings.unlikely_share), 1.0)
    return Scene(
        standing=around.sight.points @ to_robot.T,
        ranges=around.sight.ranges,
        turn=pose.yaw - float(around.sight.bearings[0]),
        times=times,
        expected=_over_time(around.expected[:HORIZON], to_robot),
        possible=_over_time(around.possible, to_robot),
        wanted=wanted,
        unlikely=share * wanted,
        berth=settings.moving_gap
        + settings.moving_gap_growth * np.minimum(times, settings.moving_gap_time),
    )


def _over_time(places: FloatArray, turn: FloatArray) -> FloatArray:
    """(2, k, T) turned points, from places (T, k, 2)."""
    return np.ascontiguousarray((places @ turn.T).transpose(2, 1, 0))
