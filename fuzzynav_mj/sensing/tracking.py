"""Velocities of moving obstacles: a filter over the looks.

The state is velocity and acceleration. The acceleration is believed to fade within about a second,
so a mover that turns is followed round its bend, and one that goes straight is not led astray.
"""

from collections import deque
from dataclasses import dataclass, field
from math import exp, hypot, sqrt
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.flow import PointFlow
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.outline import end_rates
from fuzzynav_mj.types import FloatArray

FIRST_SPEED_SIGMA = 0.3  # m/s: what is believed of a mover before its motion is measured
ACCELERATION_SIGMA = 0.6  # m/s2: how strongly movers are believed to change their velocity
ACCELERATION_TIME = 1.0  # s: how long an acceleration is believed to last
SPEED_NOISE = 0.03  # m/s per look: changes that the acceleration does not explain
LARGEST_ACCELERATION = 1.2  # m/s2
MATCH_DISTANCE = 0.20  # m between where a track expects its obstacle and where one is seen
FORGET_AFTER = 3  # looks without a match
UNSEEN = np.full((2, 2), np.nan)  # ends of an outline


Row = tuple[float, float, float, float]  # of a measurement: what it takes of each of the state


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


@dataclass(slots=True, eq=False)
class Track:
    """Belief about one moving obstacle. Mutable: the filter's own memory.

    Attributes:
        centre: (2,) mean of its hits when last seen, world frame, carried on with its velocity.
        state: (4,) velocity, m/s, and acceleration, m/s2.
        covariance: (4, 4) of the state.
        missed: looks since it was seen.
        outlines: of the last looks, the stamp and the two ends (2, 2) of the visible outline; nan
            for an end that something nearer may have hidden.
    """

    centre: FloatArray
    state: FloatArray
    covariance: FloatArray
    missed: int = 0
    outlines: deque[tuple[float, FloatArray]] = field(default_factory=lambda: deque(maxlen=3))

    @classmethod
    def begin(cls, centre: FloatArray) -> "Track":
        """A track of a mover whose velocity is not known yet."""
        sigmas = np.array([FIRST_SPEED_SIGMA] * 2 + [ACCELERATION_SIGMA] * 2)
        return cls(centre, np.zeros(4), np.diag(sigmas**2))

    @property
    def velocity(self) -> FloatArray:
        """(2,) m/s."""
        return self.state[:2]

    @property
    def speed(self) -> float:
        """m/s."""
        return hypot(float(self.state[0]), float(self.state[1]))

    @property
    def turn_rate(self) -> float:
        """Rate at which the velocity turns, rad/s."""
        vx, vy, ax, ay = self.state.tolist()
        squared = vx * vx + vy * vy
        if squared < 1e-4:
            return 0.0
        largest = LARGEST_ACCELERATION / squared**0.5
        return float(min(max((vx * ay - vy * ax) / squared, -largest), largest))

    def sigma_along(self, x: float, y: float) -> float:
        """Uncertainty of the speed along the unit vector (x, y), m/s."""
        (xx, xy), (_, yy) = self.covariance[:2, :2].tolist()
        return sqrt(xx * x * x + 2.0 * xy * x * y + yy * y * y)

    def moves_for_certain(self, sigmas: float) -> bool:
        """True if the velocity lies so many standard deviations from none at all."""
        vx, vy = self.state[:2].tolist()
        (xx, xy), (_, yy) = self.covariance[:2, :2].tolist()
        squared = (yy * vx * vx - 2.0 * xy * vx * vy + xx * vy * vy) / (xx * yy - xy * xy)
        return bool(squared >= sigmas**2)

    def predict(self, elapsed: float) -> None:
        """Carries the belief on to the next look."""
        self.centre = self.centre + self.velocity * elapsed
        self.state, self.covariance = _carried_on(self.state, self.covariance, elapsed)
        self.missed += 1

    def take_in(
        self,
        flow: PointFlow,
        span: tuple[int, int],
        centre: FloatArray,
        ends: FloatArray,
        now: Look,
        beliefs: Beliefs,
    ) -> None:
        """Takes in what a look shows; in directions in which it shows none the belief stays.

        Args:
            flow: of the look's hits.
            span: the obstacle's first hit and the one after its last.
            centre: (2,) mean of its hits.
            ends: (2, 2) of its outline, nan where hidden.
            now: the look.
            beliefs: how far all these can be trusted.
        """
        stamp, before = self.outlines[0] if self.outlines else (now.stamp, UNSEEN)
        self.state, self.covariance = _taken_in(
            self.state, self.covariance, flow, *span, ends, before, now, now.stamp - stamp, beliefs
        )
        self.centre = centre
        self.outlines.append((now.stamp, ends))
        self.missed = 0


@compiled
def _carried_on(
    state: FloatArray, covariance: FloatArray, elapsed: float
) -> tuple[FloatArray, FloatArray]:
    """State (4,) and covariance (4, 4) some seconds later."""
    fade = exp(-elapsed / ACCELERATION_TIME)
    noise = ACCELERATION_SIGMA**2 * (1.0 - fade * fade)
    state, covariance = state.copy(), covariance.copy()
    # Each velocity gains what its acceleration brings, and that one fades: in the state, in the
    # columns of the covariance, and in its rows.
    for v, a in ((0, 2), (1, 3)):
        state[v] += elapsed * state[a]
        state[a] *= fade
        for i in range(4):
            covariance[i, v] += elapsed * covariance[i, a]
            covariance[i, a] *= fade
    for v, a in ((0, 2), (1, 3)):
        for j in range(4):
            covariance[v, j] += elapsed * covariance[a, j]
            covariance[a, j] *= fade
        covariance[v, v] += SPEED_NOISE**2
        covariance[a, a] += noise
    return state, covariance


@compiled
def _taken_in(
    state: FloatArray,
    covariance: FloatArray,
    flow: PointFlow,
    first: int,
    end: int,
    ends: FloatArray,
    ends_before: FloatArray,
    now: Look,
    elapsed: float,
    beliefs: Beliefs,
) -> tuple[FloatArray, FloatArray]:
    """State (4,) and covariance (4, 4) after a look; see `Track.take_in`."""
    prior = _inverse(covariance)
    information, evidence = prior.copy(), _times(prior, state)
    _add_surface(information, evidence, state, covariance, flow, first, end, beliefs)
    fit = _times(_inverse(information), evidence)
    information, evidence = prior, _times(prior, state)
    _add_surface(information, evidence, fit, np.zeros((4, 4)), flow, first, end, beliefs)
    across, rates = end_rates(ends, ends_before, elapsed, now)
    for k in range(2):
        if not np.isnan(rates[k]):
            row = _row(across[k, 0], across[k, 1], elapsed)
            _add(information, evidence, row, rates[k], (elapsed / beliefs.outline_sigma) ** 2)
    covariance = _inverse(information)
    return _times(covariance, evidence), covariance


@compiled
def _add_surface(
    information: FloatArray,
    evidence: FloatArray,
    guess: FloatArray,
    doubt: FloatArray,
    flow: PointFlow,
    first: int,
    end: int,
    beliefs: Beliefs,
) -> None:
    """Adds the motion of an obstacle's surface to the normal equations.

    Some hits are compared with another face, or another obstacle, than their own. They count
    less: first those that contradict what is known of the mover, then those that contradict the
    fit to the rest.

    Args:
        information, evidence: (4, 4) and (4,) of the normal equations.
        guess: (4,) state that the hits should not contradict.
        doubt: (4, 4) its covariance.
        flow, first, end, beliefs: see `Track.take_in`.
    """
    count = 0
    for look in range(len(flow.elapsed)):
        for i in range(first, end):
            count += flow.known[look, i]
    # Smoothing spreads one hit's noise over its neighbours, so all that the hits tell together
    # is limited by the raw noise over their number.
    variance = beliefs.flow_sigma**2 * max(1.0, count / beliefs.independent_hits)
    variance += 2.0 * beliefs.noise**2
    for look in range(len(flow.elapsed)):
        elapsed = flow.elapsed[look]
        for i in range(first, end):
            if not flow.known[look, i]:
                continue
            row = _row(flow.normals[look, 0, i], flow.normals[look, 1, i], elapsed)
            off = rate = flow.distance[look, i] / elapsed
            spread = beliefs.outlier**2
            for a in range(4):
                off -= row[a] * guess[a]
                for b in range(4):
                    spread += row[a] * doubt[a, b] * row[b]
            weight = elapsed**2 / variance / (1.0 + off * off / spread)
            _add(information, evidence, row, rate, weight)


@compiled
def _row(x: float, y: float, elapsed: float) -> Row:
    """Measures the mean speed along (x, y) over the last `elapsed` seconds: the velocity now, less
    what the acceleration added in half that time."""
    return x, y, -x * elapsed / 2, -y * elapsed / 2


@compiled
def _add(
    information: FloatArray, evidence: FloatArray, row: Row, value: float, weight: float
) -> None:
    """Adds one measurement to the normal equations."""
    for a in range(4):
        evidence[a] += weight * row[a] * value
        for b in range(4):
            information[a, b] += weight * row[a] * row[b]


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


def nearest_track(tracks: list[Track], centre: FloatArray) -> Track | None:
    """The unmatched track that expects its obstacle nearest to `centre`, if near enough."""
    best, best_distance = None, MATCH_DISTANCE
    for track in tracks:
        if track.missed == 0:
            continue
        distance = hypot(*(track.centre - centre).tolist())
        if distance < best_distance:
            best, best_distance = track, distance
    return best
