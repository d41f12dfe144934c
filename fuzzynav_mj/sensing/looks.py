"""One look: a scan with the pose it was taken from, its hits as points in the world frame."""

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from fuzzynav_mj.types import BoolArray, FloatArray, LaserScan, Pose2D


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """A scan in the world frame.

    Attributes:
        stamp: simulated time, s.
        pose: where it was taken from.
        ranges: (n,) m, the sensor's range where nothing was hit.
        hit: (n,) True where something was hit.
        points: (n, 2) end points of the rays, world frame; hits only where `hit`.
        joined: (n,) True where ray i and ray i + 1 (cyclic) hit one continuous surface.
        normals: (n, 2) unit normal of that surface between the two hits, towards the sensor.
    """

    stamp: float
    pose: Pose2D
    ranges: FloatArray
    hit: BoolArray
    points: FloatArray
    joined: BoolArray
    normals: FloatArray


def take_look(scan: LaserScan, pose: Pose2D) -> Look:
    """The look of one scan."""
    c, s = cos(pose.yaw), sin(pose.yaw)
    x, y = np.cos(scan.bearings), np.sin(scan.bearings)
    rays = np.stack((c * x - s * y, s * x + c * y), axis=1)
    points = rays * scan.ranges[:, None]
    edges = np.roll(points, -1, axis=0) - points
    length = np.sqrt(edges[:, 0] ** 2 + edges[:, 1] ** 2)
    both = scan.hit & np.roll(scan.hit, -1)
    spacing = scan.ranges * (2 * np.pi / len(scan.ranges))
    joined = both & ((length < 2.5 * spacing + 0.01) | _continues(edges, length, both))
    normals = np.stack((edges[:, 1], -edges[:, 0]), axis=1) / np.maximum(length, 1e-9)[:, None]
    inward = (normals * points).sum(axis=1) > 0.0  # must point against the ray
    normals[inward] *= -1.0
    return Look(
        stamp=scan.stamp,
        pose=pose,
        ranges=scan.ranges,
        hit=scan.hit,
        points=points + np.array([pose.x, pose.y]),
        joined=joined,
        normals=normals,
    )


def _continues(edges: FloatArray, length: FloatArray, both: BoolArray) -> BoolArray:
    """True where a long edge lies in line with a neighbouring one: a wall seen at a grazing angle.

    The hits on such a wall spread far apart, but they stay on one line, and their distances grow
    slowly; the edge between two separate obstacles does neither.
    """
    unit = edges / np.maximum(length, 1e-9)[:, None]

    def in_line(shift: int) -> BoolArray:
        other = np.roll(unit, shift, axis=0)
        ratio = length / np.maximum(np.roll(length, shift), 1e-9)
        along = (unit * other).sum(axis=1) > 0.995
        straight: BoolArray = along & np.roll(both, shift) & (ratio < 2.0) & (ratio > 0.5)
        return straight

    return in_line(1) | in_line(-1)
