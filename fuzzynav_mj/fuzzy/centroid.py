"""Exact centroid of clipped and joined risk terms, without sampling the risk axis.

Term k clipped at strength h has an area and a first moment that are polynomials in h. Only
neighbours overlap, on their shared ramp, where the smaller of the two is min(m, t, 1 - t) with
m = min(h_k, h_k+1, 1/2) and t running over the ramp from 0 to 1: a trapezoid symmetric about the
ramp's middle, of area m (1 - m) per width. As max(f, g) = f + g - min(f, g), the integrals of the
joined shape are those of the terms less those of the overlaps.
"""

from dataclasses import dataclass

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.fuzzy.membership import Memberships
from fuzzynav_mj.types import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class RiskShapes:
    """What the centroid needs to know of the five risk terms.

    Attributes:
        terms: (5, 5) a1, a2, m1, m2, m3 of each, where area(h) = h (a1 + h a2) and
            moment(h) = h (m1 + h (m2 + h m3)): integrals over the height z of the slice from
            a + z (b - a) to d - z (d - c).
        ramps: (4, 2) width and middle of the ramps that neighbours share.
    """

    terms: FloatArray
    ramps: FloatArray


def risk_shapes(memberships: Memberships) -> RiskShapes:
    """The shapes of these memberships' risk terms."""
    terms = [
        (
            t.d - t.a,
            -((t.b - t.a) + (t.d - t.c)) / 2,
            (t.d**2 - t.a**2) / 2,
            -(t.d * (t.d - t.c) + t.a * (t.b - t.a)) / 2,
            ((t.d - t.c) ** 2 - (t.b - t.a) ** 2) / 6,
        )
        for t in memberships.risk_terms.values()
    ]
    ramps = [(end - start, (start + end) / 2) for start, end in memberships.risk_ramps]
    return RiskShapes(np.array(terms), np.array(ramps))


@compiled
def centroid(strengths: FloatArray, terms: FloatArray, ramps: FloatArray) -> float:
    """Centre of gravity of max_k min(h_k, term_k(risk)) over risk in [0, 100].

    Args:
        strengths: (5,) the heights h_k.
        terms, ramps: as in `RiskShapes`.

    Returns:
        nan if all strengths are 0.
    """
    area = moment = 0.0
    for k in range(len(terms)):
        h = strengths[k]
        a1, a2, m1, m2, m3 = terms[k]
        area += h * (a1 + h * a2)
        moment += h * (m1 + h * (m2 + h * m3))
    for k in range(len(ramps)):
        m = min(strengths[k], strengths[k + 1], 0.5)
        overlap = ramps[k, 0] * m * (1.0 - m)
        area -= overlap
        moment -= ramps[k, 1] * overlap
    return moment / area if area > 0.0 else np.nan
