"""Table 1 as it is packaged, its mirror images, and what the lint finds in it."""

import pytest

from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.fuzzy import DistanceTerm, RiskTerm, Rule, lint, mirror_rules, published_rules
from fuzzynav_mj.fuzzy.rules import Antecedent, mirror, parse_rules

C, M, F, VF = DistanceTerm.C, DistanceTerm.M, DistanceTerm.F, DistanceTerm.VF
HEADER = "rule,LS,FS,RS,LD,FD,RD,risk\n"


def test_table_1_has_28_numbered_rules() -> None:
    rules = published_rules()
    assert [rule.number for rule in rules] == list(range(1, 29))
    assert len({rule.antecedent for rule in rules}) == 27
    counts = [sum(rule.consequent is risk for rule in rules) for risk in RiskTerm]
    assert counts == [2, 3, 8, 4, 11]


@pytest.mark.parametrize(
    ("number", "antecedent", "consequent"),
    [
        (1, (VF, C, VF, C, VF, C), RiskTerm.VH),
        (3, (VF, M, VF, C, C, F), RiskTerm.H),
        (13, (VF, VF, VF, VF, VF, VF), RiskTerm.VL),
        (28, (C, VF, VF, M, VF, F), RiskTerm.H),
    ],
)
def test_rules_of_table_1(number: int, antecedent: Antecedent, consequent: RiskTerm) -> None:
    assert published_rules()[number - 1] == Rule(number, antecedent, consequent)


def test_mirror_swaps_left_and_right() -> None:
    assert mirror((C, M, F, VF, C, M)) == (F, M, C, M, C, VF)


def test_nineteen_mirror_images_are_missing_from_table_1() -> None:
    images = mirror_rules(published_rules())
    assert len(images) == 19
    own = {rule.number for rule in published_rules() if mirror(rule.antecedent) == rule.antecedent}
    assert own == {1, 4, 5, 13, 20, 21, 22, 23}
    assert mirror_rules((*published_rules(), *images)) == ()


def test_lint_of_table_1() -> None:
    report = lint(published_rules())
    assert (report.rules, report.covered, report.combinations) == (28, 27, 4096)
    assert report.duplicates == ((6, 9),)
    assert report.contradictions == ()
    assert report.comparable == 140
    assert report.monotonicity_violations == ()
    assert report.mirror_violations == ()
    assert report.jumps == ((18, 26),)
    assert report.consistent


def test_lint_of_table_1_with_its_mirror_images() -> None:
    report = lint((*published_rules(), *mirror_rules(published_rules())))
    assert (report.covered, report.comparable) == (46, 288)
    assert report.consistent


def test_lint_reports_every_kind_of_fault() -> None:
    rules = (
        Rule(1, (C, VF, VF, VF, VF, VF), RiskTerm.H),
        Rule(2, (C, VF, VF, VF, VF, VF), RiskTerm.N),
        Rule(3, (VF, VF, C, VF, VF, VF), RiskTerm.L),
        Rule(4, (C, F, VF, VF, VF, VF), RiskTerm.VL),
        Rule(5, (C, F, F, VF, VF, VF), RiskTerm.VH),
        Rule(6, (C, F, F, VF, VF, VF), RiskTerm.VH),
    )
    report = lint(rules)
    assert report.duplicates == ((5, 6),)
    assert report.contradictions == ((1, 2),)
    assert report.monotonicity_violations == ((1, 4),)
    assert report.mirror_violations == ((1, 3),)
    assert report.jumps == ((4, 5),)
    assert not report.consistent


def test_lint_of_an_empty_rule_base() -> None:
    report = lint(())
    assert (report.rules, report.covered, report.comparable) == (0, 0, 0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "rule,LS,FS,risk\n",
            "own.csv: header 'rule,LS,FS,risk', must be 'rule,LS,FS,RS,LD,FD,RD,risk'",
        ),
        ("", "own.csv: header '', must be 'rule,LS,FS,RS,LD,FD,RD,risk'"),
        (HEADER + "1,C,C,C\n", "own.csv, line 2: need 8 values, as in the header"),
        (HEADER + "1,C,C,C,C,C,C,H,H\n", "own.csv, line 2: need 8 values, as in the header"),
        (
            HEADER + "a,C,C,C,C,C,C,H\n",
            "own.csv, line 2: rule = 'a', must be an integer",
        ),
        (
            HEADER + "1,C,C,C,C,C,C,H\n2,C,C,N,C,C,C,H\n",
            "own.csv, line 3: RS = 'N', must be one of VF, F, M, C",
        ),
        (
            HEADER + "1,C,C,C,C,C,C,M\n",
            "own.csv, line 2: risk = 'M', must be one of VL, L, N, H, VH",
        ),
    ],
)
def test_malformed_rules_are_refused_with_their_place(text: str, message: str) -> None:
    with pytest.raises(FuzzyNavError) as error:
        parse_rules(text, "own.csv")
    assert str(error.value) == message
