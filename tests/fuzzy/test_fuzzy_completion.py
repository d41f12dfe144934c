"""The completed rule tables: equal to the reference table, monotone, symmetric, faithful."""

import csv
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from fuzzynav_mj.errors import UnknownNameError
from fuzzynav_mj.fuzzy import PROFILES, DistanceTerm, Origin, RiskTerm, published_rules, rule_table
from fuzzynav_mj.fuzzy.completion import NO_RULE
from fuzzynav_mj.fuzzy.rules import Antecedent

C, M, F, VF = DistanceTerm.C, DistanceTerm.M, DistanceTerm.F, DistanceTerm.VF
COMPLETE = [name for name in PROFILES if name != "paper"]
ORIGIN_LETTERS = {
    "p": Origin.PUBLISHED,
    "m": Origin.MIRROR,
    "a": Origin.ANCHOR,
    "f": Origin.FORCED,
    "b": Origin.FORCED_BY_ANCHOR,
    "l": Origin.LOWER_BOUND,
    "s": Origin.SMOOTHED,
}


def reference(column: str) -> np.ndarray:
    """A column of the reference table, whose rows hold one character for each of the 64 terms of
    LD, FD and RD in the order C, M, F, VF: a level of risk, or the initial of an origin."""
    table = np.full((4,) * 6, -1)
    with (Path(__file__).parent / "completed_rules.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            static = tuple(DistanceTerm[row[name]] for name in ("LS", "FS", "RS"))
            for dynamic, letter in zip(product((C, M, F, VF), repeat=3), row[column], strict=True):
                value = ORIGIN_LETTERS[letter] if column == "origin" else int(letter)
                table[(*static, *dynamic)] = value
    return table


@pytest.mark.parametrize(
    ("column", "attribute"),
    [("risk", "consequent"), ("lower", "lower"), ("upper", "upper"), ("origin", "origin")],
)
def test_completed_table_equals_the_reference(column: str, attribute: str) -> None:
    np.testing.assert_array_equal(getattr(rule_table("completed"), attribute), reference(column))


@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_every_published_rule_is_kept(profile: str) -> None:
    table = rule_table(profile)
    for rule in published_rules():
        assert table.consequent[rule.antecedent] == rule.consequent
        assert table.origin[rule.antecedent] == Origin.PUBLISHED


@pytest.mark.parametrize("profile", COMPLETE)
def test_no_step_towards_danger_lowers_the_risk(profile: str) -> None:
    consequent = rule_table(profile).consequent
    steps = [np.diff(consequent, axis=axis) for axis in range(6)]
    assert sum(step.size for step in steps) == 18_432
    assert min(step.min() for step in steps) >= 0


@pytest.mark.parametrize("profile", COMPLETE)
def test_mirrored_situations_have_the_same_risk(profile: str) -> None:
    consequent = rule_table(profile).consequent
    np.testing.assert_array_equal(consequent, consequent.transpose(2, 1, 0, 5, 4, 3))


@pytest.mark.parametrize("profile", COMPLETE)
def test_every_combination_lies_within_the_bounds_of_table_1(profile: str) -> None:
    table = rule_table(profile)
    assert (table.lower <= table.consequent).all()
    assert (table.consequent <= table.upper).all()


@pytest.mark.parametrize(
    ("profile", "counts"),
    [
        ("completed", [7, 163, 860, 1652, 1414]),
        ("front_close_vh", [4, 95, 730, 1385, 1882]),
        ("strict", [7, 163, 616, 1395, 1915]),
        ("paper", [2, 3, 8, 4, 10]),
    ],
)
def test_how_often_each_risk_occurs(profile: str, counts: list[int]) -> None:
    consequent = rule_table(profile).consequent
    assert [int((consequent == risk).sum()) for risk in RiskTerm] == counts
    assert (consequent == NO_RULE).sum() == 4096 - sum(counts)


def test_only_rules_18_and_26_and_their_mirror_images_jump_two_levels() -> None:
    consequent = rule_table("completed").consequent
    jumps = [
        tuple(cell)
        for axis in range(6)
        for cell in np.argwhere(np.diff(consequent, axis=axis) >= 2).tolist()
    ]
    assert sorted(jumps) == [(VF, M, M, VF, VF, VF), (M, M, VF, VF, VF, VF)]


def test_minimal_situations_of_very_high_risk() -> None:
    very_high = rule_table("completed").consequent == RiskTerm.VH
    minimal = very_high.copy()
    for axis in range(6):
        inner = np.moveaxis(minimal, axis, 0)
        inner[1:] &= ~np.moveaxis(very_high, axis, 0)[:-1]
    expected: set[Antecedent] = {
        (C, M, VF, VF, VF, VF),  # Table 1
        (VF, M, C, VF, VF, VF),
        (M, VF, VF, C, M, VF),
        (VF, VF, M, VF, M, C),
        (VF, C, VF, C, VF, C),
        (C, VF, C, VF, M, VF),  # two walls and a mover ahead
        (C, VF, C, C, VF, VF),  # three Close
        (C, VF, C, VF, VF, C),
        (C, VF, VF, C, VF, C),
        (VF, VF, C, C, VF, C),
        (C, VF, VF, VF, C, C),
        (VF, VF, C, C, C, VF),
        (VF, C, VF, C, C, VF),
        (VF, C, VF, VF, C, C),
        (VF, VF, VF, C, C, C),
    }
    assert {tuple(cell) for cell in np.argwhere(minimal).tolist()} == expected


def test_static_obstacles_with_a_free_front_are_never_very_high() -> None:
    statics = rule_table("completed").consequent[:, :, :, VF, VF, VF]
    assert statics[:, VF, :].max() == RiskTerm.H
    very_high = np.argwhere(statics == RiskTerm.VH)
    assert len(very_high) == 14
    assert all(fs >= M and C in (ls, rs) for ls, fs, rs in very_high.tolist())


@pytest.mark.parametrize(
    ("situation", "risk"),
    [
        ((VF, C, VF, VF, VF, VF), RiskTerm.H),
        ((VF, M, VF, VF, VF, VF), RiskTerm.N),
        ((VF, VF, C, VF, VF, VF), RiskTerm.H),
        ((VF, VF, VF, VF, VF, C), RiskTerm.N),
        ((VF, VF, VF, VF, C, VF), RiskTerm.N),
        ((C, VF, C, VF, VF, VF), RiskTerm.H),
        ((C, F, C, VF, VF, VF), RiskTerm.H),
        ((M, VF, M, VF, VF, VF), RiskTerm.N),
        ((C, VF, C, VF, C, VF), RiskTerm.VH),
        ((VF, VF, VF, C, C, C), RiskTerm.VH),
        ((C, VF, VF, VF, VF, C), RiskTerm.H),
        ((C, C, C, C, C, C), RiskTerm.VH),
    ],
)
def test_everyday_situations_without_a_published_rule(
    situation: Antecedent, risk: RiskTerm
) -> None:
    assert rule_table("paper").consequent[situation] == NO_RULE
    assert rule_table("completed").consequent[situation] == risk


def test_profiles_differ_where_their_names_say() -> None:
    front = (VF, C, VF, VF, VF, VF)
    wall_and_mover = (C, VF, VF, VF, VF, C)
    assert rule_table("front_close_vh").consequent[front] == RiskTerm.VH
    assert rule_table("strict").consequent[front] == RiskTerm.H
    assert rule_table("strict").consequent[wall_and_mover] == RiskTerm.VH


def test_a_table_is_built_once_and_cannot_be_written() -> None:
    table = rule_table("completed")
    assert rule_table("completed") is table
    with pytest.raises(ValueError, match="read-only"):
        table.consequent[0, 0, 0, 0, 0, 0] = 1


def test_rules_of_a_table() -> None:
    listed = rule_table("paper").rules()
    assert [rule.number for rule in listed] == list(range(1, 28))
    assert {(rule.antecedent, rule.consequent) for rule in listed} == {
        (rule.antecedent, rule.consequent) for rule in published_rules()
    }


def test_unknown_profile() -> None:
    with pytest.raises(UnknownNameError) as error:
        rule_table("complete")
    assert str(error.value) == (
        "unknown risk profile 'complete': allowed are completed, front_close_vh, paper, strict. "
        "Did you mean 'completed'?"
    )
