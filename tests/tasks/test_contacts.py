"""The episode ends at the first contact: when, with what, and whose fault it was."""

from math import cos, hypot, pi, sin

import numpy as np
import pytest
import shapely
from scenes import circle, mover, polygon, scenario

from fuzzynav_mj.geometry import footprint
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.types import Contact, FloatArray, Outcome, Pose2D

DT = DEFAULT_ROBOT.physics_period
HALF = DEFAULT_ROBOT.half_side


def drive_on(
    made: Scenario, heading: float | None, limit: float = 20.0
) -> tuple[Contact, FloatArray]:
    """Drive at full speed towards `heading`, or stand still, until contact.

    Returns:
        The contact, and (n, 3) poses after every physics step.
    """
    simulation = EpisodeSimulation(made, 0)
    poses = []
    while simulation.outcome is None and simulation.time < limit:
        pose = simulation.pose
        step = (0.0, 0.0) if heading is None else (0.05 * cos(heading), 0.05 * sin(heading))
        block = simulation.drive((pose.x + step[0], pose.y + step[1]))
        poses.append(block.poses)
    assert simulation.outcome is Outcome.CONTACT
    assert simulation.contact is not None
    return simulation.contact, np.concatenate(poses)


def first_overlap(poses: FloatArray, obstacle: shapely.Geometry) -> float:
    """Time of the first physics step whose footprint overlaps the obstacle."""
    for step, (x, y, yaw) in enumerate(poses):
        if footprint(Pose2D(x, y, yaw), HALF).intersects(obstacle):
            return (step + 1) * DT
    raise AssertionError("no pose overlaps the obstacle")


@pytest.mark.parametrize("heading", [0.0, pi / 2, pi, -pi / 2, 0.6])
def test_driving_into_a_wall(heading: float) -> None:
    made = scenario(start=(0.0, 0.0, heading), bounds=(-1.0, -1.2, 1.4, 1.6), goal=(9.0, 9.0))
    contact, poses = drive_on(made, heading)
    outside = shapely.box(-9, -9, 9, 9) - shapely.box(*made.bounds)
    assert contact.with_ == "wall"
    assert contact.at_fault
    assert contact.time_s == pytest.approx(first_overlap(poses, outside), abs=DT + 1e-9)
    assert contact.robot_speed_mps == pytest.approx(DEFAULT_ROBOT.max_speed, rel=0.03)


NOTCH = polygon((2.0, -0.5), (2.6, -0.5), (2.6, 0.5), (2.0, 0.5), (2.0, 0.25), (2.4, 0.25),
                (2.4, -0.25), (2.0, -0.25))  # fmt: skip


@pytest.mark.parametrize(
    ("obstacle", "expected"),
    [
        (polygon((1.0, -0.3), (1.4, 0.0), (1.0, 0.3)), 1.0 - HALF),
        (circle(1.5, 0.0, 0.3), 1.2 - HALF),
        (NOTCH, 2.4 - HALF),  # deep in the notch, not at its mouth
    ],
)
def test_driving_into_a_static_obstacle(obstacle: Shape, expected: float) -> None:
    decoys = (circle(-2.0, 2.0, 0.3), polygon((3.5, 3.5), (3.9, 3.5), (3.5, 3.9)))
    contact, poses = drive_on(scenario(static=(*decoys, obstacle)), 0.0)
    assert contact.with_ == "static:2"
    assert contact.at_fault
    assert poses[-1, 0] == pytest.approx(expected, abs=DEFAULT_ROBOT.max_speed * DT + 1e-4)
    footing = first_overlap(poses, obstacle.footprint)
    assert contact.time_s == pytest.approx(footing, abs=DT + 1e-9)


@pytest.mark.parametrize("phase", range(7))
@pytest.mark.parametrize("speed", [0.1, 0.5, 1.0])
def test_parked_robot_is_not_at_fault(phase: int, speed: float) -> None:
    """Whatever step of the decision period the mover arrives at."""
    gap = 0.9 + 0.013 * phase * speed
    if phase % 2:
        shape, front = circle(0.0, 0.0, 0.15), 0.15
    else:  # its points pass the robot on both sides; the mouth between them meets the corners
        shape = polygon((-0.15, -0.2), (0.15, -0.2), (0.0, 0.0), (0.15, 0.2), (-0.15, 0.2))
        front = 0.15 * HALF / 0.2
    begin = front + HALF + gap
    bystander = mover(circle(0.0, 0.0, 0.2), (-3.0, -3.0), (3.0, -3.0), 0.3)
    hitting = mover(shape, (-begin, 0.0), (0.0, 0.0), speed)
    contact, poses = drive_on(scenario(moving=(bystander, hitting)), None)
    assert contact.with_ == "moving:1"
    assert not contact.at_fault
    assert contact.robot_speed_mps < 1e-3
    assert contact.time_s == pytest.approx(gap / speed, abs=DT + 1e-9)
    assert np.abs(poses[-1, :2]).max() < 1e-4


def test_driving_into_a_mover_is_at_fault() -> None:
    crossing = mover(circle(0.0, 0.0, 0.2), (1.0, -1.0), (1.0, 1.0), 0.4)
    contact, _ = drive_on(scenario(moving=(crossing,)), 0.0)
    assert contact.with_ == "moving:0"
    assert contact.at_fault


def test_robot_that_turns_on_the_spot_sweeps_its_corner_into_a_wall() -> None:
    """A side is HALF from the axle's line; a corner reaches farther."""
    made = scenario(start=(0.0, 5.0 - HALF - 0.01, 0.0))
    simulation = EpisodeSimulation(made, 0)
    d = DEFAULT_ROBOT.axle_offset
    while simulation.outcome is None:
        pose, yaw = simulation.pose, simulation.pose.yaw + 0.2
        axle = pose.x - d * cos(pose.yaw), pose.y - d * sin(pose.yaw)
        simulation.drive((axle[0] + d * cos(yaw), axle[1] + d * sin(yaw)))
    contact = simulation.contact
    assert contact is not None
    assert contact.with_ == "wall" and contact.at_fault
    assert hypot(simulation.pose.x, simulation.pose.y - made.start.y) < 0.05


def test_passing_close_by_is_no_contact() -> None:
    slot = 2 * HALF + 0.006
    posts = (
        polygon((1.0, slot / 2), (1.5, slot / 2), (1.5, 1.0), (1.0, 1.0)),
        polygon((1.0, -1.0), (1.5, -1.0), (1.5, -slot / 2), (1.0, -slot / 2)),
    )
    simulation = EpisodeSimulation(scenario(static=posts, goal=(2.0, 0.0)), 0)
    while simulation.outcome is None:
        simulation.drive((simulation.pose.x + 0.05, 0.0))
    assert simulation.outcome is Outcome.GOAL_REACHED


def test_obstacles_move_at_every_physics_step() -> None:
    shape = circle(0.0, 0.0, 0.15)
    simulation = EpisodeSimulation(
        scenario(moving=(mover(shape, (-3.0, 2.0), (3.0, 2.0), 0.4),)), 0
    )
    rows = np.concatenate([simulation.drive((0.0, 0.0)).movers for _ in range(40)])
    expected = -3.0 + 0.4 * DT * (1 + np.arange(len(rows)))
    assert rows[:, 0, 0] == pytest.approx(expected, abs=1e-9)
    assert rows[-1].tolist() == simulation.mover_positions.tolist()
