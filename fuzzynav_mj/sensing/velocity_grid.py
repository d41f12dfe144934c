"""The velocities that a mover may have: a grid over what is uncertain of its own."""

from math import atan2, cos, exp, sin, sqrt
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import FloatArray

KNOWN = 0.04  # m/s: a smaller uncertainty of a velocity is left as it is
SPAN = 2.5  # standard deviations within which velocities are tried ...
TRIED = 21  # ... so many of them, along each axis


class Frame(NamedTuple):
    """The velocities to try, more or less than the one believed: a grid along the axes of its
    uncertainty.

    Attributes:
        x, y: the axis of the largest uncertainty; the other one is (-y, x).
        most, least: standard deviations along them, m/s.
        steps: how many are tried along the first ...
        side_steps: ... and along the other axis; one where little is uncertain.
    """

    x: float
    y: float
    most: float
    least: float
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
    steps = TRIED if most > KNOWN else 1
    return Frame(x, y, most, least, steps, TRIED if least > KNOWN else 1)


@compiled
def _place(number: int, steps: int) -> float:
    """Place on an axis, in standard deviations, of one of so many steps."""
    return SPAN * (2.0 * number / (steps - 1) - 1.0) if steps > 1 else 0.0


@compiled
def velocities(frame: Frame) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The velocities of a frame: (h, 2) places on its axes, in standard deviations, (h, 2) m/s more
    than the one believed, and (h,) how likely each is, next to it."""
    most = frame.steps * frame.side_steps
    places, tried, likely = np.empty((most, 2)), np.empty((most, 2)), np.empty(most)
    count = 0
    for k in range(most):
        a = _place(k // frame.side_steps, frame.steps)
        b = _place(k % frame.side_steps, frame.side_steps)
        if a * a + b * b > SPAN**2 + 1e-9:
            continue
        along, aside = frame.most * a, frame.least * b
        places[count, 0], places[count, 1] = a, b
        tried[count, 0] = along * frame.x - aside * frame.y
        tried[count, 1] = along * frame.y + aside * frame.x
        likely[count] = exp(-0.5 * (a * a + b * b))
        count += 1
    return places[:count], tried[:count], likely[:count]


@compiled
def without(
    state: FloatArray,
    covariance: FloatArray,
    frame: Frame,
    places: FloatArray,
    open_: FloatArray,
    likely: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """State (6,) and covariance (6, 6) if a frame's velocities, at `places` (h, 2), are as
    likely as `open_` (h,) says, not as `likely` (h,).

    The velocity gets the mean and the covariance of what is open; the acceleration follows as far
    as it depends on the velocity.
    """
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
    # it ends; and between its steps nothing is known.
    between = (2.0 * SPAN / (TRIED - 1)) ** 2 / 12.0
    change = np.zeros((2, 2))
    if frame.steps > 1:
        change[0, 0] = (left[3] - left[1] ** 2) / every[3] + between - 1.0
    if frame.side_steps > 1:
        change[1, 1] = (left[5] - left[2] ** 2) / every[5] + between - 1.0
    if frame.steps > 1 and frame.side_steps > 1:
        change[0, 1] = (left[4] - left[1] * left[2]) / sqrt(every[3] * every[5])
        change[1, 0] = change[0, 1]
    size = len(state)
    gain, x, y = np.zeros((size, 2)), frame.x, frame.y
    for i in range(size):
        gain[i, 0] = (covariance[i, 0] * x + covariance[i, 1] * y) / frame.most
        if frame.side_steps > 1:
            gain[i, 1] = (covariance[i, 1] * x - covariance[i, 0] * y) / frame.least
    state, covariance = state.copy(), covariance.copy()
    for i in range(size):
        state[i] += gain[i, 0] * left[1] + gain[i, 1] * left[2]
        for j in range(size):
            for m in range(2):
                for n in range(2):
                    covariance[i, j] += gain[i, m] * change[m, n] * gain[j, n]
    return state, covariance
