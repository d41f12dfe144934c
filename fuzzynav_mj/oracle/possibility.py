"""Whether a world leaves a way to the goal: the judge of what a planner can be asked for."""

import math
from dataclasses import dataclass

import numpy as np

from fuzzynav_mj.oracle.grid import Grid, grid_over
from fuzzynav_mj.oracle.occupancy import Clearance, free_layers
from fuzzynav_mj.oracle.reachability import SLOWEST, earliest_layer
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.scenarios.schema import Bounds, Scenario
from fuzzynav_mj.scenarios.world import World
from fuzzynav_mj.shortest_path import shortest_path
from fuzzynav_mj.types import IntArray

OUTSIDE = 1.0  # m around everything that the robot may use where the arena has no walls


@dataclass(frozen=True, slots=True)
class Possibility:
    """What a robot that knew every motion could do in a world.

    Attributes:
        possible_optimistic: False only if even the optimistic search finds no run.
        possible_cautious: True only if a contact-free run exists.
        earliest_arrival_s: of the cautious run, s; inf if there is none.
        static_lower_bound_s: time to the goal at top speed on the shortest path among the static
            obstacles, up to the goal's tolerance, s; inf if there is no path.
    """

    possible_optimistic: bool
    possible_cautious: bool
    earliest_arrival_s: float
    static_lower_bound_s: float


def assess(world: World, spec: RobotSpec, cell: float = 0.05) -> Possibility:
    """Judge by reachability on a time-expanded grid whether a contact-free run exists.

    The robot is a disc that changes direction and speed at once, up to `spec.max_speed`; neither
    its yaw nor a goal's yaw counts. It starts on a node; layers of time are `cell` / speed apart,
    so that a step is one cell; slanting moves of five cells in five layers add eight directions.
    It has arrived on a node within the goal's tolerance (or within half a cell's diagonal, if that
    is more), before the scenario's time limit.

    Cautious: a disc around the whole footprint, so whatever it finds is possible for the robot
    in any yaw. Nodes are kept so far from the obstacles, at every layer, that the disc touches
    nothing between the nodes and the layers either, even where a mover turns at once; thus no wall
    and no mover is jumped. It under-estimates in that a square fits where its outer disc does not;
    in that it keeps 0.5 cm more from what stands still and 1 to 1.5 cm more from movers, so that
    passages are found for certain from 0.36 m on, and none below 0.29 m (all at the defaults); and
    in that directions between the twelve are up to 5 % slow. The arrival is late by that, by three
    layers more at most, and by the detours. It over-estimates in one thing: a real robot must
    accelerate and turn.

    Optimistic: a disc inside the footprint, smaller by half a cell's diagonal so that every
    passage open to the disc holds a chain of nodes, and faster by the 5 %, so that no direction is
    slow. Obstacles are looked at on the layers only. A mover can be jumped if it and the disc
    together are smaller than the way they travel towards each other in a layer, 0.1 m at the
    defaults. It under-estimates only in that it moves from node to node, which may cost it a layer
    or two where all depends on them. What the cautious search finds is possible for it.

    Without walls the robot may leave the bounds by 1 m; detours farther out are not found.

    Args:
        world: obstacles and their motions.
        spec: the robot's size and top speed.
        cell: distance between nodes, m; the smaller the sharper and slower (by its third power).

    Raises:
        ValueError: `cell` is too large to tell thin walls, or too small for the arena.
    """
    # The optimistic disc must not fit between two nodes, or it would jump thin walls.
    largest = spec.half_side / (math.sqrt(0.5) + 0.5)
    if not 0.0 < cell <= largest:
        raise ValueError(f"cell must be above 0 and at most {largest:.3g} m, not {cell}")
    scenario = world.scenario
    start = (scenario.start.x, scenario.start.y)
    bounds = scenario.bounds if scenario.walls else None
    length, _ = shortest_path(world.static, bounds, start, scenario.goal, spec.half_side)
    if math.isinf(length):
        return Possibility(False, False, math.inf, math.inf)
    bound = max(0.0, length - scenario.goal_tolerance) / spec.max_speed
    grid = grid_over(_area(world), start, cell)
    goals = _goals(grid, scenario)
    cautious = Clearance(spec.half_diagonal, spec.max_speed, cell, safe=True)
    arrival = _earliest(world, grid, goals, cautious)
    if math.isfinite(arrival):
        return Possibility(True, True, arrival, bound)
    inner = spec.half_side - cell * math.sqrt(0.5)
    optimistic = Clearance(inner, spec.max_speed / SLOWEST, cell, safe=False)
    possible = math.isfinite(_earliest(world, grid, goals, optimistic))
    return Possibility(possible, False, math.inf, bound)


def _earliest(world: World, grid: Grid, goals: IntArray, clearance: Clearance) -> float:
    layers = math.floor(world.scenario.time_limit / clearance.layer + 1e-9) + 1
    layer = earliest_layer(free_layers(world, grid, clearance, layers), grid, goals)
    return math.inf if layer is None else layer * clearance.layer


def _area(world: World) -> Bounds:
    scenario = world.scenario
    if scenario.walls:
        return scenario.bounds
    places = [(scenario.start.x, scenario.start.y), scenario.goal, scenario.bounds[:2]]
    places.append(scenario.bounds[2:])
    for shape in world.static:
        low_x, low_y, high_x, high_y = shape.footprint.bounds
        places += [(low_x, low_y), (high_x, high_y)]
    corners = np.array(places)
    (x_min, y_min), (x_max, y_max) = corners.min(axis=0) - OUTSIDE, corners.max(axis=0) + OUTSIDE
    return float(x_min), float(y_min), float(x_max), float(y_max)


def _goals(grid: Grid, scenario: Scenario) -> IntArray:
    x, y = grid.places()
    distance = np.hypot(x - scenario.goal[0], y - scenario.goal[1])
    tolerance = max(scenario.goal_tolerance, grid.cell * math.sqrt(0.5))
    goals: IntArray = np.flatnonzero(distance <= tolerance + 1e-9)
    return goals
