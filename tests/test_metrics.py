"""Laws and hand-computed numbers of the episode's metrics."""

import json
import math
from dataclasses import dataclass, fields, replace

import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav_mj.metrics import (
    RiskSummary,
    clearances,
    min_clearance,
    optimality,
    path_length,
    percentile_ms,
    record_to_json,
    record_to_row,
    summarise_risk,
    tracking_rms,
    wilson_interval,
)
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.types import Behaviour, Contact, Decision, EpisodeRecord, Outcome

HALF_SIDE = 0.1


@dataclass(frozen=True)
class StandInMover:
    shape: Shape


@dataclass(frozen=True)
class StandInScenario:
    bounds: tuple[float, float, float, float] = (0.0, 0.0, 10.0, 10.0)
    walls: bool = True


@dataclass(frozen=True)
class StandInWorld:
    static: tuple[Shape, ...] = ()
    movers: tuple[StandInMover, ...] = ()
    scenario: StandInScenario = StandInScenario()


def polygon(*corners: tuple[float, float]) -> Shape:
    return Shape(np.array(corners, dtype=float), None)


def no_movers(count: int) -> np.ndarray:
    return np.empty((count, 0, 2))


def gap_at(world: StandInWorld, x: float, y: float, yaw: float = 0.0) -> float:
    (gap,) = clearances(np.array([[x, y, yaw]]), no_movers(1), world, HALF_SIDE)
    return gap


def random_world(rng: np.random.Generator, walls: bool) -> StandInWorld:
    def star(centre: np.ndarray, radius: float) -> Shape:
        if rng.random() < 0.3:
            return Shape(None, (centre[0], centre[1], radius))
        angles = (np.arange(6) + rng.uniform(0.0, 0.8, 6)) * math.pi / 3
        radii = radius * rng.uniform(0.3, 1.0, 6)
        corners = centre + radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
        return Shape(corners, None)

    static = tuple(star(rng.uniform(0, 10, 2), 0.8) for _ in range(rng.integers(0, 5)))
    movers = tuple(StandInMover(star(np.zeros(2), 0.25)) for _ in range(rng.integers(0, 5)))
    return StandInWorld(static, movers, StandInScenario(walls=walls))


def random_walks(rng: np.random.Generator, steps: int, count: int) -> np.ndarray:
    strides = np.cumsum(rng.normal(0.0, 0.02, (steps, count, 2)), axis=0)
    return rng.uniform(1.0, 9.0, (count, 2)) + strides


class TestClearances:
    def test_walls_from_the_middle_and_turned(self):
        world = StandInWorld()
        assert gap_at(world, 5.0, 5.0) == pytest.approx(4.9, abs=1e-12)
        assert gap_at(world, 1.0, 5.0, math.pi / 4) == pytest.approx(1.0 - 0.1 * math.sqrt(2))
        assert gap_at(world, 5.0, 9.7) == pytest.approx(0.2)

    def test_bounds_without_walls_are_no_obstacle(self):
        assert gap_at(StandInWorld(scenario=StandInScenario(walls=False)), 5.0, 9.9) == math.inf

    def test_circle_ahead_of_a_face_and_off_a_corner(self):
        world = StandInWorld(static=(Shape(None, (5.0, 5.0, 0.3)),))
        assert gap_at(world, 4.0, 5.0) == pytest.approx(1.0 - 0.1 - 0.3)
        assert gap_at(world, 4.0, 4.0) == pytest.approx(0.9 * math.sqrt(2) - 0.3)
        assert gap_at(world, 4.0, 4.0, math.pi / 4) == pytest.approx(math.sqrt(2) - 0.1 - 0.3)

    def test_inside_a_concave_pocket(self):
        pocket = polygon((4, 4), (6, 4), (6, 6), (5.8, 6), (5.8, 4.2), (4.2, 4.2), (4.2, 6), (4, 6))
        assert gap_at(StandInWorld(static=(pocket,)), 5.0, 4.5) == pytest.approx(0.2)
        assert gap_at(StandInWorld(static=(pocket,)), 5.6, 5.0) == pytest.approx(0.1)

    def test_touching_and_overlapping_are_zero(self):
        block = StandInWorld(static=(polygon((5, 5), (6, 5), (6, 6), (5, 6)),))
        assert gap_at(block, 4.875, 5.5) == pytest.approx(0.025)
        assert gap_at(block, 5.05, 5.5) == 0.0
        assert gap_at(block, 5.5, 5.5) == 0.0
        assert gap_at(StandInWorld(static=(Shape(None, (5, 5, 1)),)), 5.2, 5.0) == 0.0
        assert gap_at(StandInWorld(), 0.05, 5.0) == 0.0

    def test_movers_are_where_their_positions_say(self):
        triangle = StandInMover(polygon((0.0, -0.2), (0.2, 0.2), (-0.2, 0.2)))
        disc = StandInMover(Shape(None, (0.0, 0.5, 0.1)))
        world = StandInWorld(movers=(triangle, disc))
        poses = np.array([[5.0, 3.0, 0.0], [5.0, 3.0, 0.0]])
        places = np.array([[[5.0, 4.0], [2.0, 2.0]], [[1.0, 1.0], [5.0, 3.0]]])
        gaps = clearances(poses, places, world, HALF_SIDE)
        assert gaps == pytest.approx([4.0 - 0.2 - 3.1, 0.5 - 0.1 - 0.1])

    @settings(max_examples=40, deadline=None)
    @given(seed=st.integers(0, 2**32 - 1), walls=st.booleans())
    def test_equals_every_obstacle_measured_alone(self, seed, walls):
        rng = np.random.default_rng(seed)
        world = random_world(rng, walls)
        poses = np.column_stack([rng.uniform(0, 10, (30, 2)), rng.uniform(-4, 4, 30)])
        places = rng.uniform(0, 10, (30, len(world.movers), 2))
        gaps = clearances(poses, places, world, HALF_SIDE)
        for (x, y, yaw), place, gap in zip(poses, places, gaps, strict=True):
            square = shapely.affinity.translate(
                shapely.affinity.rotate(shapely.box(-0.1, -0.1, 0.1, 0.1), yaw, use_radians=True),
                x,
                y,
            )
            shapes = [(shape, (0.0, 0.0)) for shape in world.static]
            shapes += [(m.shape, at) for m, at in zip(world.movers, place, strict=True)]
            alone = [math.inf]
            if walls:
                corners = shapely.get_coordinates(square)
                alone.append(max(0.0, min(corners.min(), (10.0 - corners).min())))
            for shape, (dx, dy) in shapes:
                if shape.circle is not None:
                    cx, cy, radius = shape.circle
                    to_centre = square.distance(shapely.Point(cx + dx, cy + dy))
                    alone.append(max(0.0, to_centre - radius))
                else:
                    moved = shapely.affinity.translate(shape.footprint, dx, dy)
                    alone.append(square.distance(moved))
            assert gap == pytest.approx(min(alone), abs=1e-9)


class TestMinClearance:
    @settings(max_examples=60, deadline=None)
    @given(
        seed=st.integers(0, 2**32 - 1),
        steps=st.integers(1, 120),
        stride=st.integers(1, 150),
        walls=st.booleans(),
    )
    def test_equals_the_least_of_every_step(self, seed, steps, stride, walls):
        rng = np.random.default_rng(seed)
        world = random_world(rng, walls)
        places = random_walks(rng, steps, len(world.movers))
        yaw = np.cumsum(rng.normal(0.0, 0.05, steps))
        poses = np.column_stack([random_walks(rng, steps, 1)[:, 0], yaw])
        least = clearances(poses, places, world, HALF_SIDE).min()
        assert min_clearance(poses, places, world, HALF_SIDE, stride) == least

    def test_finds_one_near_step_of_a_fast_mover(self):
        block = polygon((5.16, 4.0), (6.0, 4.0), (6.0, 6.0), (5.16, 6.0))  # keeps 0.06 away
        dart = StandInMover(polygon((-0.1, -0.1), (0.1, -0.1), (0.0, 0.1)))
        poses = np.tile([5.0, 5.0, 0.0], (101, 1))
        places = np.tile([5.0, 2.0], (101, 1, 1))
        places[37, 0] = [5.0, 4.75]
        world = StandInWorld(static=(block,), movers=(dart,))
        assert min_clearance(poses, places, world, HALF_SIDE, 50) == pytest.approx(0.05)

    def test_finds_the_corner_of_a_turn_in_place(self):
        near = polygon((5.16, 4.0), (6.0, 4.0), (6.0, 6.0), (5.16, 6.0))
        poses = np.tile([5.0, 5.0, 0.0], (101, 1))
        poses[:, 2] = np.linspace(0.0, math.pi / 2, 101)
        least = min_clearance(poses, no_movers(101), StandInWorld(static=(near,)), HALF_SIDE, 200)
        assert least == pytest.approx(0.16 - 0.1 * math.sqrt(2))

    def test_leaves_out_what_is_not_finite(self):
        poses = np.array([[5.0, 5.0, 0.0], [4.0, 5.0, 0.0], [math.nan, math.nan, 0.0]])
        least = min_clearance(poses, no_movers(3), StandInWorld(), HALF_SIDE)
        assert least == pytest.approx(3.9)
        assert min_clearance(poses[2:], no_movers(1), StandInWorld(), HALF_SIDE) == math.inf


class TestNumbers:
    def test_path_length_of_a_three_four_five_triangle(self):
        assert path_length(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [0.0, 0.0]])) == 12.0
        assert path_length(np.array([[1.0, 1.0]])) == 0.0

    @given(st.integers(0, 2**32 - 1))
    def test_path_is_no_shorter_than_its_chord(self, seed):
        points = np.random.default_rng(seed).normal(size=(9, 2))
        assert path_length(points) >= math.dist(points[0], points[-1])

    def test_optimality_counts_only_at_the_goal(self):
        assert optimality(9.0, 10.0, Outcome.GOAL_REACHED) == 0.9
        assert optimality(0.0, 0.0, Outcome.GOAL_REACHED) is None
        others = [outcome for outcome in Outcome if outcome is not Outcome.GOAL_REACHED]
        assert {optimality(9.0, 10.0, outcome) for outcome in others} == {None}

    def test_tracking_rms(self):
        commanded = np.zeros((2, 2))
        assert tracking_rms(commanded, np.array([[0.3, 0.4], [0.0, 0.0]])) == pytest.approx(
            0.5 / math.sqrt(2)
        )
        assert math.isnan(tracking_rms(np.empty((0, 2)), np.empty((0, 2))))

    def test_percentile_is_in_milliseconds(self):
        assert percentile_ms([0.001, 0.002, 0.003], 50) == pytest.approx(2.0)
        assert percentile_ms([0.0, 0.010], 99) == pytest.approx(9.9)
        assert math.isnan(percentile_ms([], 50))

    def test_risk_of_accepted_decisions(self):
        def decision(risk: float, vetoed: bool = False) -> Decision:
            return Decision((0.0, 0.0), Behaviour.GOAL_SEEKING, risk=risk, vetoed=vetoed)

        decisions = [decision(20.0), decision(80.0, vetoed=True), decision(math.nan)]
        assert summarise_risk(decisions) == RiskSummary(maximum=80.0, mean=50.0, vetoes=1)
        assert summarise_risk([decision(math.nan)]) == RiskSummary(None, None, 0)


class TestWilson:
    def test_hand_computed(self):
        # z = 1.959964: centre (0.5 + z^2/20) / (1 + z^2/10) = 0.5, half width 0.2634
        assert wilson_interval(5, 10) == pytest.approx((0.2366, 0.7634), abs=5e-5)
        assert wilson_interval(0, 100) == pytest.approx((0.0, 0.0370), abs=5e-5)

    @given(st.integers(1, 10_000).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
    def test_holds_the_share_and_mirrors(self, counts):
        successes, trials = counts
        low, high = wilson_interval(successes, trials)
        assert 0.0 <= low <= successes / trials <= high <= 1.0
        mirrored = wilson_interval(trials - successes, trials)
        assert mirrored == pytest.approx((1.0 - high, 1.0 - low), abs=1e-12)

    def test_no_trials_tell_nothing(self):
        assert wilson_interval(0, 0) == (0.0, 1.0)

    def test_impossible_counts(self):
        with pytest.raises(ValueError, match=r"^successes must be in 0\.\.3, not 4$"):
            wilson_interval(4, 3)


def record() -> EpisodeRecord:
    return EpisodeRecord(
        scenario="concave",
        planner="fuzzy",
        seed=7,
        outcome=Outcome.CONTACT,
        sim_time_s=12.5,
        path_length_m=3.0,
        shortest_path_m=math.inf,
        optimality=None,
        min_clearance_m=0.0,
        contacts=(Contact(12.5, "moving:1", 0.01, False),),
        risk_max=math.nan,
        risk_mean=None,
        gate_vetoes=np.int64(2),
        decisions=125,
        plan_ms_p50=np.float64(1.5),
        plan_ms_p99=2.5,
        wall_s=0.2,
        physics_steps=2500,
        tracking_rms_m=0.01,
        slip_max_mps=0.002,
        versions={"fuzzynav_mj": "0.1.0", "mujoco": "3.17.0"},
    )


class TestRecord:
    def test_json_has_exactly_the_fields_and_no_nan(self):
        plain = record_to_json(record())
        assert list(plain) == [field.name for field in fields(EpisodeRecord)]
        assert plain["outcome"] == "contact"
        assert plain["risk_max"] is None
        assert plain["shortest_path_m"] is None
        assert plain["contacts"] == [
            {"time_s": 12.5, "with": "moving:1", "robot_speed_mps": 0.01, "at_fault": False}
        ]
        assert json.loads(json.dumps(plain, allow_nan=False)) == plain

    def test_row_is_flat(self):
        row = record_to_row(record())
        named = {name for name in row if name.startswith(("contact", "version"))}
        assert named == {
            "contacts_count",
            "contact_time_s",
            "contact_with",
            "contact_robot_speed_mps",
            "contact_at_fault",
            "version_fuzzynav_mj",
            "version_mujoco",
        }
        assert (row["contacts_count"], row["contact_time_s"], row["contact_with"]) == (
            1,
            12.5,
            "moving:1",
        )
        assert row["contact_at_fault"] is False
        assert all(isinstance(value, str | int | float | None) for value in row.values())

    def test_rows_share_their_columns(self):
        clear = record_to_row(replace(record(), contacts=()))
        assert list(clear) == list(record_to_row(record()))
        assert (clear["contacts_count"], clear["contact_with"]) == (0, None)
