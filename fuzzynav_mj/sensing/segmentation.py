"""Separates the hits of one look into obstacles, by gaps and by motion."""

from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

GAP = 0.05  # m: hits farther apart that no continuous surface joins belong to separate obstacles
EXPECTED_WITHIN = 0.15  # m between where a mover was expected and the middle of a group of hits
MOVING_SHARE = 0.25  # of a small group's hits must move for the whole of it to be a mover
MOVING, STATIC, UNKNOWN = 1, -1, 0


class Hits(NamedTuple):
    """The hits of one look in ray order, beginning at the start of an obstacle.

    Attributes:
        points: (2, m) x and y, world frame.
        rays: (m,) the rays that hit.
        first: (m,) True at the first hit of each group of hits without a gap between them.
    """

    points: FloatArray
    rays: IntArray
    first: BoolArray


@compiled
def gather_hits(look: Look) -> Hits:
    """The look's hits, split at gaps."""
    points, rays = look.points, look.hit.nonzero()[0]
    count = len(rays)
    parted = np.empty(count, dtype=np.bool_)  # each hit from the next one
    start = 0
    for i in range(count):
        ray, after = rays[i], rays[(i + 1) % count]
        dx, dy = points[0, after] - points[0, ray], points[1, after] - points[1, ray]
        beside = look.joined[ray] and after == (ray + 1) % len(look.hit)
        parted[i] = not (dx * dx + dy * dy < GAP**2 or beside)
        if parted[i]:
            start = i + 1
    gathered, order = np.empty((2, count)), np.empty(count, dtype=np.intp)
    first = np.empty(count, dtype=np.bool_)
    for i in range(count):
        k = (start + i) % count
        order[i] = rays[k]
        gathered[0, i], gathered[1, i] = points[0, rays[k]], points[1, rays[k]]
        first[i] = i == 0 or parted[k - 1]
    return Hits(gathered, order, first)


@compiled
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
        (k + 1,) index of the first hit of each obstacle, and the number of hits; (k,) its flag.
    """
    points, first = hits.points, hits.first
    flags = _without_lone(first, flags)
    count = len(flags)
    bounds, kinds = np.empty(count + 1, dtype=np.intp), np.empty(count, dtype=np.intp)
    number = begin = 0
    while begin < count:
        end = begin + 1
        while end < count and not first[end]:
            end += 1
        if _moves_as_a_whole(points[:, begin:end], flags[begin:end], expected, mover_extent):
            flags[begin:end] = MOVING
        _fill_unknown(flags[begin:end])
        for i in range(begin, end):
            if i == begin or flags[i] != flags[i - 1]:
                bounds[number], kinds[number] = i, flags[i]
                number += 1
        begin = end
    bounds[number] = count
    return bounds[: number + 1], kinds[:number]


@compiled
def _without_lone(first: BoolArray, flags: IntArray) -> IntArray:
    """Overrules a single hit between two of the opposite kind in the same group."""
    kept = flags.copy()
    for i in range(1, len(flags) - 1):
        previous = flags[i - 1]
        if not first[i] and not first[i + 1] and previous == flags[i + 1] == -flags[i]:
            kept[i] = previous
    return kept


@compiled
def _moves_as_a_whole(
    points: FloatArray, flags: IntArray, expected: FloatArray, mover_extent: float
) -> bool:
    """True if a group of hits is no larger than a mover, and moves or was expected to."""
    count, moving = len(flags), 0
    x, y = points[0, 0], points[1, 0]
    left, right, low, high, middle_x, middle_y = x, x, y, y, 0.0, 0.0
    for i in range(count):
        x, y = points[0, i], points[1, i]
        left, right, low, high = min(left, x), max(right, x), min(low, y), max(high, y)
        middle_x += x
        middle_y += y
        moving += flags[i] == MOVING
    if max(right - left, high - low) > mover_extent:
        return False
    if moving >= max(MOVING_SHARE * count, 2.0):
        return True
    for k in range(len(expected)):
        dx, dy = middle_x / count - expected[k, 0], middle_y / count - expected[k, 1]
        if dx * dx + dy * dy < EXPECTED_WITHIN**2:
            return True
    return False


@compiled
def _fill_unknown(flags: IntArray) -> None:
    """Gives a group's unknown hits the flag of their neighbours, rather of those before them;
    none: STATIC."""
    known = STATIC
    for i in range(len(flags) - 1, -1, -1):
        if flags[i] != UNKNOWN:
            known = flags[i]
    for i in range(len(flags)):
        if flags[i] == UNKNOWN:
            flags[i] = known
        known = flags[i]


@compiled
def drop_single(first: BoolArray, flags: IntArray) -> IntArray:
    """Says of a moving hit with no moving one beside it in its group that it is unknown: a single
    ray may be wrong."""
    kept, count = flags.copy(), len(flags)
    for i in range(count):
        before = i > 0 and not first[i] and flags[i - 1] == MOVING
        after = i + 1 < count and not first[i + 1] and flags[i + 1] == MOVING
        if flags[i] == MOVING and not before and not after:
            kept[i] = UNKNOWN
    return kept
