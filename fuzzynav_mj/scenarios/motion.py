"""How obstacles move: along scripted routes, or around closed curves."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, Protocol

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.types import FloatArray

Repeat = Literal["reverse", "loop", "once"]
Interpolation = Literal["linear", "catmull-rom"]


class Motion(Protocol):
    """A translation over time; obstacles do not turn."""

    def positions(self, times: FloatArray) -> FloatArray:
        """Return the (n, 2) places of the obstacle's origin, world frame, at (n,) `times`, s."""


@dataclass(frozen=True, slots=True)
class Mover:
    """A moving obstacle: its shape in its own frame, and its motion."""

    shape: Shape
    motion: Motion


@dataclass(frozen=True, eq=False)
class RouteMotion:
    """A timed route that is run once, again and again, or there and back.

    Attributes:
        times: (k,) strictly increasing times of the knots, s.
        points: (k, 2) knots, world frame, m.
        tangents: (k, 2) velocities at the knots for a cubic Hermite course; None for straight legs.
        repeat: what follows the last knot: stop there (`once`), begin anew at the first knot
            (`loop`), or run the route backwards (`reverse`).
        phase: time into the motion at time 0, s. Where `repeat` is `once`, a negative phase
            delays the departure.
    """

    times: FloatArray
    points: FloatArray
    tangents: FloatArray | None
    repeat: Repeat
    phase: float

    @property
    def period(self) -> float:
        """Time after which the motion repeats itself, or ends where `repeat` is `once`, s."""
        duration = float(self.times[-1] - self.times[0])
        return 2 * duration if self.repeat == "reverse" else duration

    def positions(self, times: FloatArray) -> FloatArray:
        """Return the (n, 2) places at (n,) `times`; see `Motion`."""
        first, duration = self.times[0], self.times[-1] - self.times[0]
        if duration == 0.0:
            return np.repeat(self.points[:1], len(times), axis=0)
        elapsed = np.asarray(times, dtype=float) + self.phase - first
        if self.repeat == "once":
            elapsed = np.clip(elapsed, 0.0, duration)
        elif self.repeat == "loop":
            elapsed = np.mod(elapsed, duration)
        else:
            elapsed = duration - np.abs(np.mod(elapsed, 2 * duration) - duration)
        if self.tangents is not None:
            course: FloatArray = self._spline(first + elapsed)
            return course
        return np.column_stack(
            [np.interp(first + elapsed, self.times, self.points[:, axis]) for axis in (0, 1)]
        )

    @cached_property
    def _spline(self) -> CubicHermiteSpline:
        return CubicHermiteSpline(self.times, self.points, self.tangents)


def waypoint_motion(
    waypoints: FloatArray, speed: float, repeat: Repeat = "reverse", phase: float = 0.0
) -> RouteMotion:
    """Follow straight legs between (k, 2) `waypoints` at one `speed`, with instant turns.

    `loop` adds the leg from the last waypoint back to the first.
    """
    points = np.asarray(waypoints, dtype=float)
    if repeat == "loop":
        points = np.vstack([points, points[:1]])
    legs = np.hypot(*np.diff(points, axis=0).T)
    points = points[np.concatenate([[True], legs > 0.0])]
    if speed == 0.0 or len(points) == 1:
        return RouteMotion(np.zeros(1), points[:1], None, repeat, phase)
    times = np.concatenate([[0.0], np.cumsum(legs[legs > 0.0])]) / speed
    return RouteMotion(times, points, None, repeat, phase)


def keyframe_motion(
    keyframes: Sequence[Sequence[float]] | FloatArray,
    interpolation: Interpolation = "linear",
    repeat: Repeat = "reverse",
    phase: float = 0.0,
) -> RouteMotion:
    """Be at given places at given times: (k, 3) rows of time, x, y with increasing times.

    `catmull-rom` gives every inner knot the velocity of the chord between its neighbours.
    `loop` returns from a last place that differs from the first at the mean speed of the
    keyframed motion, so that no obstacle jumps.
    """
    frames = np.asarray(keyframes, dtype=float)
    times, points = frames[:, 0], frames[:, 1:]
    if repeat == "loop":
        gap = float(np.hypot(*(points[0] - points[-1])))
        if gap > 0.0:
            length = float(np.hypot(*np.diff(points, axis=0).T).sum())
            there = times[-1] + gap * float(times[-1] - times[0]) / length
            if there > times[-1]:  # a gap of next to nothing takes no time
                times = np.append(times, there)
                points = np.vstack([points, points[:1]])
    tangents = None
    if interpolation == "catmull-rom":
        tangents = _catmull_rom_tangents(times, points, closed=repeat == "loop")
    return RouteMotion(times, points, tangents, repeat, phase)


def _catmull_rom_tangents(times: FloatArray, points: FloatArray, closed: bool) -> FloatArray:
    tangents = np.empty_like(points)
    tangents[1:-1] = (points[2:] - points[:-2]) / (times[2:] - times[:-2])[:, None]
    first, last = np.diff(times)[[0, -1]]
    if closed:
        tangents[0] = tangents[-1] = (points[1] - points[-2]) / (first + last)
    else:
        tangents[0] = (points[1] - points[0]) / first
        tangents[-1] = (points[-1] - points[-2]) / last
    return tangents


@dataclass(frozen=True, eq=False)
class ClosedCurveMotion:
    """Constant speed around a smooth closed curve.

    Attributes:
        knots: (k, 2) points on the curve at equal steps of arc length, the first not repeated.
        length: of the curve, m.
        speed: m/s; negative to go around the other way.
        offset: arc length from the first knot at time 0, m.
    """

    knots: FloatArray
    length: float
    speed: float
    offset: float

    def positions(self, times: FloatArray) -> FloatArray:
        """Return the (n, 2) places at (n,) `times`; see `Motion`."""
        arc = np.mod(self.offset + self.speed * np.asarray(times, dtype=float), self.length)
        course: FloatArray = self._spline(arc)
        return course

    @cached_property
    def _spline(self) -> CubicSpline:
        closed = np.vstack([self.knots, self.knots[:1]])
        arcs = np.linspace(0.0, self.length, len(closed))
        return CubicSpline(arcs, closed, bc_type="periodic")
