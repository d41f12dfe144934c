"""Separates the hits of one look into obstacles, by gaps and by motion."""

from math import hypot
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.parts import convex_parts
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

GAP = 0.05  # m: hits farther apart that no continuous surface joins belong to separate obstacles
EXPECTED_WITHIN = 0.15  # m between where a mover was expected and the middle of a group of hits
MOVING_SHARE = 0.25  # of a small group's hits must move for the whole of it to be a mover
CAME_INTO_VIEW = 0.05  # m of a mover's outline that may come into view between two looks
MOVING, STATIC, UNKNOWN = 1, -1, 0
STANDS, NEW = -1, -2  # owners of hits that belong to no known mover


class Hits(NamedTuple):
    """The hits of one look in ray order, beginning at the start of an obstacle.

    Attributes:
        points: (2, m) x and y, world frame.
        rays: (m,) the rays that hit.
        first: (m,) True at the first hit of each group of hits without a gap between them.
        part: (m,) number of the convex part of an outline that each is of (`convex_parts`).
    """

    points: FloatArray
    rays: IntArray
    first: BoolArray
    part: IntArray


@compiled
def gather_hits(look: Look) -> Hits:
    """The look's hits, split at gaps."""
    points, rays = look.points, look.hit.nonzero()[0]
    count = len(rays)
    parted = np.empty(count, dtype=np.bool_)  # each hit from the next one
    beside = np.empty(count, dtype=np.bool_)  # on one surface with the next one
    start = 0
    for i in range(count):
        ray, after = rays[i], rays[(i + 1) % count]
        dx, dy = points[0, after] - points[0, ray], points[1, after] - points[1, ray]
        beside[i] = look.joined[ray] and after == (ray + 1) % len(look.hit)
        parted[i] = not (dx * dx + dy * dy < GAP**2 or beside[i])
        if parted[i]:
            start = i + 1
    gathered, order = np.empty((2, count)), np.empty(count, dtype=np.intp)
    first, joined = np.empty(count, dtype=np.bool_), np.empty(count, dtype=np.bool_)
    for i in range(count):
        k = (start + i) % count
        order[i] = rays[k]
        gathered[0, i], gathered[1, i] = points[0, rays[k]], points[1, rays[k]]
        first[i] = i == 0 or parted[k - 1]
        joined[i] = i + 1 < count and beside[k]
    return Hits(gathered, order, first, convex_parts(gathered, joined))


@compiled
def moved_as_one(hits: Hits, flags: IntArray, intrudes: BoolArray, mover_extent: float) -> IntArray:
    """(m,) the flags, where a part of an outline moves as a whole if a hit of it does for certain.

    Of a side that slides along itself only the end that leads shows that it moves.

    Args:
        hits: m of them.
        flags: (m,) MOVING, STATIC or UNKNOWN for each hit.
        intrudes: (m,) True for hits in former free space: no standing obstacle comes there.
        mover_extent: largest extent of a mover's visible side, m.
    """
    moved, bounds = flags.copy(), run_bounds(hits.first, hits.part)
    for k in range(len(bounds) - 1):
        begin, end = bounds[k], bounds[k + 1]
        if intrudes[begin:end].any() and _extent(hits.points[:, begin:end]) <= mover_extent:
            moved[begin:end] = MOVING
    return moved


@compiled
def divide(
    hits: Hits,
    flags: IntArray,
    claims: IntArray,
    centres: FloatArray,
    look: Look,
    mover_extent: float,
) -> IntArray:
    """(m,) what each hit belongs to: the number of a known mover, `NEW` or `STANDS`.

    A mover that passes close to a wall is one group with it; its hits move, the wall's do not.
    A group no larger than a mover moves as a whole if a fair share of it does: a side that slides
    along itself merely does not show it.

    Args:
        hits: the hits and their groups.
        flags: (m,) MOVING, STATIC or UNKNOWN for each hit.
        claims: (m,) number of the known mover on whose expected outline it lies, or -1.
        centres: (k, 2) where the middles of those movers should be, world frame.
        look: that the hits belong to.
        mover_extent: largest extent of a mover's visible side, m.
    """
    owners, flags = claims.copy(), _without_lone(hits.first, flags)
    count, begin = len(flags), 0
    while begin < count:
        end = begin + 1
        while end < count and not hits.first[end]:
            end += 1
        group = hits.points[:, begin:end]
        small = _extent(group) <= mover_extent
        x, y = group[0].mean(), group[1].mean()
        known = 0
        for i in range(begin, end):
            mover = owners[i]
            if mover >= 0 and flags[i] == STATIC:
                # It may slide along itself, or be a wall that the mover slides along.
                away = hypot(x - centres[mover, 0], y - centres[mover, 1])
                expected = small and away <= EXPECTED_WITHIN
                if not expected and not _moves_with(i, mover, owners, flags, hits.part):
                    owners[i] = STANDS
            known += owners[i] >= 0
        if known > 0:
            apart = _stand_apart(
                hits.first[begin:end], hits.part[begin:end], flags[begin:end], owners[begin:end]
            )
            _spread(hits, flags[begin:end], owners[begin:end], apart, begin, look)
            if small:
                _share(owners[begin:end], flags[begin:end], apart)
        else:
            moving = (flags[begin:end] == MOVING).sum()
            if small and moving >= max(MOVING_SHARE * (end - begin), 2.0):
                flags[begin:end] = MOVING
            _fill_unknown(flags[begin:end])
        for i in range(begin, end):
            if owners[i] < 0:
                owners[i] = NEW if flags[i] == MOVING else STANDS
        begin = end
    return owners


def owners_anew(hits: Hits, flags: IntArray, left: IntArray) -> IntArray:
    """(k,) `NEW` or `STANDS` for hits that their mover's motion does not explain: one that is not
    seen to move stands if something in its part of the outline does.

    Args:
        hits: m of them.
        flags: (m,) MOVING, STATIC or UNKNOWN for each hit.
        left: (k,) numbers of those that need an owner.
    """
    standing = hits.part[flags == STATIC]
    stands = (flags[left] != MOVING) & np.isin(hits.part[left], standing)
    return np.where(stands, STANDS, NEW)


@compiled
def _moves_with(i: int, mover: int, owners: IntArray, flags: IntArray, part: IntArray) -> bool:
    """True if a hit of the same part as hit `i` moves and is a mover's; see `divide`."""
    for k in range(len(part)):
        if part[k] == part[i] and owners[k] == mover and flags[k] == MOVING:
            return True
    return False


@compiled
def run_bounds(first: BoolArray, owners: IntArray | BoolArray) -> IntArray:
    """(k + 1,) the first hit of each obstacle, hits side by side in one group with one owner; and
    the number of hits. The same for runs of hits with anything else in common, as a part."""
    count = len(owners)
    bounds, number = np.empty(count + 1, dtype=np.intp), 0
    for i in range(count):
        if first[i] or owners[i] != owners[i - 1]:
            bounds[number] = i
            number += 1
    bounds[number] = count
    return bounds[: number + 1]


@compiled
def _spread(
    hits: Hits, flags: IntArray, owners: IntArray, apart: BoolArray, begin: int, look: Look
) -> None:
    """Gives hits that came into view beside a known mover to it.

    Args:
        hits: all hits.
        flags, owners, apart: (k,) of the group that begins with hit number `begin`.
        look: that the hits belong to.
    """
    count = len(owners)
    for step in (1, -1):
        beside = -1  # the hit of a known mover that was passed last
        for n in range(count):
            i = n if step > 0 else count - 1 - n
            if owners[i] >= 0:
                beside = i
                continue
            before = i - step
            standing = apart[i] or flags[i] == STATIC
            if beside < 0 or standing or owners[before] != owners[beside]:
                continue
            dx = hits.points[0, begin + i] - hits.points[0, begin + beside]
            dy = hits.points[1, begin + i] - hits.points[1, begin + beside]
            ray = hits.rays[begin + min(i, before)]
            near = look.joined[ray] and hypot(dx, dy) <= CAME_INTO_VIEW
            if near or hits.part[begin + i] == hits.part[begin + beside]:
                owners[i] = owners[beside]


@compiled
def _stand_apart(first: BoolArray, part: IntArray, flags: IntArray, owners: IntArray) -> BoolArray:
    """(k,) True for hits of a group that are not seen to move, in a part of the outline in which
    something stands and no mover owns anything."""
    apart, bounds = np.zeros(len(part), dtype=np.bool_), run_bounds(first, part)
    for k in range(len(bounds) - 1):
        begin, end = bounds[k], bounds[k + 1]
        stands = (flags[begin:end] == STATIC).any()
        if stands and not (owners[begin:end] >= 0).any():
            apart[begin:end] = flags[begin:end] != MOVING
    return apart


@compiled
def _share(owners: IntArray, flags: IntArray, apart: BoolArray) -> None:
    """Gives all of a small group to the movers that own most of it, each hit to the one beside; but
    not what moves on a place that none of them claims, for it may come out from behind them, nor
    what stands apart from them."""
    count = len(owners)
    if 2 * (owners >= 0).sum() < count:
        return
    for step in (1, -1):
        for n in range(1, count):
            i = n if step > 0 else count - 1 - n
            if owners[i] < 0 and flags[i] != MOVING and not apart[i]:
                owners[i] = owners[i - step]


@compiled
def _extent(points: FloatArray) -> float:
    """The larger side of the box around points (2, k), m."""
    left, right, low, high = points[0, 0], points[0, 0], points[1, 0], points[1, 0]
    for i in range(1, points.shape[1]):
        x, y = points[0, i], points[1, i]
        left, right, low, high = min(left, x), max(right, x), min(low, y), max(high, y)
    larger: float = max(right - left, high - low)
    return larger


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
