"""The published rules, Table 1 of the paper, and their left-right mirror images."""

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.fuzzy.membership import DistanceTerm, RiskTerm

INPUTS = ("LS", "FS", "RS", "LD", "FD", "RD")
"""The fuzzy inputs in the order of Table 1: left, front, right; static before dynamic."""

Antecedent = tuple[
    DistanceTerm, DistanceTerm, DistanceTerm, DistanceTerm, DistanceTerm, DistanceTerm
]
"""One term per input, in the order of `INPUTS`."""


@dataclass(frozen=True, slots=True)
class Rule:
    """IF every input has its term of the antecedent THEN the risk is the consequent.

    Attributes:
        number: of the rule in its rule base; Table 1 counts from 1.
        antecedent: one term per input.
        consequent: term of the risk.
    """

    number: int
    antecedent: Antecedent
    consequent: RiskTerm


def mirror(antecedent: Antecedent) -> Antecedent:
    """The same situation seen in a mirror: left and right swapped."""
    ls, fs, rs, ld, fd, rd = antecedent
    return rs, fs, ls, rd, fd, ld


@cache
def published_rules() -> tuple[Rule, ...]:
    """The 28 rules of Table 1; rules 6 and 9 are the same."""
    text = files("fuzzynav_mj.fuzzy").joinpath("rules.csv").read_text(encoding="utf-8")
    return parse_rules(text, "rules.csv")


def mirror_rules(rules: Iterable[Rule]) -> tuple[Rule, ...]:
    """The mirror images that the rules lack; each keeps the number of the rule it mirrors."""
    known = list(rules)
    seen = {rule.antecedent for rule in known}
    images: list[Rule] = []
    for rule in known:
        image = mirror(rule.antecedent)
        if image not in seen:
            seen.add(image)
            images.append(Rule(rule.number, image, rule.consequent))
    return tuple(images)


def parse_rules(text: str, source: str) -> tuple[Rule, ...]:
    """Read rules from CSV text with the columns rule, LS, FS, RS, LD, FD, RD, risk.

    Raises:
        FuzzyNavError: naming `source`, the line and the column, what was given and what is allowed.
    """
    reader = csv.DictReader(text.splitlines())
    columns = ["rule", *INPUTS, "risk"]
    if reader.fieldnames is None or list(reader.fieldnames) != columns:
        given = ",".join(reader.fieldnames or ())
        raise FuzzyNavError(f"{source}: header {given!r}, must be {','.join(columns)!r}")
    rules: list[Rule] = []
    for row in reader:
        where = f"{source}, line {reader.line_num}"
        if None in row or None in row.values():
            raise FuzzyNavError(f"{where}: need {len(columns)} values, as in the header")
        try:
            number = int(row["rule"])
        except ValueError:
            raise FuzzyNavError(f"{where}: rule = {row['rule']!r}, must be an integer") from None
        ls, fs, rs, ld, fd, rd = (_distance_term(row[name], f"{where}: {name}") for name in INPUTS)
        consequent = _risk_term(row["risk"], f"{where}: risk")
        rules.append(Rule(number, (ls, fs, rs, ld, fd, rd), consequent))
    return tuple(rules)


def _distance_term(name: str, where: str) -> DistanceTerm:
    try:
        return DistanceTerm[name]
    except KeyError:
        allowed = ", ".join(term.name for term in DistanceTerm)
        raise FuzzyNavError(f"{where} = {name!r}, must be one of {allowed}") from None


def _risk_term(name: str, where: str) -> RiskTerm:
    try:
        return RiskTerm[name]
    except KeyError:
        allowed = ", ".join(term.name for term in RiskTerm)
        raise FuzzyNavError(f"{where} = {name!r}, must be one of {allowed}") from None
