"""Two tracks that turn out to be faces of one mover, of each of which alone the motion along itself
is hardly known."""

from math import inf

import numpy as np

from fuzzynav_mj.sensing.corners import STRAY_REACH
from fuzzynav_mj.sensing.outline import in_one
from fuzzynav_mj.sensing.registration import misfit
from fuzzynav_mj.sensing.tracking import Track
from fuzzynav_mj.sensing.velocity_filter import STATE, gone_since
from fuzzynav_mj.types import FloatArray

SAME_MOVER = 3.0  # squared standard deviations between velocities that may be one
SAME_MOVER_MISFIT = 0.006  # m by which one velocity may miss both outlines


def are_one(one: Track, other: Track) -> bool:
    """True if one velocity explains what both have seen."""
    both = one.covariance[:2, :2] + other.covariance[:2, :2]
    off = one.velocity - other.velocity
    if off @ np.linalg.solve(both, off) >= SAME_MOVER:
        return False
    state, _ = _in_the_light_of_both(one, other)
    return all(_misses(track, state) < SAME_MOVER_MISFIT for track in (one, other))


def absorb(one: Track, other: Track) -> None:
    """Has a track take in what is known of a mover that turned out to be the same one, seen after
    it in the order of the rays."""
    one.state, one.covariance = _in_the_light_of_both(one, other)
    later = {outline.stamp: outline for outline in other.outlines}
    for number, outline in enumerate(one.outlines):
        if outline.stamp in later:
            one.outlines[number] = in_one(outline, later[outline.stamp])
    one.fullest = one.outlines[-1]
    one.most = len(one.fullest.joined)
    one.shift = np.zeros(2)
    one.centre = one.fullest.points.mean(axis=1)
    one.seen = max(one.seen, other.seen)


def _in_the_light_of_both(one: Track, other: Track) -> tuple[FloatArray, FloatArray]:
    """State (6,) and covariance (6, 6) of what both tracks tell of one mover."""
    mine = np.linalg.inv(one.covariance[:4, :4])
    theirs = np.linalg.inv(other.covariance[:4, :4])
    state, covariance = np.zeros(STATE), np.zeros((STATE, STATE))
    covariance[:4, :4] = np.linalg.inv(mine + theirs)
    state[:4] = covariance[:4, :4] @ (mine @ one.state[:4] + theirs @ other.state[:4])
    return state, covariance


def _misses(track: Track, state: FloatArray) -> float:
    """By how much a motion misses the last outline of a track, m; inf if that cannot be told."""
    if len(track.outlines) < 2:
        return inf
    now, before = track.outlines[-1], track.outlines[-2]
    gone = gone_since(state, now.stamp - before.stamp)
    return misfit(now, before, *gone, STRAY_REACH)
