"""Mamdani inference over a rule table: min for AND, max to aggregate, exact centroid."""

from collections.abc import Sequence

import numpy as np

from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.fuzzy.centroid import Centroid
from fuzzynav_mj.fuzzy.completion import NO_RULE, RuleTable
from fuzzynav_mj.fuzzy.membership import DistanceTerm, Memberships, RiskTerm, ramp_fractions
from fuzzynav_mj.fuzzy.rules import INPUTS
from fuzzynav_mj.types import FloatArray

_STRIDES = tuple(len(DistanceTerm) ** (len(INPUTS) - 1 - i) for i in range(len(INPUTS)))
_ROWS_AT_ONCE = 2048  # keeps the (rows, 64) intermediates of a batch near one megabyte


class MamdaniEngine:
    """Risk of six distances. Holds no state that a call changes.

    At most two terms of an input are active, so at most 64 of the 4096 rules fire.
    """

    def __init__(self, table: RuleTable, memberships: Memberships) -> None:
        self._consequents = table.consequent.tobytes()  # int8 0..5, indexed by the flat cell
        self._consequent_array = table.consequent.ravel().astype(np.uint8)
        self._ramps = memberships.distance_ramps
        self._centroid = Centroid(memberships)

    def risk(self, distances: Sequence[float]) -> float:
        """Risk in [0, 100] of the six distances, m, in the order of `INPUTS`.

        Distances outside [0, 1] count as the nearer end. The risk is nan if a distance is nan or
        no rule fires.
        """
        return self._centroid.of(self.strengths(distances))

    def strengths(self, distances: Sequence[float]) -> list[float]:
        """Strengths of the five `RiskTerm`s; all 0 if a distance is nan or no rule fires.

        Where an input lies on a ramp, call its grades major (>= 1/2) and minor (<= 1/2). A rule
        over major terms alone fires at the smallest major grade, which is 1 - the largest minor
        one; any other rule fires at the smallest of its minor grades. So, taking the inputs by
        falling minor grade, the rules that the next input adds all fire at its minor grade, and a
        consequent that has been met before is no longer raised.
        """
        (a0, b0), (a1, b1), (a2, b2) = self._ramps
        cell = 0
        minors: list[tuple[float, int]] = []
        for x, stride in zip(distances, _STRIDES, strict=True):
            # Very Far adds 0 strides to the cell, Far 1, Medium 2, Close 3.
            if x >= b2:
                continue
            if x > a2:
                term, rising = 0, (x - a2) / (b2 - a2)
            elif x >= b1:
                cell += stride
                continue
            elif x > a1:
                term, rising = 1, (x - a1) / (b1 - a1)
            elif x >= b0:
                cell += 2 * stride
                continue
            elif x > a0:
                term, rising = 2, (x - a0) / (b0 - a0)
            elif x <= a0:
                cell += 3 * stride
                continue
            else:
                return [0.0] * len(RiskTerm)
            if rising >= 0.5:
                cell += term * stride
                minors.append((1.0 - rising, stride))
            else:
                cell += (term + 1) * stride
                minors.append((rising, -stride))

        consequents = self._consequents
        minors.sort(reverse=True)
        strengths = [0.0] * (NO_RULE + 1)
        strengths[consequents[cell]] = 1.0 - minors[0][0] if minors else 1.0
        cells = [cell]
        for grade, step in minors:
            added = [c + step for c in cells]
            for c in added:
                if not strengths[consequents[c]]:
                    strengths[consequents[c]] = grade
            cells += added
        return strengths[:NO_RULE]

    def risks(self, distances: FloatArray) -> FloatArray:
        """Risks (n,) of distances (n, 6), m, columns in the order of `INPUTS`; rules as in `risk`.

        Raises:
            FuzzyNavError: if the array is not of shape (n, 6).
        """
        rows = np.asarray(distances, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] != len(INPUTS):
            raise FuzzyNavError(
                f"distances: got an array of shape {rows.shape}, need (n, {len(INPUTS)}) with the "
                f"columns {', '.join(INPUTS)}"
            )
        risks = np.empty(len(rows))
        for start in range(0, len(rows), _ROWS_AT_ONCE):
            part = slice(start, start + _ROWS_AT_ONCE)
            risks[part] = self._centroid.of_rows(self._strength_rows(rows[part]))
        return risks

    def _strength_rows(self, rows: FloatArray) -> FloatArray:
        """Strengths (n, 5) of the `RiskTerm`s: all 64 rules of each row, weighed one by one."""
        fractions = ramp_fractions(rows, self._ramps)
        ramp = (fractions[..., :-1] >= 1.0).sum(axis=-1)  # (n, 6): the first incomplete one
        far = np.take_along_axis(fractions, ramp[..., None], axis=-1)[..., 0]
        near = 1.0 - far
        near_term = len(self._ramps) - ramp

        cells = (near_term * np.array(_STRIDES)).sum(axis=1, keepdims=True)
        weights = np.ones((len(rows), 1))
        for i, stride in enumerate(_STRIDES):
            cells = np.concatenate([cells, cells - stride], axis=1)
            weights = np.concatenate(
                [np.minimum(weights, near[:, i, None]), np.minimum(weights, far[:, i, None])],
                axis=1,
            )
        consequents = self._consequent_array[cells]
        strengths = np.stack(
            [np.where(consequents == risk, weights, 0.0).max(axis=1) for risk in RiskTerm], axis=1
        )
        strengths[np.isnan(rows).any(axis=1)] = 0.0
        return strengths
