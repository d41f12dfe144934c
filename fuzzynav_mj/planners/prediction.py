"""Where the hits of moving obstacles will be: the paper's predicted future trajectories, Eq. (14).

A mover may go straight on, or keep turning as it turns now; a candidate must stay clear of both.
One whose speed towards the robot is still uncertain is also thought of as coming faster.
"""

from math import hypot

import numpy as np

from fuzzynav_mj.types import FloatArray, PerceivedObstacle

TURNING = 0.15  # rad/s: slower turns are as good as straight
UNCERTAIN = 0.12  # m/s: a smaller uncertainty of the closing speed is not worth a thought
LARGEST_SURPRISE = 0.5  # m/s


def displacements(
    obstacle: PerceivedObstacle, place: FloatArray, times: FloatArray
) -> list[FloatArray]:
    """(T, 2) displacements after each of `times` (T,), one array for each way it may go on.

    Args:
        obstacle: a moving one.
        place: (2,) of the robot, world frame.
        times: s from now.
    """
    straight = times[:, None] * obstacle.velocity
    ways = [straight]
    if abs(obstacle.turn_rate) > TURNING:
        ways.append(_turning(obstacle.velocity, obstacle.turn_rate, times))
    if obstacle.closing_sigma > UNCERTAIN:
        towards = place - obstacle.nearest_point
        towards = towards / max(hypot(*towards.tolist()), 1e-9)
        surprise = min(obstacle.closing_sigma, LARGEST_SURPRISE)
        ways.append(straight + times[:, None] * (surprise * towards))
    return ways


def _turning(velocity: FloatArray, turn_rate: float, times: FloatArray) -> FloatArray:
    angle = turn_rate * times
    along, across = np.sin(angle) / turn_rate, (1.0 - np.cos(angle)) / turn_rate
    vx, vy = velocity
    return np.stack((along * vx - across * vy, across * vx + along * vy), axis=1)
