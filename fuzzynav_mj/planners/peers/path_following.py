"""Following a path found on the map, and finding another one where the scan shows it blocked."""

from collections.abc import Callable
from typing import ClassVar

import numpy as np
import shapely
from shapely.ops import substring

from fuzzynav_mj.planners.arrival import docking
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Requirements
from fuzzynav_mj.planners.peers.clear_motion import hits_around, step_towards
from fuzzynav_mj.planners.peers.free_space import FreeSpace, free_space
from fuzzynav_mj.planners.peers.paths import PathMethod, length
from fuzzynav_mj.types import Behaviour, Decision, FloatArray

RADIUS = 0.15  # m: of the disc that paths are planned for; the footprint's half diagonal is 0.141
UNMAPPED = 0.03  # m: a hit this far from all that is on the map is a temporary obstacle
CARROT = 0.35  # m: the point of the path that is pursued lies at most so far ahead
AHEAD = 1.2  # m of path that must be clear of temporary obstacles
TOUCHES = 0.13  # m: a temporary obstacle this near to the path ahead blocks it
PLAN_PERIOD = 0.3  # s: shortest time between two plans
SHORTEST = 1e-3  # m: no path is cut shorter
REVIEW_PERIOD = 1.0  # s: after which a detour is compared with a new plan


class PathFollower:
    """Plans a path on the map of what stands and pursues it (Coulter 1992, pure pursuit).

    Where hits that are not on the map block the path ahead it plans anew with these hits as
    obstacles, and waits where there is no way around them. It knows nothing of motion: a hit
    counts for as long as it is seen.
    """

    requires: ClassVar[Requirements] = Requirements(scan=True, obstacles=False, static_map=True)

    def __init__(self, method: Callable[[], PathMethod]) -> None:
        self._make_method = method

    def reset(self, problem: NavigationProblem, rng: np.random.Generator) -> None:
        """Begins an episode."""
        assert problem.static_map is not None
        self._problem = problem
        self._map = free_space(problem.static_map, problem.goal, RADIUS)
        self._method = self._make_method()
        # A goal beside a wall may be nearer to it than the disc: then one within its tolerance.
        self._method.prepare(self._map, self._map.nearest(np.array(problem.goal)), rng)
        self._path: FloatArray | None = None
        self._detour = False
        self._planned = -np.inf  # time of the last plan, s

    def decide(self, observation: Observation) -> Decision:
        """The next position along the path, or another path."""
        pose, scan = observation.pose, observation.scan
        assert scan is not None
        place = np.array([pose.x, pose.y])
        hits = hits_around(scan, pose)
        strangers = self._map.unmapped(hits + place, UNMAPPED)
        reachable = self._path is not None or self._plan_on_map(place)
        blocked = self._look_after_path(place, strangers, observation.stamp)
        dock = docking(self._problem, pose) if reachable and not blocked else None
        if self._path is None or blocked:
            target, behaviour = (pose.x, pose.y), Behaviour.WAITING
        elif dock is not None:
            target, behaviour = dock.target, Behaviour.GOAL_SEEKING
        else:
            target, behaviour = self._carrot(place), Behaviour.GOAL_SEEKING
        if self._detour and behaviour is not Behaviour.WAITING:
            behaviour = Behaviour.STATIC_AVOIDANCE
        turn_to = None if dock is None else dock.turn_to
        step = step_towards(
            target, hits, pose, observation.twist, self._problem.spec, turn_to, strangers - place
        )
        return Decision(
            next_position=step.next_position,
            behaviour=behaviour if step.clear else Behaviour.EVASION,
            subgoal=target,
            give_up=None if reachable else "no_path",
        )

    def _plan_on_map(self, place: FloatArray) -> bool:
        self._path = self._found(self._map, place)
        return self._path is not None

    def _look_after_path(self, place: FloatArray, strangers: FloatArray, stamp: float) -> bool:
        """Replaces the path where that is due. True if it is blocked all the same."""
        if self._path is None:
            return False
        self._path = _rest(self._path, place)
        blocked = _is_blocked(self._path, strangers)
        pause = PLAN_PERIOD if blocked else REVIEW_PERIOD
        if (blocked or self._detour) and stamp >= self._planned + pause - 1e-9:
            self._planned = stamp
            found = self._found(self._map.without(strangers), place)
            if found is not None and (blocked or length(found) < length(self._path)):
                self._path, self._detour = found, len(strangers) > 0
                blocked = False
        return blocked

    def _found(self, space: FreeSpace, place: FloatArray) -> FloatArray | None:
        start = space.nearest(place)
        path = self._method.path(space, start)
        return path if path is None or start is place else np.vstack((place, path))

    def _carrot(self, place: FloatArray) -> tuple[float, float]:
        """The farthest point of the path, up to `CARROT`, that the disc reaches straight on."""
        assert self._path is not None
        line = shapely.LineString(self._path)
        points = shapely.line_interpolate_point(line, CARROT * np.array([1.0, 0.75, 0.5, 0.25]))
        ahead = shapely.get_coordinates(points)
        straight = self._map.joins(np.broadcast_to(place, ahead.shape), ahead)
        x, y = ahead[int(straight.argmax())].tolist()
        return (x, y)


def _rest(path: FloatArray, place: FloatArray) -> FloatArray:
    """The path from its point nearest to the robot on, which is sought near its beginning."""
    line = shapely.LineString(path)
    if line.length < SHORTEST:
        return path
    at = float(substring(line, 0.0, AHEAD).project(shapely.Point(place)))
    rest: FloatArray = shapely.get_coordinates(
        substring(line, min(at, line.length - SHORTEST), line.length)
    )
    return rest


def _is_blocked(path: FloatArray, strangers: FloatArray) -> bool:
    if len(strangers) == 0:
        return False
    ahead = substring(shapely.LineString(path), 0.0, AHEAD)
    return bool(ahead.distance(shapely.MultiPoint(strangers)) < TOUCHES)
