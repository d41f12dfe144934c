"""Where the hits of moving obstacles will be: the paper's predicted future trajectories, Eq. (14).

A mover may keep turning as it turns now, turn more to either side, or go straight on; a candidate
must stay clear of all of these. How far one can swerve within the time that the robot needs to
react is what counts: later the robot will have looked and decided again. A mover whose speed
towards the robot is still uncertain is also thought of as coming faster.
"""

from math import hypot

import numpy as np

from fuzzynav_mj.types import FloatArray, PerceivedObstacle

SWERVE = 0.5  # m/s2: sideways acceleration that a mover may add to what is seen of it
SWERVE_TIME = 0.8  # s: for so long
TURNING = 0.3  # rad/s: a slower turn is as good as straight
UNCERTAIN = 0.12  # m/s: a smaller uncertainty of the closing speed is not worth a thought
LARGEST_SURPRISE = 0.5  # m/s


def displacements(
    obstacle: PerceivedObstacle, place: FloatArray, times: FloatArray
) -> list[FloatArray]:
    """(T, 2) displacements after each of `times` (T,), one array for each way it may go on; the
    expected way comes first.

    Args:
        obstacle: a moving one.
        place: (2,) of the robot, world frame.
        times: s from now.
    """
    velocity = obstacle.velocity
    expected = _turning(velocity, obstacle.turn_rate, times)
    ways = [expected]
    if abs(obstacle.turn_rate) > TURNING:
        ways.append(times[:, None] * velocity)
    speed = max(hypot(*velocity.tolist()), 1e-9)
    across = np.array([-velocity[1], velocity[0]]) / speed
    swerve = 0.5 * SWERVE * np.minimum(times, SWERVE_TIME) ** 2
    soon = (times <= SWERVE_TIME + 1e-9)[:, None]
    for side in (1.0, -1.0):
        ways.append(np.where(soon, expected + side * swerve[:, None] * across, expected))
    if obstacle.closing_sigma > UNCERTAIN:
        towards = place - obstacle.nearest_point
        towards = towards / max(hypot(*towards.tolist()), 1e-9)
        surprise = min(obstacle.closing_sigma, LARGEST_SURPRISE)
        ways.append(expected + times[:, None] * (surprise * towards))
    return ways


def _turning(velocity: FloatArray, turn_rate: float, times: FloatArray) -> FloatArray:
    """(T, 2) displacements on an arc with a constant turn rate, rad/s."""
    if abs(turn_rate) < 1e-3:
        return times[:, None] * velocity
    angle = turn_rate * times
    along, across = np.sin(angle) / turn_rate, (1.0 - np.cos(angle)) / turn_rate
    vx, vy = velocity
    return np.stack((along * vx - across * vy, across * vx + along * vy), axis=1)
