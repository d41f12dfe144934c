"""Where the outlines of known movers should be in the next look."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.sensing.tracking import Track
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray


class Expected(NamedTuple):
    """Outlines of t known movers where they should be now, k points in all.

    Attributes:
        points: (2, k) world frame, m.
        joined: (k,) True where a point and the next one lie on one surface of one mover.
        normals: (2, k) of the piece between them.
        owner: (k,) number of the mover.
        velocity: (t, 2) m/s.
        centre: (t, 2) middle of its hits, world frame, m.
        reach: (t,) how far off its outline a mover's hits may lie, m.
    """

    points: FloatArray
    joined: BoolArray
    normals: FloatArray
    owner: IntArray
    velocity: FloatArray
    centre: FloatArray
    reach: FloatArray


NOBODY = Expected(
    np.empty((2, 0)),
    np.empty(0, dtype=bool),
    np.empty((2, 0)),
    np.empty(0, dtype=np.intp),
    np.empty((0, 2)),
    np.empty((0, 2)),
    np.empty(0),
)


def expected_outlines(tracks: Sequence[Track], slack: float) -> Expected:
    """Where the tracks' outlines should be now, give or take `slack`, m, for the sensor's noise."""
    if not tracks:
        return NOBODY
    full = [track.fullest for track in tracks]
    return Expected(
        points=np.concatenate([track.expected_outline for track in tracks], axis=1),
        joined=np.concatenate([outline.joined for outline in full]),
        normals=np.concatenate([outline.normals for outline in full], axis=1),
        owner=np.repeat(np.arange(len(tracks)), [len(outline.joined) for outline in full]),
        velocity=np.array([track.velocity for track in tracks]),
        centre=np.array([track.centre for track in tracks]),
        reach=np.array([track.reach + slack for track in tracks], dtype=np.float64),
    )
