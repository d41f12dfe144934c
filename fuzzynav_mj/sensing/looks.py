"""One look: a scan with the pose it was taken from, its hits as points in the world frame."""

from math import cos, hypot, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.bearings import ray_before
from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.cleaning import CleanScan
from fuzzynav_mj.types import BoolArray, FloatArray, LaserScan, Pose2D

SAME_FACE = 0.97  # cosine of the largest angle between normals of what is taken as one face
ONE_LINE = 0.999999  # cosine of the largest angle between pieces of one straight side ...
SAME_LINE = 0.995  # ... and where noise blurs their normals
ROUGH_REACH = 2  # hits to each side that a rough normal is drawn over, and ...
ROUGH = 5.0  # ... standard deviations of noise by which they must be apart


class Look(NamedTuple):
    """A scan in the world frame; a named tuple, which compiled functions take as a whole.

    Attributes:
        stamp: simulated time, s.
        x, y, yaw: pose that it was taken from, m and rad.
        ranges: (n,) m, the sensor's range where nothing was hit.
        hit: (n,) True where something was hit.
        points: (2, n) x and y of the rays' end points, world frame; hits only where `hit`.
        joined: (n,) True where ray i and ray i + 1 (cyclic) hit one continuous surface.
        normals: (2, n) unit normal of that surface between the two hits, towards the sensor; zero
            where noise leaves it unknown.
        sigma: (n,) uncertainty of the ranges, m; zero where they are exact.
        straight: (n,) True where the surface is known to be straight there, and its normal with it.
    """

    stamp: float
    x: float
    y: float
    yaw: float
    ranges: FloatArray
    hit: BoolArray
    points: FloatArray
    joined: BoolArray
    normals: FloatArray
    sigma: FloatArray
    straight: BoolArray


def take_look(scan: LaserScan, pose: Pose2D) -> Look:
    """The look of one scan."""
    directions = np.cos(scan.bearings), np.sin(scan.bearings)
    return _look(scan.stamp, pose.x, pose.y, pose.yaw, scan.ranges, scan.hit, *directions)


def take_clean_look(clean: CleanScan, pose: Pose2D) -> Look:
    """The look of a scan with noise, on its smoothed outlines."""
    return _smooth_look(take_look(clean.scan, pose), clean.sigma, clean.normals)


@compiled
def depth_behind(x: float, y: float, look: Look) -> float:
    """How much farther than a point the look's rays reach beside it, m."""
    count, dx, dy = len(look.ranges), x - look.x, y - look.y
    ray = ray_before(dx, dy, look.yaw - pi, count)
    reach: float = min(look.ranges[ray], look.ranges[(ray + 1) % count])
    return reach - hypot(dx, dy)


@compiled
def _look(
    stamp: float,
    x: float,
    y: float,
    yaw: float,
    ranges: FloatArray,
    hit: BoolArray,
    ahead: FloatArray,
    aside: FloatArray,
) -> Look:
    """The look of exact ranges.

    A long edge between two hits joins them where it lies in line with a neighbouring one: hits on
    a wall seen at a grazing angle spread far apart, but they stay on one line, and their distances
    grow slowly; the edge between two separate obstacles does neither.

    Args:
        stamp, x, y, yaw, ranges, hit: the look's.
        ahead, aside: (n,) cosines and sines of the bearings.
    """
    count = len(ranges)
    points, normals = np.empty((2, count)), np.empty((2, count))
    length, c, s = np.empty(count), cos(yaw), sin(yaw)
    both, joined = np.empty(count, dtype=np.bool_), np.empty(count, dtype=np.bool_)
    for i in range(count):
        points[0, i] = (c * ahead[i] - s * aside[i]) * ranges[i]
        points[1, i] = (s * ahead[i] + c * aside[i]) * ranges[i]
    for i in range(count):
        after = (i + 1) % count
        dx, dy = points[0, after] - points[0, i], points[1, after] - points[1, i]
        length[i] = sqrt(dx * dx + dy * dy)
        # Bearings increase, so the sensor lies to the left of every edge.
        normals[0, i] = -dy / max(length[i], 1e-9)
        normals[1, i] = dx / max(length[i], 1e-9)
        both[i] = hit[i] and hit[after]
        joined[i] = both[i] and length[i] < 2.5 * (ranges[i] * (2 * pi / count)) + 0.01
    for i in range(count):
        if both[i] and both[i - 1]:
            along = normals[1, i] * normals[1, i - 1] + normals[0, i] * normals[0, i - 1]
            alike = length[i] < 2.0 * length[i - 1] and length[i - 1] < 2.0 * length[i]
            if along > ONE_LINE and alike:
                joined[i] = joined[i - 1] = True
    for i in range(count):
        points[0, i] += x
        points[1, i] += y
    sigma, straight = np.zeros(count), np.full(count, True)
    return Look(stamp, x, y, yaw, ranges, hit, points, joined, normals, sigma, straight)


@compiled
def _smooth_look(look: Look, sigma: FloatArray, lines: FloatArray) -> Look:
    """The look of smoothed ranges.

    Args:
        look: as if they were exact.
        sigma: (n,) their uncertainty, m.
        lines: (n, 2) normals of the outline at the rays, robot frame; zero at its corners.
    """
    points, c, s, count = look.points, cos(look.yaw), sin(look.yaw), len(look.ranges)
    joined, normals = np.empty(count, dtype=np.bool_), np.zeros((2, count))
    straight = np.zeros(count, dtype=np.bool_)
    for i in range(count):
        after = (i + 1) % count
        edge_x, edge_y = points[0, after] - points[0, i], points[1, after] - points[1, i]
        unsure = 3.0 * hypot(sigma[i], sigma[after])
        near = hypot(edge_x, edge_y) < 2.5 * (look.ranges[i] * (2 * pi / count)) + 0.01 + unsure
        turn = lines[i, 0] * lines[after, 0] + lines[i, 1] * lines[after, 1]
        x, y = lines[i, 0] + lines[after, 0], lines[i, 1] + lines[after, 1]
        length = max(hypot(x, y), 1e-9)
        nx, ny = (c * x - s * y) / length, (s * x + c * y) / length
        level = abs(edge_x * nx + edge_y * ny) < 0.01 + unsure
        in_line = turn > SAME_LINE and level
        joined[i] = look.hit[i] and look.hit[after] and (near or in_line)
        if turn > SAME_FACE and level:
            straight[i], normals[0, i], normals[1, i] = True, nx, ny
    for i in range(count):
        if joined[i] and not straight[i]:
            normals[0, i], normals[1, i] = _rough_normal(points, joined, sigma, i)
    return Look(
        look.stamp, look.x, look.y, look.yaw, look.ranges, look.hit, points, joined, normals,
        sigma, straight,
    )  # fmt: skip


@compiled
def _rough_normal(
    points: FloatArray, joined: BoolArray, sigma: FloatArray, ray: int
) -> tuple[float, float]:
    """Normal of the chord over the hits around a ray; (0, 0) where noise drowns it."""
    count = len(joined)
    first, last = ray, (ray + 1) % count
    for _ in range(ROUGH_REACH):
        if joined[first - 1]:
            first = (first - 1) % count
        if joined[last]:
            last = (last + 1) % count
    x, y = points[0, last] - points[0, first], points[1, last] - points[1, first]
    length = hypot(x, y)
    if length <= ROUGH * hypot(sigma[first], sigma[last]):
        return 0.0, 0.0
    return -y / length, x / length
