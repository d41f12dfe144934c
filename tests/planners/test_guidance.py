"""Guidance in worlds of pure geometry: out of traps, through gaps, and no way at all."""

import pickle
from itertools import pairwise
from math import hypot, inf

import numpy as np
import pytest
from point_world import Point, Walk, box, sight_at, walk, walls

from fuzzynav_mj.planners.boundary import Following
from fuzzynav_mj.planners.guidance import Guidance
from fuzzynav_mj.planners.settings import GuidanceSettings
from fuzzynav_mj.planners.sight import Sight
from fuzzynav_mj.types import FloatArray

TOUCH = 0.11  # m: half the robot's side and a centimetre


def strips(*corners: Point, half: float = 0.05) -> FloatArray:
    """A wall of straight strips, parallel to the axes, from corner to corner."""
    pieces = []
    for (x0, y0), (x1, y1) in pairwise(corners):
        low, high = (min(x0, x1), min(y0, y1)), (max(x0, x1), max(y0, y1))
        pieces.append(box(low[0] - half, low[1] - half, high[0] + half, high[1] + half))
    return walls(*pieces)


def square_spiral(pitch: float, turns: int = 2) -> FloatArray:
    """A spiral that begins at the origin; the way between its walls is pitch - 0.1 m wide."""
    x = y = 0.0
    side = pitch
    corners = [(x, y)]
    for number in range(4 * turns):
        dx, dy = ((1, 0), (0, 1), (-1, 0), (0, -1))[number % 4]
        x, y = x + dx * side, y + dy * side
        corners.append((x, y))
        side += pitch * (number % 2)
    return strips(*corners)


def room_with_gap(low: float, high: float) -> FloatArray:
    """Two rooms and a wall with a gap from y = low to y = high between them."""
    return walls(box(0.0, 0.0, 5.0, 4.0), box(2.4, 0.0, 2.6, low), box(2.4, high, 2.6, 4.0))


ROOM = box(-1.0, -1.0, 7.0, 7.0)
TRAP = walls(ROOM, strips((2.0, 1.5), (4.0, 1.5), (4.0, 4.5), (2.0, 4.5), half=0.1))
COMB = walls(
    box(0.0, 0.0, 5.0, 5.0),
    strips((1.0, 0.0), (1.0, 4.0)),
    strips((2.0, 1.0), (2.0, 5.0)),
    strips((3.0, 0.0), (3.0, 4.0)),
    strips((4.0, 1.0), (4.0, 5.0)),
)
RINGS = walls(
    box(0.0, 0.0, 6.0, 6.0),
    strips((1.0, 1.0), (5.0, 1.0), (5.0, 5.0), (1.0, 5.0), (1.0, 2.0)),
    strips((2.0, 2.0), (2.0, 4.0), (4.0, 4.0), (4.0, 2.0), (3.0, 2.0)),
    strips((5.0, 3.0), (6.0, 3.0)),
)

SOLVABLE = {
    "trap_from_outside": (TRAP, (1.0, 3.0), (5.5, 3.0)),
    "trap_from_inside": (TRAP, (3.2, 3.0), (5.5, 3.0)),
    "out_of_the_spiral_east": (square_spiral(0.8), (0.4, 0.4), (4.5, 0.3)),
    "out_of_the_spiral_south": (square_spiral(1.0), (0.5, 0.5), (0.3, -4.0)),
    "into_the_spiral": (square_spiral(0.8), (-4.0, 0.3), (0.4, 0.4)),
    "through_the_comb": (COMB, (0.5, 0.5), (4.5, 0.5)),
    "into_the_middle_of_the_comb": (COMB, (4.5, 4.5), (2.5, 2.5)),
    "out_of_the_rings": (RINGS, (3.0, 3.0), (5.5, 5.5)),
    "into_the_rings": (RINGS, (5.5, 5.5), (3.0, 3.0)),
    "gap_of_0.50_m": (room_with_gap(2.6, 3.1), (1.0, 1.0), (4.0, 1.0)),
    "gap_of_0.44_m_in_passing": (
        walls(box(0.0, 0.0, 5.0, 4.0), box(2.09, 0.0, 2.37, 2.355), box(2.09, 2.792, 2.37, 4.0)),
        (1.37, 0.56),
        (4.21, 0.50),
    ),
    "spiral_0.60_m_wide": (square_spiral(0.7), (0.35, 0.35), (0.3, 5.0)),
    "gap_of_0.36_m_ahead": (room_with_gap(1.82, 2.18), (1.0, 2.2), (4.0, 1.8)),
    # Round the end of the wall in between, nothing within sight lies at the edge of sight.
    "hairpin_0.50_m_wide": (
        walls(
            box(0.0, -0.05, 3.0, 0.05),
            strips((3.0, 0.6), (-0.55, 0.6), (-0.55, -0.6), (3.0, -0.6)),
        ),
        (1.5, 0.3),
        (1.5, -0.3),
    ),
}


def go(world: tuple[FloatArray, Point, Point], steps: int = 1200) -> Walk:
    """Walk through a world."""
    sides, start, goal = world
    return walk(Guidance(goal, 0.1), sides, start, goal, steps)


@pytest.mark.parametrize("name", SOLVABLE)
def test_goal_is_reached(name: str) -> None:
    result = go(SOLVABLE[name])
    assert result.arrived
    assert result.nearest_wall > TOUCH
    assert result.headings[-1].closed_loops == 0


def test_open_ground_is_crossed_in_a_straight_line() -> None:
    result = go((ROOM, (0.0, 0.0), (3.0, 4.0)))
    assert result.arrived and 4.9 - 1e-9 <= result.length <= 4.95
    assert all(heading.mode == "goal" and heading.direct for heading in result.headings)


def test_trap_is_left_by_following_its_wall() -> None:
    """Inside, the way out leads away from the goal: only the boundary mode does that."""
    result = go(SOLVABLE["trap_from_inside"])
    assert result.was("boundary")
    away = [hypot(5.5 - x, 3.0 - y) for x, y in result.places]
    assert max(away) > away[0] + 0.5
    # Shortest way round the nearer arm: 1.2 back, 1.5 up or down, and the rest.
    assert result.length < 12.0


def test_gap_too_narrow_is_not_driven_into() -> None:
    result = go((room_with_gap(1.88, 2.12), (1.0, 2.0), (4.0, 2.0)), steps=600)
    assert not result.arrived and result.nearest_wall > TOUCH
    assert max(x for x, _ in result.places) < 2.4


LARGE_CELL = (walls(ROOM, box(2.0, 2.0, 4.0, 4.0)), (1.0, 2.8), (3.0, 3.0))
WALLED_IN = {
    "goal_in_a_cell": (walls(ROOM, box(2.5, 2.5, 3.7, 3.7)), (1.0, 1.0), (3.1, 3.1)),
    "robot_in_a_cell": (walls(box(0.0, 0.0, 2.0, 2.0), box(-2.0, -2.0, 4.0, 4.0)), (1.0, 1.0),
                        (3.0, 3.0)),
}  # fmt: skip


@pytest.mark.parametrize("name", WALLED_IN)
def test_no_way_is_found_out_by_closing_the_loop_both_ways(name: str) -> None:
    result = go(WALLED_IN[name])
    assert not result.arrived and result.nearest_wall > TOUCH
    counts = [heading.closed_loops for heading in result.headings]
    assert counts[-1] == 2
    assert all(0 <= after - before <= 1 for before, after in pairwise(counts))
    # A loop has been walked for each.
    assert counts.count(0) > 30 and counts.count(1) > 30


def test_loop_is_closed_though_it_was_begun_far_from_the_boundary() -> None:
    assert go(LARGE_CELL, steps=600).headings[-1].closed_loops == 2


def test_no_open_direction_is_said_to_be_blocked() -> None:
    guidance = Guidance((3.0, 0.0), 0.1)
    heading = guidance.head((0.0, 0.0), sight_at(box(-0.4, -0.4, 0.4, 0.4), (0.0, 0.0)))
    assert heading.mode == "blocked" and heading.subgoal == (0.0, 0.0) and not heading.direct


def test_goal_in_straight_reach_is_the_subgoal() -> None:
    guidance = Guidance((0.5, 0.2), 0.1)
    heading = guidance.head((0.0, 0.0), sight_at(ROOM, (0.0, 0.0)))
    assert heading.mode == "goal" and heading.direct
    assert heading.subgoal == pytest.approx((0.5, 0.2))


def test_memory_is_of_constant_size() -> None:
    """No map: whatever the walk, what is remembered fits into three quarters of a kilobyte."""
    sides, start, goal = LARGE_CELL
    guidance = Guidance(goal, 0.1)
    sizes: list[int] = []

    def measure(number: int, place: Point) -> None:
        sizes.append(len(pickle.dumps(vars(guidance))))

    walk(guidance, sides, start, goal, 300, measure)
    assert len(sizes) > 200
    assert max(sizes) < 768
    assert max(sizes[60:]) <= max(sizes[:60]) + 16  # integers of another size


def following(guidance: Guidance) -> Following:
    """The guidance's memory while it follows a boundary."""
    memory = guidance._following
    assert memory is not None
    return memory


HELD_UP = ("held", "pushed_back", "pushed_aside")


@pytest.mark.parametrize("kind", HELD_UP)
@pytest.mark.parametrize("name", ["trap_from_inside", "through_the_comb"])
def test_evasion_and_gate_do_not_touch_the_memory(name: str, kind: str) -> None:
    """Something keeps the robot from following for a while; then it goes on as before."""
    sides, start, goal = SOLVABLE[name]
    guidance = Guidance(goal, 0.1)
    trail: list[Point] = []
    states: list[tuple[int, Point]] = []
    since: list[int] = []

    def hold_up(number: int, place: Point) -> Point | None:
        memory = guidance._following
        under_way = memory is not None and memory.length > 0.8
        if len(since) < 8 and (since or under_way):
            since.append(number)
            memory = following(guidance)
            states.append((memory.side, memory.start))
            if kind == "pushed_back":
                return trail.pop()
            if kind == "pushed_aside" and len(since) <= 2:
                dx, dy = memory.direction  # the boundary is to the right of a robot on side +1
                return (place[0] - 0.03 * memory.side * dy, place[1] + 0.03 * memory.side * dx)
            return place
        if len(since) == 8 and number == since[-1] + 1:
            states.append((following(guidance).side, following(guidance).start))
        trail.append(place)
        return None

    result = walk(guidance, sides, start, goal, 1200, hold_up)
    modes = [result.headings[number].mode for number in since]
    assert len(since) == 8 and since[-1] - since[0] == 7
    assert len(states) == 9 and len(set(states)) == 1
    assert set(modes) == {"boundary"}
    assert result.arrived


def test_robot_that_is_held_keeps_its_subgoal_and_its_odometer() -> None:
    sides, start, goal = SOLVABLE["trap_from_inside"]
    guidance = Guidance(goal, 0.1)
    place = walk(guidance, sides, start, goal, 45).places[-1]
    sight = sight_at(sides, place)
    first = guidance.head(place, sight)
    assert first.mode == "boundary"
    length, nearest = following(guidance).length, following(guidance).nearest
    for _ in range(50):
        again = guidance.head(place, sight)
        assert again.mode == "boundary"
        assert again.subgoal == pytest.approx(first.subgoal, abs=0.1)
    assert following(guidance).length == pytest.approx(length, abs=1e-9)
    assert following(guidance).nearest == pytest.approx(nearest, abs=1e-9)


def test_driving_to_and_fro_closes_no_loop() -> None:
    """The odometer counts driving back with its sign: 8 m within a corner are no loop."""
    sides, start, goal = LARGE_CELL
    guidance = Guidance(goal, 0.1)
    trail: list[Point] = []
    swings = 0

    def swing(number: int, place: Point) -> Point | None:
        nonlocal swings
        memory = guidance._following
        if memory is None or swings > 160:
            return None
        swings += 1
        if swings // 10 % 2 == 1 and trail:
            return trail.pop()
        trail.append(place)
        return None

    result = walk(guidance, sides, start, goal, 200, swing)
    assert swings > 100
    assert result.headings[-1].closed_loops == 0


def test_coming_by_along_the_other_wall_of_a_corridor_closes_no_loop() -> None:
    settings = GuidanceSettings()
    boundary = Following(1, (0.0, 0.0), (0.0, -0.3), nearest=5.0, reached=5.0)
    boundary.direction = (1.0, 0.0)
    assert not boundary.closes((0.0, 0.0), 0.05, settings)  # it begins
    boundary.length = 2.0
    assert not boundary.closes((1.0, 0.0), 0.05, settings)
    boundary.direction = (-1.0, 0.0)
    assert not boundary.closes((0.0, 0.2), 0.05, settings)
    boundary.direction = (1.0, 0.0)
    assert boundary.closes((0.0, 0.2), 0.05, settings)


POCKET = walls(
    box(-6.0, -6.0, 8.0, 6.0),
    strips((0.0, 1.6), (0.0, -1.5), (-3.0, -1.5), half=0.1),
)


def test_robot_turns_round_where_the_other_side_turns_out_shorter() -> None:
    """The robot comes down along a wall that bends back by 3 m, out of sight."""
    start, goal = (-0.4, 0.3), (4.0, -0.55)
    turning = go((POCKET, start, goal))
    settings = GuidanceSettings(turning_gain=inf)
    stubborn = walk(Guidance(goal, 0.1, settings), POCKET, start, goal, 1200)
    assert turning.arrived and stubborn.arrived
    assert turning.length < stubborn.length - 2.0
    assert turning.headings[-1].closed_loops == 0


def test_one_look_that_sees_no_way_changes_nothing() -> None:
    """Noise may close a narrow gap for a look: the robot keeps to the way it was on."""
    guidance, place = Guidance((4.0, 1.9), 0.1), (2.25, 2.0)
    first = guidance.head(place, sight_at(room_with_gap(1.8, 2.2), place))
    closed = sight_at(room_with_gap(1.99, 2.01), place)
    headings = [guidance.head(place, closed) for _ in range(3)]
    assert first.mode == "goal" and not first.direct
    assert [heading.mode for heading in headings] == ["goal", "goal", "boundary"]
    assert headings[1].subgoal == pytest.approx(first.subgoal)


LONG_WALL = box(0.0, -4.0, 0.2, 4.0)


def test_side_is_kept_when_movers_drive_the_robot_off() -> None:
    """Out of sight of the wall and back to it again: still the same way round."""
    goal = (3.0, 0.0)
    guidance = Guidance(goal, 0.1)
    x, y = walk(guidance, LONG_WALL, (-0.3, 0.02), goal, 20).places[-1]
    side = following(guidance).side
    assert abs(y) > 0.7
    walk(guidance, LONG_WALL, (x - 1.0, y), goal, 1)
    assert guidance._following is None
    # Back at the wall, the goal first leads along it the other way.
    back = walk(guidance, LONG_WALL, (-0.3, y), goal, 30)
    assert not back.headings[0].direct and back.headings[0].mode == "goal"
    assert following(guidance).side == side


def test_no_boundary_is_followed_out_of_sight_of_all_that_stands() -> None:
    goal = (3.0, 0.0)
    guidance = Guidance(goal, 0.1)
    walk(guidance, LONG_WALL, (-0.3, 0.0), goal, 20)
    assert following(guidance).length > 0.5
    heading = guidance.head((-2.0, 0.5), sight_at(LONG_WALL, (-2.0, 0.5)))
    assert heading.mode == "goal" and guidance._following is None


def test_boundary_left_without_having_been_all_around_clears_the_count_of_loops() -> None:
    """Loops around two obstacles in turn are no proof that there is no path."""
    goal = (3.0, 0.0)
    guidance = Guidance(goal, 0.1)
    guidance._closed_loops = 1
    result = walk(guidance, box(0.0, -1.0, 0.2, 1.0), (-0.3, 0.0), goal, 400)
    assert result.was("boundary") and result.arrived
    assert result.headings[-1].closed_loops == 0


@pytest.mark.parametrize("name", ["trap_from_outside", "out_of_the_rings", "through_the_comb"])
def test_what_a_way_promised_before_is_no_gain_when_a_boundary_is_followed(name: str) -> None:
    """Or a dead end would be entered again after every round along the boundary."""
    sides, place, goal = SOLVABLE[name]
    guidance, promised, begun = Guidance(goal, 0.1), inf, 0
    for number in range(400):
        before = guidance._following
        heading = guidance.head(place, sight_at(sides, place, yaw=0.7 * number))
        x, y = heading.subgoal
        left_over = hypot(goal[0] - x, goal[1] - y)
        following = guidance._following
        if before is None and following is not None and promised < inf:
            begun += 1
            assert following.reached <= promised + 1e-9
        if following is not None or heading.direct:
            promised = inf
        elif before is None:
            promised = min(promised, left_over)
        share = min(1.0, 0.05 / max(hypot(x - place[0], y - place[1]), 1e-9))
        place = (place[0] + share * (x - place[0]), place[1] + share * (y - place[1]))
    assert begun > 0


@pytest.mark.parametrize("mirror", [1.0, -1.0])
def test_boundary_is_begun_on_the_side_that_leads_nearer_to_the_goal(mirror: float) -> None:
    """Driven along a wall to the one side, past where the other one becomes the shorter."""
    wall = box(0.5, -9.0, 0.7, 9.0)
    guidance = Guidance((3.0, 0.0), 0.1)
    before = (0.0, -mirror * 0.1)
    heading = guidance.head(before, sight_at(wall, before))
    assert heading.mode == "goal" and mirror * heading.subgoal[1] > 0.0
    away = (0.0, mirror * 0.5)
    for _ in range(3):
        heading = guidance.head(away, sight_at(wall, away))
    assert heading.mode == "boundary"
    assert mirror * (heading.subgoal[1] - away[1]) < 0.0


@pytest.mark.parametrize("hidden", [False, True])
def test_what_a_mover_hides_is_no_reason_to_leave_a_boundary(hidden: bool) -> None:
    """Past the end of a wall the goal is in straight reach, unless a mover stands in between."""
    guidance = Guidance((3.0, 0.0), 0.1)
    place, beyond = (1.2, 0.0), sight_at(box(0.4, -0.5, 0.6, 0.5), (1.2, 0.0))
    guidance._following = Following(1, (0.0, 0.0), (0.6, 0.0), 2.9, 2.9)
    covered = np.cos(beyond.bearings) > 0.99 if hidden else np.zeros(len(beyond.bearings), bool)
    sight = Sight(beyond.points, beyond.bearings, beyond.ranges, beyond.max_range, covered)
    assert guidance.head(place, sight).direct is not hidden
