"""Cuts a group of moving hits in two where two movers overlap in the robot's view.

Hits of one rigid mover all agree with one velocity. Where one mover passes behind another their
hits form one group without a gap, and no single velocity explains it; two do, one on each side of
a cut.
"""

import numpy as np

from fuzzynav_mj.types import FloatArray

FEWEST = 4  # measured hits on either side of a cut
UNEXPLAINED = 0.03  # m/s: root mean square deviation that calls for a cut
GAIN = 0.5  # a cut must bring the deviation below this share of it
STIFFNESS = 0.05  # keeps fits defined along directions that the hits do not constrain


def motion_cut(normals: FloatArray, rates: FloatArray) -> int | None:
    """Index of the first hit after the cut; None where one velocity is enough.

    Args:
        normals: (m, 2) unit normals of the measured hits, in ray order.
        rates: (m,) their motion along the normals, m/s.
    """
    count = len(rates)
    if count < 2 * FEWEST:
        return None
    terms = np.stack(
        (
            normals[:, 0] ** 2,
            normals[:, 0] * normals[:, 1],
            normals[:, 1] ** 2,
            normals[:, 0] * rates,
            normals[:, 1] * rates,
            rates**2,
        )
    )
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
    return np.maximum(rr - explained, 0.0)
