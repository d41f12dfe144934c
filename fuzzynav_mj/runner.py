"""Runs one episode of a scenario: what the command line and the benchmark have in common."""

from functools import lru_cache
from importlib.metadata import version

import numpy as np

import fuzzynav_mj
from fuzzynav_mj.disturbance import PERFECT, Disturbance
from fuzzynav_mj.episode import Episode, run_episode
from fuzzynav_mj.oracle import Possibility, assess
from fuzzynav_mj.planners import make_planner
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.schema import Bounds, Scenario
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.scenarios.world import make_world
from fuzzynav_mj.sensing.disturbed import Sensors
from fuzzynav_mj.shortest_path import shortest_path

Point = tuple[float, float]
Circle = tuple[float, float, float]


def play_episode(
    scenario: Scenario, planner: str, seed: int, disturbance: Disturbance = PERFECT
) -> Episode:
    """Simulate one episode from its start to its end.

    Args:
        scenario: what to drive through.
        planner: name of a planner.
        seed: of everything random in the episode; not negative.
        disturbance: what is wrong with the sensors and the floor.

    Raises:
        UnknownNameError: no planner has this name.
        ScenarioError: the moving obstacles of this seed find no room.
    """
    chosen = make_planner(planner)
    # MuJoCo and dm_control take longer to import than a wrong name takes to be found.
    from fuzzynav_mj.rehearsal import rehearse
    from fuzzynav_mj.tasks.simulation import EpisodeSimulation

    rehearse()
    simulation = EpisodeSimulation(scenario, seed, disturbance.friction)
    return run_episode(
        simulation,
        chosen,
        planner,
        simulation.planner_rng,
        shortest_length(scenario),
        versions(),
        Sensors(disturbance, simulation.sensor_rng),
    )


def judge_world(scenario: Scenario, seed: int) -> Possibility:
    """Whether a contact-free run exists among the obstacles that this seed brings.

    Raises:
        ScenarioError: the moving obstacles of this seed find no room.
    """
    from fuzzynav_mj.tasks.streams import episode_streams

    return assess(make_world(scenario, episode_streams(seed).scenario), DEFAULT_ROBOT)


def shortest_length(scenario: Scenario) -> float:
    """Length of the shortest path from start to goal among the static obstacles, m.

    `inf` where there is none. Computed once in a process for the same geometry.
    """
    return _shortest_length(
        tuple(shape.circle or _corners(shape) for shape in scenario.static),
        scenario.bounds if scenario.walls else None,
        (scenario.start.x, scenario.start.y),
        scenario.goal,
    )


def versions() -> dict[str, str]:
    """Versions of everything that an episode's numbers depend on."""
    return {
        "fuzzynav_mj": fuzzynav_mj.__version__,
        "mujoco": version("mujoco"),
        "dm_control": version("dm-control"),
        "numpy": version("numpy"),
    }


def _corners(shape: Shape) -> tuple[Point, ...]:
    assert shape.polygon is not None
    return tuple((float(x), float(y)) for x, y in shape.polygon)


@lru_cache(maxsize=256)
def _shortest_length(
    static: tuple[Circle | tuple[Point, ...], ...], bounds: Bounds | None, start: Point, goal: Point
) -> float:
    shapes = [
        Shape(None, outline) if isinstance(outline[0], float) else Shape(np.array(outline), None)
        for outline in static
    ]
    return shortest_path(shapes, bounds, start, goal)[0]
