"""Optima under half-planes, held against other ways to find them."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import linprog

from fuzzynav_mj.planners.peers.half_planes import (
    HalfPlanes,
    box,
    least_violating,
    lowest,
    nearest,
)
from fuzzynav_mj.types import FloatArray

UNIT_BOX = box(np.array([-1.0, -1.0]), np.array([1.0, 1.0]))
NONE = HalfPlanes(np.empty((0, 2)), np.empty(0))
SEEDS = st.integers(0, 2**32 - 1)
COUNTS = st.integers(0, 8)


def random_planes(rng: np.random.Generator, count: int) -> HalfPlanes:
    """Half-planes whose borders pass within 0.6 of the origin, which most of them hold."""
    angle = rng.uniform(-np.pi, np.pi, count)
    return HalfPlanes(
        np.stack((np.cos(angle), np.sin(angle)), axis=1), rng.uniform(-0.2, 0.6, count)
    )


def corners_and_feet(wanted: FloatArray, planes: HalfPlanes) -> FloatArray:
    """Every point that can be nearest: the wanted one, its feet on the borders, their crossings."""
    feet = wanted - planes.excess(wanted)[:, None] * planes.normals
    crossings = [
        np.linalg.solve(planes.normals[[i, j]], planes.offsets[[i, j]])
        for i, j in combinations(range(len(planes.offsets)), 2)
        if abs(np.linalg.det(planes.normals[[i, j]])) > 1e-9
    ]
    return np.concatenate((wanted[None], feet, np.array(crossings).reshape(-1, 2)))


def test_without_half_planes_the_wanted_point_is_taken() -> None:
    wanted = np.array([0.3, -7.0])
    assert nearest(wanted, NONE) is wanted


def test_one_half_plane_gives_the_foot_of_the_perpendicular() -> None:
    """From (2, 2) to x + y <= 2: (1, 1). From (0, 0), which is inside: itself."""
    planes = HalfPlanes(np.array([[1.0, 1.0]]), np.array([2.0]))
    assert nearest(np.array([2.0, 2.0]), planes) == pytest.approx((1.0, 1.0))
    assert nearest(np.array([0.0, 0.0]), planes) == pytest.approx((0.0, 0.0))


def test_two_half_planes_that_shut_each_other_out_leave_nothing() -> None:
    planes = HalfPlanes(np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([-1.0, -1.0]))
    assert nearest(np.zeros(2), planes) is None
    assert lowest(np.ones(2), UNIT_BOX.and_(planes)) is None


def test_least_violation_lies_in_the_middle_of_what_shuts_each_other_out() -> None:
    """x <= -0.5 and x >= 0.1 are missed least at x = -0.2, by 0.3 each."""
    soft = HalfPlanes(np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([-0.5, -0.1]))
    point = least_violating(UNIT_BOX, soft)
    assert point is not None and point[0] == pytest.approx(-0.2)
    assert soft.excess(point) == pytest.approx([0.3, 0.3])


@given(SEEDS, COUNTS)
def test_nearest_point_is_the_best_of_all_that_can_be_it(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    planes, wanted = UNIT_BOX.and_(random_planes(rng, count)), rng.uniform(-2, 2, 2)
    eligible = [p for p in corners_and_feet(wanted, planes) if planes.excess(p).max() <= 1e-8]
    found = nearest(wanted, planes)
    if not eligible:
        assert found is None
        return
    assert found is not None and planes.excess(found).max() <= 1e-7
    best = min(float(np.hypot(*(p - wanted))) for p in eligible)
    assert float(np.hypot(*(found - wanted))) == pytest.approx(best, abs=1e-6)


@given(SEEDS, COUNTS)
def test_lowest_point_is_as_low_as_the_simplex_method_finds(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    planes, slope = UNIT_BOX.and_(random_planes(rng, count)), rng.normal(size=2)
    reference = linprog(slope, planes.normals, planes.offsets, bounds=(None, None))
    found = lowest(slope, planes)
    assert (found is not None) == (reference.status == 0)
    if found is not None:
        assert planes.excess(found).max() <= 1e-7
        assert float(slope @ found) == pytest.approx(reference.fun, abs=1e-6)


@given(SEEDS, COUNTS, st.integers(1, 6))
def test_least_violation_is_as_small_as_the_simplex_method_finds(
    seed: int, firm: int, count: int
) -> None:
    rng = np.random.default_rng(seed)
    hard = UNIT_BOX.and_(random_planes(rng, firm))
    soft = random_planes(rng, count)
    found = least_violating(hard, soft)
    rows = np.concatenate(
        (
            np.column_stack((hard.normals, np.zeros(len(hard.offsets)))),
            np.column_stack((soft.normals, -np.ones(count))),
        )
    )
    limits = np.concatenate((hard.offsets, soft.offsets))
    reference = linprog([0.0, 0.0, 1.0], rows, limits, bounds=(None, None))
    assert (found is not None) == (reference.status == 0)
    assume(found is not None)
    assert found is not None and hard.excess(found).max() <= 1e-7
    assert float(soft.excess(found).max()) == pytest.approx(reference.fun, abs=1e-6)
