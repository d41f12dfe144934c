"""Paths: broken lines of the footprint's centre, (k, 2) in the world frame, m."""

from typing import Protocol

import numpy as np

from fuzzynav_mj.planners.peers.free_space import FreeSpace
from fuzzynav_mj.types import FloatArray

SHORTCUTS = 150  # random attempts to shorten a path


class PathMethod(Protocol):
    """A way to find paths on a map."""

    def prepare(self, space: FreeSpace, goal: FloatArray, rng: np.random.Generator) -> None:
        """Begins an episode on a map with a goal (2,)."""

    def path(self, space: FreeSpace, start: FloatArray) -> FloatArray | None:
        """A path (k, 2) from `start` (2,) to the goal in the map's free space or a part of it."""


def length(path: FloatArray) -> float:
    """Length of a path, m."""
    return float(np.hypot(*np.diff(path, axis=0).T).sum())


def shortened(path: FloatArray, space: FreeSpace, rng: np.random.Generator) -> FloatArray:
    """The path with corners cut where the disc can move straight on between two of its points.

    Pairs of points are drawn at random along the path (Geraerts and Overmars 2007, "shortcuts").
    """
    for _ in range(SHORTCUTS):
        if len(path) == 2:
            break
        ends = np.append(0.0, np.hypot(*np.diff(path, axis=0).T).cumsum())
        first, last = np.sort(rng.uniform(0.0, ends[-1], 2))
        i, j = np.searchsorted(ends, (first, last), side="right") - 1
        j = min(int(j), len(path) - 2)
        if i == j:
            continue
        a, b = (np.array([np.interp(at, ends, path[:, k]) for k in (0, 1)]) for at in (first, last))
        if space.joins(a[None], b[None])[0]:
            path = np.vstack((path[: i + 1], a, b, path[j + 1 :]))
    return path
