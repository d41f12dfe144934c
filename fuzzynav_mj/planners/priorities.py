"""What the priorities of the multilayer decision measure on the rolled-out candidates."""

from math import pi, sqrt

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.planners.outlook import Outlook
from fuzzynav_mj.planners.passing import JUDGED, Passing, judged_places, worth
from fuzzynav_mj.types import BoolArray, FloatArray

STANDING = 0.03  # m or rad: a candidate that changes its pose by no more stands still


@compiled
def cheapest(costs: FloatArray, allowed: BoolArray) -> int:
    """The number of the smallest of costs (m,) among those that are allowed (m,); -1 for none."""
    best = -1
    for i in range(len(costs)):
        if allowed[i] and (best < 0 or costs[i] < costs[best]):
            best = i
    return best


@compiled
def costs_alone(
    poses: FloatArray,
    other: FloatArray,
    target: tuple[float, float],
    near_enough: float,
    steps: int,
    waiting_cost: float,
) -> FloatArray:
    """(m,) what candidates cost where nothing moves, m: how far they stay from the target, Eq.
    (13), standing still, and what they cost otherwise.

    Args:
        poses: (m, T, 3) robot frame.
        other: (m,) m.
        target: robot frame, m.
        near_enough: nearer to it than this no candidate is better than another, m.
        steps: decision periods that count.
        waiting_cost: of standing still, m.
    """
    costs: FloatArray = np.maximum(closest_approach(poses, steps, target), near_enough) + other
    if waiting_cost > 0.0:
        costs += waiting_cost * stand_still(poses, STANDING)
    return costs


@compiled
def costs_among_movers(
    outlook: Outlook,
    passing: Passing,
    other: FloatArray,
    yaw: float,
    length_weight: float,
    crowding_weight: float,
    contact_cost: float,
) -> FloatArray:
    """(m,) what candidates cost among movers, m: what the places reached are worth, the ways to
    them, being near movers, Eq. (14), contact, and what they cost otherwise (m,).

    Args:
        outlook: the candidates' prospects.
        passing: what places are worth.
        other: m.
        yaw: of the robot, rad.
        length_weight, crowding_weight, contact_cost: settings.
    """
    x, y = judged_places(outlook.poses[:, JUDGED - 1], yaw)
    cost = worth(passing, x, y) + other
    length = way_lengths(outlook.poses, JUDGED)
    for i in range(len(cost)):
        cost[i] += length_weight * length[i]
        cost[i] += crowding_weight * outlook.crowding[i]
        cost[i] += contact_cost * (1.0 - outlook.alive[i, -1])
    return cost


@compiled
def closest_approach(poses: FloatArray, steps: int, target: tuple[float, float]) -> FloatArray:
    """(m,) how near to the target each candidate comes in the first steps, m.

    Args:
        poses: (m, T, 3) robot frame.
        steps: decision periods that count.
        target: robot frame, m.
    """
    nearest = np.empty(len(poses))
    for i in range(len(poses)):
        squared = np.inf
        for j in range(steps):
            dx, dy = poses[i, j, 0] - target[0], poses[i, j, 1] - target[1]
            squared = min(squared, dx * dx + dy * dy)
        nearest[i] = sqrt(squared)
    return nearest


@compiled
def way_lengths(poses: FloatArray, steps: int) -> FloatArray:
    """(m,) how far each candidate of `poses` (m, T, 3) goes from its first pose to the last of so
    many, m."""
    lengths = np.zeros(len(poses))
    for i in range(len(poses)):
        for j in range(steps - 1):
            dx, dy = poses[i, j + 1, 0] - poses[i, j, 0], poses[i, j + 1, 1] - poses[i, j, 1]
            lengths[i] += sqrt(dx * dx + dy * dy)
    return lengths


@compiled
def stand_still(poses: FloatArray, most: float) -> BoolArray:
    """(m,) True for the candidates of `poses` (m, T, 3) whose last place and yaw differ from the
    present ones by no more than `most`, m and rad."""
    still = np.empty(len(poses), dtype=np.bool_)
    for i in range(len(poses)):
        x, y, yaw = poses[i, -1]
        still[i] = max(abs(x), abs(y), abs(yaw)) <= most
    return still


@compiled
def secondary_costs(
    gaps: FloatArray,
    speed: FloatArray,
    direction: FloatArray,
    yaw: float,
    travel: float,
    comfortable_gap: float,
    static_weight: float,
    reverse_cost: float,
    change_cost: float,
) -> FloatArray:
    """(m,) what room, reversing and a new direction cost each candidate, m.

    Args:
        gaps: (m,) smallest gap to what stands, m.
        speed: (m,) aimed at, m/s.
        direction: (m,) of travel, rad, robot frame.
        yaw: of the robot, rad.
        travel: direction of travel so far, rad, world frame.
        comfortable_gap, static_weight, reverse_cost, change_cost: settings.
    """
    costs = np.empty(len(gaps))
    for i in range(len(gaps)):
        cost = static_weight * max(comfortable_gap - gaps[i], 0.0)
        if speed[i] < 0.0:
            cost += reverse_cost
        turn = abs((direction[i] + yaw - travel + pi) % (2 * pi) - pi)
        costs[i] = cost + change_cost * turn
    return costs
