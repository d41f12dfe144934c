"""Checks of a rule base: what it repeats, contradicts, leaves out or orders against reason."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fuzzynav_mj.fuzzy.membership import DistanceTerm
from fuzzynav_mj.fuzzy.rules import INPUTS, Antecedent, Rule, mirror

Numbers = tuple[int, ...]
Pair = tuple[int, int]


@dataclass(frozen=True, slots=True)
class RuleBaseReport:
    """Findings about a rule base; rules are given by their numbers.

    Attributes:
        rules: how many there are.
        covered: how many combinations of terms have a rule.
        combinations: how many there are in all.
        duplicates: groups with the same antecedent and the same consequent.
        contradictions: groups with the same antecedent and different consequents.
        comparable: pairs of covered combinations of which one is nowhere less dangerous.
        monotonicity_violations: (safer, more dangerous) where the safer has the higher risk.
        mirror_violations: pairs whose antecedents mirror each other and whose risks differ.
        jumps: (safer, more dangerous) one term apart and two or more levels of risk apart.
    """

    rules: int
    covered: int
    combinations: int
    duplicates: tuple[Numbers, ...]
    contradictions: tuple[Numbers, ...]
    comparable: int
    monotonicity_violations: tuple[Pair, ...]
    mirror_violations: tuple[Pair, ...]
    jumps: tuple[Pair, ...]

    @property
    def consistent(self) -> bool:
        """True if nothing is contradicted: duplicates, gaps and jumps are allowed."""
        return not (self.contradictions or self.monotonicity_violations or self.mirror_violations)


def lint(rules: Sequence[Rule]) -> RuleBaseReport:
    """Check the rules of one base; `RuleTable.rules` gives those of a completed one."""
    groups: dict[Antecedent, list[Rule]] = defaultdict(list)
    for rule in rules:
        groups[rule.antecedent].append(rule)
    repeated = [group for group in groups.values() if len(group) > 1]
    contradicting = [group for group in repeated if len({rule.consequent for rule in group}) > 1]
    comparable, violations, jumps = _order_findings([group[0] for group in groups.values()])
    return RuleBaseReport(
        rules=len(rules),
        covered=len(groups),
        combinations=len(DistanceTerm) ** len(INPUTS),
        duplicates=tuple(_numbers(group) for group in repeated if group not in contradicting),
        contradictions=tuple(_numbers(group) for group in contradicting),
        comparable=comparable,
        monotonicity_violations=violations,
        mirror_violations=_mirror_findings([group[0] for group in groups.values()]),
        jumps=jumps,
    )


def _numbers(group: Sequence[Rule]) -> Numbers:
    return tuple(rule.number for rule in group)


def _order_findings(rules: Sequence[Rule]) -> tuple[int, tuple[Pair, ...], tuple[Pair, ...]]:
    """Comparable pairs, monotonicity violations and jumps of rules with distinct antecedents."""
    terms = np.array([rule.antecedent for rule in rules], dtype=np.int8).reshape(-1, len(INPUTS))
    risks = np.array([rule.consequent for rule in rules], dtype=np.int8)
    comparable = 0
    violations: list[Pair] = []
    jumps: list[Pair] = []
    for safer, rule in enumerate(rules):
        steps = terms - terms[safer]
        above = (steps >= 0).all(axis=1)
        above[safer] = False
        comparable += int(above.sum())
        rise = risks - risks[safer]
        adjacent = steps.sum(axis=1) == 1
        for found, where in (
            (violations, above & (rise < 0)),
            (jumps, above & adjacent & (rise >= 2)),
        ):
            found.extend(
                (rule.number, rules[other].number) for other in np.flatnonzero(where).tolist()
            )
    return comparable, tuple(violations), tuple(jumps)


def _mirror_findings(rules: Sequence[Rule]) -> tuple[Pair, ...]:
    by_antecedent = {rule.antecedent: rule for rule in rules}
    found: set[Pair] = set()
    for rule in rules:
        image = by_antecedent.get(mirror(rule.antecedent))
        if image is not None and image.consequent != rule.consequent:
            found.add((min(rule.number, image.number), max(rule.number, image.number)))
    return tuple(sorted(found))
