"""The oracle on worlds whose answer is known by hand, and the laws behind its two verdicts."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav_mj.oracle import Possibility, assess
from fuzzynav_mj.oracle.grid import BORDER, Grid, grid_over
from fuzzynav_mj.oracle.occupancy import Clearance, free_layers
from fuzzynav_mj.oracle.reachability import LONG, SLANTING, SLOWEST, earliest_layer
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.loading import parse_scenario
from fuzzynav_mj.scenarios.world import World, make_world
from fuzzynav_mj.types import BoolArray

SPEED, CELL = DEFAULT_ROBOT.max_speed, 0.05
LAYER = CELL / SPEED
SHORT = ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1))


def world(
    *tables: str,
    start: str = "1.0, 1.0",
    goal: str = "5.0, 1.0",
    bounds: str = "0, 0, 6, 2",
    head: str = "",
    seed: int = 0,
) -> World:
    text = f"""
schema = 1
name = "by_hand"
bounds = [{bounds}]
allow_faster = true
{head}
[robot]
start = [{start}, 0.0]
goal = [{goal}]
"""
    scenario = parse_scenario((text + "\n".join(tables)).encode(), "by_hand.toml")
    return make_world(scenario, np.random.default_rng(seed))


def wall_with_gap(width: float, x: float = 3.0) -> str:
    """A wall across the default arena, 0.2 m thick, with a gap in its middle."""
    low, high = 1.0 - width / 2, 1.0 + width / 2
    return f"""
[[static]]
polygon = [[{x}, 0], [{x + 0.2}, 0], [{x + 0.2}, {low}], [{x}, {low}]]
[[static]]
polygon = [[{x}, {high}], [{x + 0.2}, {high}], [{x + 0.2}, 2], [{x}, 2]]
"""


def box(width: float, height: float) -> str:
    x, y = width / 2, height / 2
    return f"polygon = [[{-x}, {-y}], [{x}, {-y}], [{x}, {y}], [{-x}, {y}]]"


def keyframes(shape: str, *rows: tuple[float, float, float]) -> str:
    return f'[[moving]]\n{shape}\nkeyframes = {[list(row) for row in rows]}\nrepeat = "once"\n'


def verdicts(result: Possibility) -> tuple[bool, bool]:
    return result.possible_optimistic, result.possible_cautious


# by hand ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("goal", [(4.0, 0.0), (0.0, -4.0), (3.0, 4.0), (-4.0, 3.0), (-3.2, -2.4)])
def test_without_obstacles_arrival_is_exact_along_the_twelve_directions(
    goal: tuple[float, float],
) -> None:
    open_plane = world(start="0.0, 0.0", goal=f"{goal[0]}, {goal[1]}", bounds="-5, -5, 5, 5")
    result = assess(open_plane, DEFAULT_ROBOT)
    exact = (math.hypot(*goal) - 0.10) / SPEED
    assert result.static_lower_bound_s == pytest.approx(exact)
    assert exact - 1e-9 <= result.earliest_arrival_s <= exact + 4 * LAYER
    if 0.0 in goal:
        assert result.earliest_arrival_s == pytest.approx(exact)


@pytest.mark.parametrize("degrees", range(0, 360, 17))
def test_without_obstacles_arrival_is_late_by_five_per_cent_and_three_layers_at_most(
    degrees: float,
) -> None:
    x, y = 6.0 * math.cos(math.radians(degrees)), 6.0 * math.sin(math.radians(degrees))
    open_plane = world(start="0.0, 0.0", goal=f"{x}, {y}", bounds="-7, -7, 7, 7")
    exact = 5.9 / SPEED
    arrival = assess(open_plane, DEFAULT_ROBOT).earliest_arrival_s
    assert exact - 1e-9 <= arrival <= exact / SLOWEST + 3 * LAYER


def test_slowest_direction_is_half_way_between_an_axis_and_a_slanting_move() -> None:
    assert math.cos(math.atan2(3, 4) / 2) == pytest.approx(SLOWEST)
    assert {math.hypot(*vector) for vector in SLANTING} == {LONG}
    assert len(set(SLANTING)) == 8


def test_a_closed_door_that_opens() -> None:
    """The door's leaf begins to slide at 20 s and is 0.05 m off the way's middle 0.25 s later."""
    leaf = keyframes(box(0.1, 0.58), (0, 3.1, 1.0), (20.0, 3.1, 1.0), (24.0, 3.1, 1.8))
    result = assess(world(wall_with_gap(0.6), leaf), DEFAULT_ROBOT)
    assert verdicts(result) == (True, True)
    # The leaf leaves room for the disc once it has slid 0.283 m minus the 0.01 m beside it. The
    # robot waits before the leaf, and has a metre and a half to go from there to its goal.
    open_at = 20.0 + (2 * DEFAULT_ROBOT.half_diagonal - 0.01) / 0.2
    way = (4.9 - (3.05 - DEFAULT_ROBOT.half_diagonal)) / SPEED
    assert open_at < result.earliest_arrival_s
    assert open_at + way - 1.0 < result.earliest_arrival_s < open_at + way + 1.0
    assert assess(world(wall_with_gap(0.6)), DEFAULT_ROBOT).earliest_arrival_s < 8.0


@pytest.mark.parametrize(
    "mover",
    [
        f"[[moving]]\n{box(0.1, 0.5)}\nwaypoints = [[3.1, 0.97], [3.1, 1.03]]\nspeed = 0.3\n",
        f"[[moving]]\n{box(0.002, 0.58)}\nwaypoints = [[3.1, 1.0], [3.2, 1.0]]\nspeed = 0.0\n",
        f"[[moving]]\n{box(0.002, 1.99)}\nwaypoints = [[4.5, 1.0], [2.0, 1.0]]\nspeed = 0.5\n",
    ],
    ids=["shuttle", "thin plate", "thin plate that sweeps the corridor"],
)
def test_a_mover_that_seals_a_corridor_for_ever(mover: str) -> None:
    result = assess(world(wall_with_gap(0.6), mover, head="time_limit = 60"), DEFAULT_ROBOT)
    assert verdicts(result) == (False, False)
    assert result.earliest_arrival_s == math.inf
    assert result.static_lower_bound_s == pytest.approx(7.8, abs=1e-6)


def test_a_mover_that_must_be_waited_for() -> None:
    """It comes through a corridor 0.5 m wide towards the robot, which can wait beside the mouth."""
    corridor = """
[[static]]
polygon = [[2, 0], [4, 0], [4, 0.75], [2, 0.75]]
[[static]]
polygon = [[2, 1.25], [4, 1.25], [4, 2], [2, 2]]
"""
    coming = keyframes("circle = 0.15", (0, 4.5, 1.0), (4.0, 4.5, 1.0), (14.0, 2.0, 1.0),
                       (16.0, 1.6, 0.4))  # fmt: skip
    result = assess(world(corridor, coming), DEFAULT_ROBOT)
    assert verdicts(result) == (True, True)
    # From 14 s on, at (2, 1), it makes way along (-2, -3) at 0.361 m/s. The disc can be in the
    # mouth no higher than at (2, 1.109), 0.291 m from the mover's centre: after 0.194 m more.
    entering = 14.0 + 0.194 / 0.361
    rest = (4.9 - 2.0) / SPEED
    assert entering + rest < result.earliest_arrival_s < entering + rest + 1.0
    assert assess(world(corridor), DEFAULT_ROBOT).earliest_arrival_s < 8.0


def test_a_piston_faster_than_the_robot_in_a_blind_corridor() -> None:
    """At 0.9 m/s it catches the robot after 1.9 s at x = 1.05 and fills the corridor."""
    piston = keyframes(box(0.2, 1.9), (0, 3.0, 1.0), (5.0, -1.5, 1.0))
    for goal, expected in [("1.3, 1.0", True), ("0.5, 1.0", False), ("5.0, 1.0", False)]:
        result = assess(world(piston, start="2.0, 1.0", goal=goal), DEFAULT_ROBOT)
        assert verdicts(result) == (expected, expected)


@pytest.mark.parametrize(
    ("width", "expected"),
    [(0.32, (True, True)), (0.26, (True, False)), (0.22, (True, False)), (0.19, (False, False))],
)
def test_gaps_between_the_two_discs(width: float, expected: tuple[bool, bool]) -> None:
    """0.283 m lets the outer disc pass, 0.2 m the inner one."""
    small = world(wall_with_gap(width), head="time_limit = 20")
    assert verdicts(assess(small, DEFAULT_ROBOT)) == expected


def test_bound_is_infinite_without_a_static_path() -> None:
    closed = world("[[static]]\npolygon = [[3, 0], [3.1, 0], [3.1, 2], [3, 2]]")
    assert assess(closed, DEFAULT_ROBOT) == Possibility(False, False, math.inf, math.inf)


def test_time_limit_is_the_last_moment_of_arrival() -> None:
    for limit, possible in [(7.8, True), (7.6, False)]:
        result = assess(world(head=f"time_limit = {limit}"), DEFAULT_ROBOT)
        assert result.possible_cautious is possible
    assert verdicts(assess(world(head="time_limit = 7.6"), DEFAULT_ROBOT))[0]  # faster by 5 %
    assert verdicts(assess(world(head="time_limit = 7.0"), DEFAULT_ROBOT)) == (False, False)


def test_without_walls_the_way_may_leave_the_bounds() -> None:
    blocked = "[[static]]\npolygon = [[3, -0.5], [3.2, -0.5], [3.2, 2], [3, 2]]"
    assert not assess(world(blocked), DEFAULT_ROBOT).possible_cautious
    assert assess(world(blocked, head="walls = false"), DEFAULT_ROBOT).possible_cautious


def test_start_and_goal_off_the_grid_of_the_bounds() -> None:
    shifted = world(start="1.013, 1.007", goal="5.021, 0.992", bounds="0.003, 0.001, 6, 2")
    result = assess(shifted, DEFAULT_ROBOT)
    assert 0.0 <= result.earliest_arrival_s - result.static_lower_bound_s <= 4 * LAYER


@pytest.mark.parametrize("cell", [0.0, -0.05, 0.083, math.nan])
def test_cells_that_cannot_tell_thin_walls(cell: float) -> None:
    with pytest.raises(ValueError, match=r"cell must be above 0 and at most 0\.0828 m, not "):
        assess(world(), DEFAULT_ROBOT, cell)


def test_arena_too_large_for_its_cells() -> None:
    with pytest.raises(ValueError, match=r"cell must be at least 0\.1 m in an arena this large"):
        grid_over((0.0, 0.0, 100.0, 100.0), (1.0, 1.0), 0.05)


# laws ------------------------------------------------------------------------------------------

MOVERS = st.lists(
    st.tuples(
        st.floats(0.3, 3.7), st.floats(0.3, 3.7), st.floats(0.3, 3.7), st.floats(0.3, 3.7),
        st.floats(0.1, 0.7), st.sampled_from(["circle = 0.2", box(0.5, 0.1), box(0.04, 0.9)]),
        st.floats(0.0, 20.0),
    ),
    max_size=4,
)  # fmt: skip


def moving_world(
    movers: list[tuple[float, float, float, float, float, str, float]],
) -> World | None:
    tables = [
        f"[[moving]]\n{shape}\nwaypoints = [[{a}, {b}], [{c}, {d}], [{d}, {c}]]\nspeed = {speed}\n"
        f"phase = {phase}\n"
        for a, b, c, d, speed, shape, phase in movers
    ]
    try:
        return world(
            *tables,
            "[[static]]\npolygon = [[1.8, 1.5], [2.2, 1.5], [2.2, 2.5], [1.8, 2.5]]",
            start="0.4, 2.0", goal="3.6, 2.0", bounds="0, 0, 4, 4", head="time_limit = 25",
        )  # fmt: skip
    except Exception:
        return None  # a mover on the start


@settings(max_examples=25, deadline=None)
@given(MOVERS)
def test_laws_of_the_verdicts(
    movers: list[tuple[float, float, float, float, float, str, float]],
) -> None:
    crowded, fewer = moving_world(movers), moving_world(movers[1:])
    if crowded is None or fewer is None:
        return
    more, less = assess(crowded, DEFAULT_ROBOT), assess(fewer, DEFAULT_ROBOT)
    assert more.possible_optimistic >= more.possible_cautious
    assert more.possible_cautious == math.isfinite(more.earliest_arrival_s)
    assert more.earliest_arrival_s >= more.static_lower_bound_s - 1e-9
    assert less.earliest_arrival_s <= more.earliest_arrival_s
    assert less.possible_optimistic >= more.possible_optimistic


@pytest.mark.parametrize(
    ("speed", "corners", "slack"),
    [(0.0, 2, 0.006), (0.5, 2, 0.012), (0.5, 9, 0.012), (0.9, 9, 0.016)],
    ids=["standing", "straight", "with sharp turns", "fast"],
)
def test_cautious_moves_touch_nothing_between_nodes_and_layers(
    speed: float, corners: int, slack: float
) -> None:
    """Every move that the search may make near a thin post, followed in steps of 1/20 layer.

    The disc comes near to the post: no more is kept free than need be.
    """
    post, radius = 0.01, DEFAULT_ROBOT.half_diagonal
    rng = np.random.default_rng(corners)
    clearance = Clearance(radius, SPEED, CELL, safe=True)
    smallest = math.inf
    for _ in range(25):
        places = (1.0 + rng.uniform(-0.3, 0.3, (corners, 2))).tolist()
        there = world(
            f"[[moving]]\ncircle = {post}\nwaypoints = {places}\nspeed = {speed}\n",
            start="0.2, 0.2", goal="1.8, 1.8", bounds="0, 0, 2, 2",
        )  # fmt: skip
        grid = grid_over(there.scenario.bounds, (0.2, 0.2), CELL)
        free = np.stack(list(free_layers(there, grid, clearance, 9)))
        nodes = np.column_stack(grid.places())
        for move in (*SHORT, *SLANTING):
            length = LONG if move in SLANTING else 1
            share = np.linspace(0.0, 1.0, 20 * length + 1)[:, None, None]
            for first in range(len(free) - length):
                times = (first + length * share.ravel()) * LAYER
                mover = there.movers[0].motion.positions(times)[:, None]
                near = np.hypot(*(nodes - mover[0]).T) < 0.5
                begin = nodes[near & allowed(free, grid, first, move)]
                ways = begin + share * CELL * np.array(move)
                gaps = np.hypot(*np.moveaxis(ways - mover, 2, 0)) - post
                smallest = min(smallest, float(gaps.min()))
    assert radius <= smallest <= radius + slack


def test_distance_that_cautious_nodes_keep_by_hand() -> None:
    """Half a cell for the corners of a cell, half the way in a layer, and the arcs' shortfall."""
    clearance = Clearance(0.14, 0.5, 0.05, safe=True)
    arcs = math.cos(math.pi / 96)
    assert clearance.layer == 0.1
    assert clearance.static() * arcs == pytest.approx(math.sqrt(0.14**2 + 2 * 0.025**2))
    moving = math.sqrt((0.14 + 0.004) ** 2 + 0.025**2 + 0.045**2)
    assert clearance.moving(0.4, 0.004) * arcs == pytest.approx(moving)
    assert Clearance(0.06, 0.5, 0.05, safe=False).moving(0.4, 0.0) == 0.06


def allowed(free: BoolArray, grid: Grid, first: int, move: tuple[int, int]) -> BoolArray:
    """From which nodes at layer `first` the search lets a point move, (grid.size,)."""

    def at(layer: int, across: int, up: int) -> BoolArray:
        return np.roll(free[layer], -(across + up * grid.columns))

    dx, dy = move
    if move in SHORT:
        return free[first] & at(first + 1, dx, dy)
    result = free[first] & at(first + LONG, dx, dy)
    for part in range(1, LONG):
        left, below = math.floor(dx * part / LONG), math.floor(dy * part / LONG)
        for across in (left, left + 1):
            for up in (below, below + 1):
                result &= at(first + part, across, up)
    return result


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.6, 0.98))
def test_search_agrees_with_a_search_from_node_to_node(seed: int, share: float) -> None:
    rng = np.random.default_rng(seed)
    grid = grid_over((0.0, 0.0, 0.6, 0.5), (0.3, 0.25), CELL)
    free = (rng.random((16, grid.size)) < share) & grid.inner()
    free[0, grid.start] = True
    reached = [np.arange(grid.size) == grid.start]
    for layer in range(1, len(free)):
        now = np.zeros(grid.size, dtype=np.bool_)
        for dx, dy in (*SHORT, *SLANTING):
            length = LONG if (dx, dy) in SLANTING else 1
            if layer >= length:
                starts = reached[layer - length] & allowed(free, grid, layer - length, (dx, dy))
                now |= np.roll(starts, dx + dy * grid.columns)
        reached.append(now)
    for node in np.flatnonzero(grid.inner()):
        layers = [layer for layer, there in enumerate(reached) if there[node]]
        found = earliest_layer(free, grid, np.array([node]))
        assert found == (layers[0] if layers else None)


def test_grid_has_a_node_at_the_start_and_a_blocked_border() -> None:
    grid = grid_over((0.0, -1.0, 3.0, 2.0), (0.513, 0.207), 0.05)
    x, y = grid.places()
    assert (x[grid.start], y[grid.start]) == pytest.approx((0.513, 0.207))
    inner = grid.inner()
    assert x[inner].min() >= 0.0 and x[inner].max() <= 3.0
    assert y[inner].min() >= -1.0 and y[inner].max() <= 2.0
    assert inner.sum() == (grid.rows - 2 * BORDER) * (grid.columns - 2 * BORDER)
