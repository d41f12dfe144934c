"""Where to head for: towards the goal, or along a boundary until that pays again.

A bug algorithm with a range sensor (Kamon, Rimon, Rivlin 1998, TangentBug; the leaving condition
with a minimum gain is DistBug's, Kamon, Rivlin 1997). Its memory is of constant size: mode, side,
the point where following began, the smallest distance to the goal, and one point of the followed
boundary. Movers and the fuzzy gate may hold the robot up; they never touch this state.
"""

from dataclasses import dataclass
from math import atan2, cos, hypot, inf, pi, sin
from typing import Literal

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.reach import free_distance
from fuzzynav_mj.planners.sight import (
    Sight,
    Ways,
    either,
    range_jumps,
    searched_ways,
    straight_ways,
)
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

BOUNDARY_LOST = 0.1  # m beyond sight
BOUNDARY_GAP = 0.3  # m: parts farther from each other are different boundaries
DOUBTS = 2  # looks that see no way on before a boundary is followed: one may be mistaken
SAME_WAY = 0.87  # cosine of the largest angle between bearings of what is still the same way


@dataclass(frozen=True, slots=True)
class GuidanceSettings:
    """Widths and gains of the guidance, m.

    Attributes:
        comfortable: half width of a passage that is taken without hesitation.
        tight: half width of the narrowest passage that is taken at all.
        tight_penalty: detour that is preferred to a tight passage.
        blind_penalty: detour that is preferred to going along a wall whose end is not in sight.
        search_gain: what a searched way must promise to save before a search is made.
        gain: how much nearer to the goal than all of the boundary a way must lead to leave it.
        turning_gain: how much shorter the way around the other side must look to turn round.
        patience: length of boundary after which a smaller gain will do.
        settling: length after which the robot surely drives along the boundary.
        loop_radius: how near to its start a followed boundary counts as closed.
        loop_length: shortest boundary that can be closed.
    """

    comfortable: float = 0.20
    tight: float = 0.13
    tight_penalty: float = 0.10
    search_gain: float = 0.15
    blind_penalty: float = 0.3
    gain: float = 0.15
    turning_gain: float = 0.1
    patience: float = 6.0
    settling: float = 0.6
    loop_radius: float = 0.25
    loop_length: float = 1.5


@dataclass(frozen=True, slots=True)
class Alternative:
    """The way around the other end of a boundary, not taken when following began.

    Attributes:
        place: (x, y) from where it was seen.
        edge: (x, y) a point of the boundary next to it.
        cost: its length to the edge of sight and what was left from there to the goal, m.
    """

    place: tuple[float, float]
    edge: tuple[float, float]
    cost: float


@dataclass(slots=True)
class Following:
    """The memory while following a boundary. Mutable: the guidance's own state.

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
    start: tuple[float, float]
    edge: tuple[float, float]
    nearest: float
    reached: float
    length: float = 0.0
    farthest: float = 0.0
    direction: tuple[float, float] = (0.0, 0.0)
    alternative: Alternative | None = None
    closed: bool = False

    def begin_anew(self, place: tuple[float, float], distance: float) -> None:
        """Forgets what belongs to another boundary; `distance` to the goal, m."""
        self.start = place
        self.nearest = self.reached = distance
        self.length = self.farthest = 0.0
        self.alternative = None

    def turn_round(self, place: tuple[float, float], other: Alternative) -> None:
        """Follows the boundary around its other side, from `place` on. Only once."""
        self.side = -self.side
        self.start, self.edge = place, other.edge
        self.length = self.farthest = 0.0
        self.direction = (0.0, 0.0)
        self.alternative = None


@dataclass(frozen=True, slots=True)
class Heading:
    """What guidance wants.

    Attributes:
        subgoal: (x, y) world frame; the present place where no way leads on.
        mode: what leads the robot.
        direct: True if the goal itself is in straight reach, as far as can be seen.
        closed_loops: how many boundaries have been followed all around.
    """

    subgoal: tuple[float, float]
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
        goal: tuple[float, float],
        tolerance: float,
        settings: GuidanceSettings | None = None,
    ) -> None:
        self._goal = goal
        self._tolerance = tolerance
        self._settings = settings or GuidanceSettings()
        self._following: Following | None = None
        self._closed_loops = 0
        self._last: tuple[float, float] | None = None
        self._bearing: float | None = None  # of the way taken last while seeking the goal
        self._onward_to: tuple[float, float] | None = None  # the subgoal of that way
        # Side of the boundary from which movers drove the robot off last, and where.
        self._driven_off: tuple[int, tuple[float, float]] | None = None
        self._doubts = 0  # looks since then that saw no way

    def head(self, place: tuple[float, float], sight: Sight, among_movers: bool = False) -> Heading:
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
        distance = float(np.hypot(*goal))
        if self._following is not None:
            edge = self._following.edge
            away = hypot(edge[0] - place[0], edge[1] - place[1])
            if away > sight.max_range + BOUNDARY_LOST or len(sight.points) == 0:
                # Movers have driven the robot off: what it sees now is another boundary.
                self._driven_off = (self._following.side, place)
                self._following = None
            else:
                self._watch_boundary(place, goal, sight, self._following)
        if self._goal_in_reach(goal, distance, sight):
            self._following = None
            self._bearing = atan2(goal[1], goal[0])
            return self._heading(place, goal, "goal", direct=True)
        ways = self._ways(place, goal, sight)
        if not ways.open.any():
            return self._heading(place, np.zeros(2), "blocked")
        left_over = np.hypot(ways.end[:, 0] - goal[0], ways.end[:, 1] - goal[1])
        cost = ways.length + left_over
        following = self._following
        if following is None:
            ahead = _ray(atan2(goal[1], goal[0]), sight)
            blind = _blind(ahead, sight.ranges, sight.max_range, ways.open)
            cost = cost + self._settings.blind_penalty * blind
            best = int(cost.argmin())
            bearing = float(sight.bearings[best])
            if left_over[best] < distance and not self._turned_back(bearing):
                self._bearing = bearing
                return self._onward(place, ways.first_point(best))
            if self._onward_to is not None and self._doubts < DOUBTS:
                self._doubts += 1
                onward = np.array(self._onward_to) - np.array(place)
                return self._heading(place, onward, "goal")
            chosen = self._way_of_before(place, goal, sight, ways)
            if chosen is None:
                chosen = self._kept(sight, ways, best)
            following = self._begin(place, goal, sight, ways, chosen)
        else:
            along = following.direction
            gone = step[0] * along[0] + step[1] * along[1]
            following.length += gone
            following.reached = min(following.reached, distance)
            gaining = ways.open & (left_over < self._to_beat(following) - self._settings.gain)
            if sight.hidden is not None:
                gaining &= ~sight.hidden  # what a mover hides is no reason to leave
            if gaining.any():
                self._following = None
                if not following.closed:
                    self._closed_loops = 0  # those were around other boundaries
                best = int(np.where(gaining, cost, np.inf).argmin())
                return self._heading(place, ways.first_point(best), "goal")
            self._watch_loop(place, distance, gone, following)
            edge = following.edge
            chosen = self._along(place, sight, ways, following)
            following.reached = min(following.reached, float(left_over[chosen]))
            if among_movers and not _same_boundary(place, sight, edge, following.edge):
                self._driven_off = (following.side, place)
                following.begin_anew(place, distance)
                self._watch_boundary(place, goal, sight, following)
            if self._other_side_pays(place, sight, float(cost[chosen]), following):
                chosen = self._along(place, sight, ways, following)
        bearing = float(sight.bearings[chosen])
        following.direction = (cos(bearing), sin(bearing))
        return self._heading(place, ways.first_point(chosen), "boundary")

    def _onward(self, place: tuple[float, float], target: FloatArray) -> Heading:
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
        self, place: tuple[float, float], goal: FloatArray, sight: Sight, ways: Ways
    ) -> int | None:
        """The first open way to the side on which the robot was going around when movers drove it
        off its boundary not far from here; None where there is no such side or way."""
        before, self._driven_off = self._driven_off, None
        if before is None:
            return None
        side, (x, y) = before
        if hypot(x - place[0], y - place[1]) > 2 * sight.max_range:
            return None
        count = len(sight.bearings)
        turned = (_ray(atan2(goal[1], goal[0]), sight) + side * np.arange(1, count // 2)) % count
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
        place: tuple[float, float],
        target: FloatArray,
        mode: Literal["goal", "boundary", "blocked"],
        direct: bool = False,
    ) -> Heading:
        subgoal = (place[0] + float(target[0]), place[1] + float(target[1]))
        return Heading(subgoal, mode, direct, self._closed_loops)

    def _goal_in_reach(self, goal: FloatArray, distance: float, sight: Sight) -> bool:
        bearing = np.array([atan2(goal[1], goal[0])])
        if distance <= sight.max_range:
            free = free_distance(sight.points, bearing, self._settings.tight)[0]
            return bool(free >= distance - self._tolerance)
        following = self._following
        if (
            following is not None
            and distance - sight.max_range >= self._to_beat(following) - self._settings.gain
        ):
            return False
        width = self._settings.comfortable
        free = free_distance(sight.points, bearing, width)[0]
        return bool(free >= sight.max_range - width)

    def _ways(self, place: tuple[float, float], goal: FloatArray, sight: Sight) -> Ways:
        """Comfortable ways, tight ones where they save enough, searched ones where they might."""
        settings = self._settings
        easy, tight = straight_ways(sight, (settings.comfortable, settings.tight))
        ways = either(easy, tight, settings.tight_penalty)
        if self._search_might_help(place, goal, sight, ways):
            found = searched_ways(sight, settings.tight, settings.comfortable)
            ways = either(ways, found, settings.tight_penalty)
        return ways

    def _search_might_help(
        self, place: tuple[float, float], goal: FloatArray, sight: Sight, ways: Ways
    ) -> bool:
        """True if a ray sees free ground that no straight way reaches, and it would be wanted."""
        if self._following is None:
            promised, have = _promises(
                sight.ranges, sight.bearings, sight.max_range, self._settings.tight,
                ways.open, ways.length, ways.end, goal,
            )  # fmt: skip
            return promised < have - self._settings.search_gain
        jump, _ = range_jumps(sight.ranges, self._settings.tight)
        hopeful = ((sight.ranges >= sight.max_range - 1e-9) | jump) & ~ways.open
        if not hopeful.any():
            return False
        order = self._outwards(place, sight, self._following)
        if not ways.open.any():
            return True
        # The width of the robot hides a few rays beside every edge; those promise nothing.
        hidden = self._settings.tight / sight.max_range * len(order) / (2 * pi)
        lead = int(ways.open[order].argmax()) - int((hopeful | ways.open)[order].argmax())
        return lead > 1.5 * hidden

    def _begin(
        self,
        place: tuple[float, float],
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
        edge = _blocking_point(place, sight, closed)
        distance = float(np.hypot(*goal))
        self._following = Following(side, place, edge, distance, distance)
        self._following.alternative = self._other_side(place, goal, sight, ways, side)
        self._bearing = self._onward_to = None
        self._watch_boundary(place, goal, sight, self._following)
        return self._following

    def _other_side(
        self,
        place: tuple[float, float],
        goal: FloatArray,
        sight: Sight,
        ways: Ways,
        side: int,
    ) -> Alternative | None:
        """The first way beyond the other end of what is in the way to the goal."""
        ahead = _ray(atan2(goal[1], goal[0]), sight)
        beyond = (ahead - side * np.arange(len(sight.bearings) // 2)) % len(sight.bearings)
        if not ways.open[beyond].any():
            return None
        steps = int(ways.open[beyond].argmax())
        ray = int(beyond[steps])
        edge = _blocking_point(place, sight, int(beyond[max(steps - 1, 0)]))
        left_over = np.hypot(*(ways.end[ray] - goal))
        return Alternative(place, edge, float(ways.length[ray] + left_over))

    def _other_side_pays(
        self, place: tuple[float, float], sight: Sight, cost: float, following: Following
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
        free = free_distance(sight.points, np.array([atan2(y, x)]), self._settings.tight)[0]
        if free < back - self._tolerance:
            return False
        following.turn_round(place, other)
        return True

    def _to_beat(self, following: Following) -> float:
        """Distance to the goal that a way must undercut for the boundary to be left, m.

        At first that of all of the boundary that was seen, as in TangentBug, so that a pocket is
        not entered twice. Part of another obstacle may have been taken for it, though: after a
        long while the robot's own smallest distance counts, as in DistBug.
        """
        patient = following.length < self._settings.patience
        if patient:
            return following.nearest
        # A way may keep closer to the wall than the robot did.
        return following.reached - (self._settings.comfortable - self._settings.tight)

    def _watch_boundary(
        self, place: tuple[float, float], goal: FloatArray, sight: Sight, following: Following
    ) -> None:
        """Notes how near to the goal the followed boundary comes, as far as it is seen now."""
        if len(sight.points) == 0:
            return
        edge = np.array(following.edge) - np.array(place)
        part = _connected(sight.points, edge, 2 * self._settings.tight)
        left_over = np.hypot(part[:, 0] - goal[0], part[:, 1] - goal[1])
        following.nearest = min(following.nearest, float(left_over.min()))

    def _watch_loop(
        self, place: tuple[float, float], distance: float, gone: float, following: Following
    ) -> None:
        if gone > 0.0 and following.length < self._settings.settling:
            following.start = place  # only now does the robot drive along the boundary
        away = hypot(place[0] - following.start[0], place[1] - following.start[1])
        following.farthest = max(following.farthest, away)
        settings = self._settings
        if (
            following.length > settings.loop_length
            and following.farthest > 2 * settings.loop_radius
            and away < settings.loop_radius
        ):
            # Movers may have made it begin elsewhere: what counts the second time round is only
            # what is seen of this boundary then.
            self._closed_loops += 1
            following.closed = True
            following.side = -following.side
            following.begin_anew(place, distance)

    def _along(
        self, place: tuple[float, float], sight: Sight, ways: Ways, following: Following
    ) -> int:
        """Ray of the first way beside the followed boundary; remembers the boundary's new edge."""
        count = len(sight.bearings)
        outwards = self._outwards(place, sight, following)
        start = int(outwards[0])
        if ways.open[start]:
            # The boundary has ended here: look behind its end, for at most a third of a turn.
            inwards = (start - following.side * np.arange(count // 3)) % count
            closed = np.flatnonzero(~ways.open[inwards])
            steps = int(closed[0]) if len(closed) else 0
            first = int(inwards[max(steps - 1, 0)])
        else:
            first = int(outwards[int(ways.open[outwards].argmax())])
        following.edge = _blocking_point(place, sight, (first - following.side) % count)
        # Within this opening, keep a comfortable distance where there is room for it.
        opening = (first + following.side * np.arange(count // 4)) % count
        end = int(np.append(ways.open[opening], False).argmin())
        roomy = np.flatnonzero(ways.comfortable[opening[:end]])
        return int(opening[roomy[0]]) if len(roomy) else first

    def _outwards(self, place: tuple[float, float], sight: Sight, following: Following) -> IntArray:
        """All rays in turn away from the boundary, from where it is nearest to the robot.

        The edge may lie far ahead, beyond a gap that only opens beside the robot.
        """
        count = len(sight.bearings)
        if following.direction == (0.0, 0.0):
            edge = following.edge
            start = _ray(atan2(edge[1] - place[1], edge[0] - place[0]), sight)
            beside = (start - following.side * np.arange(count // 3)) % count
        else:
            # The boundary is beside the way taken, whatever else lies nearer behind the robot.
            along = _ray(atan2(following.direction[1], following.direction[0]), sight)
            beside = (along - following.side * np.arange(count // 3, -1, -1)) % count
        start = int(beside[int(sight.ranges[beside].argmin())])
        return (start + following.side * np.arange(count)) % count


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


def _same_boundary(
    place: tuple[float, float],
    sight: Sight,
    one: tuple[float, float],
    other: tuple[float, float],
) -> bool:
    """True if the two points of boundaries hang together as far as can be seen."""
    if len(sight.points) == 0:
        return True
    part = _connected(sight.points, np.array(one) - np.array(place), BOUNDARY_GAP)
    offset = part - (np.array(other) - np.array(place))
    return bool(np.hypot(offset[:, 0], offset[:, 1]).min() < BOUNDARY_GAP)


def _ray(bearing: float, sight: Sight) -> int:
    count = len(sight.bearings)
    return round((bearing - float(sight.bearings[0])) * count / (2 * pi)) % count


@compiled
def _promises(
    ranges: FloatArray,
    bearings: FloatArray,
    max_range: float,
    width: float,
    is_open: BoolArray,
    length: FloatArray,
    end: FloatArray,
    goal: FloatArray,
) -> tuple[float, float]:
    """Shortest way to the goal, m, by ground that a ray sees free and no straight way reaches; and
    by the ways that there are. Each inf where there is none."""
    promised = have = inf
    jump, _ = range_jumps(ranges, width)
    for i in range(len(ranges)):
        have = min(have, length[i] + hypot(end[i, 0] - goal[0], end[i, 1] - goal[1]))
        if not is_open[i] and (jump[i] or ranges[i] >= max_range - 1e-9):
            x, y = max_range * cos(bearings[i]), max_range * sin(bearings[i])
            promised = min(promised, max_range + hypot(x - goal[0], y - goal[1]))
    return promised, have


@compiled
def _blind(goal_ray: int, ranges: FloatArray, max_range: float, is_open: BoolArray) -> BoolArray:
    """(n,) True for the ways on a side of the goal's direction on which the obstacle in the way
    runs on beyond sight: there may be no end to it.

    Args:
        goal_ray: the ray towards the goal.
        ranges: (n,) m.
        max_range: m.
        is_open: (n,) where ways lead on.
    """
    count = len(ranges)
    blind = np.zeros(count, dtype=np.bool_)
    if is_open[goal_ray]:
        return blind
    for side in (1, -1):
        hits = np.empty(count // 2, dtype=np.intp)  # how far from the goal's ray
        found = 0
        for step in range(count // 2):
            ray = (goal_ray + side * step) % count
            if is_open[ray]:
                break
            if ranges[ray] < max_range - 1e-9:
                hits[found] = step
                found += 1
        else:
            found = 0  # no way at all on this side
        if found == 0:
            continue
        last, before = hits[found - 1], hits[max(found - 4, 0)]
        farthest = ranges[(goal_ray + side * last) % count]
        rise = farthest - ranges[(goal_ray + side * before) % count]
        if found < 4 or farthest + 2.0 * rise / max(last - before, 1) > max_range:
            for step in range(count // 2):
                blind[(goal_ray + side * step) % count] = True
    return blind


def _blocking_point(place: tuple[float, float], sight: Sight, ray: int) -> tuple[float, float]:
    """World-frame point of the obstacle that closes the way at this ray."""
    bearing = float(sight.bearings[ray])
    c, s = float(np.cos(bearing)), float(np.sin(bearing))
    if len(sight.points) == 0:
        return (place[0] + c * sight.max_range, place[1] + s * sight.max_range)
    along = sight.points[:, 0] * c + sight.points[:, 1] * s
    across = np.abs(sight.points[:, 1] * c - sight.points[:, 0] * s)
    nearest = int(np.where(along > 0.0, across, np.inf).argmin())
    x, y = sight.points[nearest].tolist()
    return (place[0] + x, place[1] + y)
