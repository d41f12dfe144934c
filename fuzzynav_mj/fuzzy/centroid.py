"""Exact centroid of clipped and joined risk terms, without sampling the risk axis.

Term k clipped at strength h has an area and a first moment that are polynomials in h. Only
neighbours overlap, on their shared ramp, where the smaller of the two is min(m, t, 1 - t) with
m = min(h_k, h_k+1, 1/2) and t running over the ramp from 0 to 1: a trapezoid symmetric about the
ramp's middle, of area m (1 - m) per width. As max(f, g) = f + g - min(f, g), the integrals of the
joined shape are those of the terms less those of the overlaps.
"""

import math
from collections.abc import Sequence

import numpy as np

from fuzzynav_mj.fuzzy.membership import Memberships
from fuzzynav_mj.types import FloatArray


class Centroid:
    """Centre of gravity of max_k min(h_k, term_k(risk)) over risk in [0, 100]."""

    def __init__(self, memberships: Memberships) -> None:
        terms = memberships.risk_terms.values()
        # area(h) = h (a1 + h a2), moment(h) = h (m1 + h (m2 + h m3)): integrals over the height z
        # of the slice from a + z (b - a) to d - z (d - c).
        self._terms = tuple(
            (
                t.d - t.a,
                -((t.b - t.a) + (t.d - t.c)) / 2,
                (t.d**2 - t.a**2) / 2,
                -(t.d * (t.d - t.c) + t.a * (t.b - t.a)) / 2,
                ((t.d - t.c) ** 2 - (t.b - t.a) ** 2) / 6,
            )
            for t in terms
        )
        self._ramps = tuple(
            (end - start, (start + end) / 2) for start, end in memberships.risk_ramps
        )
        self._term_columns = np.array(self._terms).T
        self._ramp_columns = np.array(self._ramps).T

    def of(self, strengths: Sequence[float]) -> float:
        """Centroid for the strengths of the five `RiskTerm`s; nan if all are 0."""
        area = moment = 0.0
        for h, (a1, a2, m1, m2, m3) in zip(strengths, self._terms, strict=True):
            if h:
                area += h * (a1 + h * a2)
                moment += h * (m1 + h * (m2 + h * m3))
        below = strengths[0]
        for above, (width, middle) in zip(strengths[1:], self._ramps, strict=True):
            if below and above:
                m = min(below, above, 0.5)
                overlap = width * m * (1.0 - m)
                area -= overlap
                moment -= middle * overlap
            below = above
        return moment / area if area > 0.0 else math.nan

    def of_rows(self, strengths: FloatArray) -> FloatArray:
        """Centroids (n,) for strengths (n, 5); nan where all five are 0."""
        a1, a2, m1, m2, m3 = self._term_columns
        width, middle = self._ramp_columns
        h = strengths
        m = np.minimum(np.minimum(h[:, :-1], h[:, 1:]), 0.5)
        overlap = width * m * (1.0 - m)
        area = (h * (a1 + h * a2)).sum(axis=1) - overlap.sum(axis=1)
        moment = (h * (m1 + h * (m2 + h * m3))).sum(axis=1) - (middle * overlap).sum(axis=1)
        centroids = np.full(len(h), np.nan)
        np.divide(moment, area, out=centroids, where=area > 0.0)
        return centroids
