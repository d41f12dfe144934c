"""Judges perception against the simulated truth while a robot drives at full speed and turns."""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import atan2, cos, hypot, pi, sin

import numpy as np
import shapely

from fuzzynav_mj.geometry import wrap_angle
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.world import Mover
from fuzzynav_mj.sensing.perception import Perceiver
from fuzzynav_mj.tasks.simulation import EpisodeSimulation
from fuzzynav_mj.types import FloatArray, IntArray, LaserScan, Perception, Pose2D

SETTLED = 0.4  # s in sight after which a mover must have been recognised
LOST = 0.25  # s out of sight after which a mover counts as new
FAST = 0.1  # m/s: slower movers need not be recognised
ON_SURFACE = 1.5e-3  # m: a hit this near to a mover's outline is on it

Driver = Callable[[Pose2D, LaserScan], tuple[float, float]]


@dataclass
class Tally:
    """What perception said against what was true, over many looks.

    Attributes:
        static_points: hits on walls and static obstacles.
        called_dynamic: how many of them were taken for movers.
        entries: fast movers that stayed in sight for `SETTLED`.
        recognised: how many of them were called dynamic within that time.
        settled_looks: looks at fast movers that had been in sight for longer.
        still_dynamic: how many of these looks called them dynamic.
        velocity_errors: m/s, at each of those.
        approach: true rate, m/s, at which the mover's visible part comes nearer to where the
            robot is, for quarters that show one mover and nothing else.
        growth: of the intersection count in the same quarters.
        robot_speeds: forward speed and yaw rate at every look.
    """

    static_points: int = 0
    called_dynamic: int = 0
    entries: int = 0
    recognised: int = 0
    settled_looks: int = 0
    still_dynamic: int = 0
    velocity_errors: list[float] = field(default_factory=list)
    approach: list[float] = field(default_factory=list)
    growth: list[int] = field(default_factory=list)
    robot_speeds: list[tuple[float, float]] = field(default_factory=list)


@dataclass
class _Sighting:
    """A mover in sight: when it came, when it was last seen, when it was recognised."""

    since: float
    last: float
    recognised: float | None = None
    counted: bool = False


def judge(scenario: Scenario, seed: int, driver: Driver, looks: int, tally: Tally) -> None:
    """Drive one episode, at most `looks` looks long, and add what perception said to `tally`."""
    simulation = EpisodeSimulation(scenario, seed)
    perceiver = Perceiver(simulation.spec)
    movers = simulation.world.movers
    sightings: dict[int, _Sighting] = {}
    for _ in range(looks):
        pose, time, twist = simulation.pose, simulation.time, simulation.twist
        perception = perceiver.perceive(simulation.scan, pose)
        points, dynamic, velocity = _labelled(perception)
        owner = owners(points, movers, simulation.mover_positions)
        truth = [true_velocity(mover, time) for mover in movers]
        tally.robot_speeds.append((twist.v, twist.omega))
        tally.static_points += int((owner == -1).sum())
        tally.called_dynamic += int(dynamic[owner == -1].sum())
        for index in np.unique(owner[owner >= 0]).tolist():
            mine = owner == index
            seen = sightings.get(index)
            if seen is None or time - seen.last > LOST:
                seen = sightings[index] = _Sighting(time, time)
            seen.last = time
            called = bool(dynamic[mine].mean() > 0.5)
            if called and seen.recognised is None:
                seen.recognised = time
            if hypot(*truth[index]) <= FAST or time - seen.since < SETTLED - 1e-9:
                continue
            if not seen.counted:
                seen.counted = True
                tally.entries += 1
                tally.recognised += (
                    seen.recognised is not None and seen.recognised - seen.since < SETTLED + 1e-9
                )
            tally.settled_looks += 1
            tally.still_dynamic += called
            if called:
                said = np.median(velocity[mine & dynamic], axis=0)
                tally.velocity_errors.append(hypot(*(said - truth[index])))
        _compare_counts(tally, perception, pose, points, owner, truth)
        simulation.drive(driver(pose, simulation.scan))
        if simulation.outcome is not None:
            return


def _labelled(perception: Perception) -> tuple[FloatArray, np.ndarray, FloatArray]:
    """(n, 2) hits, (n,) whether they are called dynamic, (n, 2) the velocity ascribed to them."""
    found = perception.obstacles
    if not found:
        return np.empty((0, 2)), np.empty(0, dtype=bool), np.empty((0, 2))
    return (
        np.concatenate([obstacle.points for obstacle in found]),
        np.concatenate([np.full(len(obstacle.points), obstacle.dynamic) for obstacle in found]),
        np.concatenate(
            [np.tile(obstacle.velocity, (len(obstacle.points), 1)) for obstacle in found]
        ),
    )


def owners(points: FloatArray, movers: tuple[Mover, ...], places: FloatArray) -> IntArray:
    """(n,) index of the mover that each point lies on; -1 for none."""
    owner = np.full(len(points), -1, dtype=np.intp)
    for index, (mover, place) in enumerate(zip(movers, places, strict=True)):
        near = np.hypot(*(points - place).T) < mover.shape.radius + 0.01
        if near.any():
            area = shapely.affinity.translate(mover.shape.footprint, *place)
            on_it = shapely.distance(shapely.points(points[near]), area) < ON_SURFACE
            owner[np.flatnonzero(near)[on_it]] = index
    return owner


def true_velocity(mover: Mover, time: float) -> FloatArray:
    """(2,) m/s."""
    around = np.array([time - 1e-3, time + 1e-3])
    before, after = mover.motion.positions(around)
    return (after - before) / 2e-3


def quarters(points: FloatArray, pose: Pose2D) -> IntArray:
    """(n,) 0 front right, 1 front left, 2 rear left, 3 rear right: the order of the counts."""
    bearing = np.arctan2(points[:, 1] - pose.y, points[:, 0] - pose.x) - pose.yaw
    return (np.floor(wrap_angle(bearing) / (pi / 2)).astype(np.intp) + 1) % 4


def _compare_counts(
    tally: Tally,
    perception: Perception,
    pose: Pose2D,
    points: FloatArray,
    owner: IntArray,
    truth: list[FloatArray],
) -> None:
    """Record growth of the counts and true approach where a quarter shows one mover alone."""
    quarter = quarters(points, pose)
    visibility = perception.visibility
    for index in range(4):
        inside = quarter == index
        seen = np.unique(owner[inside])
        if len(seen) != 1 or seen[0] == -1 or visibility.previous_counts[index] == 0:
            continue
        middle = points[inside].mean(axis=0) - (pose.x, pose.y)
        rate = -float(truth[int(seen[0])] @ middle) / hypot(*middle)
        tally.approach.append(rate)
        tally.growth.append(int(visibility.counts[index] - visibility.previous_counts[index]))


# Drivers --------------------------------------------------------------------------------------


def rover(rng: np.random.Generator, bounds: tuple[float, float, float, float]) -> Driver:
    """Full speed towards random places, round whatever is within half a metre."""
    low, high = np.array(bounds[:2]) + 0.5, np.array(bounds[2:]) - 0.5
    target = rng.uniform(low, high)
    turns = sorted(np.linspace(-pi, pi, 37).tolist(), key=abs)
    count = 0

    def drive(pose: Pose2D, scan: LaserScan) -> tuple[float, float]:
        nonlocal target, count
        count += 1
        if hypot(target[0] - pose.x, target[1] - pose.y) < 0.2 or count % 60 == 0:
            target = rng.uniform(low, high)
        wish = atan2(target[1] - pose.y, target[0] - pose.x)
        heading = wish + pi
        for turn in turns:
            off = wrap_angle(scan.bearings + pose.yaw - wish - turn)
            if scan.ranges[np.abs(off) < 0.6].min() > 0.45:
                heading = wish + turn
                break
        return _step(pose, heading)

    return drive


def weaver(turn_rate: float, period: int) -> Driver:
    """Full speed in a slalom: turns with `turn_rate`, the other way after every `period` looks."""
    count = -period // 2

    def drive(pose: Pose2D, scan: LaserScan) -> tuple[float, float]:
        nonlocal count
        count += 1
        sense = 1.0 if (count // period) % 2 == 0 else -1.0
        return _step(pose, pose.yaw + sense * turn_rate * DEFAULT_ROBOT.decision_period)

    return drive


def _step(pose: Pose2D, heading: float) -> tuple[float, float]:
    reach = DEFAULT_ROBOT.max_speed * DEFAULT_ROBOT.decision_period
    return pose.x + reach * cos(heading), pose.y + reach * sin(heading)
