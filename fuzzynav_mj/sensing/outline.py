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
    drawn = hits.rays[chosen]
    ends, rays = np.full((2, 2), np.nan), len(look.ranges)
    for end, k, step in ((0, 0, -1), (1, len(drawn) - 1, 1)):
        ray = drawn[k]
        beside = (ray + step) % rays
        # Where nothing was hit beside it, the obstacle may go on just out of range.
        depth = END_DEPTH if look.hit[beside] else RANGE_END_DEPTH
        if look.ranges[beside] >= look.ranges[ray] + depth:
            ends[end, 0], ends[end, 1] = look.points[0, ray], look.points[1, ray]
    return _drawn(look.stamp, look.points, look.joined, look.normals, drawn, ends)


@compiled
def outline_around(look: Look, taken: BoolArray, x: float, y: float, reach: float) -> Outline:
    """What a look shows within `reach` of a place, m, without the rays (n,) already taken.

    Of its ends nothing is known.
    """
    wanted = look.hit & ~taken
    for ray in range(len(wanted)):
        if hypot(look.points[0, ray] - x, look.points[1, ray] - y) >= reach:
            wanted[ray] = False
    rays, unknown = wanted.nonzero()[0], np.full((2, 2), np.nan)
    return _drawn(look.stamp, look.points, look.joined, look.normals, rays, unknown)


@compiled
def left_over(outline: Outline, gone: BoolArray) -> Outline:
    """The outline without the hits that are `gone` (k,)."""
    kept, ends = (~gone).nonzero()[0], outline.ends.copy()
    for end, k in ((0, 0), (1, len(gone) - 1)):
        if gone[k]:
            ends[end] = np.nan
    return _drawn(outline.stamp, outline.points, outline.joined, outline.normals, kept, ends)


@compiled
def _drawn(
    stamp: float,
    points: FloatArray,
    joined: BoolArray,
    normals: FloatArray,
    kept: IntArray,
    ends: FloatArray,
) -> Outline:
    """The outline of those of n points (2, n) that are kept (k,); the arguments are its fields."""
    count, size = len(kept), points.shape[1]
    outline = Outline(
        stamp, np.empty((2, count)), np.zeros(count, dtype=np.bool_), np.empty((2, count)), ends
    )
    for k in range(count):
        i = kept[k]
        outline.points[0, k], outline.points[1, k] = points[0, i], points[1, i]
        outline.normals[0, k], outline.normals[1, k] = normals[0, i], normals[1, i]
        outline.joined[k] = k + 1 < count and joined[i] and kept[k + 1] == (i + 1) % size
    return outline


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
