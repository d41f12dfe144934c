"""Cheapest ways over the grid against SciPy's, and free distances on rays against single ones."""

from itertools import pairwise
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from fuzzynav_mj.planners.grid import grid_around
from fuzzynav_mj.planners.reach import free_distance, free_on_rays

GRID = grid_around(0.4)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.6))
def test_costs_are_those_of_dijkstra(seed: int, blocked: float) -> None:
    rng = np.random.default_rng(seed)
    size, cells = len(GRID.axis), len(GRID.x)
    toll = rng.uniform(1.0, 3.0, cells)
    toll[rng.random(cells) < blocked] = np.inf
    cost, before = GRID.cheapest(toll)
    rows, columns = np.divmod(np.arange(cells), size)
    edges = np.zeros((cells, cells))
    for (a, b), step in zip(GRID.moves, GRID.steps, strict=True):
        i, j = rows + a, columns + b
        inside = (i >= 0) & (i < size) & (j >= 0) & (j < size)
        tail, head = np.flatnonzero(inside), (i * size + j)[inside]
        free = np.isfinite(toll[head])
        edges[tail[free], head[free]] = step * toll[head[free]]
    assert cost == pytest.approx(dijkstra(csr_array(edges), indices=GRID.origin))
    reached = np.flatnonzero(np.isfinite(cost))
    assert (before[~np.isfinite(cost)] == -1).all()
    for cell in reached.tolist():
        chain = [*GRID.chain(before, cell), GRID.origin]
        steps = [
            np.hypot(GRID.x[p] - GRID.x[q], GRID.y[p] - GRID.y[q]) * toll[p]
            for p, q in pairwise(chain)
        ]
        assert sum(steps) == pytest.approx(cost[cell])


def test_lengths_are_those_of_the_ways() -> None:
    _, before = GRID.cheapest(np.ones(len(GRID.x)))
    half, size = len(GRID.axis) // 2, len(GRID.axis)
    three_along, knight = GRID.origin + 3 * size, GRID.origin + 2 * size + 1
    lengths, ends = GRID.ways(before, np.array([GRID.origin, three_along, knight, -1]))
    assert lengths == pytest.approx([0.0, 0.15, 0.05 * 5**0.5, np.inf])
    assert ends[:3] == pytest.approx(np.array([[0.0, 0.0], [0.15, 0.0], [0.1, 0.05]]))
    assert half == 8 and GRID.x[GRID.origin] == GRID.y[GRID.origin] == 0.0


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 40), st.floats(-pi, pi))
def test_rays_are_as_free_as_single_bearings(seed: int, count: int, turn: float) -> None:
    points = np.random.default_rng(seed).uniform(-0.8, 0.8, (count, 2))
    bearings = np.arange(180) * (2 * pi / 180) - pi + turn
    widths = np.array([0.2, 0.15])
    c, s = np.cos(bearings), np.sin(bearings)
    free = free_on_rays(points, c, s, float(bearings[0]), widths)
    for row, width in zip(free, widths.tolist(), strict=True):
        assert row == pytest.approx(free_distance(points, bearings, width))
