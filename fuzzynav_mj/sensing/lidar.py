"""The range sensor: a ring of rays among the obstacles of the model."""

import mujoco
import numpy as np

from fuzzynav_mj.sensing.ground_plan import ground_plan
from fuzzynav_mj.types import BoolArray, FloatArray, LaserScan

OBSTACLE_GROUP = 0  # the geom group of obstacles and walls in `models/arenas/room.xml`


def ray_bearings(count: int) -> FloatArray:
    """(count,) evenly spaced ray directions in the robot frame, rad, in [-pi, pi)."""
    return np.arange(count, dtype=np.float64) * (2 * np.pi / count) - np.pi


def decode(readings: FloatArray, max_range: float) -> tuple[FloatArray, BoolArray]:
    """Ranges and hits of raw readings.

    MuJoCo reports "no hit" as a negative number (-1 for a ray, minus the cutoff for a sensor) and
    a hit beyond the cutoff as the cutoff. A reading that is not a number is taken as a hit at
    zero distance: what the sensor cannot tell must not be driven into.
    """
    readings = np.where(np.isnan(readings), 0.0, readings)
    hit = (readings >= 0.0) & (readings < max_range)
    return np.where(hit, readings, max_range), hit


class Lidar:
    """A ring of rays from one site, cast on demand.

    Args:
        model: compiled model.
        site: name of the site that the rays start from.
        ray_count: number of rays.
        max_range: largest distance seen, m.
    """

    def __init__(self, model: mujoco.MjModel, site: str, ray_count: int, max_range: float) -> None:
        self.bearings = ray_bearings(ray_count)
        self._model = model
        self._site = model.site(site).id
        self._body = int(model.site_bodyid[self._site])
        self._max_range = max_range
        self._group = np.zeros(6, dtype=np.uint8)
        self._group[OBSTACLE_GROUP] = 1
        self._directions = np.stack(
            (np.cos(self.bearings), np.sin(self.bearings), np.zeros(ray_count))
        )
        self._geom_ids = np.empty(ray_count, dtype=np.int32)
        self._distances = np.empty(ray_count)
        self._plan = ground_plan(model, OBSTACLE_GROUP, self._body)

    def scan(self, data: mujoco.MjData) -> LaserScan:
        """One look. The data's kinematics must be up to date."""
        if self._plan is not None:
            ranges = self._plan.ranges(data, self._site, self._directions[:2], self._max_range)
            if ranges is not None:
                stamp, hit = float(data.time), ranges < self._max_range
                return LaserScan(stamp, self.bearings, ranges, hit, self._max_range)
        return self._cast(data)

    def _cast(self, data: mujoco.MjData) -> LaserScan:
        """One look by MuJoCo's own rays, whatever the obstacles are."""
        rotation = data.site_xmat[self._site].reshape(3, 3)
        rays = np.ascontiguousarray((rotation @ self._directions).T).ravel()
        mujoco.mj_multiRay(
            self._model,
            data,
            data.site_xpos[self._site],
            rays,
            self._group,
            True,
            self._body,
            self._geom_ids,
            self._distances,
            None,
            len(self.bearings),
            self._max_range,
        )
        ranges, hit = decode(self._distances, self._max_range)
        return LaserScan(float(data.time), self.bearings, ranges, hit, self._max_range)
