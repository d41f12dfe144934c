"""Phases drawn for one episode: where on its route a scripted obstacle is at time 0."""

from dataclasses import replace

import numpy as np
import shapely
from shapely.affinity import translate

from fuzzynav_mj.errors import ScenarioError
from fuzzynav_mj.geometry import footprint
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.motion import Mover, RouteMotion
from fuzzynav_mj.scenarios.random_movers import START_GAP
from fuzzynav_mj.scenarios.schema import Scenario

TRIES = 500


def draw_phases(scenario: Scenario, rng: np.random.Generator) -> tuple[Mover, ...]:
    """Return the scripted obstacles in their order, those that ask for it with a drawn phase.

    The phases are independent of each other, each uniform over one period of its motion (over the
    whole route where `repeat` is `once`) among those that keep the obstacle `START_GAP` away from
    the robot's start at time 0.

    Raises:
        ScenarioError: no such phase was found.
    """
    start = footprint(scenario.start, DEFAULT_ROBOT.half_side)
    shapely.prepare(start)
    movers = list(scenario.moving)
    for index in sorted(scenario.random_phases):
        shape, motion = movers[index].shape, movers[index].motion
        assert isinstance(motion, RouteMotion)
        for phase in rng.uniform(0.0, motion.period, TRIES):
            drawn = replace(motion, phase=motion.times[0] + phase)
            x, y = drawn.positions(np.zeros(1))[0]
            if not shapely.dwithin(start, translate(shape.footprint, x, y), START_GAP):
                movers[index] = Mover(shape, drawn)
                break
        else:
            raise ScenarioError(
                f"{scenario.source}: moving.{index}.phase: given 'random' for a motion that was "
                "found at no time away from the robot's start; allowed a motion that takes the "
                f"obstacle {START_GAP} m away from it"
            )
    return tuple(movers)
