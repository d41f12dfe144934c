"""What one look shows of an obstacle: its hits in order, how they join, and where it ends."""

from math import hypot
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.segmentation import Hits
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

END_DEPTH = 0.05  # m: an outline ends where the next ray reaches this much farther ...
RANGE_END_DEPTH = 0.15  # m: ... or this much, where the next ray hits nothing


class Outline(NamedTuple):
    """The outline that k hits draw, pieces of straight surface between them.

    Attributes:
        stamp: of the look, s.
        points: (2, k) the hits in ray order, world frame, m.
        joined: (k,) True where a hit and the next one lie on one continuous surface.
        normals: (2, k) unit normals of the surface between a hit and the next one.
        ends: (2, 2) first and last hit; nan where something nearer may hide the outline's end.
    """

    stamp: float
    points: FloatArray
    joined: BoolArray
    normals: FloatArray
    ends: FloatArray


@compiled
def outline_of(hits: Hits, chosen: IntArray, look: Look) -> Outline:
    """The outline of the chosen hits (k,), k > 0."""
    count, rays = len(chosen), len(look.ranges)
    points, normals = np.empty((2, count)), np.empty((2, count))
    joined, ends = np.zeros(count, dtype=np.bool_), np.full((2, 2), np.nan)
    for k in range(count):
        ray = hits.rays[chosen[k]]
        points[0, k], points[1, k] = look.points[0, ray], look.points[1, ray]
        normals[0, k], normals[1, k] = look.normals[0, ray], look.normals[1, ray]
        if k + 1 < count:
            joined[k] = look.joined[ray] and hits.rays[chosen[k + 1]] == (ray + 1) % rays
    for end, k, step in ((0, 0, -1), (1, count - 1, 1)):
        ray = hits.rays[chosen[k]]
        beside = (ray + step) % rays
        # Where nothing was hit beside it, the obstacle may go on just out of range.
        depth = END_DEPTH if look.hit[beside] else RANGE_END_DEPTH
        if look.ranges[beside] >= look.ranges[ray] + depth:
            ends[end, 0], ends[end, 1] = points[0, k], points[1, k]
    return Outline(look.stamp, points, joined, normals, ends)


@compiled
def outline_around(look: Look, taken: BoolArray, x: float, y: float, reach: float) -> Outline:
    """What a look shows within `reach` of a place, m, without the rays (n,) already taken.

    Of its ends nothing is known.
    """
    rays, count = np.empty(len(look.ranges), dtype=np.intp), 0
    for ray in range(len(look.ranges)):
        near = hypot(look.points[0, ray] - x, look.points[1, ray] - y) < reach
        if look.hit[ray] and near and not taken[ray]:
            rays[count] = ray
            count += 1
    points, normals = np.empty((2, count)), np.empty((2, count))
    joined = np.zeros(count, dtype=np.bool_)
    for k in range(count):
        ray = rays[k]
        points[0, k], points[1, k] = look.points[0, ray], look.points[1, ray]
        normals[0, k], normals[1, k] = look.normals[0, ray], look.normals[1, ray]
        joined[k] = k + 1 < count and look.joined[ray] and rays[k + 1] == ray + 1
    return Outline(look.stamp, points, joined, normals, np.full((2, 2), np.nan))


@compiled
def left_over(outline: Outline, gone: BoolArray) -> Outline:
    """The outline without the hits that are `gone` (k,)."""
    kept = (~gone).nonzero()[0]
    count = len(kept)
    points, normals = np.empty((2, count)), np.empty((2, count))
    joined, ends = np.zeros(count, dtype=np.bool_), outline.ends.copy()
    for k in range(count):
        i = kept[k]
        points[0, k], points[1, k] = outline.points[0, i], outline.points[1, i]
        normals[0, k], normals[1, k] = outline.normals[0, i], outline.normals[1, i]
        joined[k] = k + 1 < count and outline.joined[i] and kept[k + 1] == i + 1
    for end, i in ((0, 0), (1, len(gone) - 1)):
        if gone[i]:
            ends[end] = np.nan
    return Outline(outline.stamp, points, joined, normals, ends)


def in_one(first: Outline, second: Outline) -> Outline:
    """Two outlines of one look as one."""
    return Outline(
        first.stamp,
        np.concatenate((first.points, second.points), axis=1),
        np.concatenate((first.joined, second.joined)),
        np.concatenate((first.normals, second.normals), axis=1),
        np.stack((first.ends[0], second.ends[1])),
    )


@compiled
def end_rates(
    ends: FloatArray, before: FloatArray, elapsed: float, look: Look
) -> tuple[FloatArray, FloatArray]:
    """(2, 2) directions across the lines of sight to the ends, and (2,) how fast each moved in its
    direction, m/s; nan for an end that is not known in both looks.

    Args:
        ends: (2, 2) as the look shows them, world frame.
        before: (2, 2) as they were before.
        elapsed: s since then.
        look: the newer one.
    """
    across, rates = np.zeros((2, 2)), np.full(2, np.nan)
    for end in range(2):
        if elapsed <= 0.0 or np.isnan(ends[end, 0]) or np.isnan(before[end, 0]):
            continue
        x, y = ends[end, 0] - look.x, ends[end, 1] - look.y
        length = max(hypot(x, y), 1e-9)
        across[end, 0], across[end, 1] = -y / length, x / length
        along_x = across[end, 0] * (ends[end, 0] - before[end, 0])
        along_y = across[end, 1] * (ends[end, 1] - before[end, 1])
        rates[end] = (along_x + along_y) / elapsed
    return across, rates
