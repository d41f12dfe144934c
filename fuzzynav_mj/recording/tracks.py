"""The steps of an episode as arrays over time."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fuzzynav_mj.types import (
    CandidateSet,
    Decision,
    EpisodeRecord,
    FloatArray,
    IntArray,
    PerceivedObstacle,
    StepRecord,
)

PREDICTION_TIME = 1.5  # s of a perceived obstacle's motion that is drawn


@dataclass(frozen=True, slots=True, eq=False)
class Ragged:
    """A varying number of rows per step.

    Attributes:
        values: (sum of lengths, ...) the steps' rows one after another.
        lengths: (n,) rows of each step.
    """

    values: FloatArray
    lengths: IntArray


@dataclass(frozen=True, slots=True)
class Event:
    """Something worth a line of text.

    Attributes:
        step: decision it belongs to, counted from 0.
        time: simulated time, s.
        level: INFO, WARN or ERROR.
        text: one line.
    """

    step: int
    time: float
    level: str
    text: str


def ragged(rows: Iterable[FloatArray], shape: tuple[int, ...]) -> Ragged:
    """Join the steps' rows, each of them (any number, *shape)."""
    arrays = [np.asarray(row, dtype=np.float64).reshape(-1, *shape) for row in rows]
    lengths = np.array([len(array) for array in arrays], dtype=np.intp)
    return Ragged(np.concatenate([np.empty((0, *shape)), *arrays]), lengths)


def poses(steps: Sequence[StepRecord]) -> FloatArray:
    """(n, 3) x, y, yaw of the footprint's centre."""
    return np.array([(s.pose.x, s.pose.y, s.pose.yaw) for s in steps]).reshape(-1, 3)


def mover_positions(steps: Sequence[StepRecord], movers: int) -> FloatArray:
    """(n, movers, 2) origins of the moving obstacles."""
    return np.array([s.mover_positions for s in steps], dtype=np.float64).reshape(
        len(steps), movers, 2
    )


def hit_points(steps: Sequence[StepRecord]) -> Ragged:
    """Where the rays hit something, rows (x, y) in the world frame."""

    def hits(step: StepRecord) -> FloatArray:
        if step.scan is None:
            return np.empty((0, 2))
        scan = step.scan
        return np.array([scan.bearings[scan.hit], scan.ranges[scan.hit]]).T

    polar = ragged(map(hits, steps), (2,))
    x, y, yaw = np.repeat(poses(steps), polar.lengths, axis=0).T
    bearings, ranges = polar.values.T
    points = np.column_stack(
        [x + ranges * np.cos(yaw + bearings), y + ranges * np.sin(yaw + bearings)]
    )
    return Ragged(points, polar.lengths)


def predicted_paths(steps: Sequence[StepRecord]) -> Ragged:
    """Where the perceived dynamic obstacles are expected to go.

    Rows (2, 2): the nearest point, and its way within `PREDICTION_TIME`, world frame.
    """

    def moving(step: StepRecord) -> list[PerceivedObstacle]:
        seen = step.perception.obstacles if step.perception else ()
        return [obstacle for obstacle in seen if obstacle.dynamic]

    return ragged(
        (
            np.array([(o.nearest_point, PREDICTION_TIME * o.velocity) for o in moving(step)])
            for step in steps
        ),
        (2, 2),
    )


def candidates(steps: Sequence[StepRecord]) -> Ragged:
    """The next positions that were weighed: rows (x, y, risk, admissible as 0 or 1)."""

    def table(found: CandidateSet | None) -> FloatArray:
        if found is None:
            return np.empty((0, 4))
        return np.column_stack([found.positions, found.risk, found.admissible])

    return ragged((table(step.decision.candidates) for step in steps), (4,))


def next_positions(steps: Sequence[StepRecord]) -> Ragged:
    """The next positions taken: one row (x, y) each."""
    return ragged((np.array(step.decision.next_position) for step in steps), (2,))


def subgoals(steps: Sequence[StepRecord]) -> Ragged:
    """The points in sight that the robot headed for: no or one row (x, y)."""
    return ragged((np.array(step.decision.subgoal or ()) for step in steps), (2,))


def fuzzy_inputs(steps: Sequence[StepRecord], names: Sequence[str]) -> FloatArray:
    """(n, 6) the fuzzy inputs in the order of `names`; nan for decisions without a gate."""
    given = [step.decision.inputs for step in steps]
    rows = [[getattr(i, name) if i else math.nan for name in names] for i in given]
    return np.array(rows, dtype=np.float64).reshape(-1, len(names))


def behaviour_changes(steps: Sequence[StepRecord]) -> list[int]:
    """Steps whose behaviour differs from that of the step before; the first step is one."""
    kinds = [None, *(step.decision.behaviour for step in steps)]
    return [index for index, (old, new) in enumerate(pairwise(kinds)) if old is not new]


def events(steps: Sequence[StepRecord], record: EpisodeRecord, risk_limit: float) -> list[Event]:
    """What is worth a line, in order of time.

    Changes of behaviour, vetoes, new notes, contacts and the outcome; and the first decision of
    each run of decisions that took a risk above `risk_limit` for want of an alternative.
    """
    changes = set(behaviour_changes(steps))
    found = []
    note, was_cornered = "", False
    for index, step in enumerate(steps):
        for level, text in _decision_texts(step.decision, index in changes, note):
            found.append(Event(index, step.time, level, text))
        cornered = _cornered(step.decision, risk_limit)
        if cornered and not was_cornered:
            text = f"risk {step.decision.risk:.0f}: no alternative below {risk_limit:g}"
            found.append(Event(index, step.time, "WARN", text))
        note, was_cornered = step.decision.note, cornered
    end = max(len(steps) - 1, 0)
    for contact in record.contacts:
        fault = "the robot moved" if contact.at_fault else "the robot stood"
        text = f"contact with {contact.with_}; {fault} ({contact.robot_speed_mps:.2f} m/s)"
        found.append(Event(end, contact.time_s, "ERROR", text))
    level = "INFO" if record.outcome.value == "goal_reached" else "ERROR"
    text = f"the episode ends: {spoken(record.outcome.value)}"
    return [*found, Event(end, record.sim_time_s, level, text)]


def spoken(name: str) -> str:
    """An identifier as words."""
    return name.replace("_", " ")


def _cornered(decision: Decision, risk_limit: float) -> bool:
    """True if the risk is above the limit and that of every admissible alternative too.

    Alternatives whose risk was not evaluated do not count: the gate did not have them to choose.
    """
    found = decision.candidates
    if found is None or not decision.risk > risk_limit:
        return False
    return not np.any(found.admissible & (found.risk <= risk_limit))


def _decision_texts(
    decision: Decision, changed: bool, previous_note: str
) -> Iterable[tuple[str, str]]:
    if changed:
        yield "INFO", f"behaviour: {spoken(decision.behaviour.value)}"
    if decision.vetoed:
        yield "WARN", f"the gate changed the next position; its risk is now {decision.risk:.0f}"
    if decision.note and decision.note != previous_note:
        yield "INFO", decision.note
    if decision.give_up:
        yield "ERROR", f"the planner gives up: {spoken(decision.give_up)}"
