"""What a scenario says, checked: the record that the rest of the product reads."""

from dataclasses import dataclass

from fuzzynav_mj.scenarios.motion import Mover
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.types import FloatArray, Pose2D

Bounds = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class RandomMovingSpec:
    """Moving obstacles that are drawn anew for every seed.

    Attributes:
        count: smallest and largest number of obstacles.
        radius: range of the circumscribed radius, m.
        vertices: smallest and largest number of corners.
        concave_fraction: share of the polygons that are concave, 0..1.
        speed: range of the speed, m/s; each obstacle keeps one.
        acceleration: upper bound of curvature times speed squared, m/s2.
        region: (n, 2) simple polygon, world frame, that holds every obstacle at every time.
    """

    count: tuple[int, int]
    radius: tuple[float, float]
    vertices: tuple[int, int]
    concave_fraction: float
    speed: tuple[float, float]
    acceleration: float
    region: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Scenario:
    """A checked scenario file.

    Attributes:
        name: of the scenario.
        description: one sentence.
        bounds: x_min, y_min, x_max, y_max of the arena, m.
        walls: True if the bounds are walls.
        time_limit: simulated time after which an episode ends, s.
        allow_faster: True if obstacles may be faster than the robot. Without it no `speed` exceeds
            the robot's top speed; keyframes are not checked and may.
        start: pose of the footprint's centre at time 0.
        goal: (x, y) that the footprint's centre is to reach, m.
        goal_yaw: direction to turn to on arrival, rad; or None.
        goal_tolerance: distance from the goal that counts as arrived, m.
        static: obstacles that stand still, world frame.
        moving: scripted obstacles.
        random_moving: obstacles drawn for every seed.
        source: name of the file, for messages.
        random_phases: indices of the scripted obstacles whose phase is drawn for every seed; each
            must have a RouteMotion.
    """

    name: str
    description: str
    bounds: Bounds
    walls: bool
    time_limit: float
    allow_faster: bool
    start: Pose2D
    goal: tuple[float, float]
    goal_yaw: float | None
    goal_tolerance: float
    static: tuple[Shape, ...]
    moving: tuple[Mover, ...]
    random_moving: tuple[RandomMovingSpec, ...]
    source: str
    random_phases: frozenset[int] = frozenset()
