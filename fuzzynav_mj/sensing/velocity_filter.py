"""The filter behind a mover's track: velocity and acceleration from outlines in turn.

Each look's outline is held against the mover's own earlier ones. How far a straight face has gone
along its normal is as exact as the ranges are, so the way since the last look is a part of the
state: what is measured of it tells at once how the velocity changes. The acceleration is believed
to fade within about a second, so a mover that turns is followed round its bend, and one that goes
straight is not led astray. Of the motion along a single face nothing is seen, but movers change
their direction more than their speed: what is seen across the face tells the rest.
"""

from math import exp, hypot, sqrt
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.outline import Outline, end_before
from fuzzynav_mj.sensing.registration import hold_against
from fuzzynav_mj.types import FloatArray

FIRST_SPEED_SIGMA = 0.3  # m/s: what is believed of a mover before its motion is measured
ACCELERATION_SIGMA = 0.6  # m/s2: how strongly movers are believed to change their velocity, ...
TURNING_SIGMA = 1.2  # rad/s: ... slow ones no more than by turning as fast as this
LARGEST_ACCELERATION = 1.2  # m/s2
ACCELERATION_TIME = 1.0  # s: how long an acceleration is believed to last
SPEEDING_SIGMA = 0.3  # m/s2: how strongly movers are believed to change their speed ...
SLOWEST = 0.05  # m/s: ... where they are fast enough to have a direction
EXACT = 1e-5  # m: no way is known better
PASSES = 3  # rounds of fitting: each carries the earlier outlines on by the motion of the last
REACH = 0.02  # m between an outline and an earlier one carried onward, besides ...
LARGEST_REACH = 0.1  # ... what is uncertain of the motion, and at most
END_OUTLIER = 2.0  # standard deviations at which an end of an outline counts half

STATE = 6  # velocity, acceleration, and the way since the mover was last seen; x and y of each
Row = tuple[float, float, float, float, float, float]  # what a measurement takes of each of them


class _Fit(NamedTuple):
    """A round of fitting.

    Attributes:
        information, evidence: (6, 6) and (6,) of the normal equations, added to in place.
        guess: (6,) state that the measurements should not contradict.
        doubt: (6, 6) its covariance.
    """

    information: FloatArray
    evidence: FloatArray
    guess: FloatArray
    doubt: FloatArray


class Beliefs(NamedTuple):
    """How far measured speeds can be trusted.

    Attributes:
        flow_sigma: uncertainty of one hit's surface motion, m.
        noise: standard deviation of the ranges, m.
        independent_hits: hits on one obstacle beyond this number tell nothing new.
        outlier: deviation from the obstacle's motion at which a hit counts half, m/s.
        outline_sigma: uncertainty of the place of a visible outline's end, m.
    """

    flow_sigma: float
    noise: float
    independent_hits: float
    outlier: float
    outline_sigma: float


def nothing_known(elapsed: float = 0.0) -> tuple[FloatArray, FloatArray]:
    """State (6,) and covariance (6, 6) of a mover whose motion was not measured yet, and which was
    seen so many seconds ago."""
    sigmas = np.array([FIRST_SPEED_SIGMA] * 2 + [ACCELERATION_SIGMA] * 2 + [0.0] * 2)
    return carried_on(np.zeros(STATE), np.diag(sigmas**2), elapsed)


@compiled
def squared_sigmas(x: float, y: float, covariance: FloatArray) -> float:
    """Squared standard deviations between two velocities that differ by (x, y), m/s.

    Args:
        x, y: the difference.
        covariance: (6, 6) of a state, whose velocity is one of them.
    """
    xx, xy, yy = covariance[0, 0], covariance[0, 1], covariance[1, 1]
    squared: float = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / (xx * yy - xy * xy)
    return squared


@compiled
def gone_since(state: FloatArray, elapsed: float) -> tuple[float, float]:
    """How far a mover of this state (6,) has gone in the last `elapsed` seconds, m."""
    fading = elapsed**2 / 2
    return elapsed * state[0] - fading * state[2], elapsed * state[1] - fading * state[3]


@compiled
def _jerk(elapsed: float, speed: float) -> float:
    """Power of the white noise, m2/s5, by which the fading accelerations of a mover of this speed
    stay as large as they are believed to be."""
    fade = exp(-elapsed / ACCELERATION_TIME)
    sigma = min(ACCELERATION_SIGMA, TURNING_SIGMA * speed)
    return sigma**2 * (1.0 - fade * fade) / max(elapsed, 1e-9)


@compiled
def carried_on(
    state: FloatArray, covariance: FloatArray, elapsed: float
) -> tuple[FloatArray, FloatArray]:
    """State (6,) and covariance (6, 6) some seconds later: the acceleration fades, and changes by
    white noise of its rate meanwhile."""
    model, noise = np.eye(STATE), np.zeros((STATE, STATE))
    fade, t = exp(-elapsed / ACCELERATION_TIME), elapsed
    # What may be fast, as far as is known, may change as much as what is.
    squared = state[0] ** 2 + state[1] ** 2 + covariance[0, 0] + covariance[1, 1]
    rate = _jerk(elapsed, sqrt(squared))
    for v in range(2):
        a, d = v + 2, v + 4
        model[v, a], model[a, a], model[d, v], model[d, a] = t, fade, t, t**2 / 2
        noise[v, v], noise[a, a] = t**3 / 3 * rate, t * rate
        noise[d, d] = t**5 / 20 * rate + EXACT**2
        noise[v, a] = noise[a, v] = t**2 / 2 * rate
        noise[v, d] = noise[d, v] = t**4 / 8 * rate
        noise[a, d] = noise[d, a] = t**3 / 6 * rate
    return model @ state, model @ covariance @ model.T + noise


@compiled
def taken_in(
    state: FloatArray,
    covariance: FloatArray,
    outline: Outline,
    earlier: tuple[Outline, Outline],
    count: int,
    place: tuple[float, float],
    beliefs: Beliefs,
) -> tuple[FloatArray, FloatArray]:
    """State (6,) and covariance (6, 6) after a look from a place; see `Track.take_in` in
    tracking.py.

    The first `count` of the earlier outlines count, of which the last one is that of the look that
    showed the mover last, and of whose ends the first one's.
    """
    prior = _inverse(covariance)
    guess, doubt, posterior = state, covariance, covariance
    for _ in range(PASSES):
        fit = _Fit(prior.copy(), _times(prior, state), guess, doubt)
        for k in range(count):
            _add_surface(fit, outline, earlier[k], k == count - 1, beliefs)
        _add_ends(fit, outline, earlier[0], place, beliefs)
        _add_steadiness(fit)
        posterior = _inverse(fit.information)
        guess, doubt = _times(posterior, fit.evidence), np.zeros((STATE, STATE))
    return guess, posterior


@compiled
def _add_surface(
    fit: _Fit, outline: Outline, before: Outline, last: bool, beliefs: Beliefs
) -> None:
    """Adds the motion of an outline since an earlier one.

    Hits that contradict what is believed count less: they may lie on another face, or another
    obstacle.

    Args:
        fit: to add to.
        outline, before: now and earlier.
        last: True if no look in between showed the mover.
        beliefs: see `Track.take_in` in tracking.py.
    """
    elapsed = outline.stamp - before.stamp
    if elapsed <= 0.0:
        return
    x, y = gone_since(fit.guess, elapsed)
    if last:
        x, y = fit.guess[4], fit.guess[5]
    unsure = elapsed * sqrt(max(fit.doubt[0, 0], fit.doubt[1, 1]))
    shift = hold_against(outline, before, x, y, min(REACH + 2.0 * unsure, LARGEST_REACH))
    # Smoothing spreads one hit's noise over its neighbours, so all that the hits tell together
    # is limited by the raw noise over their number.
    crowd = max(1.0, shift.known.sum() / beliefs.independent_hits)
    variance = beliefs.flow_sigma**2 * crowd + 2.0 * beliefs.noise**2
    if not last:
        # All hits are led astray alike by what the acceleration changed in between.
        speed = hypot(fit.guess[0], fit.guess[1])
        variance += shift.known.sum() * _jerk(elapsed, speed) * elapsed**5 / 20.0
    spread = (beliefs.outlier * elapsed) ** 2
    for i in range(len(shift.known)):
        if shift.known[i]:
            nx, ny = shift.normals[0, i], shift.normals[1, i]
            row = (0.0, 0.0, 0.0, 0.0, nx, ny) if last else _row(nx, ny, elapsed)
            off = shift.distance[i]
            doubted = variance + shift.blur[i] ** 2
            _add(fit, row, off, _trust(fit, row, off, spread) / doubted)


@compiled
def _add_ends(
    fit: _Fit, outline: Outline, before: Outline, place: tuple[float, float], beliefs: Beliefs
) -> None:
    """Adds the motion of an outline's ends across the lines of sight to them from a place, world
    frame; the other arguments are those of `_add_surface`."""
    elapsed = outline.stamp - before.stamp
    if elapsed <= 0.0:
        return
    x, y = gone_since(fit.guess, elapsed)
    variance = beliefs.outline_sigma**2
    for k in range(outline.points.shape[1]):
        for end in range(2):
            if not outline.bounds[end, k]:
                continue
            j = end_before(outline, before, end, k, x, y)
            if j < 0:
                continue
            # What is nearer or farther along the line of sight may be another part of the mover.
            sight_x, sight_y = outline.points[0, k] - place[0], outline.points[1, k] - place[1]
            length = max(hypot(sight_x, sight_y), 1e-9)
            across_x, across_y = -sight_y / length, sight_x / length
            moved_x = outline.points[0, k] - before.points[0, j]
            moved_y = outline.points[1, k] - before.points[1, j]
            moved = across_x * moved_x + across_y * moved_y
            row = _row(across_x, across_y, elapsed)
            trust = _trust(fit, row, moved, END_OUTLIER**2 * variance)
            _add(fit, row, moved, trust / variance)


@compiled
def _add_steadiness(fit: _Fit) -> None:
    """Adds that a mover hardly changes its speed: its acceleration is across its velocity, give or
    take, so each tells of the other's direction."""
    vx, vy, ax, ay = fit.guess[0], fit.guess[1], fit.guess[2], fit.guess[3]
    speed = hypot(vx, vy)
    if speed > SLOWEST:
        x, y = vx / speed, vy / speed
        turning = (x * ay - y * ax) / speed
        row = (-turning * y, turning * x, x, y, 0.0, 0.0)
        _add(fit, row, 0.0, 1.0 / SPEEDING_SIGMA**2)


@compiled
def _trust(fit: _Fit, row: Row, value: float, spread: float) -> float:
    """Share that a measurement counts: half where it lies off the guess by the root of `spread`
    and what the guess is doubted by."""
    off = value
    for a in range(STATE):
        off -= row[a] * fit.guess[a]
        for b in range(STATE):
            spread += row[a] * fit.doubt[a, b] * row[b]
    return 1.0 / (1.0 + off * off / spread)


@compiled
def _row(x: float, y: float, elapsed: float) -> Row:
    """Measures the way along (x, y) over the last `elapsed` seconds, as in `gone_since`."""
    fading = elapsed**2 / 2
    return elapsed * x, elapsed * y, -fading * x, -fading * y, 0.0, 0.0


@compiled
def _add(fit: _Fit, row: Row, value: float, weight: float) -> None:
    """Adds one measurement to the normal equations."""
    for a in range(STATE):
        fit.evidence[a] += weight * row[a] * value
        for b in range(STATE):
            fit.information[a, b] += weight * row[a] * row[b]


@compiled
def _times(matrix: FloatArray, vector: FloatArray) -> FloatArray:
    product = np.zeros(len(vector))
    for i in range(len(vector)):
        for j in range(len(vector)):
            product[i] += matrix[i, j] * vector[j]
    return product


@compiled
def _inverse(matrix: FloatArray) -> FloatArray:
    """Of a symmetric positive definite matrix, whose pivots need no search."""
    inverse, size = matrix.copy(), len(matrix)
    for k in range(size):
        pivot = inverse[k, k]
        inverse[k, k] = 1.0
        for j in range(size):
            inverse[k, j] /= pivot
        for i in range(size):
            if i != k:
                factor = inverse[i, k]
                inverse[i, k] = 0.0
                for j in range(size):
                    inverse[i, j] -= factor * inverse[k, j]
    return inverse
