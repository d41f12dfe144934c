"""Cuts a group of moving hits in two where two movers overlap in the robot's view.

All hits of one rigid mover agree with one velocity, and the two ends of its outline keep their
distance. Where one mover passes behind another their hits form one group without a gap: then no
single velocity explains all hits, or the outline's ends drift apart or together.
"""

from collections import deque
from math import hypot
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.flow import PointFlow
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.outline import Outlines, end_rates, outlines
from fuzzynav_mj.sensing.claims import NEW as MOVING
from fuzzynav_mj.sensing.segmentation import Hits
from fuzzynav_mj.types import FloatArray, IntArray

FEWEST = 4  # measured hits on either side of a cut
UNEXPLAINED = 0.03  # m/s: root mean square deviation that calls for a cut
GAIN = 0.5  # a cut must bring the deviation below this share of it
STIFFNESS = 0.05  # keeps fits defined along directions that the hits do not constrain
DRIFT = 0.20  # m/s: difference between the speeds of an outline's ends that calls for a cut
SAME_GROUP = 0.25  # m between the middles of one group in two looks
NONE = -1  # no cut


class OverlapCutter:
    """Remembers the outlines of moving groups over a few looks.

    Args:
        looks: how many looks back outlines are compared.
    """

    def __init__(self, looks: int) -> None:
        self._memory: deque[_Seen] = deque(maxlen=looks)

    def cut(
        self, hits: Hits, bounds: IntArray, flags: IntArray, flow: PointFlow, now: Look
    ) -> tuple[IntArray, IntArray]:
        """The bounds and flags of the obstacles, those that are two movers cut in two."""
        seen = _Seen(now.stamp, flags, outlines(hits, bounds, now))
        before = self._memory[0] if self._memory else seen
        self._memory.append(seen)
        cuts = _cuts(hits, bounds, seen, before, flow, now)
        if len(cuts) == 0:
            return bounds, flags
        places = bounds.searchsorted(cuts)
        return np.insert(bounds, places, cuts), np.insert(flags, places, MOVING)


class _Seen(NamedTuple):
    """The groups of one look.

    Attributes:
        stamp: of the look, s.
        flags: (k,) MOVING or STATIC.
        outlines: of the k groups.
    """

    stamp: float
    flags: IntArray
    outlines: Outlines


@compiled
def _cuts(
    hits: Hits, bounds: IntArray, seen: _Seen, before: _Seen, flow: PointFlow, look: Look
) -> IntArray:
    """First hits after the cuts of moving groups.

    Args:
        hits, bounds: of the groups.
        seen: the groups.
        before: those of an earlier look; the same ones if there is none.
        flow: of the hits.
        look: that they belong to.
    """
    cuts, count = np.empty(len(seen.flags), dtype=np.intp), 0
    for group in range(len(seen.flags)):
        if seen.flags[group] != MOVING:
            continue
        first, end = bounds[group], bounds[group + 1]
        place = _motion_cut(flow, first, end) if len(flow.elapsed) > 0 else NONE
        if place == NONE and _drifts(seen, group, before, look):
            place = _corner(hits, first, end, look)
        if place != NONE:
            cuts[count] = place
            count += 1
    return cuts[:count]


@compiled
def _drifts(seen: _Seen, group: int, before: _Seen, look: Look) -> bool:
    """True where the ends of a moving group's outline drift apart or together."""
    elapsed = seen.stamp - before.stamp
    for k in range(len(before.flags)):
        if before.flags[k] != MOVING:
            continue
        dx = before.outlines.middles[k, 0] - seen.outlines.middles[group, 0]
        dy = before.outlines.middles[k, 1] - seen.outlines.middles[group, 1]
        if hypot(dx, dy) > SAME_GROUP:
            continue
        across, rates = end_rates(seen.outlines.ends[group], before.outlines.ends[k], elapsed, look)
        if not np.isnan(rates[0] + rates[1]):
            # The first end's direction serves for both: they are seen nearly side by side.
            along = across[0, 0] * across[1, 0] + across[0, 1] * across[1, 1]
            turn = 1.0 if along > 0.0 else -1.0
            drifts: bool = abs(rates[0] - turn * rates[1]) > DRIFT
            return drifts
    return False


@compiled
def _motion_cut(flow: PointFlow, first: int, end: int) -> int:
    """The first hit after the cut of a group; `NONE` where one velocity is enough.

    Args:
        flow: the first row of which is looked at.
        first: of the group's hits.
        end: one after the last of them.
    """
    known = first + flow.known[0, first:end].nonzero()[0]
    count = len(known)
    if count < 2 * FEWEST:
        return NONE
    sums = np.zeros((count + 1, 6))  # over the hits before each
    for i in range(count):
        nx, ny = flow.normals[0, 0, known[i]], flow.normals[0, 1, known[i]]
        rate = flow.distance[0, known[i]] / flow.elapsed[0]
        terms = (nx * nx, nx * ny, ny * ny, nx * rate, ny * rate, rate * rate)
        for term in range(6):
            sums[i + 1, term] = sums[i, term] + terms[term]
    whole = _misfit(sums[0], sums[count])
    if whole < count * UNEXPLAINED**2:
        return NONE
    best, place = GAIN**2 * whole, NONE
    for cut in range(FEWEST, count - FEWEST + 1):
        parts = _misfit(sums[0], sums[cut]) + _misfit(sums[cut], sums[count])
        if parts < best:
            best, place = parts, known[cut]
    return place


@compiled
def _misfit(before: FloatArray, upto: FloatArray) -> float:
    """Sum of squared deviations from the best velocity of some hits, from the (6,) sums over the
    hits before them and over those up to the last of them."""
    xx, xy, yy = (
        upto[0] - before[0] + STIFFNESS,
        upto[1] - before[1],
        upto[2] - before[2] + STIFFNESS,
    )
    xr, yr, rr = upto[3] - before[3], upto[4] - before[4], upto[5] - before[5]
    explained = (yy * (xr * xr) - 2 * xy * xr * yr + xx * (yr * yr)) / (xx * yy - xy * xy)
    misfit: float = max(rr - explained, 0.0)
    return misfit


@compiled
def _corner(hits: Hits, first: int, end: int, look: Look) -> int:
    """The hit at the sharpest corner or step of a group's outline, not at its very ends."""
    sharpest, place = np.inf, NONE
    if end - first < 2 * FEWEST:
        return place
    for i in range(first + FEWEST - 1, end - FEWEST + 1):
        before, ray = hits.rays[i - 1], hits.rays[i]
        alike = -1.0
        if look.joined[before] and look.joined[ray]:
            alike = (
                look.normals[0, before] * look.normals[0, ray]
                + look.normals[1, before] * look.normals[1, ray]
            )
        if alike < sharpest:
            sharpest, place = alike, i
    return place
