"""The risk gate of section 4: takes or refuses a next position, and says why."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product

from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.fuzzy.completion import NO_RULE, Origin, rule_table
from fuzzynav_mj.fuzzy.inference import MamdaniEngine
from fuzzynav_mj.fuzzy.membership import (
    DEFAULT_MEMBERSHIPS,
    RISK_MAX,
    DistanceTerm,
    Memberships,
    RiskTerm,
)
from fuzzynav_mj.fuzzy.rules import INPUTS, Antecedent, mirror, published_rules
from fuzzynav_mj.types import FloatArray, FuzzyInputs


@dataclass(frozen=True, slots=True)
class FiredRule:
    """One rule that took part in a risk.

    Attributes:
        antecedent: its term for each input of `INPUTS`.
        consequent: its term of the risk.
        strength: smallest grade of its terms, in (0, 1].
        origin: why it has its consequent.
        numbers: of the rules of Table 1 that it is or, by origin MIRROR, mirrors; else empty.
    """

    antecedent: Antecedent
    consequent: RiskTerm
    strength: float
    origin: Origin
    numbers: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Explanation:
    """How a risk came about.

    Attributes:
        inputs: the distances as they were given, m.
        memberships: for each input of `INPUTS` the grade of each distance term; nan for nan.
        rules: the rules that fired, strongest first.
        strengths: aggregate strength of each risk term, 0 where no rule has it.
        risk: 0..100; nan if an input is nan or no rule fired.
        fired: True if any rule fired.
        accepted: True if the gate takes this risk.
    """

    inputs: FuzzyInputs
    memberships: Mapping[str, Mapping[DistanceTerm, float]]
    rules: tuple[FiredRule, ...]
    strengths: Mapping[RiskTerm, float]
    risk: float
    fired: bool
    accepted: bool


@dataclass(frozen=True, slots=True)
class RiskGate:
    """Mamdani risk of a next position, and the limit above which it is refused.

    Distances above 1 or infinite count as 1 (nothing in range), negative ones as 0. Where nothing
    can be said, because a distance is nan or, in the profile `paper`, no rule fires, the risk is
    nan and the gate refuses.

    Attributes:
        profile: rule base, a name in `fuzzynav_mj.fuzzy.completion.PROFILES`.
        limit: the largest risk that is accepted; 76 in section 4 of the paper.
        memberships: breakpoints of the terms.

    Raises:
        UnknownNameError: if there is no such profile.
        FuzzyNavError: if the limit is not in [0, 100].
    """

    profile: str = "completed"
    limit: float = 76.0
    memberships: Memberships = DEFAULT_MEMBERSHIPS
    _engine: MamdaniEngine = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        engine = MamdaniEngine(rule_table(self.profile), self.memberships)
        if not 0.0 <= self.limit <= RISK_MAX:
            raise FuzzyNavError(f"risk limit: got {self.limit}, must be in [0, {RISK_MAX:g}]")
        object.__setattr__(self, "_engine", engine)

    def risk(self, inputs: FuzzyInputs) -> float:
        """Risk in [0, 100], or nan."""
        # The engine is much faster on Python's floats than on NumPy's scalars.
        distances = (inputs.LS, inputs.FS, inputs.RS, inputs.LD, inputs.FD, inputs.RD)
        return self._engine.risk([float(x) for x in distances])

    def risks(self, distances: FloatArray) -> FloatArray:
        """Risks (n,) of distances (n, 6), m, with the columns LS, FS, RS, LD, FD, RD.

        Raises:
            FuzzyNavError: if the array is not of shape (n, 6).
        """
        return self._engine.risks(distances)

    def accepts(self, risk: float) -> bool:
        """True if the risk is known and within the limit; never for nan."""
        return bool(0.0 <= risk <= self.limit)

    def explain(self, inputs: FuzzyInputs) -> Explanation:
        """The risk of the inputs with every grade and rule behind it."""
        terms = self.memberships.distance_terms
        memberships = {
            name: {
                term: shape.grade(_in_range(getattr(inputs, name))) for term, shape in terms.items()
            }
            for name in INPUTS
        }
        rules = tuple(
            sorted(self._fired(memberships), key=lambda rule: (-rule.strength, rule.antecedent))
        )
        strengths = dict.fromkeys(RiskTerm, 0.0)
        for rule in rules:
            strengths[rule.consequent] = max(strengths[rule.consequent], rule.strength)
        risk = self.risk(inputs)
        return Explanation(
            inputs=inputs,
            memberships=memberships,
            rules=rules,
            strengths=strengths,
            risk=risk,
            fired=bool(rules),
            accepted=self.accepts(risk),
        )

    def _fired(
        self, memberships: Mapping[str, Mapping[DistanceTerm, float]]
    ) -> Iterator[FiredRule]:
        table = rule_table(self.profile)
        active = [[t for t, g in memberships[name].items() if g > 0.0] for name in INPUTS]
        for ls, fs, rs, ld, fd, rd in product(*active):
            antecedent = (ls, fs, rs, ld, fd, rd)
            consequent = int(table.consequent[antecedent])
            if consequent == NO_RULE:
                continue
            origin = Origin(int(table.origin[antecedent]))
            yield FiredRule(
                antecedent=antecedent,
                consequent=RiskTerm(consequent),
                strength=min(
                    memberships[name][term] for name, term in zip(INPUTS, antecedent, strict=True)
                ),
                origin=origin,
                numbers=_numbers(antecedent, origin),
            )


def _in_range(distance: float) -> float:
    return distance if math.isnan(distance) else min(max(float(distance), 0.0), 1.0)


def _numbers(antecedent: Antecedent, origin: Origin) -> tuple[int, ...]:
    if origin not in (Origin.PUBLISHED, Origin.MIRROR):
        return ()
    listed = antecedent if origin is Origin.PUBLISHED else mirror(antecedent)
    return tuple(rule.number for rule in published_rules() if rule.antecedent == listed)
