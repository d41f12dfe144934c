"""The visibility matrix and the counts per quarter, on scenes counted by hand."""

from itertools import pairwise
from math import cos, pi, radians, sin

import numpy as np
import pytest

from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.loading import parse_scenario
from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.sensing.looks import take_look
from fuzzynav_mj.sensing.perception import Perceiver
from fuzzynav_mj.sensing.visibility import visibility_matrix
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.types import LaserScan, Pose2D, VisibilityMatrix

RINGS = DEFAULT_ROBOT.rings
BEARINGS = ray_bearings(180)  # every two degrees, one of them straight ahead
HERE = Pose2D(0.0, 0.0, 0.0)


def seen(arcs: list[tuple[int, int, float]], stamp: float = 0.0) -> LaserScan:
    """A scan that meets something at `range` on the bearings from `first` to `last` degrees."""
    degrees = np.degrees(BEARINGS)
    ranges = np.full(180, RINGS[-1])
    for first, last, distance in arcs:
        ranges[(degrees > first - 1) & (degrees < last + 1)] = distance
    return LaserScan(stamp, BEARINGS, ranges, ranges < RINGS[-1], RINGS[-1])


def matrix(
    now: list[tuple[int, int, float]],
    before: list[tuple[int, int, float]] | None = None,
    pose: Pose2D = HERE,
) -> VisibilityMatrix:
    earlier = None if before is None else take_look(seen(before), HERE)
    return visibility_matrix(take_look(seen(now, 0.1), pose), earlier, BEARINGS, RINGS)


def test_nothing_in_sight() -> None:
    visibility = matrix([])
    assert not visibility.occupied.any()
    assert visibility.counts.tolist() == visibility.previous_counts.tolist() == [0, 0, 0, 0]


@pytest.mark.parametrize(
    ("distance", "rings"), [(0.1, 4), (0.2, 4), (0.21, 3), (0.5, 2), (0.7, 1), (0.79, 1)]
)
def test_a_ring_is_blocked_from_the_hit_outwards(distance: float, rings: int) -> None:
    visibility = matrix([(10, 28, distance)])  # ten rays
    assert visibility.occupied.shape == (4, 180)
    assert visibility.counts.tolist() == [0, 10 * rings, 0, 0]
    per_ring = visibility.occupied.sum(axis=1).tolist()
    assert per_ring == [0] * (4 - rings) + [10] * rings


@pytest.mark.parametrize(
    ("first", "last", "quarter"),
    [(-88, -2, 0), (0, 88, 1), (90, 178, 2), (-180, -92, 3)],
)
def test_quarters(first: int, last: int, quarter: int) -> None:
    """q1 front right, q2 front left, q3 rear left, q4 rear right; a border counts to its left."""
    rays = (last - first) // 2 + 1
    expected = [0, 0, 0, 0]
    expected[quarter] = 2 * rays
    assert matrix([(first, last, 0.5)]).counts.tolist() == expected


def test_obstacle_straight_ahead_counts_on_both_sides() -> None:
    assert matrix([(-6, 6, 0.3)]).counts.tolist() == [9, 12, 0, 0]  # 3 and 4 rays, 3 rings


def test_approach_makes_the_count_grow_and_retreat_makes_it_shrink() -> None:
    far, near = [(20, 38, 0.7)], [(18, 40, 0.5)]
    assert matrix(near, far).counts.tolist() == [0, 24, 0, 0]
    assert matrix(near, far).previous_counts.tolist() == [0, 10, 0, 0]
    assert matrix(far, near).counts.tolist() == [0, 10, 0, 0]
    assert matrix(far, near).previous_counts.tolist() == [0, 24, 0, 0]


def test_first_look_compares_with_itself() -> None:
    visibility = matrix([(0, 40, 0.5)])
    assert visibility.previous_counts.tolist() == visibility.counts.tolist()


def test_turning_on_the_spot_changes_no_total() -> None:
    """Ninety degrees to the left: what was ahead is seen to the right."""
    visibility = matrix([(-70, -50, 0.5)], [(20, 40, 0.5)], Pose2D(0.0, 0.0, pi / 2))
    assert visibility.counts.tolist() == visibility.previous_counts.tolist() == [22, 0, 0, 0]


def test_previous_look_is_seen_from_the_present_place() -> None:
    """A point 0.70 m ahead is 0.55 m ahead after 0.15 m: one ring more, though nothing moved."""
    visibility = matrix([(0, 0, 0.55)], [(0, 0, 0.70)], Pose2D(0.15, 0.0, 0.0))
    assert visibility.counts.sum() == visibility.previous_counts.sum() == 2


# Simulated scenes -----------------------------------------------------------------------------

SCENE = """
schema = 1
name = "scene"
description = "One obstacle near the robot."
bounds = [-4.0, -4.0, 4.0, 4.0]
time_limit = 60.0
[robot]
start = [0.0, 0.0, {yaw}]
goal = [3.5, 3.5]
"""


def scene(obstacle: str, yaw: float = 0.0) -> EpisodeSimulation:
    text = SCENE.format(yaw=yaw) + obstacle
    return EpisodeSimulation(parse_scenario(text.encode(), "scene"), 0)


def looks(
    simulation: EpisodeSimulation, step: tuple[float, float], count: int
) -> list[VisibilityMatrix]:
    """What each of the next looks shows while every step leads (forward, left) by `step`, m."""
    perceiver = Perceiver(DEFAULT_ROBOT)
    found = []
    for _ in range(count):
        pose = simulation.pose
        found.append(perceiver.perceive(simulation.scan, pose).visibility)
        c, s = cos(pose.yaw), sin(pose.yaw)
        forward, left = step
        simulation.drive((pose.x + c * forward - s * left, pose.y + s * forward + c * left))
        assert simulation.outcome is None
    return found


def change(visibility: VisibilityMatrix) -> list[int]:
    counts: list[int] = (visibility.counts - visibility.previous_counts).tolist()
    return counts


def test_what_a_standing_robot_saw_is_what_it_remembers() -> None:
    found = looks(scene("[[moving]]\ncircle = 0.15\nwaypoints = [[2, 0.4], [-2, 0.4]]\n"
                        "speed = 0.4"), (0.0, 0.0), 80)  # fmt: skip
    for before, now in pairwise(found):
        assert np.abs(now.previous_counts - before.counts).max() <= 1
    assert max(int(v.counts.sum()) for v in found) > 50


@pytest.mark.parametrize("degrees", [45, 135, 225, 315])
def test_counts_tell_coming_from_going(degrees: float) -> None:
    """A mover comes straight at the standing robot as near as 0.4 m, and goes back."""
    c, s = cos(radians(degrees)), sin(radians(degrees))
    mover = (
        f"[[moving]]\ncircle = 0.2\nspeed = 0.3\n"
        f"waypoints = [[{1.5 * c}, {1.5 * s}], [{0.4 * c}, {0.4 * s}]]"
    )
    quarter = (int(degrees // 90) + 1) % 4
    turned = round(1.1 / 0.3 / DEFAULT_ROBOT.decision_period)
    found = [change(visibility) for visibility in looks(scene(mover), (0.0, 0.0), 2 * turned)]
    coming, going = found[:turned], found[turned + 1 :]
    assert all(row[quarter] >= 0 for row in coming)
    assert all(row[quarter] <= 0 for row in going)
    assert sum(row[quarter] > 0 for row in coming) >= 12
    assert sum(row[quarter] < 0 for row in going) >= 12
    assert all(not any(row[:quarter] + row[quarter + 1 :]) for row in found)


@pytest.mark.parametrize("step", [(0.0, 0.0), (0.05, 0.0), (0.03, 0.008), (0.0, -0.012)])
def test_counts_of_a_standing_obstacle_hardly_change_as_the_robot_moves(
    step: tuple[float, float],
) -> None:
    """They differ only where hits of the one look fall between the rays of the other."""
    found = looks(scene("[[static]]\ncircle = [0.55, 0.35, 0.12]", yaw=-0.3), step, 9)
    for visibility in found:
        now, before = int(visibility.counts.sum()), int(visibility.previous_counts.sum())
        assert now > 5
        assert abs(now - before) <= 3


def test_mover_among_what_stands_shows_in_its_quarter_only() -> None:
    """A wall to the right, a mover coming from the left."""
    obstacles = (
        "[[static]]\npolygon = [[-2, -0.7], [2, -0.7], [2, -0.5], [-2, -0.5]]\n"
        "[[moving]]\ncircle = 0.15\nspeed = 0.3\nwaypoints = [[0.3, 1.5], [0.3, 0.45]]"
    )
    found = [change(visibility) for visibility in looks(scene(obstacles), (0.0, 0.0), 30)]
    front_right, front_left, _, rear_right = zip(*found, strict=True)
    assert not any(front_right) and not any(rear_right)
    assert min(front_left) >= 0 and sum(front_left) > 20
