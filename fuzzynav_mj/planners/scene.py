"""What roll-outs are held against: the surroundings in the robot's frame, with the margins."""

from dataclasses import dataclass
from functools import lru_cache
from math import cos, sin
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.headings import HORIZON
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.planners.surroundings import Surroundings
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray, IntArray, Pose2D


class Scene(NamedTuple):
    """Robot frame, over T periods; a named tuple, which compiled functions take as a whole.

    Attributes:
        standing: (k, 2) points of what stands.
        ranges: (n,) of the rays, m.
        turn: bearing of the robot's own axis from the first ray, rad.
        times: (T,) ends of the periods, s from now.
        expected: (2, k, T) points of movers as far as their motion can be foreseen ...
        possible: (2, j, T) ... and where else they may be.
        outlines, shares: of these points, as in `Surroundings`.
        wanted: (T,) gap that an admissible candidate keeps to the former, m ...
        unlikely: (T,) ... and to the latter.
        berth: (T,) gap below which a candidate costs more.
        risky: (T,) gap, beyond touch, below which contact cannot be ruled out.
    """

    standing: FloatArray
    ranges: FloatArray
    turn: float
    times: FloatArray
    expected: FloatArray
    possible: FloatArray
    outlines: IntArray
    shares: FloatArray
    wanted: FloatArray
    unlikely: FloatArray
    berth: FloatArray
    risky: FloatArray

    def later(self, periods: int) -> "Scene":
        """The scene without its first periods."""
        return self._replace(
            times=self.times[: len(self.times) - periods],
            expected=np.ascontiguousarray(self.expected[..., periods:]),
            possible=np.ascontiguousarray(self.possible[..., periods:]),
            wanted=self.wanted[periods:],
            unlikely=self.unlikely[periods:],
            berth=self.berth[periods:],
            risky=self.risky[periods:],
        )


def scene_around(
    around: Surroundings, pose: Pose2D, spec: RobotSpec, settings: DecisionSettings
) -> Scene:
    """The scene of the robot at `pose`."""
    growing = _growing(spec, settings)
    share = min(max(around.doubt / settings.doubtful, settings.unlikely_share), 1.0)
    standing, expected, possible = _turned(
        around.sight.points, around.expected, around.possible, cos(pose.yaw), sin(pose.yaw)
    )
    return Scene(
        standing=standing,
        ranges=around.sight.ranges,
        turn=pose.yaw - float(around.sight.bearings[0]),
        times=growing.times,
        expected=expected,
        possible=possible,
        outlines=around.outlines,
        shares=around.shares,
        wanted=growing.wanted,
        unlikely=share * growing.wanted,
        berth=growing.berth,
        risky=growing.risky,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Growing:
    """What of a scene depends on its times only: the fields of `Scene` of these names."""

    times: FloatArray
    wanted: FloatArray
    berth: FloatArray
    risky: FloatArray


@lru_cache(maxsize=8)
def _growing(spec: RobotSpec, settings: DecisionSettings) -> _Growing:
    times: FloatArray = np.arange(1, HORIZON + 1) * np.float64(spec.decision_period)
    berth_times = np.minimum(times, settings.moving_gap_time)
    return _Growing(
        times=times,
        wanted=settings.moving_margin + settings.moving_margin_growth * times,
        berth=settings.moving_gap + settings.moving_gap_growth * berth_times,
        risky=settings.risky_gap + settings.risky_gap_growth * times,
    )


@compiled
def _turned(
    standing: FloatArray, expected: FloatArray, possible: FloatArray, c: float, s: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points (k, 2) and places (T, k, 2) of `Surroundings` as `Scene` has them, turned by an angle
    of this cosine and sine."""
    points = np.empty_like(standing)
    for k in range(len(standing)):
        x, y = standing[k, 0], standing[k, 1]
        points[k, 0], points[k, 1] = c * x + s * y, c * y - s * x
    return points, _over_time(expected, c, s), _over_time(possible, c, s)


@compiled
def _over_time(places: FloatArray, c: float, s: float) -> FloatArray:
    """(2, k, HORIZON) turned points, from the first places of (T, k, 2)."""
    points = np.empty((2, places.shape[1], HORIZON))
    for t in range(HORIZON):
        for k in range(places.shape[1]):
            x, y = places[t, k, 0], places[t, k, 1]
            points[0, k, t], points[1, k, t] = c * x + s * y, c * y - s * x
    return points
