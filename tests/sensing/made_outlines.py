"""Outlines of movers at given places, worked out without a scan, and tracks that follow them."""

from math import hypot

import numpy as np

from fuzzynav_mj.sensing.free_space import FreeSpace
from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.sensing.looks import take_look
from fuzzynav_mj.sensing.outline import Outline
from fuzzynav_mj.sensing.tracking import Track
from fuzzynav_mj.sensing.velocity_filter import Beliefs
from fuzzynav_mj.types import FloatArray, LaserScan, Pose2D

BELIEFS = Beliefs(
    flow_sigma=0.0003, noise=0.0, independent_hits=6.0, outlier=0.06, outline_sigma=0.03
)
PERIOD = 0.1
CORNER = ((0.0, 0.0), (0.12, 0.0), (0.12, 0.15))  # two faces at right angles
FACE = ((0.0, 0.0), (0.15, 0.0))


def look_at(stamp: float) -> FreeSpace:
    """A look of which nothing is known to be free."""
    blind = LaserScan(stamp, ray_bearings(12), np.zeros(12), np.zeros(12, dtype=bool), 0.8)
    return FreeSpace(take_look(blind, Pose2D(0.0, 0.0, 0.0)))


def outline(
    corners: tuple[tuple[float, float], ...], place: FloatArray, stamp: float, ends: bool = False
) -> Outline:
    """Hits 15 mm apart on a chain of faces that lies `place` (2,) off its corners."""
    points, normals = [], []
    for start, end in zip(np.array(corners)[:-1], np.array(corners)[1:], strict=True):
        way = end - start
        length = hypot(*way)
        steps = np.arange(0.003, length, 0.015)
        points.append(start + steps[:, None] * way / length)
        normals.append(np.tile(np.array([way[1], -way[0]]) / length, (len(steps), 1)))
    hits = np.concatenate(points)
    edges = np.diff(hits, axis=0, append=hits[-1:])
    across = np.stack((edges[:, 1], -edges[:, 0]), axis=1)
    across[-1] = normals[-1][-1]
    across /= np.hypot(*across.T)[:, None]
    joined = np.append(np.full(len(hits) - 1, True), False)
    at = np.ascontiguousarray((hits + place).T)
    bounds = np.zeros((2, len(hits)), dtype=bool)
    bounds[0, 0] = bounds[1, -1] = ends
    return Outline(stamp, at, joined, np.ascontiguousarray(across.T), bounds)


def followed(
    corners: tuple[tuple[float, float], ...], velocity: FloatArray, looks: int, ends: bool = False
) -> Track:
    """A track after so many looks at a mover of this velocity that shows these faces."""
    track = Track.begin(np.zeros(2))
    for number in range(looks):
        if number:
            track.predict(PERIOD)
        stamp = PERIOD * number
        shown = outline(corners, 0.5 + velocity * stamp, stamp, ends)
        assert not track.take_in(shown, look_at(stamp), BELIEFS).any()
    return track
