"""Probabilistic roadmap (Kavraki, Svestka, Latombe, Overmars 1996)."""

import numpy as np
import shapely
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from fuzzynav_mj.planners.peers.free_space import FreeSpace
from fuzzynav_mj.planners.peers.paths import shortened
from fuzzynav_mj.types import FloatArray, IntArray

SAMPLES = 2000  # free places in the first roadmap ...
MOST_SAMPLES = 32000  # ... which is doubled up to this as long as start and goal are not connected
NEIGHBOURS = 10
LONGEST_EDGE = 1.5  # m


class Prm:
    """A roadmap of random free places, each joined to its nearest ones; Dijkstra on it.

    Edges that meet a temporary obstacle are left out of a query; the roadmap itself stays.
    """

    def prepare(self, space: FreeSpace, goal: FloatArray, rng: np.random.Generator) -> None:
        """Builds the roadmap of a map."""
        self._map, self._rng = space, rng
        self._places = goal[None]
        self._grow(SAMPLES)

    def path(self, space: FreeSpace, start: FloatArray) -> FloatArray | None:
        """The shortest path on the roadmap, shortened; None if it holds none."""
        path = self._query(space, start)
        while path is None and space is self._map and len(self._places) <= MOST_SAMPLES // 2:
            self._grow(2 * len(self._places))
            path = self._query(space, start)
        return None if path is None else shortened(path, space, self._rng)

    def _grow(self, count: int) -> None:
        """Draws further places up to `count` and joins all anew."""
        low, high = np.reshape(self._map.bounds, (2, 2))
        while len(self._places) < count:
            drawn = self._rng.uniform(low, high, (count, 2))
            kept = drawn[self._map.holds(drawn)][: count - len(self._places)]
            self._places = np.concatenate((self._places, kept))
        self._tree = cKDTree(self._places)
        _, near = self._tree.query(self._places, NEIGHBOURS + 1)
        ends = np.column_stack((np.repeat(near[:, 0], NEIGHBOURS), near[:, 1:].ravel()))
        edges = np.unique(np.sort(ends, axis=1), axis=0)
        edges = edges[self._lengths(edges) <= LONGEST_EDGE]
        edges = edges[self._map.joins(*self._places[edges.T])]
        self._edges: IntArray = edges
        self._lines = shapely.STRtree(shapely.linestrings(self._places[edges]))

    def _lengths(self, edges: IntArray) -> FloatArray:
        a, b = self._places[edges.T]
        lengths: FloatArray = np.hypot(*(a - b).T)
        return lengths

    def _query(self, space: FreeSpace, start: FloatArray) -> FloatArray | None:
        edges = self._edges
        if space is not self._map:
            met = self._lines.query(space.blocked, predicate="intersects")
            edges = np.delete(edges, met, axis=0)
        count = len(self._places)
        graph = csr_matrix((self._lengths(edges), edges.T), shape=(count, count))
        to_goal, onwards = dijkstra(graph, directed=False, indices=0, return_predecessors=True)
        away, near = self._tree.query(start, min(3 * NEIGHBOURS, count))
        free = space.joins(np.broadcast_to(start, (len(near), 2)), self._places[near])
        cost = np.where(free, away + to_goal[near], np.inf)
        best = int(cost.argmin())
        if not np.isfinite(cost[best]):
            return None
        chain = [int(near[best])]
        while chain[-1] != 0:
            chain.append(int(onwards[chain[-1]]))
        return np.vstack((start, self._places[chain]))
