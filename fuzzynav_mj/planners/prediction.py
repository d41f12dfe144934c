"""Where the hits of moving obstacles will be: the paper's predicted future trajectories, Eq. (14).

A mover may keep turning as it turns now, turn more to either side, go straight on, or turn aside or
back on the spot, as scripted ones do in the corners and at the ends of their routes; a candidate
must stay clear of all of these. How far one can get within the time that the robot needs to react
is what counts: later the robot will have looked and decided again. A mover whose speed towards the
robot is still uncertain is also thought of as coming faster, and one whose direction noise makes
uncertain as going astray to either side. Where noise leaves much of a velocity open it may be more
or less by one standard deviation.
"""

from math import cos, hypot, sin
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import FloatArray, PerceivedObstacle

SWERVE = 0.5  # m/s2: sideways acceleration that a mover may add to what is seen of it
SWERVE_TIME = 0.6  # s: for so long
TURNED_ASIDE = 0.2  # s: for so long it may have turned at once by a right angle
TURNED_BACK = 0.4  # s: a look, and what the robot takes to be as fast as the mover
TURNING = 0.3  # rad/s: a slower turn is as good as straight
UNCERTAIN = 0.12  # m/s: a smaller uncertainty of the closing speed is not worth a thought
LARGEST_SURPRISE = 0.5  # m/s
# How likely ways are, in proportion: the expected one, turning back, and each of the others.
EXPECTED_SHARE, BACK_SHARE, OTHER_SHARE = 4.0, 0.2, 1.0
STEADY = 0.03  # m/s: a smaller uncertainty of the sideways speed is not worth a thought; of what
DRIFTS = 3.0  # is beyond, so many standard deviations count, but of no more than ...
LARGEST_DRIFT = 0.1  # m/s: ... this; and what is uncertain of a velocity counts ...
ASTRAY_TIME = 0.8  # s: ... for so long


class Going(NamedTuple):
    """How a mover goes on; also as a row of numbers (9,), which compiled functions take.

    Attributes:
        vx, vy: m/s.
        turn_rate: rad/s.
        closing_sigma: uncertainty of its speed towards the robot, m/s.
        drift: speed at which it may go astray to the sides, m/s.
        unsure_x, unsure_y: what else is uncertain of its velocity, m/s.
        robot_x, robot_y: of the robot, from the mover's nearest point, m.
    """

    vx: float
    vy: float
    turn_rate: float
    closing_sigma: float
    drift: float
    unsure_x: float
    unsure_y: float
    robot_x: float
    robot_y: float


def going(obstacle: PerceivedObstacle, place: tuple[float, float]) -> Going:
    """How a moving obstacle goes on, as the robot at `place`, world frame, sees it."""
    vx, vy = obstacle.velocity.tolist()
    unsure_x, unsure_y = obstacle.unsure.tolist()
    x, y = obstacle.nearest_point.tolist()
    drift = DRIFTS * min(max(obstacle.drift_sigma - STEADY, 0.0), LARGEST_DRIFT)
    return Going(
        vx,
        vy,
        obstacle.turn_rate,
        obstacle.closing_sigma,
        drift,
        unsure_x,
        unsure_y,
        place[0] - x,
        place[1] - y,
    )


@compiled
def displacements(motion: FloatArray, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(ways, T, 2) displacements after each of `times` (T,) on every way that a mover may go on;
    the expected way comes first. And (ways,) how likely each is, in all 1.

    Args:
        motion: (9,) of the mover, as in `Going`.
        times: s from now.
    """
    vx, vy, turn_rate, closing_sigma, drift, unsure_x, unsure_y, x, y = motion
    turns, surprises = abs(turn_rate) > TURNING, closing_sigma > UNCERTAIN
    unsure = hypot(unsure_x, unsure_y)
    guesses = unsure > UNCERTAIN
    ways = np.empty((4 + turns + surprises + 2 * guesses, len(times), 2))
    shares = np.full(len(ways), OTHER_SHARE)
    shares[0], shares[3 + turns] = EXPECTED_SHARE, BACK_SHARE
    speed, distance = max(hypot(vx, vy), 1e-9), max(hypot(x, y), 1e-9)
    surprise = min(closing_sigma, LARGEST_SURPRISE)
    for k in range(len(times)):
        t = times[k]
        forth_x, forth_y = t * vx, t * vy
        if abs(turn_rate) >= 1e-3:  # on an arc
            angle = turn_rate * t
            along, across = sin(angle) / turn_rate, (1.0 - cos(angle)) / turn_rate
            forth_x, forth_y = along * vx - across * vy, across * vx + along * vy
        ways[0, k] = forth_x, forth_y
        way = 1
        if turns:
            ways[way, k] = t * vx, t * vy
            way += 1
        aside = 0.5 * SWERVE * t * t if t <= SWERVE_TIME + 1e-9 else 0.0
        if t <= TURNED_ASIDE + 1e-9:
            aside = max(aside, t * speed)
        if t <= ASTRAY_TIME + 1e-9:
            aside += drift * t
        for side in (1.0, -1.0):
            swerve = side * aside / speed
            ways[way, k] = forth_x - swerve * vy, forth_y + swerve * vx
            way += 1
        back = t <= TURNED_BACK + 1e-9
        ways[way, k] = (-t * vx, -t * vy) if back else (forth_x, forth_y)
        way += 1
        if surprises:
            share = t * surprise / distance
            ways[way, k] = forth_x + share * x, forth_y + share * y
            way += 1
        if guesses:
            share = t * min(1.0, LARGEST_SURPRISE / unsure) if t <= ASTRAY_TIME + 1e-9 else 0.0
            for side in (share, -share):
                ways[way, k] = forth_x + side * unsure_x, forth_y + side * unsure_y
                way += 1
    return ways, shares / shares.sum()
