"""How long the robot waits for movers about one place, and what it takes them for after that."""

from math import hypot
from pathlib import Path

import numpy as np
import pytest
from perceived import mover, standing
from short_episodes import box, disc, play

from fuzzynav_mj.planners.lingering import Lingering
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.planners.surroundings import as_if_standing, surroundings
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.types import LaserScan, Outcome, PerceivedObstacle, Perception, Pose2D

SETTINGS = DecisionSettings()
LOOK = 0.15  # s: a decision period, and what sums of tenths are off
HERE, ORIGIN = (0.0, 0.0), Pose2D(0.0, 0.0, 0.0)
MOVER = mover([[0.5, -0.02], [0.5, 0.0], [0.5, 0.02]], (0.0, 0.3))


def seen(*obstacles: PerceivedObstacle) -> Perception:
    """A perception from the origin whose scan shows each hit on the ray nearest to it."""
    ranges, bearings = np.full(180, 0.8), ray_bearings(180)
    for obstacle in obstacles:
        for x, y in obstacle.points:
            ranges[int(np.abs(bearings - np.arctan2(y, x)).argmin())] = hypot(x, y)
    scan = LaserScan(0.0, bearings, ranges, ranges < 0.8, 0.8)
    return Perception(scan, obstacles, np.zeros((0, 0)))


def impatience(
    seconds: float, places: dict[float, tuple[float, float]], movers_until: float = 1e9
) -> list[float]:
    """Times at which a robot is impatient that is at each of the places from some time on."""
    lingering, impatient, place = Lingering(SETTINGS), [], HERE
    for tick in range(round(seconds * 10)):
        stamp = tick / 10
        place = places.get(stamp, place)
        if stamp < movers_until:
            lingering.note_movers(seen(MOVER), stamp)
        if lingering.impatient(place, stamp):
            impatient.append(stamp)
        lingering.stuck(place, stamp)
    return impatient


def test_patience_lasts_and_so_does_impatience_then_patience_again() -> None:
    patience, impatient = SETTINGS.patience, SETTINGS.impatience
    times = impatience(2 * patience + impatient + 5.0, {})
    assert times[0] == pytest.approx(patience, abs=LOOK)
    gap = int(np.diff(times).argmax())
    assert times[gap] - times[0] == pytest.approx(impatient, abs=LOOK)
    assert times[gap + 1] - times[gap] == pytest.approx(patience, abs=2 * LOOK)


def test_impatience_ends_well_away_from_where_it_began() -> None:
    patience, away = SETTINGS.patience, SETTINGS.well_away
    near, far = (away - 0.01, 0.0), (away + 0.01, 0.0)
    times = impatience(patience + 6.0, {patience + 2.0: near, patience + 4.0: far})
    assert times[0] == pytest.approx(patience, abs=LOOK)
    assert times[-1] == pytest.approx(patience + 4.0, abs=LOOK)
    assert times[-1] - times[0] == pytest.approx((len(times) - 1) / 10)


def test_robot_that_moves_on_is_patient() -> None:
    wide = 1.1 * SETTINGS.stuck_radius
    places = {float(second): (second * wide / 10, 0.0) for second in range(0, 40, 10)}
    assert impatience(40.0, places) == []


def test_where_nothing_moves_there_is_nothing_to_be_patient_with() -> None:
    until = SETTINGS.patience - SETTINGS.wedged_time - 1.0
    assert impatience(40.0, {}, movers_until=until) == []


def test_staying_for_too_long_is_being_stuck() -> None:
    lingering = Lingering(SETTINGS)
    inside, outside = (SETTINGS.stuck_radius - 0.01, 0.0), (SETTINGS.stuck_radius + 0.01, 0.0)
    assert not lingering.stuck(HERE, 0.0)
    assert not lingering.stuck(inside, SETTINGS.stuck_time)
    assert lingering.stuck(inside, SETTINGS.stuck_time + 0.1)
    assert not lingering.stuck(outside, SETTINGS.stuck_time + 0.2)


def test_trails_are_the_hits_of_movers_in_the_last_looks() -> None:
    lingering = Lingering(SETTINGS)
    wall = standing([[0.0, 0.6], [0.1, 0.6]])
    for tick in range(50):
        lingering.note_movers(seen(MOVER, wall), tick / 10)
    trails = lingering.trails(4.9)
    assert len(trails) == pytest.approx(SETTINGS.trail_time * 10, abs=1)
    assert all(hits is MOVER.points for hits in trails)
    assert lingering.trails(4.9 + SETTINGS.trail_time + 0.1) == []


def test_as_if_standing_has_movers_and_their_trails_among_what_stands() -> None:
    wall = standing([[0.0, 0.6], [0.1, 0.6]])
    perception = seen(MOVER, wall)
    around = surroundings(perception, ORIGIN, DEFAULT_ROBOT)
    trail = np.array([[-0.4, 0.0], [-0.9, 0.0]])  # the second one is out of sight
    stand = as_if_standing(around, perception, ORIGIN, [MOVER.points, trail])
    ahead, behind = 90, 0
    assert around.sight.ranges[ahead] == 0.8 and around.sight.hidden[ahead]
    assert stand.sight.ranges[ahead] == pytest.approx(0.5)
    assert stand.sight.ranges[behind] == pytest.approx(0.4)
    assert not stand.sight.hidden.any() and stand.expected.size == 0
    assert np.hypot(*stand.sight.points.T).max() < 0.8
    for point in ([0.5, -0.02], [-0.4, 0.0], [0.0, 0.6]):
        assert (np.abs(stand.sight.points - point).max(axis=1) < 1e-12).any()
    # Margins to what moves are those of before.
    assert stand.possible is around.possible and stand.outlines is around.outlines


@pytest.mark.parametrize(
    ("half", "radius", "swing", "speed"), [(0.25, 0.12, 0.06, 0.3), (0.3, 0.14, 0.1, 0.4)]
)
def test_robot_goes_round_where_something_to_and_fro_keeps_a_door(
    half: float, radius: float, swing: float, speed: float, tmp_path: Path
) -> None:
    """Whichever way it goes it seems to leave; there is another door 0.9 m aside."""
    episode = play(
        tmp_path,
        box(1.4, 0.9, 1.6, 1.3 - half),
        box(1.4, 1.3 + half, 1.6, 2.0),
        disc(radius, speed, (1.5, 1.3 - swing), (1.5, 1.3 + swing), repeat="reverse"),
        start=(0.5, 1.3, 0.0),
        goal=(2.5, 1.3),
        time_limit=90.0,
    )
    assert episode.record.outcome is Outcome.GOAL_REACHED
    assert episode.record.sim_time_s < SETTINGS.stuck_time
