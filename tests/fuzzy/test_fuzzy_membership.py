"""Laws of the terms: partition of unity, at most two active, breakpoints as configured."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.fuzzy import DistanceTerm, Memberships, RiskTerm, Trapezoid
from fuzzynav_mj.robot import DEFAULT_ROBOT


def test_default_trapezoids() -> None:
    assert Memberships().distance_terms == {
        DistanceTerm.VF: Trapezoid(0.65, 0.80, 1.0, 1.0),
        DistanceTerm.F: Trapezoid(0.45, 0.55, 0.65, 0.80),
        DistanceTerm.M: Trapezoid(0.20, 0.35, 0.45, 0.55),
        DistanceTerm.C: Trapezoid(0.0, 0.0, 0.20, 0.35),
    }
    assert Memberships().risk_terms == {
        RiskTerm.VL: Trapezoid(0.0, 0.0, 9.0, 18.0),
        RiskTerm.L: Trapezoid(9.0, 18.0, 39.0, 48.0),
        RiskTerm.N: Trapezoid(39.0, 48.0, 52.0, 61.0),
        RiskTerm.H: Trapezoid(52.0, 61.0, 82.0, 91.0),
        RiskTerm.VH: Trapezoid(82.0, 91.0, 100.0, 100.0),
    }


def test_rings_of_the_default_robot_give_the_default_ramps() -> None:
    ramps = Memberships.from_rings(DEFAULT_ROBOT.rings).distance_ramps
    np.testing.assert_allclose(ramps, Memberships().distance_ramps, atol=1e-15)


@settings(deadline=None)
@given(x=st.floats(0.0, 1.0))
def test_distance_terms_are_a_partition_of_unity(x: float) -> None:
    grades = [shape.grade(x) for shape in Memberships().distance_terms.values()]
    assert sum(grades) == pytest.approx(1.0, abs=1e-15)
    assert sum(grade > 0.0 for grade in grades) <= 2
    np.testing.assert_array_equal(Memberships().distance_grades(np.array([x]))[0], grades)


@settings(deadline=None)
@given(risk=st.floats(0.0, 100.0))
def test_risk_terms_are_a_partition_of_unity(risk: float) -> None:
    grades = [shape.grade(risk) for shape in Memberships().risk_terms.values()]
    assert sum(grades) == pytest.approx(1.0, abs=1e-15)
    assert sum(grade > 0.0 for grade in grades) <= 2
    np.testing.assert_array_equal(Memberships().risk_grades(np.array([risk]))[0], grades)


@pytest.mark.parametrize(
    ("x", "term"),
    [
        (0.0, DistanceTerm.C),
        (0.2, DistanceTerm.C),
        (0.4, DistanceTerm.M),
        (0.6, DistanceTerm.F),
        (0.8, DistanceTerm.VF),
        (1.0, DistanceTerm.VF),
    ],
)
def test_a_distance_on_a_ring_has_that_rings_term_alone(x: float, term: DistanceTerm) -> None:
    grades = Memberships().distance_grades(np.array(x))
    assert grades[term] == 1.0
    assert grades.sum() == 1.0


def test_grades_halfway_down_a_ramp() -> None:
    grades = Memberships().distance_grades(np.array([0.275, 0.5, 0.725]))
    np.testing.assert_allclose(
        grades, [[0, 0, 0.5, 0.5], [0, 0.5, 0.5, 0], [0.5, 0.5, 0, 0]], atol=1e-12
    )


def test_nan_has_no_grade() -> None:
    assert np.isnan(Memberships().distance_grades(np.array([math.nan]))).all()
    assert math.isnan(Trapezoid(0.0, 0.0, 0.2, 0.35).grade(math.nan))


@pytest.mark.parametrize(
    ("ramps", "message"),
    [
        (
            ((0.35, 0.20), (0.45, 0.55), (0.65, 0.80)),
            "distance_ramps[0]: got (0.35, 0.2), need 0.0 <= start < end <= 1",
        ),
        (
            ((0.20, 0.50), (0.45, 0.55), (0.65, 0.80)),
            "distance_ramps[1]: got (0.45, 0.55), need 0.5 <= start < end <= 1",
        ),
        (
            ((0.20, 0.35), (0.45, 0.55), (0.65, 1.2)),
            "distance_ramps[2]: got (0.65, 1.2), need 0.55 <= start < end <= 1",
        ),
        (
            ((math.nan, 0.35), (0.45, 0.55), (0.65, 0.80)),
            "distance_ramps[0]: got (nan, 0.35), need 0.0 <= start < end <= 1",
        ),
        (((0.20, 0.35), (0.45, 0.55)), "distance_ramps: got 2 ramps, need 3"),
    ],
)
def test_ramps_that_make_no_partition_are_refused(ramps: tuple, message: str) -> None:
    with pytest.raises(FuzzyNavError) as error:
        Memberships(distance_ramps=ramps)
    assert str(error.value) == message


def test_rings_other_than_four_are_refused() -> None:
    with pytest.raises(FuzzyNavError, match=r"^rings: got 3 of them, .* need 4$"):
        Memberships.from_rings((0.2, 0.4, 0.6))
