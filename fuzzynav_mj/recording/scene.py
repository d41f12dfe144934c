"""What stands in a recording's scene, or moves there as a whole.

What lies under `ROBOT` is given in the robot's frame, and under `MOVING` in the obstacles' own
frames. What lies under `MAGNIFIED` is seen `MAGNIFICATION` times as far from the robot as it is.
`FOLLOWER` is a frame that moves with the robot but does not turn.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import shapely
from shapely import Polygon

from fuzzynav_mj.recording import colours
from fuzzynav_mj.recording.colours import Colour
from fuzzynav_mj.recording.solids import Mesh, box_outline, circle_outline, lying, prism
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import FloatArray

if TYPE_CHECKING:
    from fuzzynav_mj.scenarios.world import World

ROBOT = "/world/robot"
FOLLOWER = "/world/follower"
MOVING = "/world/moving"
MAGNIFIED = "/world/decision/magnified"

OBSTACLE_HEIGHT = 0.3
WALL_HEIGHT = 0.12  # low, to look over
MARK_HEIGHT = 0.01  # of what is drawn on the floor
DECK_HEIGHT = 0.1
MAGNIFICATION = 10.0  # of next positions, which differ by centimetres

FLOOR_COLOUR: Colour = (225, 225, 225)
WALL_COLOUR: Colour = (95, 95, 95)


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A body with a surface."""

    entity: str
    mesh: Mesh
    colour: Colour


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """Polylines (k, 3), m, drawn `radius` m thick to either side."""

    entity: str
    strips: tuple[FloatArray, ...]
    colour: Colour
    radius: float


@dataclass(frozen=True, slots=True)
class Label:
    """A text at `place`, m."""

    entity: str
    text: str
    place: tuple[float, float, float]


def arena(world: "World") -> Iterator[Solid | Lines | Label]:
    """Floor, bounds, goal and obstacles."""
    scenario = world.scenario
    area = shapely.box(*scenario.bounds)
    yield Solid("/world/arena/floor", prism(area, -0.02, 0.0), FLOOR_COLOUR)
    edge = box_outline(scenario.bounds, MARK_HEIGHT)
    yield Lines("/world/arena/bounds", (edge,), colours.BLACK, 0.01)
    if scenario.walls:
        outside = area.buffer(0.1, join_style="mitre").exterior
        walls = Polygon(outside, [area.exterior])
        yield Solid("/world/arena/walls", prism(walls, 0.0, WALL_HEIGHT), WALL_COLOUR)

    ring = circle_outline(scenario.goal, scenario.goal_tolerance, MARK_HEIGHT)
    yield Lines("/world/goal/tolerance", (ring,), colours.GREEN, 0.012)
    mast = shapely.Point(scenario.goal).buffer(0.015)
    yield Solid("/world/goal/mast", prism(mast, 0.0, 0.5), colours.GREEN)
    yield Label("/world/goal/label", "goal", (*scenario.goal, 0.6))

    for index, shape in enumerate(world.static):
        mesh = prism(shape.footprint, 0.0, OBSTACLE_HEIGHT)
        yield Solid(f"/world/static/{index}", mesh, colours.GREY)
    for index, mover in enumerate(world.movers):
        mesh = prism(mover.shape.footprint, 0.0, OBSTACLE_HEIGHT)
        yield Solid(f"{MOVING}/{index}", mesh, colours.ORANGE)


def robot_parts(robot: RobotSpec) -> Iterator[Solid | Lines]:
    """The robot with its front marked, its footprint, and how far it sees."""
    half, radius = robot.half_side, robot.wheel_radius
    wheel_width = 0.024
    body = shapely.box(-half, wheel_width - half, 0.8 * half, half - wheel_width)
    bumper = shapely.box(0.8 * half, -half, half, half)
    nose = Polygon([(0.75 * half, 0.0), (0.0, 0.4 * half), (0.0, -0.4 * half)])
    yield Solid(f"{ROBOT}/body", prism(body, 0.02, DECK_HEIGHT), colours.BLUE)
    yield Solid(f"{ROBOT}/bumper", prism(bumper, 0.02, 0.9 * DECK_HEIGHT), colours.YELLOW)
    yield Solid(f"{ROBOT}/nose", prism(nose, DECK_HEIGHT, 1.05 * DECK_HEIGHT), colours.YELLOW)
    tyre = shapely.Point(-robot.axle_offset, radius).buffer(radius)
    for name, y in (("left", robot.track / 2), ("right", -robot.track / 2)):
        wheel = lying(prism(tyre, y - wheel_width / 2, y + wheel_width / 2))
        yield Solid(f"{ROBOT}/wheels/{name}", wheel, colours.BLACK)

    square = box_outline((-half, -half, half, half), MARK_HEIGHT)
    rings = tuple(circle_outline((0.0, 0.0), ring, MARK_HEIGHT) for ring in robot.rings)
    yield Lines(f"{ROBOT}/footprint", (square,), colours.BLUE, 0.004)
    yield Lines(f"{ROBOT}/range", rings, colours.GREY, 0.004)
