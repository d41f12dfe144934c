"""Mamdani inference over a rule table: min for AND, max to aggregate, exact centroid."""

from collections.abc import Sequence
from math import isnan

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.fuzzy.centroid import centroid, risk_shapes
from fuzzynav_mj.fuzzy.completion import NO_RULE, RuleTable
from fuzzynav_mj.fuzzy.membership import DistanceTerm, Memberships
from fuzzynav_mj.fuzzy.rules import INPUTS
from fuzzynav_mj.types import FloatArray, IntArray

_INPUTS, _TERMS = len(INPUTS), len(DistanceTerm)  # compiled code knows numbers only


class MamdaniEngine:
    """Risk of six distances. Holds no state that a call changes.

    At most two terms of an input are active, so at most 64 of the 4096 rules fire.
    """

    def __init__(self, table: RuleTable, memberships: Memberships) -> None:
        self._consequents = table.consequent.ravel().astype(np.intp)
        self._distance_ramps = np.array(memberships.distance_ramps, dtype=np.float64)
        self._shapes = risk_shapes(memberships)

    def risk(self, distances: Sequence[float]) -> float:
        """Risk in [0, 100] of the six distances, m, in the order of `INPUTS`.

        Distances outside [0, 1] count as the nearer end. The risk is nan if a distance is nan or
        no rule fires.
        """
        return float(self.risks(np.array((distances,), dtype=np.float64))[0])

    def risks(self, distances: FloatArray) -> FloatArray:
        """Risks (n,) of distances (n, 6), m, columns in the order of `INPUTS`; rules as in `risk`.

        Raises:
            FuzzyNavError: if the array is not of shape (n, 6).
        """
        rows = np.ascontiguousarray(distances, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] != len(INPUTS):
            raise FuzzyNavError(
                f"distances: got an array of shape {rows.shape}, need (n, {len(INPUTS)}) with the "
                f"columns {', '.join(INPUTS)}"
            )
        shapes = self._shapes
        return _risks(rows, self._distance_ramps, self._consequents, shapes.terms, shapes.ramps)


@compiled
def _risks(
    rows: FloatArray,
    distance_ramps: FloatArray,
    consequents: IntArray,
    terms: FloatArray,
    ramps: FloatArray,
) -> FloatArray:
    """(n,) risks of distances (n, 6).

    Args:
        rows: (n, 6) distances, m.
        distance_ramps: (3, 2) as in `Memberships`.
        consequents: (4096,) of all combinations of terms, the last input's running fastest.
        terms, ramps: as in `RiskShapes`.
    """
    risks = np.empty(len(rows))
    for k in range(len(rows)):
        risks[k] = centroid(_strengths(rows[k], distance_ramps, consequents), terms, ramps)
    return risks


@compiled
def _strengths(row: FloatArray, distance_ramps: FloatArray, consequents: IntArray) -> FloatArray:
    """(6,) strengths of the five `RiskTerm`s, and of `NO_RULE`, for distances (6,), m; all 0 if one
    of them is nan.

    A rule fires at the smallest grade of its terms, a consequent at the largest of its rules'.
    """
    strengths = np.zeros(NO_RULE + 1)
    cells, grades = np.zeros(2**_INPUTS, dtype=np.intp), np.ones(2**_INPUTS)
    count = 1  # combinations of the terms that are active
    for i in range(_INPUTS):
        if isnan(row[i]):
            return strengths
        # Of Close, Medium, Far and Very Far at most two neighbours, on their ramp, are active.
        near = _TERMS
        far_grade = 1.0
        while far_grade == 1.0 and near > 1:
            near -= 1
            start, end = distance_ramps[_TERMS - 1 - near]
            far_grade = (min(max(row[i], start), end) - start) / (end - start)
        for c in range(count):
            cell, grade = cells[c] * _TERMS + near, grades[c]
            cells[c], grades[c] = cell, min(grade, 1.0 - far_grade)
            cells[count + c], grades[count + c] = cell - 1, min(grade, far_grade)
        count *= 2
    for c in range(count):
        consequent = consequents[cells[c]]
        strengths[consequent] = max(strengths[consequent], grades[c])
    return strengths
