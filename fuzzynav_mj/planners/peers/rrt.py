"""Rapidly exploring random tree (LaValle 1998; LaValle, Kuffner 2001)."""

import numpy as np

from fuzzynav_mj.planners.peers.free_space import FreeSpace
from fuzzynav_mj.planners.peers.paths import shortened
from fuzzynav_mj.types import FloatArray

STEP = 0.3  # m: longest edge of the tree
GOAL_BIAS = 0.05  # share of the draws that are the goal
CACHE_BIAS = 0.4  # share of the draws that are corners of the last path
DRAWS = 20000  # after which a first plan fails ...
REPLAN_DRAWS = 1500  # ... and a plan around temporary obstacles


class Rrt:
    """A tree grown from the robot until it reaches the goal; the path is then shortened.

    A later plan draws also from the corners of the one before, as ERRT does (Bruce, Veloso 2002).
    """

    def prepare(self, space: FreeSpace, goal: FloatArray, rng: np.random.Generator) -> None:
        """Begins an episode."""
        self._map, self._goal, self._rng = space, goal, rng
        self._cache = np.empty((0, 2))

    def path(self, space: FreeSpace, start: FloatArray) -> FloatArray | None:
        """A path to the goal; None if the tree has not reached it after so many draws."""
        path = self._grown(space, start, DRAWS if space is self._map else REPLAN_DRAWS)
        if path is None:
            return None
        self._cache = path[1:-1]
        return shortened(path, space, self._rng)

    def _grown(self, space: FreeSpace, start: FloatArray, draws: int) -> FloatArray | None:
        places = np.empty((draws + 1, 2))
        before = np.zeros(draws + 1, dtype=np.intp)
        places[0], count = start, 1
        for target in self._targets(space, draws):
            away = target - places[:count]
            squared = (away * away).sum(axis=1)
            nearest = int(squared.argmin())
            distance = float(np.sqrt(squared[nearest]))
            if distance < 1e-9:
                continue
            place = target
            if distance > STEP:
                place = places[nearest] + away[nearest] * (STEP / distance)
            if not space.joins(places[nearest][None], place[None])[0]:
                continue
            places[count], before[count] = place, nearest
            count += 1
            if np.array_equal(place, self._goal):
                chain = [count - 1]
                while chain[-1] != 0:
                    chain.append(int(before[chain[-1]]))
                return places[chain[::-1]]
        return None

    def _targets(self, space: FreeSpace, draws: int) -> FloatArray:
        """(draws, 2) what the tree grows towards."""
        low, high = np.reshape(space.bounds, (2, 2))
        targets = self._rng.uniform(low, high, (draws, 2))
        kind = self._rng.random(draws)
        if len(self._cache):
            cached = (kind >= GOAL_BIAS) & (kind < GOAL_BIAS + CACHE_BIAS)
            targets[cached] = self._rng.choice(self._cache, int(cached.sum()))
        targets[kind < GOAL_BIAS] = self._goal
        return targets
