"""The boundary that the robot follows: what it remembers of it, and which way leads along it.

The memory is that of a bug algorithm (TangentBug, DistBug): side, where following began, and the
smallest distance to the goal.
"""

from dataclasses import dataclass
from math import asin, atan2, cos, hypot, pi, sin

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.settings import GuidanceSettings
from fuzzynav_mj.planners.sight import Sight, Ways
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

Point = tuple[float, float]  # x, y, world frame, m

BOUNDARY_GAP = 0.3  # m: parts farther from each other are different boundaries
SEEN_AGAIN = 0.1  # m: a point of a boundary is one of the hits no farther from it


@dataclass(frozen=True, slots=True)
class Alternative:
    """The way around the other end of a boundary, not taken when following began.

    Attributes:
        place: (x, y) from where it was seen.
        edge: (x, y) a point of the boundary next to it.
        cost: its length to the edge of sight and what was left from there to the goal, m.
    """

    place: Point
    edge: Point
    cost: float


@dataclass(slots=True)
class Following:
    """The memory while following a boundary; of constant size, and mutable.

    Attributes:
        side: +1 if the robot turned left at the boundary (which stays on its right), else -1.
        start: (x, y) where the robot first drove along the boundary.
        edge: (x, y) a point of the boundary next to the way taken.
        nearest: smallest distance to the goal of any point seen of the boundary, m.
        reached: smallest distance to the goal of the robot itself, and of the ways taken, while
            following, m.
        length: distance travelled along the boundary since `start`, m; driving back counts back.
        farthest: largest distance from `start` so far, m.
        direction: unit vector of the way taken last.
        began: the same at `start`.
        alternative: the way around the other side, as long as that may be tried.
        closed: True once the robot has been all around.
    """

    side: int
    start: Point
    edge: Point
    nearest: float
    reached: float
    length: float = 0.0
    farthest: float = 0.0
    direction: Point = (0.0, 0.0)
    began: Point = (0.0, 0.0)
    alternative: Alternative | None = None
    closed: bool = False

    def begin_anew(self, place: Point, distance: float) -> None:
        """Forgets what belongs to another boundary; `distance` to the goal, m."""
        self.start = place
        self.nearest = self.reached = distance
        self.length = self.farthest = 0.0
        self.alternative = None

    def turn_round(self, place: Point, other: Alternative) -> None:
        """Follows the boundary around its other side, from `place` on. Only once."""
        self.side = -self.side
        self.start, self.edge = place, other.edge
        self.length = self.farthest = 0.0
        self.direction = (0.0, 0.0)
        self.alternative = None

    def to_beat(self, settings: GuidanceSettings) -> float:
        """Distance to the goal that a way must undercut for the boundary to be left, m.

        At first that of all of the boundary that was seen, as in TangentBug, so that a pocket is
        not entered twice. Part of another obstacle may have been taken for it, though: after a
        long while the robot's own smallest distance counts, as in DistBug.
        """
        if self.length < settings.patience:
            return self.nearest - settings.gain
        # A way may keep closer to the wall than the robot did.
        return self.reached - (settings.comfortable - settings.tight) - settings.gain

    def watch(
        self, place: Point, goal: FloatArray, sight: Sight, settings: GuidanceSettings
    ) -> None:
        """Notes how near to the goal the boundary comes, as far as it is seen now.

        Args:
            place: of the robot, world frame, m.
            goal: (2,) from there, m.
            sight: what stands; there is something.
            settings: widths.
        """
        x, y = self.edge[0] - place[0], self.edge[1] - place[1]
        gap = 2 * settings.tight
        left_over = _nearest_connected(sight.points, x, y, gap, goal[0], goal[1])
        self.nearest = min(self.nearest, left_over)

    def closes(self, place: Point, gone: float, settings: GuidanceSettings) -> bool:
        """True once the robot is back where following began, and drives the same way: in a narrow
        corridor it comes by there along the other wall, too.

        Args:
            place: of the robot, world frame, m.
            gone: along the boundary since the last look, m; negative where it was driven back.
            settings: lengths.
        """
        if gone > 0.0 and self.length < settings.settling:
            # Only now does the robot drive along the boundary.
            self.start, self.began = place, self.direction
        away = hypot(place[0] - self.start[0], place[1] - self.start[1])
        same_way = self.direction[0] * self.began[0] + self.direction[1] * self.began[1] >= 0.0
        self.farthest = max(self.farthest, away)
        return (
            self.length > settings.loop_length
            and self.farthest > 2 * settings.loop_radius
            and away < settings.loop_radius
            and same_way
        )

    def along(
        self,
        place: Point,
        sight: Sight,
        ways: Ways,
        among_movers: bool,
        settings: GuidanceSettings,
    ) -> tuple[int, bool]:
        """Ray of the first way beside the boundary, and whether that is another boundary now;
        remembers its new edge.

        The edge stays where it was while a mover hides it, and where movers have driven the robot
        over to another boundary: else it would follow that one, perhaps all around.
        """
        first, chosen = _ways_beside(
            self.beside(place, sight), self.side, ways.open, ways.comfortable
        )
        edge = blocking_point(place, sight, (first - self.side) % len(sight.bearings))
        x, y = self.edge[0] - place[0], self.edge[1] - place[1]
        away, bearing = hypot(x, y), atan2(y, x)
        before = ray_at(bearing, sight)
        another = among_movers and not same_boundary(place, sight, self.edge, edge)
        if another:
            stays = bool(sight.hidden[before]) or away >= sight.max_range
            stays = stays or _is_seen(sight.points, x, y, SEEN_AGAIN)
        else:
            stays = bool(sight.hidden[before] and sight.hidden[first])
        if stays:
            aside = asin(settings.comfortable / max(away, settings.comfortable))
            past = ray_at(bearing + self.side * aside, sight)
            return _first_open(past, self.side, ways.open), False
        self.edge = edge
        return chosen, another

    def beside(self, place: Point, sight: Sight) -> int:
        """The ray on which the boundary is nearest to the robot.

        The edge may lie far ahead, beyond a gap that only opens beside the robot.
        """
        third = len(sight.bearings) // 3
        if self.direction == (0.0, 0.0):
            edge = ray_at(atan2(self.edge[1] - place[1], self.edge[0] - place[0]), sight)
            return _nearest_ray(sight.ranges, edge, -self.side, third)
        # The boundary is beside the way taken, whatever else lies nearer behind the robot.
        onward = ray_at(atan2(self.direction[1], self.direction[0]), sight)
        return _nearest_ray(sight.ranges, onward - self.side * third, self.side, third + 1)


@compiled
def _nearest_ray(ranges: FloatArray, start: int, step: int, length: int) -> int:
    """The ray with the shortest of the ranges (n,) on `length` rays from `start` on."""
    count = len(ranges)
    nearest = start % count
    for k in range(1, length):
        ray = (start + step * k) % count
        if ranges[ray] < ranges[nearest]:
            nearest = ray
    return nearest


@compiled
def _ways_beside(
    beside: int, side: int, is_open: BoolArray, comfortable: BoolArray
) -> tuple[int, int]:
    """Rays of the first way beside the boundary, and of the one taken, which keeps a comfortable
    distance where there is room for it.

    Args:
        beside: the ray on which the boundary is nearest.
        side: +1 or -1, on which the rays turn away from it.
        is_open, comfortable: (n,) of `Ways`.
    """
    count = len(is_open)
    first = beside
    if is_open[beside]:
        # The boundary has ended here: look behind its end, for at most a third of a turn.
        for k in range(1, count // 3):
            ray = (beside - side * k) % count
            if not is_open[ray]:
                first = (ray + side) % count
                break
    else:
        for k in range(1, count):
            ray = (beside + side * k) % count
            if is_open[ray]:
                first = ray
                break
    for k in range(count // 4):
        ray = (first + side * k) % count
        if not is_open[ray]:
            break
        if comfortable[ray]:
            return first, ray
    return first, first


def _first_open(start: int, side: int, is_open: BoolArray) -> int:
    """The first ray from `start` on, turning to a side (+1 or -1), where a way leads on."""
    rays = (start + side * np.arange(len(is_open))) % len(is_open)
    return int(rays[is_open[rays].argmax()])


def _is_seen(points: FloatArray, x: float, y: float, within: float) -> bool:
    """True if one of the points (k, 2) is within this of (x, y), m."""
    return bool((np.hypot(points[:, 0] - x, points[:, 1] - y) <= within).any())


@compiled
def _nearest_connected(
    points: FloatArray, x: float, y: float, gap: float, to_x: float, to_y: float
) -> float:
    """How near the points that hang together with the one nearest to (x, y) come to another place.

    Args:
        points: (k, 2) in ray order, all around, at least one.
        x, y: where to begin.
        gap: to the next point that parts them, m.
        to_x, to_y: the place.
    """
    count = len(points)
    start, smallest = 0, np.inf
    for k in range(count):
        squared = (points[k, 0] - x) ** 2 + (points[k, 1] - y) ** 2
        if squared < smallest:
            start, smallest = k, squared
    nearest = hypot(points[start, 0] - to_x, points[start, 1] - to_y)
    for step in (1, -1):
        here = start
        for _ in range(count - 1):
            there = (here + step) % count
            if hypot(points[there, 0] - points[here, 0], points[there, 1] - points[here, 1]) > gap:
                break
            nearest = min(nearest, hypot(points[there, 0] - to_x, points[there, 1] - to_y))
            here = there
    return nearest


def same_boundary(
    place: Point,
    sight: Sight,
    one: Point,
    other: Point,
) -> bool:
    """True if the two points of boundaries hang together as far as can be seen; false where
    nothing near the first is in sight."""
    x, y = one[0] - place[0], one[1] - place[1]
    to_x, to_y = other[0] - place[0], other[1] - place[1]
    if not _is_seen(sight.points, x, y, BOUNDARY_GAP):
        return False
    return _nearest_connected(sight.points, x, y, BOUNDARY_GAP, to_x, to_y) < BOUNDARY_GAP


def ray_at(bearing: float, sight: Sight) -> int:
    """Number of the ray nearest to a bearing, rad, world frame."""
    count = len(sight.bearings)
    return round((bearing - float(sight.bearings[0])) * count / (2 * pi)) % count


def rays_beside(goal: FloatArray, sight: Sight, side: int) -> IntArray:
    """(n / 2,) rays from the goal's direction on to one side: +1 is left, -1 right."""
    count = len(sight.bearings)
    return (ray_at(atan2(goal[1], goal[0]), sight) + side * np.arange(count // 2)) % count


def blocking_point(place: Point, sight: Sight, ray: int) -> Point:
    """World-frame point of the obstacle that closes the way at this ray."""
    x, y = _blocking(sight.points, sight.bearings[ray])
    return (place[0] + x, place[1] + y)


@compiled
def _blocking(points: FloatArray, bearing: float) -> tuple[float, float]:
    """The point (k, 2) ahead on a bearing that lies nearest to its line."""
    c, s = cos(bearing), sin(bearing)
    nearest, smallest = 0, np.inf
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        if x * c + y * s > 0.0 and abs(y * c - x * s) < smallest:
            nearest, smallest = k, abs(y * c - x * s)
    return points[nearest, 0], points[nearest, 1]
