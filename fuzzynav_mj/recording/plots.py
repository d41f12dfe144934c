"""The curves of a recording, and the colours of the behaviours."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fuzzynav_mj.recording import colours, tracks
from fuzzynav_mj.recording.colours import Colour
from fuzzynav_mj.types import Behaviour, FloatArray, IntArray, StepRecord

FUZZY_INPUTS = {
    "LS": colours.SKY_BLUE,
    "FS": colours.GREEN,
    "RS": colours.BLUE,
    "LD": colours.YELLOW,
    "FD": colours.VERMILLION,
    "RD": colours.ORANGE,
}
BEHAVIOURS = {
    Behaviour.GOAL_SEEKING: colours.GREEN,
    Behaviour.STATIC_AVOIDANCE: colours.SKY_BLUE,
    Behaviour.DYNAMIC_AVOIDANCE: colours.ORANGE,
    Behaviour.MOVING_AWAY: colours.YELLOW,
    Behaviour.BOUNDARY_FOLLOWING: colours.BLUE,
    Behaviour.WAITING: colours.GREY,
    Behaviour.EVASION: colours.VERMILLION,
    Behaviour.TURNING_ON_GOAL: colours.PURPLE,
}
WHEELS = {
    "left, commanded": colours.SKY_BLUE,
    "left": colours.BLUE,
    "right, commanded": colours.YELLOW,
    "right": colours.ORANGE,
}

TITLES = {
    "risk": "Risk of the next position (0 to 100)",
    "fuzzy_inputs": "Fuzzy inputs (m): left, front, right; static, dynamic",
    "clearance": "Gap to the nearest obstacle (m)",
    "wheels": "Wheel speeds (rad/s)",
}
# Corners that the curves seldom visit: what happens at the end of a run matters most.
LEGENDS: dict[str, Literal["LeftTop", "LeftBottom"]] = {
    "risk": "LeftTop",
    "fuzzy_inputs": "LeftBottom",
    "clearance": "LeftBottom",
    "wheels": "LeftBottom",
}


@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """Curves over the same steps.

    Attributes:
        entity: where they are kept; its first part names the plot that shows them.
        names: (k,) as the plot's legend shows them.
        colours: (k,) of the curves.
        steps: (rows,) decision of each row, counted from 0.
        times: (rows,) simulated time of each row, s.
        values: (rows, k).
        as_points: True to draw separate points instead of lines.
    """

    entity: str
    names: tuple[str, ...]
    colours: tuple[Colour, ...]
    steps: IntArray
    times: FloatArray
    values: FloatArray
    as_points: bool = False


def all_curves(steps: Sequence[StepRecord], end_time: float, risk_limit: float) -> list[Curves]:
    """Every curve of an episode that ended at `end_time`, s; empty ones are left out."""
    found = [*_risk(steps, risk_limit), _inputs(steps), _clearance(steps), _wheels(steps, end_time)]
    return [curves for curves in found if len(curves.steps)]


def _times(steps: Sequence[StepRecord]) -> FloatArray:
    return np.array([step.time for step in steps], dtype=np.float64)


def _risk(steps: Sequence[StepRecord], limit: float) -> list[Curves]:
    risk = np.array([step.decision.risk for step in steps], dtype=np.float64)
    vetoed = np.array([step.decision.vetoed for step in steps], dtype=np.bool_)
    times, known = _times(steps), np.isfinite(risk)
    gated, changed = np.flatnonzero(known), np.flatnonzero(known & vetoed)
    ends = gated[[0, -1]] if len(gated) > 1 else gated

    def curve(name: str, label: str, colour: Colour, at: IntArray, values: FloatArray) -> Curves:
        points = name == "vetoes"
        return Curves(f"/risk/{name}", (label,), (colour,), at, times[at], values[:, None], points)

    limits = np.full(len(ends), limit)
    return [
        curve("taken", "risk of the next position", colours.SKY_BLUE, gated, risk[gated]),
        curve("limit", f"limit of the gate: {limit:g}", colours.VERMILLION, ends, limits),
        curve("vetoes", "changed by the gate", colours.YELLOW, changed, risk[changed]),
    ]


def _inputs(steps: Sequence[StepRecord]) -> Curves:
    values = tracks.fuzzy_inputs(steps, tuple(FUZZY_INPUTS))
    given = np.flatnonzero(np.isfinite(values).all(axis=1))
    names, inks = tuple(FUZZY_INPUTS), tuple(FUZZY_INPUTS.values())
    return Curves("/fuzzy_inputs", names, inks, given, _times(steps)[given], values[given])


def _clearance(steps: Sequence[StepRecord]) -> Curves:
    gaps = np.array([step.clearance for step in steps], dtype=np.float64)
    finite = np.flatnonzero(np.isfinite(gaps))  # infinite where there is nothing to touch
    names = ("gap to the nearest obstacle (m)",)
    times = _times(steps)[finite]
    return Curves("/clearance", names, (colours.GREEN,), finite, times, gaps[finite, None])


def _wheels(steps: Sequence[StepRecord], end_time: float) -> Curves:
    speeds = [
        (s.wheel_command.left, s.wheel_actual.left, s.wheel_command.right, s.wheel_actual.right)
        for s in steps
    ]
    return Curves(
        "/wheels",
        tuple(WHEELS),
        tuple(WHEELS.values()),
        np.arange(len(steps)),
        np.append(_times(steps)[1:], end_time)[: len(steps)],  # they are of the periods' ends
        np.array(speeds, dtype=np.float64).reshape(-1, len(WHEELS)),
    )
