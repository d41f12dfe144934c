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
END_REACH = 0.2  # m within which an end is looked for where it should have been before


class Outline(NamedTuple):
    """The outline that k hits draw, pieces of straight surface between them.

    Attributes:
        stamp: of the look, s.
        points: (2, k) the hits in ray order, world frame, m.
        joined: (k,) True where a hit and the next one lie on one continuous surface.
        normals: (2, k) unit normals of the surface between a hit and the next one.
        bounds: (2, k) True for hits at which a piece of outline is seen to begin, and to end: not
            where something nearer may hide the rest.
    """

    stamp: float
    points: FloatArray
    joined: BoolArray
    normals: FloatArray
    bounds: BoolArray


@compiled
def outline_of(hits: Hits, chosen: IntArray, look: Look) -> Outline:
    """The outline of the chosen hits (k,), k > 0."""
    drawn = hits.rays[chosen]
    bounds = np.zeros((2, len(drawn)), dtype=np.bool_)
    outline = _drawn(look.stamp, look.points, look.joined, look.normals, drawn, bounds)
    for k in range(len(drawn)):
        before = outline.joined[k - 1] if k > 0 else False
        # A hit with none beside it may be anything.
        if before != outline.joined[k]:
            end, step = (1, 1) if before else (0, -1)
            beside = (drawn[k] + step) % len(look.ranges)
            # Where nothing was hit beside it, the obstacle may go on just out of range.
            depth = END_DEPTH if look.hit[beside] else RANGE_END_DEPTH
            bounds[end, k] = look.ranges[beside] >= look.ranges[drawn[k]] + depth
    return outline


@compiled
def outline_around(look: Look, taken: BoolArray, x: float, y: float, reach: float) -> Outline:
    """What a look shows within `reach` of a place, m, without the rays (n,) already taken.

    Of its ends nothing is known.
    """
    wanted = look.hit & ~taken
    for ray in range(len(wanted)):
        if hypot(look.points[0, ray] - x, look.points[1, ray] - y) >= reach:
            wanted[ray] = False
    rays = wanted.nonzero()[0]
    unknown = np.zeros((2, len(rays)), dtype=np.bool_)
    return _drawn(look.stamp, look.points, look.joined, look.normals, rays, unknown)


def left_over(outline: Outline, gone: BoolArray) -> Outline:
    """The outline without the hits that are `gone` (k,); itself if none are."""
    return _left_over(outline, gone) if gone.any() else outline


@compiled
def _left_over(outline: Outline, gone: BoolArray) -> Outline:
    kept = (~gone).nonzero()[0]
    bounds = np.empty((2, len(kept)), dtype=np.bool_)
    for k in range(len(kept)):
        bounds[0, k], bounds[1, k] = outline.bounds[0, kept[k]], outline.bounds[1, kept[k]]
    return _drawn(outline.stamp, outline.points, outline.joined, outline.normals, kept, bounds)


@compiled
def _drawn(
    stamp: float,
    points: FloatArray,
    joined: BoolArray,
    normals: FloatArray,
    kept: IntArray,
    bounds: BoolArray,
) -> Outline:
    """The outline of those of n points (2, n) that are kept (k,); the arguments are its fields."""
    count, size = len(kept), points.shape[1]
    outline = Outline(
        stamp, np.empty((2, count)), np.zeros(count, dtype=np.bool_), np.empty((2, count)), bounds
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
        np.concatenate((first.bounds, second.bounds), axis=1),
    )


@compiled
def end_before(outline: Outline, before: Outline, end: int, k: int, x: float, y: float) -> int:
    """The number of the hit at which the outline that now begins or ends at hit `k` did so before;
    -1 where that is not known.

    Args:
        outline, before: now and earlier.
        end: 0 for where it begins, 1 for where it ends.
        k: the hit at which it does so now.
        x, y: motion in between, m.
    """
    nearest, found = END_REACH, -1
    for j in range(before.points.shape[1]):
        if before.bounds[end, j]:
            dx = outline.points[0, k] - x - before.points[0, j]
            dy = outline.points[1, k] - y - before.points[1, j]
            off = hypot(dx, dy)
            if off < nearest:
                nearest, found = off, j
    return found
