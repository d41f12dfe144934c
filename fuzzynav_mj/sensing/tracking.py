"""Velocities of moving obstacles: a constant-velocity filter over the looks."""

from collections import deque
from dataclasses import dataclass, field
from math import hypot

import numpy as np

from fuzzynav_mj.types import FloatArray

FIRST_SPEED_SIGMA = 0.3  # m/s: what is believed of a mover before its motion is measured
ACCELERATION_SIGMA = 1.0  # m/s2: how fast movers are believed to change their velocity
MATCH_DISTANCE = 0.20  # m between where a track expects its obstacle and where one is seen
FORGET_AFTER = 3  # looks without a match


@dataclass(slots=True, eq=False)
class Track:
    """Belief about one moving obstacle. Mutable: the filter's own memory.

    Attributes:
        centre: (2,) mean of its hits when last seen, world frame, carried on with its velocity.
        velocity: (2,) m/s.
        covariance: (2, 2) of the velocity.
        missed: looks since it was seen.
        outlines: (stamp, middle of the visible outline's two ends) of the last looks that showed
            both ends.
    """

    centre: FloatArray
    velocity: FloatArray
    covariance: FloatArray
    missed: int = 0
    outlines: deque[tuple[float, FloatArray]] = field(default_factory=lambda: deque(maxlen=3))

    @classmethod
    def begin(cls, centre: FloatArray) -> "Track":
        """A track of a mover whose velocity is not known yet."""
        return cls(centre, np.zeros(2), np.eye(2) * FIRST_SPEED_SIGMA**2)

    def predict(self, elapsed: float) -> None:
        """Carries the belief on to the next look."""
        self.centre = self.centre + self.velocity * elapsed
        self.covariance = self.covariance + np.eye(2) * (ACCELERATION_SIGMA * elapsed) ** 2
        self.missed += 1

    def update(self, centre: FloatArray, information: FloatArray, evidence: FloatArray) -> None:
        """Takes in the normal speeds of the obstacle's surface.

        Along directions that the surface does not constrain the belief stays as it was.

        Args:
            centre: (2,) mean of the hits.
            information: (2, 2) sum of n n^T / sigma^2 over the measured hits.
            evidence: (2,) sum of n (n . v) / sigma^2.
        """
        prior = np.linalg.inv(self.covariance)
        self.covariance = np.linalg.inv(prior + information)
        self.velocity = self.covariance @ (prior @ self.velocity + evidence)
        self.centre = centre
        self.missed = 0

    @property
    def speed(self) -> float:
        """m/s."""
        return hypot(float(self.velocity[0]), float(self.velocity[1]))


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
