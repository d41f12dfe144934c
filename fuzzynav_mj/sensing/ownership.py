"""From a look to the owner of each of its hits: the steps between, in one compiled call."""

from math import sqrt
from typing import NamedTuple

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.claims import claimed, without_strangers
from fuzzynav_mj.sensing.evidence import Evidence
from fuzzynav_mj.sensing.expected import Expected
from fuzzynav_mj.sensing.flow import seen_to_move
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.segmentation import (
    MOVING,
    Hits,
    divide,
    drop_single,
    gather_hits,
    moved_as_one,
)
from fuzzynav_mj.types import IntArray


class Owned(NamedTuple):
    """The hits of a look and whose they are.

    Attributes:
        hits: m of them.
        flags: (m,) MOVING, STATIC or UNKNOWN for each hit.
        owners: (m,) number of a known mover, `NEW` or `STANDS`.
    """

    hits: Hits
    flags: IntArray
    owners: IntArray


@compiled
def owners_of(
    now: Look,
    earlier: tuple[Look, ...],
    count: int,
    expected: Expected,
    evidence: Evidence,
) -> Owned:
    """The look's hits and their owners.

    Args:
        now: the look.
        earlier: the oldest that is compared and the newest, of which the first `count` count; where
            rays are unreliable, looks before those.
        expected: the known movers.
        evidence: what shows that a hit moves.
    """
    hits = gather_hits(now)
    flags, intrudes = seen_to_move(hits, now, earlier, count, evidence)
    if evidence.unreliable:
        flags = drop_single(hits.first, flags)
        intrudes &= flags == MOVING
    elapsed = now.stamp - earlier[0].stamp
    slack = evidence.certainty * sqrt(2.0) * evidence.noise  # noise moves what stands, too
    claims = claimed(hits, flags, expected, elapsed, evidence.still + slack)
    flags = moved_as_one(hits, flags, intrudes, evidence.mover_extent)
    owners = divide(hits, flags, claims, expected.centre, now, evidence.mover_extent)
    if count > 0 and len(expected.reach) > 0:
        previous = earlier[count - 1]
        since = now.stamp - previous.stamp
        owners = without_strangers(hits, flags, claims, owners, expected, previous, since)
    return Owned(hits, flags, owners)
