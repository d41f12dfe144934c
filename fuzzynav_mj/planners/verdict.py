"""The fuzzy gate's verdict on the chosen next position, section 4 of the paper."""

from dataclasses import dataclass

import numpy as np

from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.planners.sectors import as_fuzzy_inputs, sector_distances
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import CandidateSet, FloatArray, FuzzyInputs, IntArray, Perception


@dataclass(frozen=True, slots=True, eq=False)
class Verdict:
    """What is taken.

    Attributes:
        chosen: number of the candidate.
        inputs: its fuzzy inputs; None without a gate.
        vetoed: True if the gate changed the next position.
    """

    chosen: int
    inputs: FuzzyInputs | None
    vetoed: bool


def verdict_on(
    chosen: int,
    candidates: CandidateSet,
    travel: FloatArray,
    seen: Perception,
    spec: RobotSpec,
    gate: RiskGate | None,
) -> Verdict:
    """The chosen candidate, or in its place the alternative of lowest risk.

    Args:
        chosen: number of the candidate that the priorities chose.
        candidates: m of them; the risks that the gate has to know are noted here.
        travel: (m,) directions of travel, rad, world frame.
        seen: what is perceived.
        spec: the robot's parameters.
        gate: None to leave it out.
    """
    risks = candidates.risk
    if gate is None:
        return Verdict(chosen, None, False)
    pick = slice(chosen, chosen + 1)
    inputs = as_fuzzy_inputs(_inputs(pick, candidates, travel, seen, spec)[0])
    risks[chosen] = gate.risk(inputs)
    if gate.accepts(float(risks[chosen])):
        return Verdict(chosen, inputs, False)
    pool = np.flatnonzero(candidates.admissible)
    if len(pool) == 0:
        return Verdict(chosen, inputs, False)
    # The gate may slow the robot, or lead it round, but a way back out is no alternative.
    cost = candidates.cost
    standing_still = min(float(cost[-1]), float(cost[pool].max()))
    onward = pool[cost[pool] <= (cost[chosen] + standing_still) / 2]
    pool = onward if len(onward) else pool
    alternatives = _inputs(pool, candidates, travel, seen, spec)
    risks[pool] = gate.risks(alternatives)
    worth = np.where(np.isnan(risks[pool]), np.inf, risks[pool])
    if np.isinf(worth).all():
        # No rule speaks of any alternative: nothing is known to be safe, so stand still.
        return Verdict(len(risks) - 1, inputs, True)
    best = int(np.lexsort((candidates.cost[pool], worth.round(1)))[0])
    taken = int(pool[best])
    return Verdict(taken, as_fuzzy_inputs(alternatives[best]), taken != chosen)


def _inputs(
    rows: IntArray | slice,
    candidates: CandidateSet,
    travel: FloatArray,
    seen: Perception,
    spec: RobotSpec,
) -> FloatArray:
    """(k, 6) fuzzy inputs of the candidates `rows`; see `verdict_on`."""
    return sector_distances(
        candidates.positions[rows],
        travel[rows],
        seen.obstacles,
        spec.decision_period,
        spec.sensor_range,
    )
