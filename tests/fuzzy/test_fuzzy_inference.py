"""The inference engine: exact centroids, weights of every rule, agreement with scikit-fuzzy."""

import math
from fractions import Fraction
from functools import reduce
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.fuzzy import (
    PROFILES,
    Memberships,
    RiskTerm,
    Trapezoid,
    published_rules,
    rule_table,
)
from fuzzynav_mj.fuzzy.centroid import centroid, risk_shapes
from fuzzynav_mj.fuzzy.inference import MamdaniEngine

SHAPES = risk_shapes(Memberships())
ENGINES = {name: MamdaniEngine(rule_table(name), Memberships()) for name in PROFILES}
EXACT = [Fraction(7), Fraction(57, 2), Fraction(50), Fraction(143, 2), Fraction(93)]

# Any float, and often a value on a ramp or a breakpoint.
distances = st.one_of(
    st.floats(0.0, 1.0), st.sampled_from([0.2, 0.275, 0.35, 0.45, 0.5, 0.55, 0.65, 0.725, 0.8])
)
scenes = st.tuples(*[distances] * 6)


def centroid_of(strengths: list[float]) -> float:
    return centroid(np.array(strengths), SHAPES.terms, SHAPES.ramps)


def exact_grade(shape: Trapezoid, x: Fraction) -> Fraction:
    a, b, c, d = (Fraction(knot) for knot in (shape.a, shape.b, shape.c, shape.d))
    rising = (x - a) / (b - a) if x < b else Fraction(1)
    falling = (d - x) / (d - c) if x > c else Fraction(1)
    return max(Fraction(0), min(rising, falling))


def exact_centroid(strengths: list[Fraction]) -> Fraction:
    """Centroid in rational arithmetic, piece by piece between every possible bend."""
    memberships = Memberships()
    shapes = list(memberships.risk_terms.values())
    bends = {Fraction(0), Fraction(100)}
    for start, end in memberships.risk_ramps:
        for level in (Fraction(0), Fraction(1, 2), Fraction(1), *strengths):
            for share in (level, 1 - level):
                bends.add(Fraction(start) + share * (Fraction(end) - Fraction(start)))

    def joined(x: Fraction) -> Fraction:
        return max(min(h, exact_grade(s, x)) for h, s in zip(strengths, shapes, strict=True))

    area = moment = Fraction(0)
    for left, right in pairwise(sorted(bends)):
        f, g, width = joined(left), joined(right), right - left
        area += width * (f + g) / 2
        moment += width * (left * (2 * f + g) + right * (f + 2 * g)) / 6
    return moment / area


@pytest.mark.parametrize("term", list(RiskTerm))
def test_centroids_of_whole_terms_are_exact(term: RiskTerm) -> None:
    strengths = [Fraction(int(other == term)) for other in RiskTerm]
    assert exact_centroid(strengths) == EXACT[term]
    assert centroid_of([float(h) for h in strengths]) == float(EXACT[term])


@settings(deadline=None)
@given(st.lists(st.integers(0, 64), min_size=5, max_size=5).filter(any))
def test_centroid_equals_rational_arithmetic(sixty_fourths: list[int]) -> None:
    exact = float(exact_centroid([Fraction(k, 64) for k in sixty_fourths]))
    assert centroid_of([k / 64 for k in sixty_fourths]) == pytest.approx(exact, abs=1e-11)


@settings(deadline=None)
@given(h=st.floats(1e-9, 1.0))
def test_symmetric_terms_keep_their_centroid_at_any_strength(h: float) -> None:
    for term in (RiskTerm.L, RiskTerm.N, RiskTerm.H):
        strengths = [h if other == term else 0.0 for other in RiskTerm]
        assert centroid_of(strengths) == pytest.approx(float(EXACT[term]), abs=1e-9)
    assert 91.0 <= centroid_of([0.0, 0.0, 0.0, 0.0, h]) <= 93.0 + 1e-9
    assert 7.0 - 1e-9 <= centroid_of([h, 0.0, 0.0, 0.0, 0.0]) <= 9.0


def test_no_strength_has_no_centroid() -> None:
    assert math.isnan(centroid_of([0.0] * 5))


def weighed_one_by_one(memberships: Memberships, profile: str, row: tuple[float, ...]) -> float:
    """The risk by all 4096 combinations of terms, most of which do not fire."""
    grades = memberships.distance_grades(np.array(row))
    weights = reduce(np.minimum.outer, grades)
    consequent = rule_table(profile).consequent
    return centroid_of([weights[consequent == risk].max(initial=0.0) for risk in RiskTerm])


@settings(deadline=None)
@given(
    knots=st.lists(st.integers(0, 100), min_size=6, max_size=6, unique=True).map(sorted),
    rows=st.lists(scenes, min_size=1, max_size=3),
    profile=st.sampled_from(sorted(PROFILES)),
)
def test_all_rules_that_fire_are_weighed_at_any_breakpoints(
    knots: list[int], rows: list[tuple[float, ...]], profile: str
) -> None:
    a0, b0, a1, b1, a2, b2 = (knot / 100 for knot in knots)
    for memberships in (
        Memberships(),
        Memberships(distance_ramps=((a0, b0), (a1, b1), (a2, b2))),
    ):
        engine = MamdaniEngine(rule_table(profile), memberships)
        expected = [weighed_one_by_one(memberships, profile, row) for row in rows]
        np.testing.assert_allclose(engine.risks(np.array(rows)), expected, rtol=0, atol=1e-9)
        np.testing.assert_array_equal(
            engine.risks(np.array(rows)), [engine.risk(row) for row in rows]
        )


@settings(deadline=None)
@given(row=scenes)
def test_risk_stays_between_the_centroids_of_the_extreme_terms(row: tuple[float, ...]) -> None:
    assert 7.0 - 1e-9 <= ENGINES["completed"].risk(row) <= 93.0 + 1e-9


def test_share_of_the_box_where_no_published_rule_fires() -> None:
    rows = np.random.default_rng(0).uniform(0.0, 1.0, (20_000, 6))
    assert np.isnan(ENGINES["paper"].risks(rows)).mean() == pytest.approx(0.965, abs=0.005)
    assert not np.isnan(ENGINES["completed"].risks(rows)).any()


@pytest.mark.parametrize("shape", [(6,), (2, 5), (1, 2, 6)])
def test_batch_of_another_shape_is_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(FuzzyNavError) as error:
        ENGINES["completed"].risks(np.zeros(shape))
    assert str(error.value) == (
        f"distances: got an array of shape {shape}, need (n, 6) with the columns "
        "LS, FS, RS, LD, FD, RD"
    )


def test_agreement_with_scikit_fuzzy_on_the_published_rules() -> None:
    skfuzzy = pytest.importorskip("skfuzzy")
    memberships = Memberships()
    distance_axis = np.linspace(0.0, 1.0, 101)
    risk_axis = np.linspace(0.0, 100.0, 1001)
    distance_shapes = {
        term: skfuzzy.trapmf(distance_axis, [t.a, t.b, t.c, t.d])
        for term, t in memberships.distance_terms.items()
    }
    risk_shapes = {
        term: skfuzzy.trapmf(risk_axis, [t.a, t.b, t.c, t.d])
        for term, t in memberships.risk_terms.items()
    }

    rng = np.random.default_rng(1)
    for _ in range(200):
        row = np.empty(6)
        chosen = published_rules()[rng.integers(28)]
        for i, term in enumerate(chosen.antecedent):  # inside its support, so that it fires
            t = memberships.distance_terms[term]
            row[i] = t.a + rng.uniform(0.02, 0.98) * (t.d - t.a)
        joined = np.zeros_like(risk_axis)
        for rule in published_rules():
            grades = [
                skfuzzy.interp_membership(distance_axis, distance_shapes[term], x)
                for term, x in zip(rule.antecedent, row, strict=True)
            ]
            joined = np.fmax(joined, np.fmin(min(grades), risk_shapes[rule.consequent]))
        oracle = skfuzzy.defuzz(risk_axis, joined, "centroid")
        assert ENGINES["paper"].risk(row.tolist()) == pytest.approx(oracle, abs=0.05)
