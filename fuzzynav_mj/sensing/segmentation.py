"""Separates the hits of one look into obstacles, by gaps and by motion."""

from dataclasses import dataclass

import numpy as np

from fuzzynav_mj.sensing.looks import Look, neighbours
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

GAP = 0.05  # m: hits farther apart that no continuous surface joins belong to separate obstacles
EXPECTED_WITHIN = 0.15  # m between where a mover was expected and the middle of a group of hits
MOVING_SHARE = 0.25  # of a small group's hits must move for the whole of it to be a mover
MOVING, STATIC, UNKNOWN = 1, -1, 0


@dataclass(frozen=True, slots=True, eq=False)
class Hits:
    """The hits of one look in ray order, beginning at the start of an obstacle.

    Attributes:
        points: (m, 2) world frame, stored column by column.
        rays: (m,) the rays that hit.
        first: (m,) True at the first hit of each group of hits without a gap between them.
    """

    points: FloatArray
    rays: IntArray
    first: BoolArray


def gather_hits(look: Look) -> Hits:
    """The look's hits, split at gaps."""
    rays = look.hit.nonzero()[0]
    if len(rays) == 0:
        return Hits(np.empty((0, 2)), rays, np.empty(0, dtype=bool))
    before, after = neighbours(len(rays))
    points = look.points.T.take(rays, axis=1)
    steps = points.take(after, axis=1) - points
    near = steps[0] ** 2 + steps[1] ** 2 < GAP**2
    adjacent = rays.take(after) - rays
    adjacent[-1] += len(look.hit)
    parted = ~(near | (look.joined.take(rays) & (adjacent == 1)))
    breaks = parted.nonzero()[0]
    shift = 0 if len(breaks) == 0 else int(breaks[-1]) + 1
    order = (np.arange(len(rays)) + shift) % len(rays)
    first = parted.take(before.take(order))
    first[0] = True
    return Hits(points.take(order, axis=1).T, rays.take(order), first)


def split_by_motion(
    hits: Hits, flags: IntArray, expected: FloatArray, mover_extent: float
) -> tuple[IntArray, IntArray]:
    """Splits groups further where moving hits and standing ones meet.

    A mover that passes close to a wall is one group with it; its hits move, the wall's do not.
    A group no larger than a mover moves as a whole if a fair share of it does, or if a mover was
    expected there: a side that slides along itself merely does not show it.

    Args:
        hits: the hits and their groups.
        flags: (m,) MOVING, STATIC or UNKNOWN for each hit.
        expected: (k, 2) where known movers should be now, world frame.
        mover_extent: largest extent of a mover's visible side, m.

    Returns:
        (k,) index of the first hit of each obstacle, and (k,) its flag.
    """
    first = hits.first
    if len(first) == 0:
        return np.empty(0, dtype=np.intp), flags
    if len(expected) == 0 and not (flags == MOVING).any():
        begin = first.nonzero()[0]
        return begin, np.full(len(begin), STATIC)
    flags = _whole_movers(hits, _drop_lone(first, flags), expected, mover_extent)
    flags = _fill_unknown(first, flags)
    before, _ = neighbours(len(first))
    begin = (first | (flags != flags.take(before))).nonzero()[0]
    return begin, flags.take(begin)


def _whole_movers(
    hits: Hits, flags: IntArray, expected: FloatArray, mover_extent: float
) -> IntArray:
    moves = flags == MOVING
    begin = hits.first.nonzero()[0]
    group = hits.first.cumsum() - 1
    size = np.bincount(group)
    moving = np.bincount(group, weights=moves)
    low = np.minimum.reduceat(hits.points.T, begin, axis=1)
    high = np.maximum.reduceat(hits.points.T, begin, axis=1)
    extent = (high - low).max(axis=0)
    whole = moving >= np.maximum(MOVING_SHARE * size, 2.0)
    if len(expected):
        centre = np.add.reduceat(hits.points.T, begin, axis=1) / size
        away = centre[:, :, None] - expected.T[:, None]
        whole |= (away[0] ** 2 + away[1] ** 2).min(axis=1) < EXPECTED_WITHIN**2
    whole &= extent <= mover_extent
    return np.where(whole.take(group), MOVING, flags)


def _drop_lone(first: BoolArray, flags: IntArray) -> IntArray:
    """Overrules a single hit between two of the opposite kind in the same group."""
    before, after = neighbours(len(flags))
    previous, following = flags.take(before), flags.take(after)
    between = ~(first | first.take(after)) & (previous == following)
    lone = between & (previous == -flags) & (flags != UNKNOWN)
    return np.where(lone, previous, flags)


def drop_single(first: BoolArray, flags: IntArray) -> IntArray:
    """Says of a moving hit with no moving one beside it in its group that it is unknown: a single
    ray may be wrong."""
    if len(flags) == 0:
        return flags
    before, after = neighbours(len(flags))
    moving = flags == MOVING
    joined_before = ~first & moving.take(before)
    joined_after = ~first.take(after) & moving.take(after)
    return np.where(moving & ~joined_before & ~joined_after, UNKNOWN, flags)


def _fill_unknown(first: BoolArray, flags: IntArray) -> IntArray:
    """Gives unknown hits the flag of their neighbours in the same group; none: STATIC."""
    _, after = neighbours(len(flags))
    filled = _fill_forward(first, flags)
    last = first.take(after)
    filled = _fill_forward(last[::-1], filled[::-1])[::-1]
    return np.where(filled == UNKNOWN, STATIC, filled)


def _fill_forward(first: BoolArray, flags: IntArray) -> IntArray:
    source = np.where((flags != UNKNOWN) | first, np.arange(len(flags)), 0)
    return flags.take(np.maximum.accumulate(source))
