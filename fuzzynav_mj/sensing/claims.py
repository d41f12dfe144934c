"""Which hits belong to which known mover."""

from math import hypot
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.flow import PointFlow
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.segmentation import MOVING, STATIC, UNKNOWN, Hits, _fill_unknown, _moves_as_a_whole, _without_lone
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

STANDS, NEW = -1, -2
CONTRADICTS = 0.02
FEWEST = 3
SHARE = 0.5
SPREAD = 0.06
TIGHT = 0.012
WITHIN = 0.15


class Expected(NamedTuple):
    """Outlines of t known movers as expected in a look.

    Attributes:
        points: (2, k) of all, world frame, m.
        joined: (k,) True where a point and the next one belong to one surface of one mover.
        normals: (2, k) of the piece between them.
        owner: (k,) number of the mover.
        velocity: (t, 2) m/s.
        reach: (t,) how far off its outline a mover's hits may lie, m.
    """

    points: FloatArray
    joined: BoolArray
    normals: FloatArray
    owner: IntArray
    velocity: FloatArray
    reach: FloatArray
    centre: FloatArray


@compiled
def claimed(hits: Hits, flags: IntArray, expected: Expected, elapsed: float, still: float) -> IntArray:
    count = hits.points.shape[1]
    owners = np.full(count, -1)
    total = expected.points.shape[1]
    for i in range(count):
        best = 1.0
        x, y = hits.points[0, i], hits.points[1, i]
        for k in range(total):
            t = expected.owner[k]
            dx, dy = x - expected.points[0, k], y - expected.points[1, k]
            inside = False
            if expected.joined[k]:
                bx = expected.points[0, k + 1] - expected.points[0, k]
                by = expected.points[1, k + 1] - expected.points[1, k]
                u = (dx * bx + dy * by) / max(bx * bx + by * by, 1e-12)
                inside = 0.0 <= u <= 1.0
                u = min(max(u, 0.0), 1.0)
                dx, dy = dx - u * bx, dy - u * by
            off = hypot(dx, dy) / expected.reach[t]
            if off >= best:
                continue
            if flags[i] == STATIC:
                along = (
                    expected.normals[0, k] * expected.velocity[t, 0]
                    + expected.normals[1, k] * expected.velocity[t, 1]
                )
                if abs(along) * elapsed > 2.0 * still:
                    continue
            best = off
            owners[i] = t
    return owners


@compiled
def _contradicts(flow: PointFlow, i: int, vx: float, vy: float) -> bool:
    for row in range(len(flow.elapsed)):
        if flow.known[row, i]:
            e = flow.elapsed[row]
            want = (flow.normals[row, 0, i] * vx + flow.normals[row, 1, i] * vy) * e
            return abs(flow.distance[row, i] - want) > CONTRADICTS
    return False


@compiled
def divide(
    hits: Hits, flags: IntArray, owners: IntArray, flow: PointFlow, velocity: FloatArray, centre: FloatArray, look: Look, mover_extent: float
) -> tuple[IntArray, IntArray]:
    """(k + 1,) bounds and (k,) owner of each obstacle: number of the mover, STANDS or NEW."""
    points, first = hits.points, hits.first
    flags = _without_lone(first, flags)
    owners = owners.copy()
    count = len(flags)
    bounds, kinds = np.empty(count + 1, dtype=np.intp), np.empty(count, dtype=np.intp)
    nobody = np.empty((0, 2))
    number = begin = 0
    while begin < count:
        end = begin + 1
        while end < count and not first[end]:
            end += 1
        known = False
        small = _small(points[:, begin:end], mover_extent)
        mx, my = points[0, begin:end].mean(), points[1, begin:end].mean()
        for i in range(begin, end):
            if flags[i] == STATIC and owners[i] >= 0:
                k = owners[i]
                if not small or hypot(mx - centre[k, 0], my - centre[k, 1]) > WITHIN:
                    owners[i] = STANDS
            known |= owners[i] >= 0
        if known:
            _spread(hits, flags, owners, flow, velocity, look, begin, end, small)
            if small:
                _share(owners, begin, end)
        elif _moves_as_a_whole(points[:, begin:end], flags[begin:end], nobody, mover_extent):
            flags[begin:end] = MOVING
        if not known:
            _fill_unknown(flags[begin:end])
        for i in range(begin, end):
            if owners[i] < 0:
                owners[i] = NEW if flags[i] == MOVING else STANDS
            if i == begin or owners[i] != owners[i - 1]:
                bounds[number], kinds[number] = i, owners[i]
                number += 1
        begin = end
    bounds[number] = count
    return bounds[: number + 1], kinds[:number]


@compiled
def without_standing(hits: Hits, flags: IntArray, owners: IntArray, look: Look, tracks: int) -> BoolArray:
    """Takes hits that show no motion from movers unless they are joined to some that may move.

    Returns:
        (tracks,) True where no hit of a mover shows motion.
    """
    count = len(owners)
    idle = np.full(tracks, True)
    for i in range(count):
        if owners[i] >= 0 and flags[i] != STATIC:
            idle[owners[i]] = False
    linked = np.zeros(count, dtype=np.bool_)
    for step in (1, -1):
        for n in range(count):
            i = n if step > 0 else count - 1 - n
            if owners[i] < 0:
                continue
            if flags[i] != STATIC:
                linked[i] = True
                continue
            j = i - step
            if 0 <= j < count and owners[j] == owners[i] and linked[j]:
                ray = hits.rays[j] if step > 0 else hits.rays[i]
                if look.joined[ray]:
                    linked[i] = True
    for i in range(count):
        if owners[i] >= 0 and not linked[i] and not idle[owners[i]]:
            owners[i] = STANDS
    return idle


@compiled
def _small(points: FloatArray, extent: float) -> bool:
    left = right = points[0, 0]
    low = high = points[1, 0]
    for i in range(points.shape[1]):
        x, y = points[0, i], points[1, i]
        left, right, low, high = min(left, x), max(right, x), min(low, y), max(high, y)
    return max(right - left, high - low) <= extent


@compiled
def _spread(
    hits: Hits, flags: IntArray, owners: IntArray, flow: PointFlow, velocity: FloatArray, look: Look, begin: int, end: int, small: bool
) -> None:
    """Hits that no one claims go to the mover beside them, unless they contradict its motion."""
    for step in (1, -1):
        i = begin if step > 0 else end - 1
        while begin <= i < end:
            if owners[i] < 0:
                i += step
                continue
            k = owners[i]
            j = i + step
            while begin <= j < end and owners[j] < 0:
                if flags[j] == STATIC:
                    break
                if True:
                    ray = hits.rays[j] if step < 0 else hits.rays[j - 1]
                    if not look.joined[ray]:
                        break
                if hypot(hits.points[0, j] - hits.points[0, i], hits.points[1, j] - hits.points[1, i]) > SPREAD:
                    break
                if _run_contradicts(flow, owners, j, step, begin, end, velocity[k, 0], velocity[k, 1]):
                    break
                owners[j] = k
                j += step
            i = j


@compiled
def _share(owners: IntArray, begin: int, end: int) -> None:
    """All hits of a small group go to the movers that own most of it."""
    owned = 0
    for i in range(begin, end):
        owned += owners[i] >= 0
    if owned < SHARE * (end - begin):
        return
    for i in range(begin + 1, end):
        if owners[i] < 0:
            owners[i] = owners[i - 1]
    for i in range(end - 2, begin - 1, -1):
        if owners[i] < 0:
            owners[i] = owners[i + 1]


@compiled
def _run_contradicts(flow: PointFlow, owners: IntArray, j: int, step: int, begin: int, end: int, vx: float, vy: float) -> bool:
    """True if the next few hits that nobody claims contradict the motion."""
    for n in range(FEWEST):
        i = j + n * step
        if not begin <= i < end or owners[i] >= 0:
            return False
        if not _contradicts(flow, i, vx, vy):
            return False
    return True
