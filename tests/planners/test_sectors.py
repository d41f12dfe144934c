"""The six fuzzy inputs: which obstacle counts where, and at what distance."""

from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from perceived import mover, standing

from fuzzynav_mj.geometry import rotation
from fuzzynav_mj.planners.sectors import CLEAR, as_fuzzy_inputs, sector_distances
from fuzzynav_mj.types import FloatArray, PerceivedObstacle

RANGE = 0.8
PERIOD = 0.1
LS, FS, RS, LD, FD, RD = range(6)
MIRROR = [RS, FS, LS, RD, FD, LD]


def inputs(
    *obstacles: PerceivedObstacle,
    place: tuple[float, float] = (0.0, 0.0),
    travel: float = 0.0,
    ahead: float = PERIOD,
) -> FloatArray:
    """(6,) inputs at one place."""
    row: FloatArray = sector_distances(
        np.array([place]), np.array([travel]), obstacles, ahead, RANGE
    )[0]
    return row


def expect(**distances: float) -> list[float]:
    """The six inputs, CLEAR where nothing is said."""
    return [distances.get(name, CLEAR) for name in ("LS", "FS", "RS", "LD", "FD", "RD")]


def polar(distance: float, degrees: float) -> tuple[float, float]:
    """A point, seen from the origin."""
    return distance * cos(np.radians(degrees)), distance * sin(np.radians(degrees))


def random_obstacles(seed: int, count: int) -> list[PerceivedObstacle]:
    """Standing and moving ones, each a short row of hits within range of the origin."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(count):
        distance, angle = rng.uniform(0.15, 0.75), rng.uniform(-pi, pi)
        row = np.linspace(-0.08, 0.08, 5)[:, None] * rng.normal(size=2)
        points = row + distance * np.array([cos(angle), sin(angle)])
        if rng.random() < 0.5:
            found.append(standing(points))
        else:
            found.append(mover(points, rng.uniform(-0.4, 0.4, 2)))
    return found


def test_nothing_in_range_is_clear_everywhere() -> None:
    assert inputs().tolist() == [CLEAR] * 6
    assert inputs(standing([(0.9, 0.0)]), mover([(0.0, -0.85)], (0.0, 0.0))).tolist() == [CLEAR] * 6
    assert CLEAR == 1.0


@pytest.mark.parametrize(
    ("degrees", "name"),
    [
        (0.0, "FS"), (44.0, "FS"), (-44.0, "FS"),
        (46.0, "LS"), (90.0, "LS"), (179.0, "LS"),
        (-46.0, "RS"), (-90.0, "RS"), (-179.0, "RS"),
    ],
)  # fmt: skip
def test_sectors_by_bearing(degrees: float, name: str) -> None:
    assert inputs(standing([polar(0.5, degrees)])) == pytest.approx(expect(**{name: 0.5}))
    moving = mover([polar(0.5, degrees)], (0.0, 0.0))
    assert inputs(moving) == pytest.approx(expect(**{name.replace("S", "D"): 0.5}))


def test_sectors_lie_about_the_direction_of_travel() -> None:
    ahead = standing([(0.5, 0.0)])
    assert inputs(ahead, travel=pi / 2) == pytest.approx(expect(RS=0.5))
    assert inputs(ahead, travel=-pi / 2) == pytest.approx(expect(LS=0.5))
    assert inputs(ahead, travel=2 * pi) == pytest.approx(expect(FS=0.5))


def test_distance_is_taken_at_the_next_position() -> None:
    wall = standing([(0.5, 0.0)])
    assert inputs(wall, place=(0.3, 0.0)) == pytest.approx(expect(FS=0.2))
    assert inputs(wall, place=(0.5, -0.4)) == pytest.approx(expect(LS=0.4))


def test_obstacle_counts_in_the_sector_of_its_nearest_point_only() -> None:
    """A wall that reaches from the right across the front counts once."""
    wall = standing([(0.7, y) for y in np.linspace(-0.2, 0.0, 9)] + [(0.3, -0.35), (0.0, -0.3)])
    assert inputs(wall) == pytest.approx(expect(RS=0.3))


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_one_obstacle_fills_one_sector_with_its_distance(seed: int) -> None:
    (obstacle,) = random_obstacles(seed, 1)
    found = inputs(obstacle)
    filled = np.flatnonzero(found != CLEAR)
    distance = np.hypot(*(obstacle.points + PERIOD * obstacle.velocity).T).min()
    if distance >= RANGE:
        assert len(filled) == 0
    else:
        assert len(filled) == 1
        assert (filled[0] >= LD) == obstacle.dynamic
        assert found[filled[0]] == pytest.approx(distance)


def test_movers_are_carried_on_to_the_time_of_the_next_position() -> None:
    crossing = mover([(0.3, -0.5)], (0.0, 1.0))
    assert inputs(crossing, ahead=0.0) == pytest.approx(expect(RD=np.hypot(0.3, 0.5)))
    assert inputs(crossing, ahead=0.5) == pytest.approx(expect(FD=0.3))
    assert inputs(crossing, ahead=1.0) == pytest.approx(expect(LD=np.hypot(0.3, 0.5)))


def test_nearest_obstacle_of_a_sector_counts() -> None:
    row = [standing([(distance, 0.0)]) for distance in (0.6, 0.4, 0.5)]
    assert inputs(*row) == pytest.approx(expect(FS=0.4))


def test_of_more_than_three_the_nearest_three_count() -> None:
    three = [standing([polar(0.3, 20.0 * k)]) for k in (-1, 0, 1)]
    fourth = standing([polar(0.5, 120.0)])
    moving = [mover([polar(0.6, 100.0)], (0.0, 0.0))]
    assert inputs(*three[:2], fourth)[LS] == pytest.approx(0.5)
    assert inputs(*three, fourth)[LS] == CLEAR
    assert inputs(fourth, *three)[LS] == CLEAR  # in whatever order
    assert inputs(*three, fourth, *moving)[LD] == pytest.approx(0.6)  # kinds do not compete


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 8), st.floats(-pi, pi))
def test_left_is_the_mirror_of_right(seed: int, count: int, travel: float) -> None:
    flip = np.array([1.0, -1.0])
    plain = random_obstacles(seed, count)
    mirrored = [mover(o.points * flip, o.velocity * flip, dynamic=o.dynamic) for o in plain]
    found = inputs(*plain, place=(0.02, 0.03), travel=travel)
    other = inputs(*mirrored, place=(0.02, -0.03), travel=-travel)
    np.testing.assert_allclose(other[MIRROR], found, atol=1e-12)


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 8), st.floats(-pi, pi))
def test_turned_world_changes_nothing(seed: int, count: int, angle: float) -> None:
    turn = rotation(angle)
    plain = random_obstacles(seed, count)
    turned = [mover(o.points @ turn.T, turn @ o.velocity, dynamic=o.dynamic) for o in plain]
    np.testing.assert_allclose(
        inputs(*turned, travel=0.3 + angle), inputs(*plain, travel=0.3), atol=1e-9
    )


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 8))
def test_inputs_are_within_their_domain_and_rows_are_independent(seed: int, count: int) -> None:
    obstacles = tuple(random_obstacles(seed, count))
    rng = np.random.default_rng(seed)
    places, travel = rng.uniform(-0.1, 0.1, (6, 2)), rng.uniform(-pi, pi, 6)
    rows = sector_distances(places, travel, obstacles, PERIOD, RANGE)
    assert rows.shape == (6, 6)
    assert ((rows >= 0.0) & ((rows < RANGE) | (rows == CLEAR))).all()
    for row, place, direction in zip(rows, places.tolist(), travel.tolist(), strict=True):
        np.testing.assert_array_equal(row, inputs(*obstacles, place=place, travel=direction))


def test_columns_go_by_their_names() -> None:
    record = as_fuzzy_inputs(np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6]))
    names = (record.LS, record.FS, record.RS, record.LD, record.FD, record.RD)
    assert names == (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    assert all(type(value) is float for value in names)
