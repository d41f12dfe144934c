"""The motions that a mover may have: a grid over what is uncertain of its own."""

from math import atan2, cos, exp, sin, sqrt
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import FloatArray

KNOWN = 0.04  # m/s: a smaller uncertainty of a velocity is left as it is
SPAN = 2.5  # standard deviations within which motions are tried ...
TRIED = 21  # ... so many velocities along each of two axes ...
TRIED_BENDING, BENDS = 13, 5  # ... or along one, and accelerations with each


class Frame(NamedTuple):
    """The motions to try: a grid over two independent things that are uncertain of a state, each
    with a standard deviation of one.

    The first is the velocity along the axis of its largest uncertainty. The second is the velocity
    across it, or where that is known the acceleration along it, as far as it does not depend on the
    velocity: of a flat side both are unknown.

    Attributes:
        loads: (6, 2) by how much each of the state changes with them.
        steps: how many of the first are tried ...
        side_steps: ... and of the second; one each where little is uncertain.
    """

    loads: FloatArray
    steps: int
    side_steps: int


@compiled
def frame_of(covariance: FloatArray) -> Frame:
    """The frame of a state's covariance (6, 6)."""
    xx, xy, yy = covariance[0, 0], covariance[0, 1], covariance[1, 1]
    angle = atan2(2.0 * xy, xx - yy) / 2.0
    x, y = cos(angle), sin(angle)
    most = sqrt(max(xx * x * x + 2.0 * xy * x * y + yy * y * y, 0.0))
    least = sqrt(max(xx * y * y - 2.0 * xy * x * y + yy * x * x, 0.0))
    loads = np.zeros((len(covariance), 2))
    if most <= KNOWN:
        return Frame(loads, 1, 1)
    for i in range(len(loads)):
        loads[i, 0] = (covariance[i, 0] * x + covariance[i, 1] * y) / most
    if least > KNOWN:
        for i in range(len(loads)):
            loads[i, 1] = (covariance[i, 1] * x - covariance[i, 0] * y) / least
        return Frame(loads, TRIED, TRIED)
    depends = loads[2, 0] * x + loads[3, 0] * y
    for i in range(len(loads)):
        loads[i, 1] = covariance[i, 2] * x + covariance[i, 3] * y - depends * loads[i, 0]
    own = sqrt(max(loads[2, 1] * x + loads[3, 1] * y, 0.0))
    loads[:, 1] /= max(own, 1e-9)
    return Frame(loads, TRIED_BENDING, BENDS)


@compiled
def anything_open(covariance: FloatArray) -> bool:
    """True if a state of this covariance (6, 6) leaves more than one motion worth a trial."""
    return frame_of(covariance).steps > 1


@compiled
def _place(number: int, steps: int) -> float:
    """Place on an axis, in standard deviations, of one of so many steps."""
    return SPAN * (2.0 * number / (steps - 1) - 1.0) if steps > 1 else 0.0


@compiled
def motions(frame: Frame) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The motions of a frame: (h, 2) places on its axes, (h, 4) velocities, m/s, and accelerations,
    m/s2, more than those believed, and (h,) how likely each is, next to them."""
    most = frame.steps * frame.side_steps
    places, tried, likely = np.empty((most, 2)), np.empty((most, 4)), np.empty(most)
    count = 0
    for k in range(most):
        a = _place(k // frame.side_steps, frame.steps)
        b = _place(k % frame.side_steps, frame.side_steps)
        if a * a + b * b > SPAN**2 + 1e-9:
            continue
        places[count, 0], places[count, 1] = a, b
        for i in range(4):
            tried[count, i] = frame.loads[i, 0] * a + frame.loads[i, 1] * b
        likely[count] = exp(-0.5 * (a * a + b * b))
        count += 1
    return places[:count], tried[:count], likely[:count]


@compiled
def _between(steps: int) -> float:
    """Variance of what lies between two of so many steps: nothing is known there."""
    return (2.0 * SPAN / (steps - 1)) ** 2 / 12.0


@compiled
def without(
    state: FloatArray,
    covariance: FloatArray,
    frame: Frame,
    places: FloatArray,
    open_: FloatArray,
    likely: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """State (6,) and covariance (6, 6) if a frame's motions, at `places` (h, 2), are as likely as
    `open_` (h,) says, not as `likely` (h,): with the mean and the covariance of what is open. The
    frame is one in which something is uncertain."""
    # Sums over all of the grid and over what is left of it: of 1, a, b, aa, ab, bb, where a and b
    # are the places on the axes, each as often as it is likely.
    every, left = np.zeros(6), np.zeros(6)
    for k in range(len(likely)):
        a, b = places[k]
        terms = (1.0, a, b, a * a, a * b, b * b)
        for i in range(6):
            every[i] += likely[k] * terms[i]
            left[i] += open_[k] * terms[i]
    every, left = every / every[0], left / left[0]
    # What the covariance, the identity on the grid before, becomes. The grid's own is smaller, for
    # it ends.
    change = np.zeros((2, 2))
    change[0, 0] = (left[3] - left[1] ** 2) / every[3] + _between(frame.steps) - 1.0
    change[1, 1] = (left[5] - left[2] ** 2) / every[5] + _between(frame.side_steps) - 1.0
    change[0, 1] = (left[4] - left[1] * left[2]) / sqrt(every[3] * every[5])
    change[1, 0] = change[0, 1]
    loads, state, covariance = frame.loads, state.copy(), covariance.copy()
    for i in range(len(state)):
        state[i] += loads[i, 0] * left[1] + loads[i, 1] * left[2]
        for j in range(len(state)):
            for m in range(2):
                for n in range(2):
                    covariance[i, j] += loads[i, m] * change[m, n] * loads[j, n]
    return state, covariance
