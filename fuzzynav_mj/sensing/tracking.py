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
from fuzzynav_mj.sensing.claims import Expected
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.outline import end_rates, whole_ends
from fuzzynav_mj.sensing.registration import Outline, hold_against, strays
from fuzzynav_mj.sensing.segmentation import Hits
from fuzzynav_mj.types import FloatArray, IntArray

FIRST_SPEED_SIGMA = 0.3  # m/s: what is believed of a mover before its motion is measured
ACCELERATION_SIGMA = 0.6  # m/s2: how strongly movers are believed to change their velocity
ACCELERATION_TIME = 1.0  # s: how long an acceleration is believed to last
SPEED_NOISE = 0.03  # m/s per look: changes that the acceleration does not explain
LARGEST_ACCELERATION = 1.2  # m/s2
MATCH_DISTANCE = 0.20  # m between where a track expects its obstacle and where one is seen
FORGET_AFTER = 3  # looks without a match
END_SPREAD = 4.0
CLAIM = 0.03
STRAY = 0.012
PASSES = 3
MEMORY = 2
REACH = 0.02
LARGEST_REACH = 0.1
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
    moved: FloatArray = field(default_factory=lambda: np.zeros(2))
    reach: float = 0.03
    settled: bool = False
    looks: int = 0
    outlines: deque[Outline] = field(default_factory=lambda: deque(maxlen=MEMORY))

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
        self.moved = self.moved + self.velocity * elapsed + self.state[2:] * (elapsed**2 / 2)
        self.reach = min(self.reach + 2.0 * sqrt(max(self.covariance[0, 0], self.covariance[1, 1])) * elapsed, LARGEST_REACH)
        self.state, self.covariance = _carried_on(self.state, self.covariance, elapsed)
        self.missed += 1

    def strays(self, seen: Outline, beliefs: Beliefs) -> np.ndarray:
        before = self.outlines[-1]
        e = seen.stamp - before.stamp
        x, y = (e * self.state[:2] - e**2 / 2 * self.state[2:]).tolist()
        return strays(seen, before, x, y, 0.08, STRAY + 3.0 * beliefs.noise)

    def stands(self, hits: Hits, chosen: IntArray, now: Look) -> bool:
        """True if hits that show no motion of their own do not end where the mover should."""
        before = self.outlines[0]
        elapsed = now.stamp - before.stamp
        across, rates = end_rates(whole_ends(hits, chosen, now), before.ends, elapsed, now)
        known = ~np.isnan(rates)
        if not known.any():
            return True
        wanted = across[known] @ self.velocity
        if np.abs(wanted).max() * elapsed < 0.015:
            return False
        return bool((np.abs(rates[known]) < 0.5 * np.abs(wanted)).all())

    def take_in(self, seen: Outline, centre: FloatArray, now: Look, beliefs: Beliefs) -> None:
        """Takes in what a look shows; in directions in which it shows none the belief stays.

        Args:
            seen: its outline.
            centre: (2,) mean of its hits.
            now: the look.
            beliefs: how far all these can be trusted.
        """
        if self.outlines:
            earlier = (self.outlines[0], self.outlines[-1])
            self.state, self.covariance = _taken_in(
                self.state, self.covariance, seen, earlier, min(len(self.outlines), 2), now, beliefs
            )
        self.centre = centre
        self.missed = 0
        self.looks += 1
        self.moved = np.zeros(2)
        self.reach = CLAIM


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
    seen: Outline,
    earlier: tuple[Outline, Outline],
    count: int,
    now: Look,
    beliefs: Beliefs,
) -> tuple[FloatArray, FloatArray]:
    """State (4,) and covariance (4, 4) after a look; see `Track.take_in`."""
    prior = _inverse(covariance)
    fit, doubt = state, covariance
    posterior = covariance
    for _ in range(PASSES):
        information, evidence = prior.copy(), _times(prior, state)
        for k in range(count):
            _add_surface(information, evidence, fit, doubt, seen, earlier[k], beliefs)
        for k in range(1):
            before = earlier[k]
            elapsed = seen.stamp - before.stamp
            across, rates = end_rates(seen.ends, before.ends, elapsed, now)
            for end in range(2):
                if not np.isnan(rates[end]):
                    row = _row(across[end, 0], across[end, 1], elapsed)
                    off, spread = rates[end], END_SPREAD * (beliefs.outline_sigma / elapsed) ** 2
                    for a in range(4):
                        off -= row[a] * fit[a]
                        for b in range(4):
                            spread += row[a] * doubt[a, b] * row[b]
                    weight = (elapsed / beliefs.outline_sigma) ** 2 / (1.0 + off * off / spread)
                    _add(information, evidence, row, rates[end], weight)
        posterior = _inverse(information)
        fit = _times(posterior, evidence)
        doubt = np.zeros((4, 4))
    return fit, posterior


@compiled
def _add_surface(
    information: FloatArray,
    evidence: FloatArray,
    guess: FloatArray,
    doubt: FloatArray,
    seen: Outline,
    before: Outline,
    beliefs: Beliefs,
) -> None:
    elapsed = seen.stamp - before.stamp
    x = elapsed * guess[0] - elapsed**2 / 2 * guess[2]
    y = elapsed * guess[1] - elapsed**2 / 2 * guess[3]
    unsure = elapsed * sqrt(max(doubt[0, 0], doubt[1, 1]))
    shift = hold_against(seen, before, x, y, min(REACH + 2.0 * unsure, LARGEST_REACH))
    count = 0
    for i in range(len(shift.known)):
        count += shift.known[i]
    variance = beliefs.flow_sigma**2 * max(1.0, count / beliefs.independent_hits)
    variance += 2.0 * beliefs.noise**2
    for i in range(len(shift.known)):
        if not shift.known[i]:
            continue
        row = _row(shift.normals[0, i], shift.normals[1, i], elapsed)
        off = rate = shift.distance[i] / elapsed
        spread = beliefs.outlier**2
        for a in range(4):
            off -= row[a] * guess[a]
            for b in range(4):
                spread += row[a] * doubt[a, b] * row[b]
        weight = elapsed**2 / (variance + shift.blur[i] ** 2) / (1.0 + off * off / spread)
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


def expected_outlines(tracks: list[Track]) -> Expected:
    """Where the tracks' outlines should be now."""
    if not tracks:
        return Expected(np.empty((2, 0)), np.empty(0, dtype=bool), np.empty((2, 0)), np.empty(0, dtype=np.intp), np.empty((0, 2)), np.empty(0), np.empty((0, 2)))
    last = [track.outlines[-1] for track in tracks]
    counts = [outline.points.shape[1] for outline in last]
    return Expected(
        np.concatenate([o.points + t.moved[:, None] for o, t in zip(last, tracks)], axis=1),
        np.concatenate([o.joined for o in last]),
        np.concatenate([o.normals for o in last], axis=1),
        np.repeat(np.arange(len(tracks)), counts),
        np.array([t.velocity for t in tracks]),
        np.array([t.reach for t in tracks]),
        np.array([t.centre for t in tracks]),
    )
