"""Tracks of moving obstacles over the looks.

A track remembers a mover's last outlines, and the fullest of them, and carries them onward with its
velocity; the filter in velocity_filter.py learns that velocity.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import atan2, cos, hypot, inf, sin, sqrt

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.corners import (
    changed_at_once,
    elsewhere,
    explains_most,
    turned_at_once,
    unexplained_by_both,
)
from fuzzynav_mj.sensing.free_space import FreeSpace
from fuzzynav_mj.sensing.outline import Outline, left_over
from fuzzynav_mj.sensing.velocity_filter import (
    LARGEST_ACCELERATION,
    LARGEST_REACH,
    Beliefs,
    carried_on,
    nothing_known,
    squared_sigmas,
    taken_in,
)
from fuzzynav_mj.types import BoolArray, FloatArray

FORGET_AFTER = 8  # looks without a hit
REMEMBERED = 2  # looks whose outlines are kept
CLAIM = 0.03  # m between a hit and a mover's outline that claims it, besides what is uncertain
WHOLE = 0.6  # of the most hits that an outline must have to count as a full one
HALF_BELIEVED = 1.5  # rad/s: of a turn known to no better than this, half is believed
OUTLINE_TIME = 1.0  # s after which an outline, however full, is too old

NOTHING = Outline(
    -inf,
    np.empty((2, 0)),
    np.empty(0, dtype=bool),
    np.empty((2, 0)),
    np.empty((2, 0), dtype=bool),
)


@dataclass(slots=True, eq=False)
class Track:
    """Belief about one moving obstacle. Mutable: the filter's own memory.

    Attributes:
        centre: (2,) mean of its hits when last seen, world frame, carried on with its velocity.
        state: (6,) velocity, m/s, acceleration, m/s2, and way since it was last seen, m.
        covariance: (6, 6) of the state.
        outlines: of the last looks.
        fullest: the outline of a look, not long ago, that showed most of it.
        most: the largest number of its hits, not long ago.
        shift: (2,) how far it went from then until it was last seen, m.
        straight_since: stamp of the look before which it last turned at once, s.
        reach: how far off its outline hits may lie, m.
        seen: number of looks that showed it, and ...
        missed: ... since then did not.
    """

    centre: FloatArray
    state: FloatArray
    covariance: FloatArray
    outlines: deque[Outline]
    fullest: Outline = NOTHING
    most: int = 0
    shift: FloatArray = field(default_factory=lambda: np.zeros(2))
    straight_since: float = -inf
    reach: float = CLAIM
    seen: int = 0
    missed: int = 0

    @classmethod
    def begin(
        cls, centre: FloatArray, before: Sequence[Outline] = (), elapsed: float = 0.0
    ) -> "Track":
        """A track of a mover whose velocity is not known yet.

        Args:
            centre: (2,) mean of its hits, world frame, m.
            before: what earlier looks, the newest last, showed about its place.
            elapsed: s since the newest of them.
        """
        return cls(centre, *nothing_known(elapsed), deque(before, maxlen=REMEMBERED))

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
        """Rate at which the velocity turns, rad/s. What is little known of it counts less."""
        vx, vy, ax, ay = self.state[:4].tolist()
        squared = vx * vx + vy * vy
        if squared < 1e-4:
            return 0.0
        (xx, xy), (_, yy) = self.covariance[2:4, 2:4].tolist()
        variance = (vx * vx * yy - 2.0 * vx * vy * xy + vy * vy * xx) / squared**2
        believed = 1.0 / (1.0 + (variance / HALF_BELIEVED**2) ** 2)
        largest = LARGEST_ACCELERATION / squared**0.5
        return float(believed * min(max((vx * ay - vy * ax) / squared, -largest), largest))

    @property
    def speed_sigma(self) -> float:
        """Uncertainty of the velocity, the larger one of its parts along the axes, m/s."""
        return sqrt(max(self.covariance[0, 0], self.covariance[1, 1]))

    def sigma_along(self, x: float, y: float) -> float:
        """Uncertainty of the speed along the unit vector (x, y), m/s."""
        (xx, xy), (_, yy) = self.covariance[:2, :2].tolist()
        return sqrt(xx * x * x + 2.0 * xy * x * y + yy * y * y)

    @property
    def least_known(self) -> FloatArray:
        """(2,) the direction in which least is known of the velocity, as long as its uncertainty
        there, m/s."""
        (xx, xy), (_, yy) = self.covariance[:2, :2].tolist()
        angle = atan2(2.0 * xy, xx - yy) / 2.0
        x, y = cos(angle), sin(angle)
        return self.sigma_along(x, y) * np.array([x, y])

    def moves_for_certain(self, sigmas: float) -> bool:
        """True if the velocity lies so many standard deviations from none at all."""
        vx, vy = self.state[:2].tolist()
        return squared_sigmas(vx, vy, self.covariance) >= sigmas**2

    @property
    def partly_hidden(self) -> bool:
        """True if the last look showed less of it than an earlier one."""
        return self.missed > 0 or self.fullest is not self.outlines[-1]

    @property
    def expected_outline(self) -> FloatArray:
        """(2, k) the fullest outline where it should be now, world frame, m."""
        return self.fullest.points + self._since_fullest[:, None]

    @property
    def _since_fullest(self) -> FloatArray:
        """(2,) how far it has gone since the fullest outline was seen, m."""
        return self.shift + self.state[4:]

    def predict(self, elapsed: float) -> None:
        """Carries the belief on to the next look."""
        bend = LARGEST_ACCELERATION / 2 * elapsed**2
        self.reach = min(self.reach + 2.0 * self.speed_sigma * elapsed + bend, LARGEST_REACH)
        self.centre, self.state, self.covariance = _onward(
            self.centre, self.state, self.covariance, elapsed
        )
        self.missed += 1

    def take_in(self, outline: Outline, space: FreeSpace, beliefs: Beliefs) -> BoolArray:
        """Learns from what a look shows; in directions in which it shows none the belief stays.

        Args:
            outline: of the mover, k hits.
            space: the look that they belong to, and the free space of it and of earlier ones.
            beliefs: how far it can be trusted.

        Returns:
            (k,) True for the hits that the motion learnt does not explain: another's. If it
            explains hardly any, nothing is learnt.
        """
        nobody = np.zeros(len(outline.joined), dtype=bool)
        if not self.outlines:
            self._note(outline)
            return nobody
        state, covariance = self._learnt(outline, space, beliefs)
        if self.seen == 0:
            self._go_on(outline, state, covariance)
            return nobody
        others = unexplained_by_both(state, outline, self.outlines[-1], self.outlines[0], beliefs)
        explained = explains_most(others)
        if not explained:
            strange = self._unlike_fullest(outline, beliefs)
            if explains_most(strange):
                # It comes out from behind something with another side: seen, but not learnt from.
                self._go_on(left_over(outline, strange), self.state, self.covariance)
                return strange
        if not explained or self._contradicted(state, outline, space):
            turned = self.turn(outline, space, beliefs)
            if turned is not None:
                return turned
        if not explained:
            return np.ones(len(others), dtype=bool)
        own = left_over(outline, others)
        strange, anew = space.strangers(state, own, self._shown)
        if strange.any():
            others[np.flatnonzero(~others)[strange]] = True
            if others.sum() > len(others) - 2:
                return np.ones(len(others), dtype=bool)
            own = left_over(outline, others)
            if anew:
                self.state, self.covariance = nothing_known(outline.stamp - self.outlines[-1].stamp)
                self._forget_outlines()
            state, covariance = self._learnt(own, space, beliefs)
        self._go_on(own, state, covariance)
        return others

    def turn(self, outline: Outline, space: FreeSpace, beliefs: Beliefs) -> BoolArray | None:
        """Takes in an outline if the mover has turned at once, to have it now: what `take_in`
        returns, whose arguments these are; None if it has not."""
        turned = turned_at_once(
            outline, self.outlines[-1], self.velocity, self.speed_sigma, space, beliefs
        )
        if turned is None:
            return None
        self._forget_outlines()
        self.outlines.clear()
        self.straight_since = outline.stamp
        self.state, self.covariance = turned.state, turned.covariance
        self._note(left_over(outline, turned.others))
        return turned.others

    def _go_on(self, outline: Outline, state: FloatArray, covariance: FloatArray) -> None:
        """Takes in an outline and what was learnt from it."""
        self.shift = self.shift + state[4:]
        self.state, self.covariance = state, covariance
        self._note(outline)

    def _note(self, outline: Outline) -> None:
        """Remembers the outline of a look."""
        self.centre = outline.points.sum(axis=1) / len(outline.joined)
        self.outlines.append(outline)
        old = outline.stamp - self.fullest.stamp > OUTLINE_TIME
        if old or len(outline.joined) >= WHOLE * self.most:
            self.most = len(outline.joined) if old else max(len(outline.joined), self.most)
            self.fullest = outline
            self.shift = np.zeros(2)
        self.state[4:] = self.covariance[4:] = self.covariance[:, 4:] = 0.0
        self.seen, self.missed, self.reach = self.seen + 1, 0, CLAIM

    @property
    def _shown(self) -> list[Outline]:
        """Those of the outlines that the mover itself has shown."""
        return list(self.outlines)[max(len(self.outlines) - self.seen, 0) :]

    def _learnt(
        self, outline: Outline, space: FreeSpace, beliefs: Beliefs
    ) -> tuple[FloatArray, FloatArray]:
        """State and covariance in the light of an outline and of free space."""
        state, covariance = taken_in(
            self.state, self.covariance, outline, (self.outlines[0], self.outlines[-1]),
            len(self.outlines), (space.now.x, space.now.y), beliefs,
        )  # fmt: skip
        return space.narrow(state, covariance, outline, self._shown, self.straight_since)

    def _contradicted(self, state: FloatArray, outline: Outline, space: FreeSpace) -> bool:
        """True if a state (6,) is not what was expected of a mover whose motion is known, or not
        what free space allows."""
        last = self.outlines[-1]
        elapsed = outline.stamp - last.stamp
        return self.seen >= 2 and (
            changed_at_once(state, self.state, self.covariance, elapsed)
            or space.contradicts(state, outline, last)
        )

    def _unlike_fullest(self, outline: Outline, beliefs: Beliefs) -> BoolArray:
        """(k,) True for hits that do not lie where the fullest outline should be now."""
        unsure = 2.0 * sqrt(max(self.covariance[4, 4], self.covariance[5, 5]))
        x, y = self._since_fullest.tolist()
        return elsewhere(outline, self.fullest, x, y, beliefs, unsure)

    def _forget_outlines(self) -> None:
        """Forgets which outlines are its own."""
        self.fullest, self.most, self.seen = NOTHING, 0, 0


@compiled
def _onward(
    centre: FloatArray, state: FloatArray, covariance: FloatArray, elapsed: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(2,) the place of a mover some seconds later, m, and its state and covariance then."""
    return centre + state[:2] * elapsed, *carried_on(state, covariance, elapsed)
