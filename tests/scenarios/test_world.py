"""Shapes, and what a world is made of."""

import math

import numpy as np
import pytest
import shapely

from fuzzynav_mj.scenarios.loading import parse_scenario
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.scenarios.world import make_world

FILE = b"""
schema = 1
name = "mixed"
bounds = [0, 0, 6, 6]
[robot]
start = [1, 1, 0]
goal = [5, 5]
[[static]]
polygon = [[2, 2], [3, 2], [3, 3], [2, 3]]
[[static]]
circle = [4.5, 2, 0.5]
[[moving]]
circle = 0.1
waypoints = [[1, 5], [3, 5]]
speed = 0.2
[[moving]]
polygon = [[0, 0], [0, 0.2], [0.2, 0]]
keyframes = [[0, 5, 1], [4, 5, 2]]
[[random_moving]]
count = [2, 2]
radius = [0.1, 0.1]
speed = [0.2, 0.3]
region = [[0.5, 3.5], [5.5, 3.5], [5.5, 5.5], [0.5, 5.5]]
[[random_moving]]
count = [1, 1]
radius = [0.2, 0.2]
speed = [0.1, 0.1]
region = [[3.2, 0.2], [5.8, 0.2], [5.8, 5.5], [3.2, 5.5]]
"""


def test_a_shape_is_a_polygon_or_a_circle() -> None:
    for polygon, circle in [(None, None), (np.eye(3, 2), (0.0, 0.0, 1.0))]:
        with pytest.raises(ValueError, match="either a polygon or a circle"):
            Shape(polygon, circle)


def test_radius_is_about_the_frame_s_origin() -> None:
    assert Shape(np.array([[-3.0, -4.0], [1.0, 0.0], [0.0, 1.0]]), None).radius == 5.0
    assert Shape(None, (0.0, 0.0, 0.3)).radius == 0.3
    assert Shape(None, (3.0, 4.0, 0.5)).radius == 5.5


def test_footprint_of_a_circle_is_inscribed_and_nearly_as_large() -> None:
    footprint = Shape(None, (1.0, 2.0, 0.5)).footprint
    exact = math.pi * 0.25
    assert 0.999 * exact < footprint.area < exact
    assert footprint.centroid.distance(shapely.Point(1.0, 2.0)) < 1e-12


def test_scripted_movers_come_first_and_are_the_same_for_every_seed() -> None:
    scenario = parse_scenario(FILE, "mixed.toml")
    worlds = [make_world(scenario, np.random.default_rng(seed)) for seed in (1, 2)]
    for world in worlds:
        assert world.movers[:2] == scenario.moving
        assert len(world.movers) == 5
        radii = [mover.shape.radius for mover in world.movers[2:]]
        assert radii == pytest.approx([0.1, 0.1, 0.2])
    assert worlds[0].static == worlds[1].static == scenario.static


def test_static_union_and_free_space_share_the_arena() -> None:
    world = make_world(parse_scenario(FILE, "mixed.toml"), np.random.default_rng(0))
    covered = 1.0 + world.static[1].footprint.area
    assert world.static_union.area == pytest.approx(covered)
    assert world.free_space.area == pytest.approx(36.0 - covered)
    assert not world.free_space.contains(shapely.Point(2.5, 2.5))


def test_a_world_without_static_obstacles_is_all_free() -> None:
    lines = FILE.decode().split("[[static]]")
    bare = lines[0] + "[[moving]]" + lines[2].split("[[moving]]", 1)[1]
    world = make_world(parse_scenario(bare.encode(), "bare.toml"), np.random.default_rng(0))
    assert world.static_union.is_empty
    assert world.free_space.area == 36.0
