"""A scenario with its random obstacles drawn: the geometry of one episode."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from fuzzynav_mj.scenarios.motion import Motion, Mover
from fuzzynav_mj.scenarios.random_movers import draw_movers
from fuzzynav_mj.scenarios.random_phases import draw_phases
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.shape import Shape

__all__ = ["Motion", "Mover", "Shape", "World", "make_world"]


@dataclass(frozen=True, eq=False)
class World:
    """The obstacles of one episode.

    Attributes:
        scenario: what was asked for.
        static: obstacles that stand still, world frame, in the scenario's order.
        movers: the scripted obstacles in the scenario's order, then the drawn ones.
    """

    scenario: Scenario
    static: tuple[Shape, ...]
    movers: tuple[Mover, ...]

    @cached_property
    def static_union(self) -> BaseGeometry:
        """The area covered by the static obstacles, without the walls."""
        return shapely.union_all([shape.footprint for shape in self.static])

    @cached_property
    def free_space(self) -> BaseGeometry:
        """The area within the bounds that no static obstacle covers."""
        return shapely.box(*self.scenario.bounds) - self.static_union


def make_world(scenario: Scenario, rng: np.random.Generator) -> World:
    """Draw the random phases and obstacles of `scenario`.

    Raises:
        ScenarioError: no phase was found that keeps a scripted obstacle away from the robot's
            start, or no motion that keeps a drawn one clear of the static ones.
    """
    movers = draw_phases(scenario, rng) + draw_movers(scenario, rng)
    return World(scenario=scenario, static=scenario.static, movers=movers)
