"""The boundary that the robot follows: what it remembers of it, and which way leads along it.

The memory is that of a bug algorithm (TangentBug, DistBug): side, where following began, and the
smallest distance to the goal.
"""

from dataclasses import dataclass
from math import atan2, hypot, pi

import numpy as np

from fuzzynav_mj.planners.settings import GuidanceSettings
from fuzzynav_mj.planners.sight import Sight, Ways
from fuzzynav_mj.types import FloatArray, IntArray

Point = tuple[float, float]  # x, y, world frame, m

BOUNDARY_GAP = 0.3  # m: parts farther from each other are different boundaries


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
        edge = np.array(self.edge) - np.array(place)
        part = _connected(sight.points, edge, 2 * settings.tight)
        left_over = np.hypot(part[:, 0] - goal[0], part[:, 1] - goal[1])
        self.nearest = min(self.nearest, float(left_over.min()))

    def closes(self, place: Point, gone: float, settings: GuidanceSettings) -> bool:
        """True once the robot is back where following began.

        Args:
            place: of the robot, world frame, m.
            gone: along the boundary since the last look, m; negative where it was driven back.
            settings: lengths.
        """
        if gone > 0.0 and self.length < settings.settling:
            self.start = place  # only now does the robot drive along the boundary
        away = hypot(place[0] - self.start[0], place[1] - self.start[1])
        self.farthest = max(self.farthest, away)
        return (
            self.length > settings.loop_length
            and self.farthest > 2 * settings.loop_radius
            and away < settings.loop_radius
        )

    def along(self, place: Point, sight: Sight, ways: Ways) -> int:
        """Ray of the first way beside the boundary; remembers its new edge."""
        count = len(sight.bearings)
        outwards = self.outwards(place, sight)
        start = int(outwards[0])
        if ways.open[start]:
            # The boundary has ended here: look behind its end, for at most a third of a turn.
            inwards = (start - self.side * np.arange(count // 3)) % count
            closed = np.flatnonzero(~ways.open[inwards])
            steps = int(closed[0]) if len(closed) else 0
            first = int(inwards[max(steps - 1, 0)])
        else:
            first = int(outwards[int(ways.open[outwards].argmax())])
        self.edge = blocking_point(place, sight, (first - self.side) % count)
        # Within this opening, keep a comfortable distance where there is room for it.
        opening = (first + self.side * np.arange(count // 4)) % count
        end = int(np.append(ways.open[opening], False).argmin())
        roomy = np.flatnonzero(ways.comfortable[opening[:end]])
        return int(opening[roomy[0]]) if len(roomy) else first

    def outwards(self, place: Point, sight: Sight) -> IntArray:
        """(n,) all rays in turn away from the boundary, from where it is nearest to the robot.

        The edge may lie far ahead, beyond a gap that only opens beside the robot.
        """
        count = len(sight.bearings)
        if self.direction == (0.0, 0.0):
            start = ray_at(atan2(self.edge[1] - place[1], self.edge[0] - place[0]), sight)
            beside = (start - self.side * np.arange(count // 3)) % count
        else:
            # The boundary is beside the way taken, whatever else lies nearer behind the robot.
            onward = ray_at(atan2(self.direction[1], self.direction[0]), sight)
            beside = (onward - self.side * np.arange(count // 3, -1, -1)) % count
        start = int(beside[int(sight.ranges[beside].argmin())])
        return (start + self.side * np.arange(count)) % count


def _connected(points: FloatArray, near: FloatArray, gap: float) -> FloatArray:
    """The points (k, 2), in ray order, that hang together with the one nearest to `near`."""
    steps = np.roll(points, -1, axis=0) - points
    wide = np.hypot(steps[:, 0], steps[:, 1]) > gap
    if not wide.any():
        return points
    first = int(np.flatnonzero(wide)[0]) + 1  # begin the numbering at a gap
    group = np.roll(np.cumsum(np.roll(np.roll(wide, 1), -first)), first)
    offset = points - near
    own = group[int((offset[:, 0] ** 2 + offset[:, 1] ** 2).argmin())]
    part: FloatArray = points[group == own]
    return part


def same_boundary(
    place: Point,
    sight: Sight,
    one: Point,
    other: Point,
) -> bool:
    """True if the two points of boundaries hang together as far as can be seen."""
    part = _connected(sight.points, np.array(one) - np.array(place), BOUNDARY_GAP)
    offset = part - (np.array(other) - np.array(place))
    return bool(np.hypot(offset[:, 0], offset[:, 1]).min() < BOUNDARY_GAP)


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
    bearing = float(sight.bearings[ray])
    c, s = float(np.cos(bearing)), float(np.sin(bearing))
    along = sight.points[:, 0] * c + sight.points[:, 1] * s
    across = np.abs(sight.points[:, 1] * c - sight.points[:, 0] * s)
    nearest = int(np.where(along > 0.0, across, np.inf).argmin())
    x, y = sight.points[nearest].tolist()
    return (place[0] + x, place[1] + y)
