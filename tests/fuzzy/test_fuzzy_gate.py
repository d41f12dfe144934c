"""The gate: what it refuses, what a passage costs, and that an explanation is the calculation."""

import math
import pickle
from collections.abc import Callable
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav_mj.errors import FuzzyNavError, UnknownNameError
from fuzzynav_mj.fuzzy import (
    INPUTS,
    PROFILES,
    DistanceTerm,
    Memberships,
    Origin,
    RiskGate,
    RiskTerm,
)
from fuzzynav_mj.fuzzy.centroid import centroid, risk_shapes
from fuzzynav_mj.types import FuzzyInputs

C, M, F, VF = DistanceTerm.C, DistanceTerm.M, DistanceTerm.F, DistanceTerm.VF
GATE = RiskGate()
FREE = FuzzyInputs(1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
PASSAGE = replace(FREE, LS=0.15, RS=0.15)

scenes = st.builds(FuzzyInputs, *[st.floats(0.0, 1.0)] * 6)
any_scenes = st.builds(FuzzyInputs, *[st.floats(allow_nan=False)] * 6)


def centroid_of(strengths: list[float], memberships: Memberships = GATE.memberships) -> float:
    shapes = risk_shapes(memberships)
    return centroid(np.array(strengths, dtype=np.float64), shapes.terms, shapes.ramps)


def as_row(inputs: FuzzyInputs) -> list[float]:
    return [getattr(inputs, name) for name in INPUTS]


def crossing(refused: Callable[[float], bool], low: float, high: float) -> float:
    """Where a decision changes between `low` and `high`, by bisection."""
    at_low = refused(low)
    assert refused(high) != at_low
    while high - low > 1e-9:
        middle = (low + high) / 2
        low, high = (middle, high) if refused(middle) == at_low else (low, middle)
    return low


# --- what it never accepts ---------------------------------------------------------------------


@given(inputs=any_scenes, name=st.sampled_from(INPUTS), profile=st.sampled_from(sorted(PROFILES)))
@settings(deadline=None)
def test_a_nan_in_any_place_is_refused(inputs: FuzzyInputs, name: str, profile: str) -> None:
    gate = RiskGate(profile, limit=100.0)
    blind = replace(inputs, **{name: math.nan})
    assert math.isnan(gate.risk(blind))
    assert math.isnan(gate.risks(np.array([as_row(blind)]))[0])
    assert not gate.accepts(gate.risk(blind))
    assert not gate.explain(blind).accepted
    assert not gate.explain(blind).fired


def test_a_nan_row_leaves_the_other_rows_of_a_batch_alone() -> None:
    rows = np.array([as_row(FREE), as_row(replace(FREE, FD=math.nan)), as_row(FREE)])
    np.testing.assert_array_equal(GATE.risks(rows), [7.0, math.nan, 7.0])


def test_paper_profile_refuses_where_no_published_rule_fires() -> None:
    gate = RiskGate("paper")
    assert math.isnan(gate.risk(PASSAGE))
    explanation = gate.explain(PASSAGE)
    assert not explanation.fired
    assert not explanation.accepted
    assert explanation.rules == ()
    assert set(explanation.strengths.values()) == {0.0}


@pytest.mark.parametrize("risk", [math.nan, math.inf, -math.inf, -1.0, 76.00001])
def test_refused_risks(risk: float) -> None:
    assert GATE.accepts(risk) is False


@pytest.mark.parametrize("risk", [0.0, 75.9, 76.0])
def test_accepted_risks(risk: float) -> None:
    assert GATE.accepts(risk) is True


# --- readings beyond the range -----------------------------------------------------------------


@settings(deadline=None)
@given(inputs=any_scenes)
def test_readings_beyond_the_range_count_as_its_ends(inputs: FuzzyInputs) -> None:
    clipped = FuzzyInputs(*(min(max(x, 0.0), 1.0) for x in as_row(inputs)))
    assert GATE.risk(inputs) == GATE.risk(clipped)
    assert GATE.explain(inputs).risk == GATE.explain(clipped).risk
    batch = GATE.risks(np.array([as_row(inputs), as_row(clipped)]))
    assert batch[0] == batch[1]


def test_infinite_readings() -> None:
    assert GATE.risk(FuzzyInputs(*[math.inf] * 6)) == GATE.risk(FREE) == 7.0
    assert GATE.risk(FuzzyInputs(*[-math.inf] * 6)) == 93.0


# --- numbers -----------------------------------------------------------------------------------


def test_narrow_passage_is_high_and_accepted() -> None:
    explanation = GATE.explain(PASSAGE)
    assert explanation.risk == 71.5
    assert explanation.accepted
    assert [(rule.antecedent, rule.consequent) for rule in explanation.rules] == [
        ((C, VF, C, VF, VF, VF), RiskTerm.H)
    ]


def test_corridor_with_a_free_front_is_accepted_at_every_width() -> None:
    half_widths = np.linspace(0.10, 0.50, 401)
    rows = np.ones((401, 6))
    rows[:, 0] = rows[:, 2] = half_widths
    risks = GATE.risks(rows)
    assert risks.max() == 71.5
    assert (np.diff(risks) <= 1e-9).all()
    assert risks[-1] < 40.0


@settings(deadline=None)
@given(LS=st.floats(0.0, 1.0), RS=st.floats(0.0, 1.0))
def test_walls_at_both_sides_never_close_a_free_front(LS: float, RS: float) -> None:
    assert GATE.risk(replace(FREE, LS=LS, RS=RS)) <= 71.5 + 1e-9


def test_the_trap_of_rule_1_is_refused() -> None:
    assert GATE.risk(FuzzyInputs(1.0, 0.1, 1.0, 0.1, 1.0, 0.1)) == 93.0


@pytest.mark.parametrize(
    ("strengths", "limit"),
    [
        (lambda w: [0, 0, 0, 1 - w, w], 0.430),  # VH against High
        (lambda w: [0, 0, 0, 1, w], 0.642),  # VH against a whole High
        (lambda w: [0, 0, 1 - w, 0, w], 0.668),  # VH against Normal
    ],
)
def test_share_of_very_high_that_crosses_the_limit(
    strengths: Callable[[float], list[float]], limit: float
) -> None:
    crossed = crossing(lambda w: not GATE.accepts(centroid_of(strengths(w))), 0.0, 1.0)
    assert crossed == pytest.approx(limit, abs=0.0005)


@pytest.mark.parametrize(
    ("scene", "limit"),
    [
        (lambda x: replace(FREE, LS=0.15, FS=x), 0.507),  # along a wall, another one ahead
        (lambda x: replace(PASSAGE, FD=x), 0.507),  # in a passage, a mover ahead
        (lambda x: replace(FREE, LS=x, FS=0.40), 0.250),  # a wall ahead, one coming up aside
    ],
)
def test_distance_at_which_the_gate_closes(
    scene: Callable[[float], FuzzyInputs], limit: float
) -> None:
    closed = crossing(lambda x: not GATE.accepts(GATE.risk(scene(x))), 0.16, 1.0)
    assert closed == pytest.approx(limit, abs=0.0005)


# --- laws --------------------------------------------------------------------------------------


@settings(deadline=None)
@given(inputs=scenes)
def test_mirrored_scenes_have_the_same_risk(inputs: FuzzyInputs) -> None:
    mirrored = FuzzyInputs(inputs.RS, inputs.FS, inputs.LS, inputs.RD, inputs.FD, inputs.LD)
    assert GATE.risk(mirrored) == GATE.risk(inputs)


def test_a_nearer_obstacle_lowers_the_risk_by_little_if_at_all() -> None:
    # The table is monotone, but min, max and centroid do not keep that exactly.
    rng = np.random.default_rng(0)
    before = rng.uniform(0.0, 1.0, (5000, 6))
    after = before.copy()
    nearer = (np.arange(5000), rng.integers(0, 6, 5000))
    after[nearer] *= rng.uniform(0.0, 1.0, 5000)
    change = GATE.risks(after) - GATE.risks(before)
    assert change.min() >= -3.5
    assert (change < -1e-9).mean() < 0.06


def test_the_largest_known_fall_of_the_risk_stays_below_six() -> None:
    # Found by a search that started from the worst of 400 000 random pairs.
    before = FuzzyInputs(0.848, 0.3527, 0.2217, 0.8267, 0.8982, 0.9197)
    fall = GATE.risk(before) - GATE.risk(replace(before, FS=0.275))
    assert fall == pytest.approx(5.85, abs=0.01)


# --- explanations ------------------------------------------------------------------------------


@pytest.mark.parametrize("profile", sorted(PROFILES))
@settings(deadline=None)
@given(inputs=scenes)
def test_explanation_is_the_calculation(profile: str, inputs: FuzzyInputs) -> None:
    gate = RiskGate(profile)
    explanation = gate.explain(inputs)
    assert explanation.inputs == inputs
    assert explanation.fired == bool(explanation.rules)
    assert len(explanation.rules) <= 64
    for rule in explanation.rules:
        named = zip(INPUTS, rule.antecedent, strict=True)
        grades = [explanation.memberships[name][term] for name, term in named]
        assert rule.strength == min(grades) > 0.0
    for term, strength in explanation.strengths.items():
        fired = [rule.strength for rule in explanation.rules if rule.consequent is term]
        assert strength == max(fired, default=0.0)
    recomputed = centroid_of(list(explanation.strengths.values()), gate.memberships)
    np.testing.assert_allclose([explanation.risk, gate.risk(inputs)], recomputed, atol=1e-9)
    assert explanation.accepted == gate.accepts(gate.risk(inputs))


def test_explanation_names_the_published_rules() -> None:
    scene = FuzzyInputs(0.40, 1.0, 1.0, 0.10, 0.40, 1.0)
    (rule,) = GATE.explain(scene).rules
    assert (rule.origin, rule.numbers) == (Origin.PUBLISHED, (6, 9))
    mirrored = FuzzyInputs(1.0, 1.0, 0.40, 1.0, 0.40, 0.10)
    (rule,) = GATE.explain(mirrored).rules
    assert (rule.origin, rule.numbers) == (Origin.MIRROR, (6, 9))
    (rule,) = GATE.explain(PASSAGE).rules
    assert rule.numbers == ()


def test_explanation_lists_the_strongest_rule_first() -> None:
    rules = GATE.explain(replace(FREE, LS=0.23, FS=0.72)).rules
    assert [rule.strength for rule in rules] == pytest.approx([8 / 15, 7 / 15, 0.2, 0.2])
    assert rules[0].antecedent == (C, F, VF, VF, VF, VF)


# --- configuration -----------------------------------------------------------------------------


@pytest.mark.parametrize("limit", [-0.1, 100.1, math.nan, math.inf])
def test_a_limit_outside_0_to_100_is_refused(limit: float) -> None:
    with pytest.raises(FuzzyNavError) as error:
        RiskGate(limit=limit)
    assert str(error.value) == f"risk limit: got {limit}, must be in [0, 100]"


def test_an_unknown_profile_is_refused() -> None:
    with pytest.raises(UnknownNameError, match=r"^unknown risk profile 'stric': .*'strict'\?$"):
        RiskGate("stric")


def test_breakpoints_are_configuration() -> None:
    wide = RiskGate(memberships=Memberships(distance_ramps=((0.4, 0.5), (0.6, 0.7), (0.8, 0.9))))
    scene = replace(FREE, LS=0.38)
    assert GATE.risk(scene) == 50.0  # Medium
    assert wide.risk(scene) == 71.5  # Close


def test_a_gate_is_frozen_and_survives_pickling() -> None:
    with pytest.raises(FrozenInstanceError):
        GATE.limit = 100.0  # type: ignore[misc]
    copy = pickle.loads(pickle.dumps(GATE))
    assert copy == GATE
    assert copy.risk(PASSAGE) == 71.5
