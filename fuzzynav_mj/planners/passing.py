"""The way past what moves: the cheapest way through space and time, as far as can be foreseen.

A roll-out goes straight on; whether to let a mover pass, to step aside and come back, or to run
ahead of it shows only over a longer time. Here the robot is a disc that may move in any direction
on a grid of the ground in sight, a step at a time, among movers that go on as expected. The cost
of the cheapest way on from every place (dynamic programming, backwards in time) tells what a
candidate's place is worth. It is a guide only: what is safe is decided on the roll-outs.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import cos, floor, hypot, pi, sin
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.grid import CELL, note_nearest
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.planners.sight import Sight
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

STRIDE = 3  # decision periods in a step; so many cells are driven in it at top speed
STEPS = 10
OUTLOOK = STRIDE * STEPS  # decision periods foreseen
JOINED = 3  # the step at whose end a candidate's place is judged
JUDGED = STRIDE * JOINED  # the same in decision periods
DISC = 0.12  # m: radius of the disc that stands for the footprint
ARRIVED = 0.1  # m from the target
BERTH = 0.13  # m: gap to movers below which a place costs more, now ...
BERTH_GROWTH = 0.01  # m: ... and per step
NEARBY = 0.24  # m, more than any berth: larger gaps do not matter
LEAST_GAP = 0.03  # m: a smaller one counts as contact
NO_WAY = 4.0  # m: cost of a place with no way on
LEAST_WEIGHT = 0.1  # share of the cells around a place that must have a way on, for it to have one
BLOCKED = 2.0  # m: what a place among obstacles costs more than its distance to the target


class Passing(NamedTuple):
    """What places are worth when the judged periods are over; a named tuple, which compiled
    functions take as a whole.

    Attributes:
        value: (n, n) cost of the cheapest way on from each cell, m, less the target's distance
            from the robot; `NO_WAY` where there is none.
        half: cells to each side of the robot's own.
        target: (2,) robot-centred.
    """

    value: FloatArray
    half: int
    target: FloatArray


@compiled
def worth(passing: Passing, x: FloatArray, y: FloatArray) -> FloatArray:
    """(m,) the value at places, robot-centred with axes parallel to the world's."""
    towards_x, towards_y = passing.target
    blocked = np.hypot(x - towards_x, y - towards_y) - hypot(towards_x, towards_y) + BLOCKED
    return _interpolate(passing.value, x / CELL + passing.half, y / CELL + passing.half, blocked)


@compiled
def leads_on(passing: Passing, x: float, y: float) -> bool:
    """True for a place, as in `worth`, from which there is a way on."""
    weight, _ = _mixed(passing.value, x / CELL + passing.half, y / CELL + passing.half)
    return weight > LEAST_WEIGHT


@compiled
def judged_places(judged: FloatArray, yaw: float) -> tuple[FloatArray, FloatArray]:
    """(m,) x and (m,) y, as `worth` takes them, of poses (m, 3) in the frame of a robot at this
    yaw."""
    c, s, x, y = cos(yaw), sin(yaw), judged[:, 0], judged[:, 1]
    return c * x - s * y, s * x + c * y


def ways_past(
    sight: Sight, expected: FloatArray, target: FloatArray, settings: DecisionSettings
) -> Passing:
    """The value of all places in sight.

    Args:
        sight: what stands, and what can be seen.
        expected: (OUTLOOK, k, 2) points of movers at the end of each decision period.
        target: (2,) the subgoal, robot-centred with axes parallel to the world's.
        settings: weights.
    """
    ground = _ground(sight.max_range)
    passable = _passable(ground, sight)
    left_over = np.hypot(ground.x - target[0], ground.y - target[1])
    value = _value(
        passable,
        ground.axis,
        expected,
        left_over - hypot(*target.tolist()),
        ground.rim | (left_over < ARRIVED),
        ground.moves,
        settings.passing_time * CELL * STRIDE + settings.passing_length * ground.lengths,
        settings.passing_weight,
    )
    return Passing(value, ground.half, target)


@dataclass(frozen=True, slots=True, eq=False)
class _Ground:
    """Cells around the robot and the moves of one step.

    Attributes:
        half: cells to each side of the robot's own.
        axis: (n,) coordinate of the cells in one row, m.
        x, y: (n, n) m.
        distance, bearing: (n, n) from the robot's own cell, m and rad.
        rim: (n, n) True at the edge of sight.
        moves: (k, 2) cells; as many as the top speed allows.
        lengths: (k,) m.
    """

    half: int
    axis: FloatArray
    x: FloatArray
    y: FloatArray
    distance: FloatArray
    bearing: FloatArray
    rim: BoolArray
    moves: IntArray
    lengths: FloatArray


@lru_cache(maxsize=4)
def _ground(radius: float) -> _Ground:
    half = int(radius / CELL)
    axis: FloatArray = np.arange(-half, half + 1) * np.float64(CELL)
    x, y = np.meshgrid(axis, axis, indexing="ij")
    distance = np.hypot(x, y)
    steps = range(-STRIDE, STRIDE + 1)
    moves = [(i, j) for i in steps for j in steps if i * i + j * j <= STRIDE**2]
    return _Ground(
        half=half,
        axis=axis,
        x=x,
        y=y,
        distance=distance,
        bearing=np.arctan2(y, x),
        rim=distance > radius - 1.5 * CELL,
        moves=np.array(moves, dtype=np.intp),
        lengths=CELL * np.hypot(*np.array(moves).T),
    )


def _passable(ground: _Ground, sight: Sight) -> BoolArray:
    """(n, n) True where the disc may be, as far as what stands is concerned."""
    x, y = sight.points.T
    # Where the robot stands it may stand.
    disc = min(DISC, float(np.hypot(x, y).min(initial=DISC)) - 0.02)
    seen = _seen(ground.distance, ground.bearing, sight.ranges, float(sight.bearings[0]))
    seen[ground.half, ground.half] = True
    _block(seen, ground.axis, sight.points, disc)
    return seen


@compiled
def _seen(distance: FloatArray, bearing: FloatArray, ranges: FloatArray, first: float) -> BoolArray:
    """(n, n) True for the cells at these distances and bearings that the rays (k,) reach, the
    first one at the bearing `first`."""
    seen, count = np.empty(distance.shape, dtype=np.bool_), len(ranges)
    for a in range(len(distance)):
        for b in range(len(distance)):
            turn = (bearing[a, b] - first) * (count / (2 * pi))
            seen[a, b] = distance[a, b] <= ranges[floor(turn + 0.5) % count] + 1e-9
    return seen


@compiled
def _block(passable: BoolArray, axis: FloatArray, points: FloatArray, radius: float) -> None:
    """Clears the cells that lie within the radius of a point (k, 2)."""
    squared = np.full(passable.shape, radius**2)
    for k in range(len(points)):
        note_nearest(squared, axis, points[k, 0], points[k, 1], int(radius / CELL) + 1)
    passable &= squared >= radius**2


@compiled
def _gaps(axis: FloatArray, expected: FloatArray, step: int) -> FloatArray:
    """(n, n) smallest gaps between the disc and movers around the step's end; at most `NEARBY`."""
    squared = np.full((len(axis), len(axis)), (NEARBY + DISC) ** 2)
    first = step * STRIDE - 2
    for period in range(first, min(first + STRIDE, len(expected))):
        for k in range(expected.shape[1]):
            x, y = expected[period, k, 0], expected[period, k, 1]
            note_nearest(squared, axis, x, y, int((NEARBY + DISC) / CELL))
    gaps: FloatArray = np.sqrt(squared) - DISC
    return gaps


@compiled
def _value(
    passable: BoolArray,
    axis: FloatArray,
    expected: FloatArray,
    left_over: FloatArray,
    leaves: BoolArray,
    moves: IntArray,
    tolls: FloatArray,
    crowding: float,
) -> FloatArray:
    """(n, n) cost of the cheapest way from each cell at the end of step JOINED to the last one.

    Args:
        passable: (n, n) where the disc may be.
        axis: (n,) as in `_Ground`.
        expected: (OUTLOOK, k, 2) points of movers.
        left_over: (n, n) cost of what then remains to the target.
        leaves: (n, n) True where the way may end before the last step.
        moves, tolls: (k, 2) cells and (k,) cost of each.
        crowding: cost per step and metre missing of the berth.
    """
    size = len(left_over)
    width = size + 2 * STRIDE
    ends = np.where(leaves, left_over, NO_WAY)
    # With a rim that no way leads over, row by row: a move is a shift by so many cells.
    there = np.full((width, width), np.inf)
    value = np.zeros((size, width))
    value[:, :size] = left_over
    for step in range(STEPS, JOINED, -1):
        gaps, berth = _gaps(axis, expected, step), BERTH + BERTH_GROWTH * step
        for a in range(size):
            for b in range(size):
                cost = value[a, b] + crowding * max(berth - gaps[a, b], 0.0)
                free = passable[a, b] and gaps[a, b] >= LEAST_GAP
                there[a + STRIDE, b + STRIDE] = cost if free else NO_WAY
        value[:, :size] = ends
        costs, best = there.ravel(), value.ravel()[: size * width - 2 * STRIDE]
        for m in range(len(moves)):
            first = (STRIDE + moves[m, 0]) * width + STRIDE + moves[m, 1]
            shifted, toll = costs[first : first + len(best)], tolls[m]
            for k in range(len(best)):
                best[k] = np.minimum(best[k], shifted[k] + toll)
    return np.where(passable, value[:, :size], NO_WAY)


@compiled
def _interpolate(
    value: FloatArray, x: FloatArray, y: FloatArray, blocked: FloatArray
) -> FloatArray:
    """(m,) the value between the cells, of those from which there is a way on; else `blocked`."""
    result = blocked.copy()
    for k in range(len(x)):
        weight, total = _mixed(value, x[k], y[k])
        if weight > LEAST_WEIGHT:
            result[k] = total / weight
    return result


@compiled
def _mixed(value: FloatArray, x: float, y: float) -> tuple[float, float]:
    """The share of the four cells around a place from which there is a way on, and the sum of their
    values by their shares; the place in cells."""
    last = len(value) - 2
    i, j = min(max(int(x), 0), last), min(max(int(y), 0), last)
    u, v = min(max(x - i, 0.0), 1.0), min(max(y - j, 0.0), 1.0)
    weight = total = 0.0
    for a in range(2):
        for b in range(2):
            share = (u if a else 1.0 - u) * (v if b else 1.0 - v)
            if value[i + a, j + b] < NO_WAY:
                total += share * value[i + a, j + b]
                weight += share
    return weight, total
