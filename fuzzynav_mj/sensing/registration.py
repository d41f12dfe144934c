"""Where the outline of a mover lay before: each hit held against the outline carried onward.

A mover does not turn, so its outline of an earlier look, carried on by the motion in between, lies
under its outline of now. What is left between a hit and the straight piece of outline beneath it
is what the supposed motion is wrong by, along the normal of that piece.
"""

from math import hypot
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.segmentation import Hits
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

LARGEST_BEND = 0.7  # sine of an angle: pieces of outline that differ by more are different faces


class Outline(NamedTuple):
    """What one look shows of a mover; or of a place, before anything was known to move there.

    Attributes:
        stamp: of the look, s.
        points: (2, k) hits in ray order, world frame, m.
        joined: (k,) True where a hit and the next one lie on one continuous surface.
        normals: (2, k) of the surface between a hit and the next one.
        ends: (2, 2) first and last hit; nan where something nearer may hide the outline's end.
        sigma: (k,) uncertainty of the hits, m.
    """

    stamp: float
    points: FloatArray
    joined: BoolArray
    normals: FloatArray
    ends: FloatArray


@compiled
def outline_of(hits: Hits, chosen: IntArray, ends: FloatArray, look: Look) -> Outline:
    """The outline that the chosen hits (k,) draw."""
    count = len(chosen)
    points, normals = np.empty((2, count)), np.zeros((2, count))
    joined = np.zeros(count, dtype=np.bool_)
    for k in range(count):
        i = chosen[k]
        ray = hits.rays[i]
        points[0, k], points[1, k] = hits.points[0, i], hits.points[1, i]
        normals[0, k], normals[1, k] = look.normals[0, ray], look.normals[1, ray]
        if k + 1 < count:
            joined[k] = look.joined[ray] and hits.rays[chosen[k + 1]] == (ray + 1) % len(look.hit)
    return Outline(look.stamp, points, joined, normals, ends)


class Shift(NamedTuple):
    """How k hits lie relative to an earlier outline.

    Attributes:
        known: (k,) True where a hit lies on a piece of the outline carried onward.
        normals: (2, k) of that piece.
        distance: (k,) by how much the hit lies off the piece where it was, along the normal, m.
        blur: (k,) m: uncertainty from corners between the hits.
    """

    known: BoolArray
    normals: FloatArray
    distance: FloatArray
    blur: FloatArray


@compiled
def _bend(outline: Outline, piece: int, nx: float, ny: float) -> float:
    """Sine of the angle between a normal and a piece of outline; 1 where there is none."""
    if piece < 0 or piece >= len(outline.joined) or not outline.joined[piece]:
        return 1.0
    x, y = outline.normals[0, piece], outline.normals[1, piece]
    if x * nx + y * ny <= 0.0:
        return 1.0
    return abs(x * ny - y * nx)


@compiled
def hold_against(now: Outline, before: Outline, x: float, y: float, reach: float) -> Shift:
    """The hits of an outline held against an earlier one carried onward by (x, y), m.

    A hit farther than `reach` from it is not compared.
    """
    count = now.points.shape[1]
    shift = Shift(
        np.zeros(count, dtype=np.bool_), np.zeros((2, count)), np.zeros(count), np.zeros(count)
    )
    for i in range(count):
        px, py = now.points[0, i] - x, now.points[1, i] - y
        best, found = reach, -1
        for k in range(before.points.shape[1] - 1):
            if not before.joined[k]:
                continue
            ax, ay = before.points[0, k], before.points[1, k]
            bx, by = before.points[0, k + 1] - ax, before.points[1, k + 1] - ay
            along = (px - ax) * bx + (py - ay) * by
            squared = bx * bx + by * by
            if along < -0.05 * squared or along > 1.05 * squared:
                continue
            off = abs((px - ax) * before.normals[0, k] + (py - ay) * before.normals[1, k])
            if off < best:
                best, found = off, k
        if found < 0:
            continue
        nx, ny = before.normals[0, found], before.normals[1, found]
        then = min(_bend(before, found - 1, nx, ny), _bend(before, found + 1, nx, ny))
        here = min(_bend(now, i - 1, nx, ny), _bend(now, i, nx, ny))
        bend = max(then, here)
        if here > LARGEST_BEND:
            continue
        length = hypot(
            before.points[0, found + 1] - before.points[0, found],
            before.points[1, found + 1] - before.points[1, found],
        )
        shift.known[i] = True
        shift.normals[0, i], shift.normals[1, i] = nx, ny
        shift.distance[i] = (now.points[0, i] - before.points[0, found]) * nx + (
            now.points[1, i] - before.points[1, found]
        ) * ny
        shift.blur[i] = 0.5 * length * bend
    return shift


@compiled
def strays(now: Outline, before: Outline, x: float, y: float, reach: float, off: float) -> BoolArray:
    """(k,) True for the hits that an earlier outline, carried onward by (x, y), does not explain."""
    shift = hold_against(now, before, x, y, reach)
    count = now.points.shape[1]
    stray = np.zeros(count, dtype=np.bool_)
    for i in range(count):
        if shift.known[i]:
            rest = shift.distance[i] - x * shift.normals[0, i] - y * shift.normals[1, i]
            stray[i] = abs(rest) > off + 2.0 * shift.blur[i]
    # a few together only
    kept = np.zeros(count, dtype=np.bool_)
    i = 0
    while i < count:
        j = i
        while j < count and stray[j]:
            j += 1
        if j - i >= 2:
            kept[i:j] = True
        i = max(j, i + 1)
    return kept
