"""Velocities of moving obstacles: a filter over the looks.

The state is velocity and acceleration. The acceleration is believed to fade within about a second,
so a mover that turns is followed round its bend, and one that goes straight is not led astray.
"""

from collections import deque
from dataclasses import dataclass, field
from math import exp, hypot

import numpy as np

from fuzzynav_mj.types import FloatArray

FIRST_SPEED_SIGMA = 0.3  # m/s: what is believed of a mover before its motion is measured
ACCELERATION_SIGMA = 0.6  # m/s2: how strongly movers are believed to change their velocity
ACCELERATION_TIME = 1.0  # s: how long an acceleration is believed to last
SPEED_NOISE = 0.03  # m/s per look: changes that the acceleration does not explain
LARGEST_ACCELERATION = 1.2  # m/s2
MATCH_DISTANCE = 0.20  # m between where a track expects its obstacle and where one is seen
FORGET_AFTER = 3  # looks without a match


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
    def information(self) -> FloatArray:
        """(4, 4) inverse of the covariance."""
        return np.asarray(np.linalg.inv(self.covariance), dtype=np.float64)

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

    def sigma_along(self, direction: FloatArray) -> float:
        """Uncertainty of the speed along a unit vector (2,), m/s."""
        return float(np.sqrt(direction @ self.covariance[:2, :2] @ direction))

    def moves_for_certain(self, sigmas: float) -> bool:
        """True if the velocity lies so many standard deviations from none at all."""
        vx, vy = self.state[:2].tolist()
        (xx, xy), (_, yy) = self.covariance[:2, :2].tolist()
        squared = (yy * vx * vx - 2.0 * xy * vx * vy + xx * vy * vy) / (xx * yy - xy * xy)
        return bool(squared >= sigmas**2)

    def predict(self, elapsed: float) -> None:
        """Carries the belief on to the next look."""
        self.centre = self.centre + self.velocity * elapsed
        fade = exp(-elapsed / ACCELERATION_TIME)
        transition = np.array(
            [[1.0, 0.0, elapsed, 0.0], [0.0, 1.0, 0.0, elapsed], [0, 0, fade, 0], [0, 0, 0, fade]]
        )
        self.state = transition @ self.state
        noise = ACCELERATION_SIGMA**2 * (1.0 - fade * fade)
        covariance = transition @ self.covariance @ transition.T
        covariance.ravel()[::5] += (SPEED_NOISE**2, SPEED_NOISE**2, noise, noise)  # the diagonal
        self.covariance = covariance
        self.missed += 1

    def update(
        self, centre: FloatArray, prior: FloatArray, rows: FloatArray, rates: FloatArray
    ) -> None:
        """Takes in measured speeds; in directions that none constrains the belief stays.

        Args:
            centre: (2,) mean of the hits.
            prior: (4, 4) `information` before.
            rows: (m, 4) measurement rows over their sigma.
            rates: (m,) measured speeds over the same sigma, m/s.
        """
        self.covariance = np.asarray(np.linalg.inv(prior + rows.T @ rows), dtype=np.float64)
        self.state = self.covariance @ (prior @ self.state + rows.T @ rates)
        self.centre = centre
        self.missed = 0


def speed_rows(directions: FloatArray, elapsed: FloatArray) -> FloatArray:
    """(m, 4) rows that measure the mean speed along `directions` (m, 2) over the last `elapsed`
    seconds: the velocity now, less what the acceleration added in half that time."""
    return np.concatenate((directions, directions * (-elapsed / 2)[:, None]), axis=1)


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
