"""Episodes played once more for their pictures: a benchmark keeps numbers, not ways.

The same scenario, planner and seed give the same episode, so what is drawn is what was counted;
`Trace.path_length_m` is there to be held against the row.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fuzzynav_mj.benchmark import EpisodeJob
from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.planners.headings import TURN_STEP
from fuzzynav_mj.planners.sectors import as_fuzzy_inputs, sector_distances
from fuzzynav_mj.results import FailedEpisode
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.types import (
    Decision,
    EpisodeRecord,
    FloatArray,
    FuzzyInputs,
    Outcome,
    StepRecord,
)

SAME_RISK = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class RiskPeak:
    """The decision of an episode at which the gate saw the largest risk.

    Attributes:
        step: its number, from 0.
        risk: of the next position that the gate judged there, 0..100.
        inputs: of the fuzzy system at that next position.
        refused: True if the gate took another one.
    """

    step: int
    risk: float
    inputs: FuzzyInputs
    refused: bool


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """What the pictures need of an episode.

    Attributes:
        job: which episode.
        outcome: how it ended.
        path_length_m: as in its record.
        times: (n,) of the decisions, s.
        poses: (n, 3) x, y, yaw of the footprint's centre at the decisions.
        movers: (n, m, 2) origins of the moving obstacles.
        shapes: (m,) of the moving obstacles, each about its origin.
        risks: (n,) of the accepted next positions; nan without a gate.
        proposed: (n,) of the next positions that the gate refused; nan where it refused none.
        peak: None for planners without a gate.
    """

    job: EpisodeJob
    outcome: Outcome
    path_length_m: float
    times: FloatArray
    poses: FloatArray
    movers: FloatArray
    shapes: tuple[Shape, ...]
    risks: FloatArray
    proposed: FloatArray
    peak: RiskPeak | None


def trace_job(job: EpisodeJob) -> Trace | FailedEpisode:
    """Play an episode and keep its trace; whatever goes wrong in it is its failure."""
    from fuzzynav_mj.runner import play_episode  # in the worker: the parent needs no physics

    try:
        episode = play_episode(job.scenario, job.planner, job.seed, job.disturbance)
    except FuzzyNavError as error:
        return FailedEpisode(job.key, " ".join(str(error).split()))
    except Exception as error:
        return FailedEpisode(job.key, " ".join(f"{type(error).__name__}: {error}".split()))
    return trace_of(job, episode.record, episode.steps, [m.shape for m in episode.world.movers])


def trace_of(
    job: EpisodeJob, record: EpisodeRecord, steps: Sequence[StepRecord], shapes: Sequence[Shape]
) -> Trace:
    """The trace of an episode that was played."""
    count = len(steps)
    poses = np.array([[s.pose.x, s.pose.y, s.pose.yaw] for s in steps]).reshape(count, 3)
    movers = np.array([s.mover_positions for s in steps]).reshape(count, len(shapes), 2)
    return Trace(
        job=job,
        outcome=record.outcome,
        path_length_m=record.path_length_m,
        times=np.array([s.time for s in steps]),
        poses=poses,
        movers=movers,
        shapes=tuple(shapes),
        risks=np.array([s.decision.risk for s in steps]),
        proposed=np.array([proposed_risk(s.decision) for s in steps]),
        peak=_peak(steps),
    )


def proposed_risk(decision: Decision) -> float:
    """Risk of the next position that the gate refused; nan where it refused none."""
    first = _first_choice(decision)
    if first is None:
        return float("nan")
    assert decision.candidates is not None
    return float(decision.candidates.risk[first])


def _first_choice(decision: Decision) -> int | None:
    """Index of the candidate that the gate refused: the cheapest admissible one."""
    seen = decision.candidates
    if not decision.vetoed or seen is None or not seen.admissible.any():
        return None
    return int(np.where(seen.admissible, seen.cost, np.inf).argmin())


def _peak(steps: Sequence[StepRecord]) -> RiskPeak | None:
    """The largest risk; of equal ones a refused one, and of these the first."""
    judged = []
    for index, step in enumerate(steps):
        taken, refused = step.decision.risk, proposed_risk(step.decision)
        if step.decision.inputs is not None and taken == taken:
            top = refused if refused > taken else taken
            judged.append((round(top, 1), refused > taken, -index))
    if not judged:
        return None
    index = -max(judged)[2]
    step = steps[index]
    decision = step.decision
    accepted = decision.inputs
    assert accepted is not None
    refused = proposed_risk(decision)
    inputs = _refused_inputs(step, refused) if refused > decision.risk else None
    if inputs is None:
        return RiskPeak(index, decision.risk, accepted, False)
    return RiskPeak(index, refused, inputs, True)


def _refused_inputs(step: StepRecord, risk: float) -> FuzzyInputs | None:
    """The fuzzy inputs at the next position that the gate refused for its `risk`.

    A step keeps the inputs of the accepted position alone, so they are taken again from what was
    perceived. The direction of travel, which tells front from side, lies near that of the refused
    position; it is the one nearest to it that explains the risk. None if none does.
    """
    decision, pose, seen = step.decision, step.pose, step.perception
    first = _first_choice(decision)
    if first is None or decision.candidates is None or seen is None:
        return None
    place = decision.candidates.positions[first]
    towards = np.arctan2(place[1] - pose.y, place[0] - pose.x)
    turns = np.array(sorted(np.arange(-45, 46) * TURN_STEP, key=abs))
    rows = sector_distances(
        np.repeat(place[None], len(turns), axis=0),
        towards + turns,
        seen.obstacles,
        DEFAULT_ROBOT.decision_period,
        DEFAULT_ROBOT.sensor_range,
    )
    explained = np.abs(RiskGate().risks(rows) - risk) < SAME_RISK
    return as_fuzzy_inputs(rows[int(explained.argmax())]) if explained.any() else None
