"""Where to head for: towards the goal, or along a boundary until that pays again.

A bug algorithm with a range sensor (Kamon, Rimon, Rivlin 1998, TangentBug; the leaving condition
with a minimum gain is DistBug's, Kamon, Rivlin 1997). Its memory is of constant size: what
`boundary.Following` holds of the followed boundary, the way taken last, how near to the goal ways
have led, and the side gone round when movers drove the robot off. The fuzzy gate may hold the robot
up; it never touches this state.
"""

from dataclasses import dataclass
from math import asin, atan2, cos, hypot, inf, pi, sin
from typing import Literal

import numpy as np

from fuzzynav_mj.planners.boundary import (
    Alternative,
    Following,
    Point,
    blocking_point,
    ray_at,
    rays_beside,
)
from fuzzynav_mj.planners.openings import gaining_way, shortest_way
from fuzzynav_mj.planners.reach import free_ahead
from fuzzynav_mj.planners.settings import GuidanceSettings
from fuzzynav_mj.planners.sight import Sight, Ways
from fuzzynav_mj.planners.walls import Walls, corners_closed, walls_in_sight
from fuzzynav_mj.planners.ways import straight_ways_in, way_beside_walls, ways_in_sight
from fuzzynav_mj.types import FloatArray

BOUNDARY_LOST = 0.1  # m beyond sight
DOUBTS = 2  # looks that see no way on before a boundary is followed: one may be mistaken
SAME_WAY = 0.87  # cosine of the largest angle between bearings of what is still the same way


@dataclass(frozen=True, slots=True)
class Heading:
    """What guidance wants.

    Attributes:
        subgoal: (x, y) world frame; the present place where no way leads on.
        mode: what leads the robot.
        direct: True if the goal itself is in straight reach, as far as can be seen.
        closed_loops: how often a boundary was followed all around, since one was last left before.
    """

    subgoal: Point
    mode: Literal["goal", "boundary", "blocked"]
    direct: bool
    closed_loops: int


class Guidance:
    """Chooses the subgoal for one decision after the other.

    Args:
        goal: (x, y) world frame, m.
        tolerance: of the goal, m.
        settings: widths and gains.
    """

    def __init__(
        self,
        goal: Point,
        tolerance: float,
        settings: GuidanceSettings | None = None,
    ) -> None:
        self._goal = goal
        self._tolerance = tolerance
        self._settings = settings or GuidanceSettings()
        self._following: Following | None = None
        self._closed_loops = 0
        self._last: Point | None = None
        self._bearing: float | None = None  # of the way taken last while seeking the goal
        self._onward_to: Point | None = None  # the subgoal of that way
        self._doubts = 0  # looks since then that saw no way
        self._promised = inf  # smallest distance from a way's end to the goal, since a boundary
        # Side of the boundary from which movers drove the robot off last, and where.
        self._driven_off: tuple[int, Point] | None = None

    def head(self, place: Point, sight: Sight, among_movers: bool = False) -> Heading:
        """The subgoal at `place` (x, y) with what is in sight.

        Args:
            place: of the robot, world frame, m.
            sight: what stands around it.
            among_movers: whether movers may have driven it from the boundary that it follows.
        """
        last = self._last or place
        step = (place[0] - last[0], place[1] - last[1])
        self._last = place
        goal = np.array([self._goal[0] - place[0], self._goal[1] - place[1]])
        distance = hypot(*goal.tolist())
        walls = walls_in_sight(sight)
        sight = corners_closed(sight, walls, self._settings.corner)
        if self._following is not None:
            edge = self._following.edge
            away = hypot(edge[0] - place[0], edge[1] - place[1])
            if away > sight.max_range + BOUNDARY_LOST or len(sight.points) == 0:
                # Movers have driven the robot off: what it sees now is another boundary.
                self._driven_off = (self._following.side, place)
                self._following = None
            else:
                self._following.watch(place, goal, sight, self._settings)
        if self._goal_in_reach(goal, distance, sight):
            return self._straight(place, goal, distance, sight, walls)
        ways = ways_in_sight(place, goal, sight, self._following, self._settings)
        if not ways.open.any():
            return self._heading(place, np.zeros(2), "blocked")
        following = self._following
        if following is None:
            return self._seek(place, goal, sight, ways, walls)
        along = following.direction
        gone = step[0] * along[0] + step[1] * along[1]
        following.length += gone
        following.reached = min(following.reached, distance)
        # What a mover hides is no reason to leave.
        wanted = ways.open & ~sight.hidden
        best = gaining_way(wanted, ways.length, ways.end, goal, following.to_beat(self._settings))
        if best >= 0:
            self._following, self._promised = None, inf
            if not following.closed:
                self._closed_loops = 0  # those were around other boundaries
            return self._heading(place, ways.first_point(best), "goal")
        if following.closes(place, gone, self._settings):
            # Movers may have made it begin elsewhere: what counts the second time round is only
            # what is seen of this boundary then.
            self._closed_loops += 1
            following.closed = True
            following.side = -following.side
            following.begin_anew(place, distance)
        chosen, another = following.along(place, sight, ways, among_movers, self._settings)
        left_over = hypot(*(ways.end[chosen] - goal).tolist())
        following.reached = min(following.reached, left_over)
        if another:
            self._driven_off = (following.side, place)
            following.begin_anew(place, distance)
            following.watch(place, goal, sight, self._settings)
        cost = float(ways.length[chosen]) + left_over
        if self._other_side_pays(place, sight, cost, following):
            chosen, _ = following.along(place, sight, ways, among_movers, self._settings)
        return self._follow(place, sight, ways, chosen, following)

    def _straight(
        self, place: Point, goal: FloatArray, distance: float, sight: Sight, walls: Walls
    ) -> Heading:
        """To the goal; while that is out of sight, beside a wall that would come in the way."""
        if self._following is not None:
            self._following, self._promised = None, inf
        self._bearing = atan2(goal[1], goal[0])
        ahead = ray_at(self._bearing, sight)
        if distance > sight.max_range and walls.runs_on.any():
            ways = straight_ways_in(sight, self._settings)
            taken = way_beside_walls(ahead, goal, sight, ways, walls, self._settings)
            if taken != ahead:
                return self._heading(place, ways.end[taken], "goal")
        return self._heading(place, goal, "goal", direct=True)

    def _seek(
        self, place: Point, goal: FloatArray, sight: Sight, ways: Ways, walls: Walls
    ) -> Heading:
        """The shortest way to the goal, as far as can be seen; where all lead away from it, a
        boundary is followed from now on."""
        ahead = ray_at(atan2(goal[1], goal[0]), sight)
        best, left_over = shortest_way(
            ahead, sight.ranges, sight.max_range,
            ways.open, ways.length, ways.end, goal, self._settings.blind_penalty,
        )  # fmt: skip
        bearing = float(sight.bearings[best])
        nearer = left_over < hypot(*goal.tolist())
        if nearer and not self._turned_back(bearing):
            self._bearing = bearing
            self._promised = min(self._promised, left_over)
            best = way_beside_walls(best, goal, sight, ways, walls, self._settings)
            return self._onward(place, ways.first_point(best))
        if self._onward_to is not None and self._doubts < DOUBTS:
            self._doubts += 1
            return self._heading(place, np.array(self._onward_to) - np.array(place), "goal")
        chosen = self._way_of_before(place, goal, sight, ways)
        if chosen is None:
            # A way that leads nearer to the goal is the better side, though it turns back.
            chosen = best if nearer else self._kept(sight, ways, best)
        following = self._begin(place, goal, sight, ways, chosen)
        return self._follow(place, sight, ways, chosen, following)

    def _follow(
        self, place: Point, sight: Sight, ways: Ways, chosen: int, following: Following
    ) -> Heading:
        bearing = float(sight.bearings[chosen])
        following.direction = (cos(bearing), sin(bearing))
        return self._heading(place, ways.first_point(chosen), "boundary")

    def _onward(self, place: Point, target: FloatArray) -> Heading:
        """Towards the goal, by this point; it will be kept to for a look or two that see no way."""
        heading = self._heading(place, target, "goal")
        self._onward_to, self._doubts = heading.subgoal, 0
        return heading

    def _turned_back(self, bearing: float) -> bool:
        """True if the way to the goal now leads more than a right angle off the one just taken:
        that one has turned out to be closed, and switching to and fro would never end."""
        if self._bearing is None:
            return False
        return cos(bearing - self._bearing) < 0.0

    def _way_of_before(
        self, place: Point, goal: FloatArray, sight: Sight, ways: Ways
    ) -> int | None:
        """The first open way to the side on which the robot was going around when movers drove it
        off its boundary not far from here; None where there is no such side or way."""
        before, self._driven_off = self._driven_off, None
        if before is None:
            return None
        side, (x, y) = before
        if hypot(x - place[0], y - place[1]) > 2 * sight.max_range:
            return None
        turned = rays_beside(goal, sight, side)[1:]
        steps = int(ways.open[turned].argmax())
        return int(turned[steps]) if ways.open[turned[steps]] else None

    def _kept(self, sight: Sight, ways: Ways, best: int) -> int:
        """The open way nearest to the one just taken, if it still leads on; else the best one."""
        if self._bearing is None:
            return best
        alike = np.where(ways.open, np.cos(sight.bearings - self._bearing), -1.0)
        nearest = int(alike.argmax())
        return nearest if alike[nearest] > SAME_WAY else best

    def _heading(
        self,
        place: Point,
        target: FloatArray,
        mode: Literal["goal", "boundary", "blocked"],
        direct: bool = False,
    ) -> Heading:
        subgoal = (place[0] + float(target[0]), place[1] + float(target[1]))
        return Heading(subgoal, mode, direct, self._closed_loops)

    def _goal_in_reach(self, goal: FloatArray, distance: float, sight: Sight) -> bool:
        bearing = atan2(goal[1], goal[0])
        if distance <= sight.max_range:
            free = free_ahead(sight.points, bearing, self._settings.tight)
            return free >= distance - self._tolerance
        following = self._following
        if following is not None and distance - sight.max_range >= following.to_beat(
            self._settings
        ):
            return False
        width = self._settings.comfortable
        if following is not None and sight.is_hidden(bearing, asin(width / sight.max_range)):
            return False  # what a mover hides is no reason to leave
        return free_ahead(sight.points, bearing, width) >= sight.max_range - width

    def _begin(
        self,
        place: Point,
        goal: FloatArray,
        sight: Sight,
        ways: Ways,
        chosen: int,
    ) -> Following:
        """Begins to follow the boundary between the goal's direction and the way chosen."""
        turn = (float(sight.bearings[chosen]) - atan2(goal[1], goal[0]) + pi) % (2 * pi) - pi
        side = 1 if turn >= 0 else -1
        back = (chosen - side * np.arange(len(sight.bearings))) % len(sight.bearings)
        closed = int(back[int(ways.open[back].argmin())])
        edge = blocking_point(place, sight, closed)
        distance = float(np.hypot(*goal))
        reached = min(distance, self._promised)
        self._following = Following(side, place, edge, distance, reached)
        self._following.alternative = self._other_side(place, goal, sight, ways, side)
        self._bearing = self._onward_to = None
        self._following.watch(place, goal, sight, self._settings)
        return self._following

    def _other_side(
        self,
        place: Point,
        goal: FloatArray,
        sight: Sight,
        ways: Ways,
        side: int,
    ) -> Alternative | None:
        """The first way beyond the other end of what is in the way to the goal."""
        beyond = rays_beside(goal, sight, -side)
        if not ways.open[beyond].any():
            return None
        steps = int(ways.open[beyond].argmax())
        ray = int(beyond[steps])
        edge = blocking_point(place, sight, int(beyond[max(steps - 1, 0)]))
        left_over = np.hypot(*(ways.end[ray] - goal))
        return Alternative(place, edge, float(ways.length[ray] + left_over))

    def _other_side_pays(
        self, place: Point, sight: Sight, cost: float, following: Following
    ) -> bool:
        """Turns round if the way around the other side now looks shorter, and is in straight reach.

        Only once for a boundary, so that this never goes on for ever.

        Args:
            place: of the robot, world frame, m.
            sight: what stands.
            cost: of the way chosen along the boundary, and on to the goal, m.
            following: the boundary.
        """
        other = following.alternative
        if other is None or following.length < self._settings.settling:
            return False
        x, y = other.place[0] - place[0], other.place[1] - place[1]
        back = hypot(x, y)
        if cost < back + other.cost + self._settings.turning_gain:
            return False
        if back > sight.max_range:
            return False
        free = free_ahead(sight.points, atan2(y, x), self._settings.tight)
        if free < back - self._tolerance:
            return False
        following.turn_round(place, other)
        return True
