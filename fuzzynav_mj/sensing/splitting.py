"""Cuts a group of moving hits in two where two movers overlap in the robot's view.

All hits of one rigid mover agree with one velocity, and the two ends of its outline keep their
distance. Where one mover passes behind another their hits form one group without a gap: then no
single velocity explains all hits, or the outline's ends drift apart or together.
"""

from collections import deque

import numpy as np

from fuzzynav_mj.sensing.flow import PointFlow
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.outline import end_rates, outline_ends
from fuzzynav_mj.sensing.segmentation import MOVING, Hits
from fuzzynav_mj.types import FloatArray, IntArray

FEWEST = 4  # measured hits on either side of a cut
UNEXPLAINED = 0.03  # m/s: root mean square deviation that calls for a cut
GAIN = 0.5  # a cut must bring the deviation below this share of it
STIFFNESS = 0.05  # keeps fits defined along directions that the hits do not constrain
DRIFT = 0.20  # m/s: difference between the speeds of an outline's ends that calls for a cut
SAME_GROUP = 0.25  # m between the middles of one group in two looks


class OverlapCutter:
    """Remembers the outlines of moving groups over a few looks.

    Args:
        looks: how many looks back outlines are compared.
    """

    def __init__(self, looks: int) -> None:
        self._memory: deque[list[tuple[float, FloatArray, FloatArray]]] = deque(maxlen=looks)

    def cut(
        self, hits: Hits, begin: IntArray, flags: IntArray, flows: list[PointFlow], now: Look
    ) -> tuple[IntArray, IntArray]:
        """The obstacles' first hits and flags, those that are two movers cut in two."""
        cuts: list[int] = []
        seen: list[tuple[float, FloatArray, FloatArray]] = []
        ends_of = np.append(begin, len(hits.points))[1:]
        for index in (flags == MOVING).nonzero()[0]:
            span = slice(int(begin[index]), int(ends_of[index]))
            ends = outline_ends(hits, span, now)
            middle = hits.points[span].mean(axis=0)
            seen.append((now.stamp, middle, ends))
            place = _motion_cut_within(span, flows)
            if place is None and self._drifts(middle, ends, now):
                place = _corner_within(hits, span, now)
            if place is not None:
                cuts.append(place)
        self._memory.append(seen)
        if not cuts:
            return begin, flags
        places = begin.searchsorted(cuts)
        return np.insert(begin, places, cuts), np.insert(flags, places, MOVING)

    def _drifts(self, middle: FloatArray, ends: FloatArray, now: Look) -> bool:
        if np.isnan(ends).any() or not self._memory:
            return False
        for stamp, place, before in self._memory[0]:
            if np.isnan(before).any() or np.hypot(*(place - middle)) > SAME_GROUP:
                continue
            across, rates = end_rates(ends, before, now.stamp - stamp, now)
            # The first end's direction serves for both: they are seen nearly side by side.
            turn = 1.0 if float(across[0] @ across[1]) > 0.0 else -1.0
            return bool(abs(rates[0] - turn * rates[1]) > DRIFT)
        return False


def motion_cut(normals: FloatArray, rates: FloatArray) -> int | None:
    """Index of the first hit after the cut; None where one velocity is enough.

    Args:
        normals: (m, 2) unit normals of the measured hits, in ray order.
        rates: (m,) their motion along the normals, m/s.
    """
    count = len(rates)
    if count < 2 * FEWEST:
        return None
    nx, ny = normals.T
    terms = np.stack((nx * nx, nx * ny, ny * ny, nx * rates, ny * rates, rates * rates))
    before = np.cumsum(terms, axis=1)
    total = before[:, -1:]
    whole = float(_misfit(total)[0])
    if whole < count * UNEXPLAINED**2:
        return None
    cuts = np.arange(FEWEST, count - FEWEST + 1)
    left = before[:, cuts - 1]
    parts = _misfit(left) + _misfit(total - left)
    best = int(parts.argmin())
    return int(cuts[best]) if parts[best] < GAIN**2 * whole else None


def _misfit(sums: FloatArray) -> FloatArray:
    """(k,) sum of squared deviations from the best velocity, from sums (6, k) over the hits."""
    xx, xy, yy, xr, yr, rr = sums
    xx, yy = xx + STIFFNESS, yy + STIFFNESS
    explained = (yy * xr**2 - 2 * xy * xr * yr + xx * yr**2) / (xx * yy - xy**2)
    misfit: FloatArray = np.maximum(rr - explained, 0.0)
    return misfit


def _motion_cut_within(span: slice, flows: list[PointFlow]) -> int | None:
    if not flows:
        return None
    flow = flows[0]
    known = span.start + flow.known[span].nonzero()[0]
    cut = motion_cut(flow.normals[known], flow.distance[known] / flow.elapsed)
    return None if cut is None else int(known[cut])


def _corner_within(hits: Hits, span: slice, look: Look) -> int | None:
    """The hit at the sharpest corner or step of a group's outline, not at its very ends."""
    if span.stop - span.start < 2 * FEWEST:
        return None
    rays = hits.rays[span]
    normals = look.normals[rays]
    alike = (normals[:-2] * normals[1:-1]).sum(axis=1)
    alike = np.where(look.joined[rays[:-2]] & look.joined[rays[1:-1]], alike, -1.0)
    inner = alike[FEWEST - 2 : len(alike) - FEWEST + 2]
    return int(span.start) + FEWEST - 1 + int(inner.argmin())
