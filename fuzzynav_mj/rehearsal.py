"""A short episode before the first one, so that its times are those of any other.

Compiled functions are loaded, or made on a new machine, at their first call; tables of headings
and cells are filled at the first decision. The rehearsal sees to both in some tenths of a second,
or some seconds on a new machine.
"""

import gc
from dataclasses import replace
from functools import lru_cache
from math import pi

import numpy as np

from fuzzynav_mj.disturbance import Disturbance
from fuzzynav_mj.episode import run_episode
from fuzzynav_mj.fuzzy.risk import RiskGate
from fuzzynav_mj.planners.evasion import lasting
from fuzzynav_mj.planners.motions import candidate_motions
from fuzzynav_mj.planners.multilayer import MultilayerPlanner
from fuzzynav_mj.planners.outlook import look_ahead
from fuzzynav_mj.planners.passing import ways_past
from fuzzynav_mj.planners.scene import scene_around
from fuzzynav_mj.planners.settings import DecisionSettings, GuidanceSettings
from fuzzynav_mj.planners.sight import Sight
from fuzzynav_mj.planners.surroundings import Surroundings, as_if_standing, surroundings
from fuzzynav_mj.planners.walls import walls_in_sight
from fuzzynav_mj.planners.ways import straight_ways_in, way_beside_walls
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.scenarios.motion import Mover, waypoint_motion
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.sensing.corners import elsewhere, turned_at_once
from fuzzynav_mj.sensing.free_space import FreeSpace
from fuzzynav_mj.sensing.hidden import hidden_part
from fuzzynav_mj.sensing.lateness import brought_up
from fuzzynav_mj.sensing.looks import Look, take_look
from fuzzynav_mj.sensing.outline import Outline, left_over, outline_around
from fuzzynav_mj.sensing.perception import Perceiver
from fuzzynav_mj.sensing.registration import misfit
from fuzzynav_mj.sensing.velocity_filter import Beliefs, gone_since, nothing_known, squared_sigmas
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.types import Pose2D, Twist2D

_POCKET = (
    (1.0, 0.4),
    (1.5, 0.4),
    (1.5, 1.6),
    (1.0, 1.6),
    (1.0, 1.5),
    (1.4, 1.5),
    (1.4, 0.5),
    (1.0, 0.5),
)
SELDOM = 10_000  # more objects made than freed, after which Python looks for garbage
_BLOCK = ((0.15, -0.1), (0.15, 0.1), (-0.15, 0.1), (-0.2, 0.0), (-0.15, -0.1))


@lru_cache(maxsize=1)
def settle() -> None:
    """Rehearses, has Python look no more for garbage among all that was made by then, and for
    other garbage less often.

    For processes that do nothing but play episodes: libraries, models and compiled code stay for
    as long as they do, and looking through them took 0.2 s every five episodes. What an episode
    makes is mostly its record, which is no garbage: looking through that took 3 % of its time.
    """
    rehearse()
    gc.collect()
    gc.freeze()
    gc.set_threshold(SELDOM)


@lru_cache(maxsize=1)
def rehearse() -> None:
    """Plays the rehearsal, once in a process. Nothing of it stays but what is compiled or filled.

    The robot drives into a pocket, searches the way around it, and meets a mover on the way. In the
    end it takes one look with sensors that are noisy and late.
    """
    mover = Mover(
        Shape(np.array(_BLOCK), None), waypoint_motion(np.array([[0.4, 1.5], [0.4, 0.2]]), 0.3)
    )
    scenario = Scenario(
        name="rehearsal",
        description="",
        bounds=(0.0, 0.0, 2.4, 2.0),
        walls=True,
        time_limit=3.0,
        allow_faster=False,
        start=Pose2D(1.0, 1.0, pi / 4),
        goal=(2.0, 1.0),
        goal_yaw=None,
        goal_tolerance=0.1,
        static=(Shape(np.array(_POCKET), None), Shape(None, (0.3, 1.8, 0.1))),
        moving=(mover,),
        random_moving=(),
        source="rehearsal",
    )
    simulation = EpisodeSimulation(scenario, 0)
    planner = MultilayerPlanner(RiskGate())
    run_episode(simulation, planner, "fuzzy", simulation.planner_rng, 0.0, {})
    spec, pose, scan = simulation.spec, simulation.pose, simulation.scan
    seen = Perceiver(spec, sensor=Disturbance(range_noise_m=0.01)).perceive(scan, pose)
    brought_up(seen, pose, spec.decision_period)
    around = surroundings(seen, pose, spec)
    as_if_standing(around, seen, pose, [])
    _rehearse_meetings(take_look(scan, pose), spec.sensor_range)
    _rehearse_ways(around.sight)
    _rehearse_pinch(around, pose, spec)


def _rehearse_meetings(look: Look, max_range: float) -> None:
    """What is only done where movers hide or pass each other, or turn at once."""
    nobody = np.zeros(len(look.ranges), dtype=bool)
    outline = outline_around(look, nobody, look.x, look.y, max_range)
    left_over(outline, np.arange(len(outline.joined)) == 0)
    misfit(outline, outline, 0.0, 0.0, max_range)
    hidden_part(outline.points, look, max_range, False)
    space = FreeSpace(look, [look])
    space.strangers(np.zeros(4), outline, [outline])
    _rehearse_turn(outline, space)


def _rehearse_turn(outline: Outline, space: FreeSpace) -> None:
    elapsed = 0.1
    beliefs = Beliefs(0.001, 0.0, 6.0, 0.06, 0.03)
    state, covariance = nothing_known(elapsed)
    before = outline._replace(stamp=outline.stamp - elapsed)
    past = space.now._replace(stamp=before.stamp)
    turned_at_once(outline, before, state[:2], 0.1, FreeSpace(space.now, [past]), beliefs)
    elsewhere(outline, before, *gone_since(state, elapsed), beliefs, 0.0)
    squared_sigmas(0.0, 0.0, covariance)


def _rehearse_ways(sight: Sight) -> None:
    """What is only done beside a wall that leaves sight."""
    settings = GuidanceSettings()
    ways = straight_ways_in(sight, settings)
    ways = replace(ways, open=np.ones(len(ways.open), dtype=bool))
    way_beside_walls(0, np.array([9.0, 0.0]), sight, ways, walls_in_sight(sight), settings)


def _rehearse_pinch(around: Surroundings, pose: Pose2D, spec: RobotSpec) -> None:
    """What is only done where no candidate keeps its margins."""
    settings = DecisionSettings()
    scene = scene_around(around, pose, spec, settings)
    outlook = look_ahead(candidate_motions(0.0, Twist2D(0.0, 0.0), spec), scene, spec, settings)
    passing = ways_past(around.sight, around.expected, np.array([1.0, 0.0]), settings)
    lasting(outlook, scene, passing, np.zeros(len(outlook.static)), pose.yaw, spec, settings)
