"""A world of line segments, the scans of it, and a point that follows the guidance through it."""

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot, pi

import numpy as np

from fuzzynav_mj.planners.guidance import Guidance, Heading
from fuzzynav_mj.planners.sight import Sight, thin
from fuzzynav_mj.types import FloatArray

Point = tuple[float, float]

RANGE = 0.8
RAYS = 180
STEP = 0.05  # m per decision
TOLERANCE = 0.1


def outline(*corners: Point) -> FloatArray:
    """(k, 2, 2) sides of the polygon with these corners."""
    at = np.array(corners)
    return np.stack((at, np.roll(at, -1, axis=0)), axis=1)


def box(x_min: float, y_min: float, x_max: float, y_max: float) -> FloatArray:
    """(4, 2, 2) sides of a rectangle."""
    return outline((x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max))


def walls(*sides: FloatArray) -> FloatArray:
    """(k, 2, 2) all of the sides together."""
    return np.concatenate(sides)


def cast(sides: FloatArray, place: Point, bearings: FloatArray) -> FloatArray:
    """(n,) distance of the first of the sides (k, 2, 2) on each bearing, RANGE for none."""
    start = sides[:, 0] - np.array(place)
    along = sides[:, 1] - sides[:, 0]
    ray = np.stack((np.cos(bearings), np.sin(bearings)), axis=1)[:, None]
    across = ray[..., 0] * along[:, 1] - ray[..., 1] * along[:, 0]
    with np.errstate(all="ignore"):  # parallel to a side
        distance = (start[:, 0] * along[:, 1] - start[:, 1] * along[:, 0]) / across
        share = (start[:, 0] * ray[..., 1] - start[:, 1] * ray[..., 0]) / across
    hit = (distance >= 0.0) & (share >= 0.0) & (share <= 1.0)
    ranges: FloatArray = np.where(hit, distance, RANGE).min(axis=1, initial=RANGE)
    return ranges


def sight_at(sides: FloatArray, place: Point, yaw: float = 0.0) -> Sight:
    """What a robot at `place` that faces `yaw` sees of the sides (k, 2, 2)."""
    bearings = np.arange(RAYS) * (2 * pi / RAYS) - pi + yaw
    ranges = cast(sides, place, bearings)
    hits = ranges < RANGE
    points = np.stack((np.cos(bearings), np.sin(bearings)), axis=1)[hits] * ranges[hits, None]
    return Sight(thin(points), bearings, ranges, RANGE, np.zeros(len(ranges), dtype=bool))


def distance_to(sides: FloatArray, place: Point) -> float:
    """Distance of the nearest of the sides (k, 2, 2)."""
    along = sides[:, 1] - sides[:, 0]
    offset = np.array(place) - sides[:, 0]
    share = np.clip((offset * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    return float(np.hypot(*(offset - share[:, None] * along).T).min())


@dataclass(frozen=True, slots=True)
class Walk:
    """How a point fared.

    Attributes:
        places: where it was, one per decision.
        headings: what the guidance wanted there.
        arrived: True if it ended within TOLERANCE of the goal.
        nearest_wall: smallest distance to any side.
    """

    places: list[Point]
    headings: list[Heading]
    arrived: bool
    nearest_wall: float

    @property
    def length(self) -> float:
        """m."""
        return float(np.hypot(*np.diff(np.array(self.places), axis=0).T).sum())

    def was(self, mode: str) -> bool:
        """True if the guidance was ever in this mode."""
        return any(heading.mode == mode for heading in self.headings)


Interruption = Callable[[int, Point], Point | None]


def walk(
    guidance: Guidance,
    sides: FloatArray,
    start: Point,
    goal: Point,
    steps: int,
    interruption: Interruption | None = None,
) -> Walk:
    """Follow the guidance by steps of STEP until the goal, a closed loop or the last step.

    Args:
        guidance: fresh, or in the middle of something.
        sides: (k, 2, 2) of the world.
        start: where the point begins.
        goal: where it is to arrive.
        steps: largest number of decisions.
        interruption: called with the number and place of every decision; what it returns is
            where the point goes instead, None to follow the guidance.
    """
    place, places, headings = start, [start], []
    nearest_wall = distance_to(sides, start)
    for number in range(steps):
        heading = guidance.head(place, sight_at(sides, place, yaw=0.7 * number))
        headings.append(heading)
        elsewhere = None if interruption is None else interruption(number, place)
        place = _towards(place, heading.subgoal) if elsewhere is None else elsewhere
        places.append(place)
        nearest_wall = min(nearest_wall, distance_to(sides, place))
        if hypot(goal[0] - place[0], goal[1] - place[1]) <= TOLERANCE:
            return Walk(places, headings, True, nearest_wall)
        if heading.closed_loops >= 2:
            break
    return Walk(places, headings, False, nearest_wall)


def _towards(place: Point, subgoal: Point) -> Point:
    dx, dy = subgoal[0] - place[0], subgoal[1] - place[1]
    share = min(1.0, STEP / max(hypot(dx, dy), 1e-9))
    return (place[0] + share * dx, place[1] + share * dy)
