"""Terms of the fuzzy variables and their trapezoids, Eqs. (18)-(24).

The paper gives the shapes in figures only, without numbers: every breakpoint here is a choice of
this project, tied to the sensor's rings and open to configuration.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from itertools import pairwise
from typing import Self

import numpy as np

from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.types import FloatArray

Ramp = tuple[float, float]

RISK_MAX = 100.0  # Eq. (24): risk lies in [0, 100]
DISTANCE_MAX = 1.0  # Eqs. (18)-(23): distances lie in [0, 1] m


class DistanceTerm(IntEnum):
    """Term of a distance, in the order of growing danger."""

    VF = 0  # very far
    F = 1  # far
    M = 2  # medium
    C = 3  # close


class RiskTerm(IntEnum):
    """Term of the risk, in the order of growing danger."""

    VL = 0  # very low
    L = 1  # low
    N = 2  # normal
    H = 3  # high
    VH = 4  # very high


@dataclass(frozen=True, slots=True)
class Trapezoid:
    """Membership function that rises over [a, b], is 1 on [b, c] and falls over [c, d]."""

    a: float
    b: float
    c: float
    d: float

    def grade(self, x: float) -> float:
        """Membership of `x`, in [0, 1]; nan for nan."""
        if x != x:
            return x
        if self.b <= x <= self.c:
            return 1.0
        if x <= self.a or x >= self.d:
            return 0.0
        if x < self.b:
            return (x - self.a) / (self.b - self.a)
        return 1.0 - (x - self.c) / (self.d - self.c)


@dataclass(frozen=True, slots=True)
class Memberships:
    """Breakpoints of the fuzzy variables.

    Neighbouring terms share a ramp, over which one falls from 1 to 0 while the next rises from 0
    to 1. So the grades of any value add up to 1 and at most two terms are active at a time.

    Attributes:
        distance_ramps: (start, end) of the ramps Close-Medium, Medium-Far and Far-Very Far, m,
            inside [0, 1]; the same for all six inputs.
        risk_ramps: (start, end) of the ramps VL-L, L-N, N-H and H-VH, inside [0, 100]. The default
            puts the centroids of the five whole terms at exactly 7, 28.5, 50, 71.5 and 93.

    Raises:
        FuzzyNavError: if the number of ramps is wrong, or a ramp does not rise, overlaps the one
            before it or leaves the variable's range.
    """

    distance_ramps: tuple[Ramp, Ramp, Ramp] = ((0.20, 0.35), (0.45, 0.55), (0.65, 0.80))
    risk_ramps: tuple[Ramp, Ramp, Ramp, Ramp] = (
        (9.0, 18.0),
        (39.0, 48.0),
        (52.0, 61.0),
        (82.0, 91.0),
    )

    def __post_init__(self) -> None:
        _check_ramps("distance_ramps", self.distance_ramps, len(DistanceTerm) - 1, DISTANCE_MAX)
        _check_ramps("risk_ramps", self.risk_ramps, len(RiskTerm) - 1, RISK_MAX)

    @classmethod
    def from_rings(cls, rings: Sequence[float]) -> Self:
        """Memberships of a robot with four sensor rings, m, Eq. (9).

        Close is certain up to the first ring and Very Far from the last one on; Medium and Far
        have their cores around the two rings between, a quarter of a ring spacing to either side.
        """
        if len(rings) != 4:
            raise FuzzyNavError(f"rings: got {len(rings)} of them, the four distance terms need 4")
        inner, medium, far, outer = rings
        return cls(
            distance_ramps=(
                (inner, medium - (medium - inner) / 4),
                (medium + (far - medium) / 4, far - (far - medium) / 4),
                (far + (outer - far) / 4, outer),
            )
        )

    @property
    def distance_terms(self) -> Mapping[DistanceTerm, Trapezoid]:
        """Trapezoids of the distance terms, m, Very Far first."""
        shapes = _trapezoids(self.distance_ramps, DISTANCE_MAX)
        return dict(zip(DistanceTerm, reversed(shapes), strict=True))

    @property
    def risk_terms(self) -> Mapping[RiskTerm, Trapezoid]:
        """Trapezoids of the risk terms, Very Low first."""
        return dict(zip(RiskTerm, _trapezoids(self.risk_ramps, RISK_MAX), strict=True))

    def distance_grades(self, distances: FloatArray) -> FloatArray:
        """Grades (..., 4) of distances (...), m, in the order of `DistanceTerm`; nan for nan.

        Values outside [0, 1] have the grades of the nearer end.
        """
        return _grades(distances, self.distance_ramps)[..., ::-1]

    def risk_grades(self, risks: FloatArray) -> FloatArray:
        """Grades (..., 5) of risks (...), in the order of `RiskTerm`; nan for nan."""
        return _grades(risks, self.risk_ramps)


def _grades(values: FloatArray, ramps: Sequence[Ramp]) -> FloatArray:
    start, end = np.asarray(ramps, dtype=np.float64).T
    # How much of each ramp lies below each value.
    values = np.asarray(values, dtype=np.float64)[..., None]
    fractions = (np.clip(values, start, end) - start) / (end - start)
    passed = np.concatenate([np.ones_like(fractions[..., :1]), fractions], axis=-1)
    ahead = np.concatenate([fractions, np.zeros_like(fractions[..., :1])], axis=-1)
    # A ramp is entered only after the one before it is complete, so one of the two is 0 or 1.
    grades: FloatArray = passed - ahead
    return grades


def _trapezoids(ramps: Sequence[Ramp], high: float) -> tuple[Trapezoid, ...]:
    knots = [(0.0, 0.0), *ramps, (high, high)]
    return tuple(Trapezoid(*left, *right) for left, right in pairwise(knots))


def _check_ramps(name: str, ramps: Sequence[Ramp], count: int, high: float) -> None:
    if len(ramps) != count:
        raise FuzzyNavError(f"{name}: got {len(ramps)} ramps, need {count}")
    floor = 0.0
    for index, (start, end) in enumerate(ramps):
        if not floor <= start < end <= high:
            raise FuzzyNavError(
                f"{name}[{index}]: got ({start}, {end}), need {floor} <= start < end <= {high:g}"
            )
        floor = end


DEFAULT_MEMBERSHIPS = Memberships()
