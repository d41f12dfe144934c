"""The floors and the map followers, from hand-made observations."""

from dataclasses import replace
from math import atan2, cos, hypot, pi, sin

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from peer_scenes import discs_scan, hit_points, observe, towards
from solids import scan_of

from fuzzynav_mj.control import drive_towards
from fuzzynav_mj.geometry import footprints, wrap_angle
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Planner
from fuzzynav_mj.planners.clearance import static_clearance
from fuzzynav_mj.planners.peers import prm, rrt
from fuzzynav_mj.planners.peers.bug import BugPlanner
from fuzzynav_mj.planners.peers.path_following import PathFollower
from fuzzynav_mj.planners.peers.prm import Prm
from fuzzynav_mj.planners.peers.rrt import Rrt
from fuzzynav_mj.planners.peers.static import StaticPlanner
from fuzzynav_mj.planners.peers.straight import StraightPlanner
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.types import Behaviour, FloatArray, Pose2D, Twist2D

HALF = DEFAULT_ROBOT.half_side
SQUARE = np.array([[-1.0, -3.0], [4.0, -3.0], [4.0, 3.0], [-1.0, 3.0]])  # walls far away


def with_map(x: float, y: float, *outlines: FloatArray) -> NavigationProblem:
    """The task of reaching (x, y) with a map."""
    return replace(towards(x, y), static_map=(*outlines, SQUARE))


def started(planner: Planner, problem: NavigationProblem) -> Planner:
    """The planner at the beginning of an episode."""
    planner.reset(problem, np.random.default_rng(0))
    return planner


def drive(
    planner: Planner, pose: Pose2D, goal: tuple[float, float], solid: shapely.Geometry | None = None
) -> list[Pose2D]:
    """Poses of a robot that starts at rest, up to the goal or to 15 s."""
    twist, poses = Twist2D(0.0, 0.0), [pose]
    for number in range(150):
        scan = discs_scan() if solid is None else scan_of(solid, pose)
        decision = planner.decide(Observation(0.1 * number, pose, twist, scan, None))
        profile = drive_towards(decision.next_position, pose, twist, DEFAULT_ROBOT)
        turned = float(profile.omega.sum()) * DEFAULT_ROBOT.physics_period
        pose = Pose2D(*decision.next_position, wrap_angle(pose.yaw + turned))
        twist = profile.final
        poses.append(pose)
        if hypot(pose.x - goal[0], pose.y - goal[1]) <= 0.05:
            break
    return poses


@settings(deadline=None, max_examples=30)
@given(st.floats(-pi, pi), st.floats(1.0, 5.0))
def test_straight_never_leaves_the_line(direction: float, distance: float) -> None:
    goal = (distance * cos(direction), distance * sin(direction))
    planner = started(StraightPlanner(), towards(*goal))
    poses = drive(planner, Pose2D(0.0, 0.0, direction), goal)
    assert max(abs(goal[0] * pose.y - goal[1] * pose.x) for pose in poses) < 1e-3 * distance
    assert len(poses) <= distance / 0.05 + 4  # at full speed but for the start


def test_straight_turns_about_its_axle_first() -> None:
    """Facing away, the centre swings half around the axle 5 cm behind it, then drives on."""
    planner = started(StraightPlanner(), towards(-2.0, 0.0))
    poses = drive(planner, Pose2D(0.0, 0.0, 0.0), (-2.0, 0.0))
    assert max(abs(pose.y) for pose in poses) <= 0.055
    assert hypot(poses[-1].x + 2.0, poses[-1].y) <= 0.05


def test_straight_arrives_with_the_yaw_asked_for() -> None:
    planner = started(StraightPlanner(), towards(1.0, 0.0, goal_yaw=pi / 2))
    poses = drive(planner, Pose2D(0.0, 0.0, 0.0), (9.0, 9.0))
    assert hypot(poses[-1].x - 1.0, poses[-1].y) <= 0.1
    assert poses[-1].yaw == pytest.approx(pi / 2, abs=0.1)


PLACES = st.tuples(st.floats(-0.7, 0.7), st.floats(-0.7, 0.7), st.floats(0.05, 0.2)).filter(
    lambda disc: hypot(disc[0], disc[1]) - disc[2] > 0.25
)


@settings(deadline=None, max_examples=60)
@given(
    st.lists(PLACES, max_size=4),
    st.floats(-pi, pi),
    st.floats(-0.5, 0.5),
    st.sampled_from([StaticPlanner, BugPlanner]),
)
def test_no_step_goes_into_a_hit(
    discs: list[tuple[float, float, float]], direction: float, v: float, kind: type[Planner]
) -> None:
    """From any speed at which it could stop, the next footprint keeps clear of all hits."""
    scan = discs_scan(*discs)
    problem = towards(3.0 * cos(direction), 3.0 * sin(direction))
    observation = replace(observe(scan, Twist2D(v, 0.0)), perception=None)
    decision = started(kind(), problem).decide(observation)
    profile = drive_towards(
        decision.next_position, observation.pose, observation.twist, DEFAULT_ROBOT
    )
    x, y = decision.next_position
    turned = float(profile.omega.sum()) * DEFAULT_ROBOT.physics_period
    after = np.array([[[x, y, turned]]])
    assert np.isfinite([x, y]).all()
    assert hypot(x, y) <= 0.05 + 1e-3
    assert static_clearance(after, hit_points(scan), HALF)[0, 0] > 0.0


def test_static_stays_in_a_pocket_and_bug_follows_it() -> None:
    """A bow of discs around the goal's side: the greedy one stands, the bug turns away."""
    bow = [(0.42 * cos(a), 0.42 * sin(a), 0.15) for a in np.linspace(-1.6, 1.6, 9)]
    scan = discs_scan(*bow)
    observation = replace(observe(scan), perception=None)
    static = started(StaticPlanner(), towards(3.0, 0.0)).decide(observation)
    bug = started(BugPlanner(), towards(3.0, 0.0)).decide(observation)
    assert static.subgoal is not None and bug.subgoal is not None
    assert static.subgoal[0] > 0.0
    assert bug.behaviour is Behaviour.BOUNDARY_FOLLOWING
    assert abs(atan2(bug.subgoal[1], bug.subgoal[0])) > pi / 2


@pytest.mark.parametrize("method", [Prm, Rrt])
def test_a_follower_drives_its_path(method: type[Prm] | type[Rrt]) -> None:
    wall = np.array([[1.0, -1.0], [1.2, -1.0], [1.2, 1.0], [1.0, 1.0]])
    planner = started(PathFollower(method), with_map(2.5, 0.0, wall))
    poses = drive(planner, Pose2D(0.0, 0.0, 0.0), (2.5, 0.0), shapely.Polygon(wall))
    assert hypot(poses[-1].x - 2.5, poses[-1].y) <= 0.05
    squares = footprints(np.array([[pose.x, pose.y, pose.yaw] for pose in poses]), HALF)
    assert shapely.distance(squares, shapely.Polygon(wall)).min() > 0.005


@pytest.mark.parametrize("method", [Prm, Rrt])
def test_a_follower_waits_where_strangers_shut_the_only_way(method: type[Prm] | type[Rrt]) -> None:
    """Known walls leave a corridor 0.6 m wide; a disc that no map knows of stands in it."""
    walls = [np.array([[-1.0, y], [4.0, y], [4.0, y + 0.5], [-1.0, y + 0.5]]) for y in (-0.8, 0.3)]
    planner = started(PathFollower(method), with_map(3.0, 0.0, *walls))
    seen = replace(observe(discs_scan((0.6, 0.0, 0.15))), perception=None)
    assert planner.decide(seen).behaviour is Behaviour.WAITING
    free = replace(seen, stamp=1.5, scan=discs_scan())
    assert planner.decide(free).behaviour is Behaviour.GOAL_SEEKING


@pytest.mark.parametrize("method", [Prm, Rrt])
def test_a_follower_without_a_path_says_so(
    method: type[Prm] | type[Rrt], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(prm, "MOST_SAMPLES", prm.SAMPLES)
    monkeypatch.setattr(rrt, "DRAWS", 500)
    wall = np.array([[1.0, -3.0], [1.2, -3.0], [1.2, 3.0], [1.0, 3.0]])
    planner = started(PathFollower(method), with_map(2.5, 0.0, wall))
    assert planner.decide(replace(observe(), perception=None)).give_up == "no_path"


@pytest.mark.parametrize("method", [Prm, Rrt])
def test_a_goal_close_to_a_wall_is_reached(method: type[Prm] | type[Rrt]) -> None:
    """0.11 m from the wall the square fits beside it, but not the disc that paths are for."""
    wall = np.array([[1.11, -1.0], [1.3, -1.0], [1.3, 1.0], [1.11, 1.0]])
    planner = started(PathFollower(method), with_map(1.0, 0.0, wall))
    poses = drive(planner, Pose2D(0.0, 0.0, 0.0), (1.0, 0.0), shapely.Polygon(wall))
    assert hypot(poses[-1].x - 1.0, poses[-1].y) <= 0.05
