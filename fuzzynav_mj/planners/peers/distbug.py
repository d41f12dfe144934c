"""DistBug's state: when to follow a boundary, on which side, and when to leave it again."""

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin

import numpy as np

from fuzzynav_mj.planners.reach import free_distance
from fuzzynav_mj.types import BoolArray, FloatArray

WIDTH = 0.15  # m: radius of the disc that the algorithm moves
MEET = 0.15  # m: an obstacle this near on the straight way to the goal is met
LOOK = 0.25  # m: a direction in which the disc can move so far leads along the boundary
GAIN = 0.10  # m: DistBug's STEP, how much nearer to the goal the way out must lead
DIRECTIONS = 180
BEARINGS: FloatArray = np.arange(DIRECTIONS, dtype=np.float64) * (2 * pi / DIRECTIONS) - pi
LOOP_RADIUS = 0.20  # m: how near to its first place a followed boundary counts as closed ...
LOOP_AWAY = 0.50  # ... after the robot was so far away, m


@dataclass(slots=True)
class Following:
    """The memory while following a boundary; its size is constant.

    Attributes:
        side: +1 if the robot turned left at the boundary (which stays on its right), else -1.
        edge: (x, y) a point of the boundary just beside the way taken, world frame.
        nearest: smallest distance to the goal since the boundary was met: of the point where the
            straight way meets it and of the robot, m.
        start: (x, y) and direction of travel, rad, of the first step along the boundary.
        was_away: True once the robot has been well away from `start`.
    """

    side: int
    edge: tuple[float, float]
    nearest: float
    start: tuple[float, float, float] | None = None
    was_away: bool = False


@dataclass(frozen=True, slots=True)
class Course:
    """Where to drive.

    Attributes:
        target: (x, y) world frame; the present place if no direction is free.
        following: True along a boundary.
        closed: True if a boundary has been followed all around without a way out.
    """

    target: tuple[float, float]
    following: bool
    closed: bool


class DistBug:
    """Kamon and Rivlin's DistBug (IEEE Trans. Robotics and Automation 13(6), 1997) for a disc.

    Straight to the goal until an obstacle is met at a distance d from the goal; then along its
    boundary, until the free way towards the goal leads to within the smallest distance to the goal
    so far less `GAIN`. So every obstacle is met at least `GAIN` nearer to the goal than the one
    before: boundaries are followed at most d / GAIN times, each at most once around. Coming round
    to where following began without having left proves that the goal lies behind this boundary.
    This holds for a point among finitely many standing obstacles; here it is the disc's centre.

    Args:
        goal: (x, y), world frame, m.
        tolerance: of the goal, m.
    """

    def __init__(self, goal: tuple[float, float], tolerance: float) -> None:
        self._goal = goal
        self._tolerance = tolerance
        self._following: Following | None = None

    def course(self, place: tuple[float, float], hits: FloatArray, reach: float) -> Course:
        """The course at a place.

        Args:
            place: (x, y) of the disc's centre, world frame, m.
            hits: (k, 2) robot-centred, axes parallel to the world's, m.
            reach: the sensor's range, m.
        """
        dx, dy = self._goal[0] - place[0], self._goal[1] - place[1]
        distance, to_goal = hypot(dx, dy), atan2(dy, dx)
        free = float(free_distance(hits, np.array([to_goal]), WIDTH)[0])
        if self._following is not None:
            self._following.nearest = min(self._following.nearest, distance)
            way_out = distance - min(free, reach, distance)
            if way_out <= max(self._following.nearest - GAIN, self._tolerance):
                self._following = None
        if self._following is None:
            if free >= min(MEET, distance - self._tolerance):
                return Course(self._goal, False, False)
            self._following = _met(place, to_goal, distance - free, hits)
        leads_on = free_distance(hits, BEARINGS, WIDTH) >= LOOK
        if not leads_on.any():
            return Course(place, True, False)
        chosen = _along(place, leads_on, self._following)
        if chosen is None:
            self._following = None  # what was followed is no longer there
            return Course(self._goal, False, False)
        self._following.edge = _blocking_point(place, chosen - self._following.side, hits)
        bearing = float(BEARINGS[chosen])
        closed = _has_closed(place, bearing, self._following)
        target = (place[0] + LOOK * cos(bearing), place[1] + LOOK * sin(bearing))
        return Course(target, True, closed)


def _met(place: tuple[float, float], to_goal: float, nearest: float, hits: FloatArray) -> Following:
    """Begins to follow on the side to which the turn away from the goal is the smaller one.

    Args:
        place: (x, y) of the robot, world frame.
        to_goal: direction of the goal, rad.
        nearest: distance to the goal from where the disc would touch the obstacle, m.
        hits: (k, 2) robot-centred.
    """
    leads_on = free_distance(hits, BEARINGS, WIDTH) >= LOOK
    ahead = _ray(to_goal)
    around = np.arange(DIRECTIONS)
    left = int(leads_on[(ahead + around) % DIRECTIONS].argmax())
    right = int(leads_on[(ahead - around) % DIRECTIONS].argmax())
    return Following(1 if left <= right else -1, _blocking_point(place, ahead, hits), nearest)


def _along(place: tuple[float, float], leads_on: BoolArray, following: Following) -> int | None:
    """The first direction that leads on beside the boundary; None if there is no boundary."""
    beside = _ray(atan2(following.edge[1] - place[1], following.edge[0] - place[0]))
    around = following.side * np.arange(DIRECTIONS)
    if not leads_on[beside]:
        outwards = (beside + around) % DIRECTIONS
        return int(outwards[leads_on[outwards].argmax()])
    # The boundary has ended here: look behind its end, for at most half a turn.
    inwards = ((beside - around) % DIRECTIONS)[: DIRECTIONS // 2]
    if leads_on[inwards].all():
        return None
    return int(inwards[leads_on[inwards].argmin() - 1])


def _has_closed(place: tuple[float, float], bearing: float, following: Following) -> bool:
    """True once the robot comes back to the first place, going the same way."""
    if following.start is None:
        following.start = (*place, bearing)
    x, y, first_bearing = following.start
    away = hypot(place[0] - x, place[1] - y)
    following.was_away |= away > LOOP_AWAY
    return following.was_away and away < LOOP_RADIUS and cos(bearing - first_bearing) > 0.5


def _blocking_point(place: tuple[float, float], ray: int, hits: FloatArray) -> tuple[float, float]:
    """World-frame hit that stops the disc first in a direction; the nearest beside it if none."""
    bearing = float(BEARINGS[ray % DIRECTIONS])
    along = hits[:, 0] * cos(bearing) + hits[:, 1] * sin(bearing)
    across = np.abs(hits[:, 1] * cos(bearing) - hits[:, 0] * sin(bearing))
    met = along - np.sqrt(np.maximum(WIDTH**2 - across**2, 0.0))
    beside = np.where(across < WIDTH, 0.0, 10.0 * across)
    x, y = hits[int(np.where(along > 0.0, met + beside, np.inf).argmin())].tolist()
    return (place[0] + x, place[1] + y)


def _ray(bearing: float) -> int:
    return round((bearing + pi) * DIRECTIONS / (2 * pi)) % DIRECTIONS
