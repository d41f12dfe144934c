"""Movers that turn at once, as on a route with corners.

The filter believes that a velocity changes by an acceleration that lasts for a while. Where a look
contradicts that, a mover has turned since the look before. What was believed of its motion is then
worth nothing, and of how its outline has moved since that look only the mean is known: some of the
way it went as before.
"""

from math import hypot
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.free_space import FreeSpace
from fuzzynav_mj.sensing.outline import Outline
from fuzzynav_mj.sensing.registration import strays
from fuzzynav_mj.sensing.velocity_filter import (
    LARGEST_ACCELERATION,
    Beliefs,
    gone_since,
    nothing_known,
    squared_sigmas,
    taken_in,
)
from fuzzynav_mj.sensing.velocity_grid import frame_of, motions, without
from fuzzynav_mj.types import BoolArray, FloatArray

STRAY_REACH = 0.08  # m within which a hit is held against an outline that should explain it
STRAY = 0.008  # m by which it may lie off, besides ...
STRAY_NOISE = 2.0  # ... so many standard deviations of the ranges
UNLIKE = 9.0  # squared standard deviations beyond which a velocity is not the one expected
STRAIGHT_ON = 0.4  # m/s2: what is believed of accelerations between corners
SAME_SPEED = 0.05  # m/s: standard deviation of a speed after a corner from the one before
POSSIBLE = 0.02  # share of the motions that an outline leaves open that must be slow enough
BEFORE = 0.5  # of the change: standard deviation of the velocity now from the mean since the look


class Turned(NamedTuple):
    """A mover after it has turned at once.

    Attributes:
        state: (6,) as in velocity_filter.py.
        covariance: (6, 6) of the state.
        others: (k,) True for the hits of its outline that this does not explain.
    """

    state: FloatArray
    covariance: FloatArray
    others: BoolArray


@compiled
def explains_most(others: BoolArray) -> bool:
    """True if a motion explains at least half of the hits, for which `others` (k,) is False."""
    most: bool = len(others) - others.sum() >= max(len(others) / 2, 2.0)
    return most


@compiled
def unexplained(
    state: FloatArray, outline: Outline, earlier: Outline, beliefs: Beliefs
) -> BoolArray:
    """(k,) True for hits that a mover of this state (6,) and earlier outline does not explain."""
    x, y = gone_since(state, outline.stamp - earlier.stamp)
    return elsewhere(outline, earlier, x, y, beliefs, 0.0)


@compiled
def unexplained_by_both(
    state: FloatArray, outline: Outline, last: Outline, first: Outline, beliefs: Beliefs
) -> BoolArray:
    """(k,) the same for the last outline and an earlier one: a slow difference shows only over the
    longer time."""
    others = unexplained(state, outline, last, beliefs)
    slow = unexplained(state, outline, first, beliefs)
    return others if slow.all() else others | slow


@compiled
def elsewhere(
    outline: Outline, earlier: Outline, x: float, y: float, beliefs: Beliefs, unsure: float
) -> BoolArray:
    """(k,) True for hits that do not lie on an earlier outline carried onward by (x, y), m, give or
    take what is `unsure` of that."""
    tolerance = STRAY + STRAY_NOISE * beliefs.noise + unsure
    return strays(outline, earlier, x, y, STRAY_REACH, tolerance)


@compiled
def changed_at_once(
    state: FloatArray, expected: FloatArray, covariance: FloatArray, elapsed: float
) -> bool:
    """True if a velocity differs from the one expected by more than any bend explains.

    Args:
        state: (6,) in the light of a look.
        expected: (6,) before it ...
        covariance: (6, 6) ... and how far it was known.
        elapsed: s since the look before.
    """
    x, y = state[0] - expected[0], state[1] - expected[1]
    large = hypot(x, y) > LARGEST_ACCELERATION * elapsed
    return large and squared_sigmas(x, y, covariance) > UNLIKE


def turned_at_once(
    outline: Outline,
    last: Outline,
    velocity: FloatArray,
    sigma: float,
    space: FreeSpace,
    beliefs: Beliefs,
) -> Turned | None:
    """A mover that was elsewhere expected, if it has turned at once since the look before; None if
    that does not explain its outline either, if it was not seen then, or if it had to go faster.

    Args:
        outline: now.
        last: its last one.
        velocity: (2,) that it had, m/s.
        sigma: uncertainty of that, m/s.
        space: the look of now, and the free space of it and of earlier ones.
        beliefs: how far measured speeds can be trusted.
    """
    if not space.past or last.stamp < space.past[-1].stamp:
        return None
    unknown = nothing_known(outline.stamp - last.stamp)
    place = (space.now.x, space.now.y)
    state, covariance = taken_in(*unknown, outline, (last, last), 1, place, beliefs)
    others = unexplained(state, outline, last, beliefs)
    if not explains_most(others):
        return None
    state, covariance = space.narrow(state, covariance, outline, [last], last.stamp)
    no_faster = _no_faster(state, covariance, hypot(*velocity.tolist()), sigma)
    if no_faster is None:
        return None
    state, covariance = no_faster
    change = BEFORE * (state[:2] - velocity)
    doubt = np.diag([0.0, 0.0, STRAIGHT_ON**2, STRAIGHT_ON**2, 0.0, 0.0])
    doubt[:2, :2] = covariance[:2, :2] + np.outer(change, change)
    return Turned(np.array([state[0], state[1], 0.0, 0.0, 0.0, 0.0]), doubt, others)


def _no_faster(
    state: FloatArray, covariance: FloatArray, speed: float, sigma: float
) -> tuple[FloatArray, FloatArray] | None:
    """State (6,) and covariance (6, 6) without the motions that are faster than a mover's `speed`
    before, known to `sigma`, m/s; None where next to nothing is left."""
    doubt = hypot(sigma, SAME_SPEED)
    frame = frame_of(covariance)
    places, tried, likely = motions(frame)
    faster = np.maximum(np.hypot(*(state[:2] + tried[:, :2]).T) - speed, 0.0) / doubt
    left = likely * np.exp(-(faster**2) / 2)
    if left.sum() < POSSIBLE * likely.sum():
        return None
    if frame.steps == 1:
        return state, covariance
    return without(state, covariance, frame, places, left, likely)
