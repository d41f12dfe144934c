"""Which hits known movers claim: those that lie on their outlines, carried on to this look."""

from math import hypot

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.expected import Expected
from fuzzynav_mj.sensing.segmentation import STANDS, STATIC, Hits
from fuzzynav_mj.types import IntArray


@compiled
def claimed(
    hits: Hits, flags: IntArray, expected: Expected, elapsed: float, still: float
) -> IntArray:
    """(m,) number of the mover that claims each hit; `STANDS` where none does.

    Args:
        hits: m of them.
        flags: (m,) whether each one moves.
        expected: the movers.
        elapsed: s that `flags` look back.
        still: a surface that moved less than this in that time seems to stand, m.
    """
    owners = np.full(len(flags), STANDS)
    for i in range(len(flags)):
        best = 1.0
        for k in range(len(expected.owner)):
            mover = expected.owner[k]
            dx = hits.points[0, i] - expected.points[0, k]
            dy = hits.points[1, i] - expected.points[1, k]
            if expected.joined[k]:
                along_x = expected.points[0, k + 1] - expected.points[0, k]
                along_y = expected.points[1, k + 1] - expected.points[1, k]
                squared = max(along_x * along_x + along_y * along_y, 1e-12)
                share = min(max((dx * along_x + dy * along_y) / squared, 0.0), 1.0)
                dx, dy = dx - share * along_x, dy - share * along_y
            off = hypot(dx, dy) / expected.reach[mover]
            if off >= best:
                continue
            if flags[i] == STATIC and expected.joined[k]:
                # Had this piece been there, it would have been seen to move.
                speed = (
                    expected.normals[0, k] * expected.velocity[mover, 0]
                    + expected.normals[1, k] * expected.velocity[mover, 1]
                )
                if abs(speed) * elapsed > 2.0 * still:
                    continue
            best, owners[i] = off, mover
    return owners
