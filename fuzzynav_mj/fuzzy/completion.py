"""From the 28 published rules to a consequent for each of the 4096 combinations of terms.

The published rules speak of 27 combinations, 46 with their mirror images, and leave out everyday
scenes such as a gap between two walls. They are monotone (no nearer obstacle lowers the risk) and
agree with their mirror images, and so does every completion made here:

1. Anchors fix a few scenes on which the rules are silent and the paper's text or the pattern of
   its rules is not; each is named where it is made below.
2. Monotonicity bounds every combination: at least the highest consequent among the known scenes
   that are nowhere more dangerous, at most the lowest among those nowhere less dangerous.
3. Between the bounds the risk falls by at most one level for each step of one term away from a
   known scene, so that neighbouring combinations differ by one level wherever the rules allow.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from itertools import combinations, product

import numpy as np
import numpy.typing as npt

from fuzzynav_mj.errors import UnknownNameError
from fuzzynav_mj.fuzzy.membership import DistanceTerm, RiskTerm
from fuzzynav_mj.fuzzy.rules import INPUTS, Antecedent, Rule, mirror_rules, published_rules

TermArray = npt.NDArray[np.int8]
Known = dict[Antecedent, RiskTerm]

SHAPE = (len(DistanceTerm),) * len(INPUTS)
NO_RULE = len(RiskTerm)
"""Consequent of a combination that has no rule."""


class Origin(IntEnum):
    """Why a combination of terms has its consequent."""

    NONE = 0  # it has no rule
    PUBLISHED = 1  # Table 1
    MIRROR = 2  # mirror image of a rule of Table 1
    ANCHOR = 3  # a scene fixed here
    FORCED = 4  # the only value that is monotone with the published rules
    FORCED_BY_ANCHOR = 5  # the only value that is monotone with them and the anchors
    LOWER_BOUND = 6  # the lowest value that is monotone with them and the anchors
    SMOOTHED = 7  # above the lowest value, one level per step below a known scene


@dataclass(frozen=True, slots=True, eq=False)
class RuleTable:
    """A rule base as arrays with one axis per input of `INPUTS` and one index per `DistanceTerm`.

    Attributes:
        consequent: (4, 4, 4, 4, 4, 4) `RiskTerm`, or `NO_RULE`.
        lower: same shape; the lowest `RiskTerm` monotone with the published rules and mirrors.
        upper: same shape; the highest one.
        origin: same shape; `Origin`.
    """

    consequent: TermArray
    lower: TermArray
    upper: TermArray
    origin: TermArray

    def rules(self) -> tuple[Rule, ...]:
        """One rule per combination that has one, numbered from 1 in the order of the arrays."""
        listed = ((a, int(self.consequent[a])) for a in _antecedents())
        filled = ((a, consequent) for a, consequent in listed if consequent != NO_RULE)
        return tuple(
            Rule(number, antecedent, RiskTerm(consequent))
            for number, (antecedent, consequent) in enumerate(filled, start=1)
        )


@cache
def rule_table(profile: str = "completed") -> RuleTable:
    """The rule table of a profile of `PROFILES`, built once per process.

    Raises:
        UnknownNameError: if there is no such profile.
    """
    if profile not in PROFILES:
        raise UnknownNameError("risk profile", profile, PROFILES)
    return PROFILES[profile]()


def _paper() -> RuleTable:
    published = _known(published_rules())
    lower, upper = _bounds(_known((*published_rules(), *mirror_rules(published_rules()))))
    consequent = np.full(SHAPE, NO_RULE, dtype=np.int8)
    origin = np.full(SHAPE, Origin.NONE, dtype=np.int8)
    for antecedent, risk in published.items():
        consequent[antecedent] = risk
        origin[antecedent] = Origin.PUBLISHED
    return _frozen(consequent, lower, upper, origin)


def _complete(anchors: Known) -> RuleTable:
    published = _known(published_rules())
    images = _known(mirror_rules(published_rules()))
    table = {**published, **images}
    known = {**anchors, **table}
    lower, upper = _bounds(table)
    known_lower, known_upper = _bounds(known)
    consequent = np.clip(_smooth(known), known_lower, known_upper)

    origin = np.where(consequent == known_lower, Origin.LOWER_BOUND, Origin.SMOOTHED)
    origin = np.where(known_lower == known_upper, Origin.FORCED_BY_ANCHOR, origin)
    origin = np.where(lower == upper, Origin.FORCED, origin).astype(np.int8)
    for why, cells in (
        (Origin.ANCHOR, anchors),
        (Origin.MIRROR, images),
        (Origin.PUBLISHED, published),
    ):
        for antecedent in cells:
            origin[antecedent] = why
    return _frozen(consequent, lower, upper, origin)


def _anchors(front_close: RiskTerm = RiskTerm.H) -> Known:
    """The scenes fixed by hand: 29, of which four repeat published rules."""
    terms, risks = DistanceTerm, RiskTerm
    anchors: Known = {
        # One obstacle in front is as dangerous as Table 1 makes one at the side (rules 14-16 and
        # 10-12). Rules 18, 19 and 2 cap FS = M, FS = F and FD = C at these values; rule 17 leaves
        # FS = C free, H or VH.
        _scene(FS=terms.C): front_close,
        _scene(FS=terms.M): risks.N,
        _scene(FS=terms.F): risks.L,
        _scene(FD=terms.C): risks.N,
        _scene(FD=terms.M): risks.L,
        _scene(FD=terms.F): risks.VL,
        # Section 5 h: two walls and a mover exceed the limit; with the mover Close this is below.
        _scene(LS=terms.C, RS=terms.C, FD=terms.M): risks.VH,
        # A third obstacle of a kind adds a level, as in rules 14-16, 18, 19, 21 and 22.
        _scene(LD=terms.M, FD=terms.M, RD=terms.M): risks.N,
        _scene(LD=terms.F, FD=terms.F, RD=terms.F): risks.L,
    }
    # The paper's explanation of rule 1: three close obstacles are a trap.
    for names in combinations(INPUTS, 3):
        anchors[_scene(**dict.fromkeys(names, terms.C))] = risks.VH
    return anchors


def _strict_anchors() -> Known:
    """Besides the anchors: one static and one moving obstacle Close are Very High together."""
    pairs = product(INPUTS[:3], INPUTS[3:])
    close = (_scene(**dict.fromkeys(pair, DistanceTerm.C)) for pair in pairs)
    return _anchors() | dict.fromkeys(close, RiskTerm.VH)


PROFILES: Mapping[str, Callable[[], RuleTable]] = {
    "completed": lambda: _complete(_anchors()),
    "front_close_vh": lambda: _complete(_anchors(front_close=RiskTerm.VH)),
    "strict": lambda: _complete(_strict_anchors()),
    "paper": _paper,
}
"""Rule bases by name: `paper` is Table 1 alone, all others give every combination a consequent."""


def _scene(
    LS: DistanceTerm = DistanceTerm.VF,
    FS: DistanceTerm = DistanceTerm.VF,
    RS: DistanceTerm = DistanceTerm.VF,
    LD: DistanceTerm = DistanceTerm.VF,
    FD: DistanceTerm = DistanceTerm.VF,
    RD: DistanceTerm = DistanceTerm.VF,
) -> Antecedent:
    return LS, FS, RS, LD, FD, RD


def _antecedents() -> Iterator[Antecedent]:
    axis = tuple(DistanceTerm)
    return product(axis, axis, axis, axis, axis, axis)


def _known(rules: Iterable[Rule]) -> Known:
    return {rule.antecedent: rule.consequent for rule in rules}


def _bounds(known: Known) -> tuple[TermArray, TermArray]:
    """Lowest and highest value of each combination that is monotone with the known scenes."""
    lower = _filled(known, RiskTerm.VL)
    upper = _filled(known, RiskTerm.VH)
    for axis in range(len(INPUTS)):
        lower = np.maximum.accumulate(lower, axis=axis)
        upper = np.flip(np.minimum.accumulate(np.flip(upper, axis), axis=axis), axis)
    return lower, upper


def _smooth(known: Known) -> TermArray:
    """Lowest monotone table above the known scenes that falls by at most one level per step.

    At x it is the maximum over the known scenes r of risk(r) - sum_i max(0, r_i - x_i); the sum
    separates, so one axis can be settled after the other.
    """
    below_all = -len(INPUTS) * len(DistanceTerm)
    table = _filled(known, below_all)
    steps = np.arange(len(DistanceTerm), dtype=np.int8)
    for axis in range(len(INPUTS)):
        rows = np.moveaxis(table, axis, -1)
        falling = np.maximum.accumulate((rows - steps)[..., ::-1], axis=-1)[..., ::-1] + steps
        table = np.moveaxis(np.maximum.accumulate(falling, axis=-1), -1, axis)
    return table


def _filled(known: Known, elsewhere: int) -> TermArray:
    table = np.full(SHAPE, elsewhere, dtype=np.int8)
    for antecedent, risk in known.items():
        table[antecedent] = risk
    return table


def _frozen(
    consequent: TermArray, lower: TermArray, upper: TermArray, origin: TermArray
) -> RuleTable:
    for array in (consequent, lower, upper, origin):
        array.setflags(write=False)
    return RuleTable(consequent, lower, upper, origin)
