"""What noise and missing rays make of an edge: it stands, and what comes out behind it moves."""

from math import cos, pi, sin

import numpy as np
import pytest
from made_scans import PERIOD, RAYS, REACH, scan_of, square

from fuzzynav_mj.disturbance import Disturbance
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.sensing.perception import Perceiver
from fuzzynav_mj.types import FloatArray, LaserScan, Perception, Pose2D

SENSOR = Disturbance(range_noise_m=0.01, dropouts=0.02)
WALL = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 0.2], [0.0, 0.2]])
DRIVES = range(40)


def noisy(scan: LaserScan, rng: np.random.Generator) -> LaserScan:
    hit = scan.hit & (rng.random(RAYS) >= SENSOR.dropouts)
    ranges = scan.ranges + rng.normal(0.0, SENSOR.range_noise_m, RAYS)
    return LaserScan(scan.stamp, scan.bearings, np.where(hit, ranges, REACH), hit, REACH)


def looks(bodies: list[list[FloatArray]], poses: list[Pose2D], seed: int) -> list[Perception]:
    """What is perceived of these bodies from these poses, one after the other."""
    rng, perceiver = np.random.default_rng(seed), Perceiver(DEFAULT_ROBOT, sensor=SENSOR)
    return [
        perceiver.perceive(noisy(scan_of(seen, PERIOD * k, pose), rng), pose)
        for k, (seen, pose) in enumerate(zip(bodies, poses, strict=True))
    ]


def test_the_end_of_a_wall_stands_while_the_robot_rounds_it() -> None:
    """At 0.5 m/s and 0.16 m off: along the wall, around its corner, along its end."""
    angles = (0.5 * PERIOD / 0.16 * np.arange(6)).tolist()
    beside = [Pose2D(0.05 * k, -0.16, pi) for k in range(8, 0, -1)]
    around = [Pose2D(-0.16 * sin(a), -0.16 * cos(a), pi - a) for a in angles]
    onward = [Pose2D(-0.16, 0.05 * k, pi / 2) for k in range(1, 6)]
    poses = beside + around + onward
    drives = [looks([[WALL]] * len(poses), poses, seed) for seed in DRIVES]
    assert np.mean([look.anything_moves for drive in drives for look in drive]) < 0.04


def test_a_mover_that_comes_out_from_behind_an_end_is_seen_a_look_later() -> None:
    """A square slides out behind a wall at 0.4 m/s, 5 cm off it, while the robot drives up to it;
    look 10 is the first to show it, with two rays."""
    poses = [Pose2D(-0.2, -0.7 + 0.03 * k, pi / 2) for k in range(14)]
    bodies = [[WALL, square(0.5 - 0.04 * k, 0.35)] for k in range(14)]
    shown = [
        (scan_of(seen, 0.0, pose).hit & ~scan_of([WALL], 0.0, pose).hit).sum()
        for seen, pose in zip(bodies, poses, strict=True)
    ]
    assert shown[:11] == [0] * 10 + [2]
    drives = [looks(bodies, poses, seed) for seed in DRIVES]
    first = np.array([[look.anything_moves for look in drive].index(True) for drive in drives])
    assert (first <= 11).mean() > 0.8 and first.max() <= 12


@pytest.mark.parametrize("speed", [0.1, 0.2, 0.4])
def test_a_side_that_slides_along_itself_is_seen_to_move_for_all_the_noise(speed: float) -> None:
    """A square 0.35 m ahead of the robot, to its left."""
    bodies = [[square(0.45, 0.1 * speed * k - 0.1)] for k in range(8)]
    first = []
    for seed in DRIVES:
        seen = looks(bodies, [Pose2D(0.0, 0.0, 0.3)] * 8, seed)
        first.append([look.anything_moves for look in seen].index(True))
    assert np.median(first) <= (2 if speed < 0.2 else 1) and max(first) <= 4
