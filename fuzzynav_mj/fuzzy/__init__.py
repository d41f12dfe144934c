"""The fuzzy risk gate: six distances in, one risk and a yes or no out (section 4 of the paper)."""

from fuzzynav_mj.fuzzy.completion import PROFILES, Origin, RuleTable, rule_table
from fuzzynav_mj.fuzzy.lint import RuleBaseReport, lint
from fuzzynav_mj.fuzzy.membership import DistanceTerm, Memberships, RiskTerm, Trapezoid
from fuzzynav_mj.fuzzy.risk import Explanation, FiredRule, RiskGate
from fuzzynav_mj.fuzzy.rules import INPUTS, Rule, mirror_rules, published_rules

__all__ = [
    "INPUTS",
    "PROFILES",
    "DistanceTerm",
    "Explanation",
    "FiredRule",
    "Memberships",
    "Origin",
    "RiskGate",
    "RiskTerm",
    "Rule",
    "RuleBaseReport",
    "RuleTable",
    "Trapezoid",
    "lint",
    "mirror_rules",
    "published_rules",
    "rule_table",
]
