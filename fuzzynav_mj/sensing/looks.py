"""One look: a scan with the pose it was taken from, its hits as points in the world frame."""

from dataclasses import dataclass, replace
from functools import lru_cache
from math import cos, pi, sin

import numpy as np

from fuzzynav_mj.sensing.cleaning import CleanScan
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray, LaserScan, Pose2D

SAME_FACE = 0.97  # cosine of the largest angle between normals of what is taken as one face
SAME_LINE = 0.995  # cosine of the largest angle between normals of hits on one straight surface


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """A scan in the world frame.

    Points and normals are stored column by column, so that their transposes give fast x and y.

    Attributes:
        stamp: simulated time, s.
        pose: where it was taken from.
        ranges: (n,) m, the sensor's range where nothing was hit.
        hit: (n,) True where something was hit.
        points: (n, 2) end points of the rays, world frame; hits only where `hit`.
        joined: (n,) True where ray i and ray i + 1 (cyclic) hit one continuous surface.
        normals: (n, 2) unit normal of that surface between the two hits, towards the sensor.
        sigma: (n,) uncertainty of the ranges, m; None where they are exact.
    """

    stamp: float
    pose: Pose2D
    ranges: FloatArray
    hit: BoolArray
    points: FloatArray
    joined: BoolArray
    normals: FloatArray
    sigma: FloatArray | None = None


@lru_cache(maxsize=512)
def neighbours(count: int) -> tuple[IntArray, IntArray]:
    """(count,) index before, and index after, each of `count` elements in a ring."""
    order = np.arange(count)
    return np.roll(order, 1), np.roll(order, -1)


def take_look(scan: LaserScan, pose: Pose2D) -> Look:
    """The look of one scan."""
    count = len(scan.ranges)
    _, after = neighbours(count)
    c, s = cos(pose.yaw), sin(pose.yaw)
    x, y = np.cos(scan.bearings), np.sin(scan.bearings)
    points = np.array([c * x - s * y, s * x + c * y]) * scan.ranges
    edges = points.take(after, axis=1) - points
    length = np.sqrt(edges[0] ** 2 + edges[1] ** 2)
    unit = edges / np.maximum(length, 1e-9)
    both = scan.hit & scan.hit.take(after)
    spacing = scan.ranges * (2 * pi / count)
    joined = both & ((length < 2.5 * spacing + 0.01) | _continues(unit, length, both))
    return Look(
        stamp=scan.stamp,
        pose=pose,
        ranges=scan.ranges,
        hit=scan.hit,
        points=(points + np.array([[pose.x], [pose.y]])).T,
        joined=joined,
        # Bearings increase, so the sensor lies to the left of every edge.
        normals=np.array([-unit[1], unit[0]]).T,
    )


def take_clean_look(clean: CleanScan, pose: Pose2D) -> Look:
    """The look of a scan with noise, on its smoothed outlines."""
    look = take_look(clean.scan, pose)
    _, after = neighbours(len(look.ranges))
    x, y = clean.normals.T
    next_x, next_y = x.take(after), y.take(after)
    both = look.hit & look.hit.take(after)
    edge = look.points.take(after, axis=0) - look.points
    spacing = look.ranges * (2 * pi / len(look.ranges))
    unsure = 3.0 * np.hypot(clean.sigma, clean.sigma.take(after))
    near = np.hypot(edge[:, 0], edge[:, 1]) < 2.5 * spacing + 0.01 + unsure
    turn = x * next_x + y * next_y
    x, y = x + next_x, y + next_y
    length = np.maximum(np.hypot(x, y), 1e-9)
    c, s = cos(pose.yaw), sin(pose.yaw)
    normals = np.array([c * x - s * y, s * x + c * y]) / length
    across = np.abs((edge.T * normals).sum(axis=0))
    level = across < 0.01 + unsure
    in_line = (turn > SAME_LINE) & level
    # Corners and lone hits have no normal that can be trusted: none is compared with it.
    normals *= (turn > SAME_FACE) & level
    return replace(look, joined=both & (near | in_line), normals=normals.T, sigma=clean.sigma)


def _continues(unit: FloatArray, length: FloatArray, both: BoolArray) -> BoolArray:
    """True where a long edge lies in line with a neighbouring one: a wall seen at a grazing angle.

    The hits on such a wall spread far apart, but they stay on one line, and their distances grow
    slowly; the edge between two separate obstacles does neither.

    Args:
        unit: (2, n) directions of the edges.
        length: (n,) m.
        both: (n,) True where both ends of the edge are hits.
    """
    before, after = neighbours(len(length))
    other, earlier = unit.take(before, axis=1), length.take(before)
    along = unit[0] * other[0] + unit[1] * other[1] > 0.995
    alike = (length < 2.0 * earlier) & (earlier < 2.0 * length)
    in_line = along & alike & both & both.take(before)  # with the edge before
    continued: BoolArray = in_line | in_line.take(after)
    return continued
