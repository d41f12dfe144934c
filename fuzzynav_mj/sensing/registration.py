"""Holds the hits of a mover against its own outline of an earlier look.

A mover does not turn, so its earlier outline, carried on by the motion in between, lies under its
outline of now. What is left between a hit and the straight piece of outline beneath it is what the
supposed motion is wrong by, along the normal of that piece.
"""

from math import hypot
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.outline import Outline
from fuzzynav_mj.types import BoolArray, FloatArray

BEYOND = 0.05  # of a piece's length by which a hit may lie off its ends
OTHER_FACE = 0.7  # sine of an angle: a hit on a surface that differs by more is not compared
PARALLEL = 1e-5  # sine of an angle: a smaller one is none
FEWEST_STRAYS = 2  # hits side by side: a single one may sit on a corner
COMPARABLE = 0.25  # share of an outline that must lie under the other for it to explain anything


class Shift(NamedTuple):
    """How k hits lie relative to an earlier outline.

    Attributes:
        known: (k,) True where a hit lies over a piece of the outline carried onward.
        normals: (2, k) of that piece.
        distance: (k,) how far the hit lies off the piece where it was seen, along the normal, m.
        blur: (k,) what corners between the hits may add to the distance, m.
    """

    known: BoolArray
    normals: FloatArray
    distance: FloatArray
    blur: FloatArray


@compiled
def hold_against(now: Outline, before: Outline, x: float, y: float, reach: float) -> Shift:
    """The hits of an outline held against an earlier one.

    Args:
        now, before: the outlines.
        x, y: motion in between, m.
        reach: hits farther from the outline carried onward are not compared, m.
    """
    count = now.points.shape[1]
    shift = Shift(
        np.zeros(count, dtype=np.bool_), np.zeros((2, count)), np.zeros(count), np.zeros(count)
    )
    for i in range(count):
        px, py = now.points[0, i], now.points[1, i]
        piece = _piece_beneath(before, px - x, py - y, reach)
        if piece < 0:
            continue
        nx, ny = before.normals[0, piece], before.normals[1, piece]
        here = min(_bend(now, i - 1, nx, ny), _bend(now, i, nx, ny))
        if here > OTHER_FACE:
            continue
        there = min(_bend(before, piece - 1, nx, ny), _bend(before, piece + 1, nx, ny))
        ax, ay = before.points[0, piece], before.points[1, piece]
        length = hypot(before.points[0, piece + 1] - ax, before.points[1, piece + 1] - ay)
        shift.known[i] = True
        shift.normals[0, i], shift.normals[1, i] = nx, ny
        shift.distance[i] = (px - ax) * nx + (py - ay) * ny
        # Two looks do not cut a corner alike: pieces that are exactly parallel are of one face.
        cut = here if here < PARALLEL else max(here, there)
        shift.blur[i] = cut * length / 2
    return shift


@compiled
def _piece_beneath(outline: Outline, x: float, y: float, reach: float) -> int:
    """The nearest piece of outline that a point lies over, by the number of its first hit; -1 for
    none within reach."""
    nearest, found = reach, -1
    for k in range(outline.points.shape[1] - 1):
        if not _is_piece(outline, k):
            continue
        ax, ay = outline.points[0, k], outline.points[1, k]
        along_x, along_y = outline.points[0, k + 1] - ax, outline.points[1, k + 1] - ay
        squared = along_x * along_x + along_y * along_y
        along = (x - ax) * along_x + (y - ay) * along_y
        if -BEYOND * squared <= along <= (1.0 + BEYOND) * squared:
            off = abs((x - ax) * outline.normals[0, k] + (y - ay) * outline.normals[1, k])
            if off < nearest:
                nearest, found = off, k
    return found


@compiled
def _is_piece(outline: Outline, k: int) -> bool:
    """True if a surface joins a hit and the next one, and noise leaves its normal known."""
    known: bool = outline.normals[0, k] != 0.0 or outline.normals[1, k] != 0.0
    return known if outline.joined[k] else False


@compiled
def _bend(outline: Outline, piece: int, nx: float, ny: float) -> float:
    """Sine of the angle between a normal and a piece of outline; 1 where there is none, 0 where
    noise leaves its normal unknown."""
    if piece < 0 or piece >= len(outline.joined) or not outline.joined[piece]:
        return 1.0
    x, y = outline.normals[0, piece], outline.normals[1, piece]
    if x == y == 0.0:
        return 0.0
    return abs(x * ny - y * nx) if x * nx + y * ny > 0.0 else 1.0


@compiled
def _left(shift: Shift, i: int, x: float, y: float) -> float:
    """How far hit `i` lies off the outline carried onward by (x, y), m."""
    off: float = shift.distance[i] - x * shift.normals[0, i] - y * shift.normals[1, i]
    return abs(off)


@compiled
def strays(
    now: Outline, before: Outline, x: float, y: float, reach: float, tolerance: float
) -> BoolArray:
    """(k,) True for hits that a motion does not explain; all, if the outlines hardly overlap.

    Args:
        now, before, x, y, reach: as in `hold_against`.
        tolerance: m by which a hit may lie off the outline carried onward.
    """
    shift = hold_against(now, before, x, y, reach)
    count = len(shift.known)
    pieces = 0
    for k in range(len(before.joined)):
        pieces += _is_piece(before, k)
    if shift.known.sum() < COMPARABLE * min(count, pieces):
        return np.full(count, True)
    off = np.zeros(count, dtype=np.bool_)
    for i in range(count):
        if shift.known[i]:
            off[i] = _left(shift, i, x, y) > tolerance + 2.0 * shift.blur[i]
    first = 0
    for i in range(count + 1):
        if i < count and off[i]:
            continue
        if i - first < FEWEST_STRAYS:
            off[first:i] = False
        first = i + 1
    return off


@compiled
def misfit(now: Outline, before: Outline, x: float, y: float, reach: float) -> float:
    """Mean distance of the hits from the earlier outline carried onward, m; inf if too few can be
    compared. The arguments are those of `hold_against`."""
    shift = hold_against(now, before, x, y, reach)
    total = 0.0
    for i in range(len(shift.known)):
        if shift.known[i]:
            total += _left(shift, i, x, y)
    count = shift.known.sum()
    mean: float = total / count if count >= FEWEST_STRAYS else np.inf
    return mean
