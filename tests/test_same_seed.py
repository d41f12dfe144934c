"""Same scenario, planner and seed: the same episode to the last bit, whatever ran before."""

import os
import subprocess
import sys
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fuzzynav_mj.episode import Episode
from fuzzynav_mj.runner import play_episode
from fuzzynav_mj.scenarios import load_scenario
from fuzzynav_mj.scenarios.schema import Scenario

WALL_TIMES = {"plan_time", "wall_s", "plan_ms_p50", "plan_ms_p99"}

SMALL = """
schema = 1
name = "small"
description = "A wall and a drawn mover."
bounds = [0.0, 0.0, 3.0, 2.0]
time_limit = 20.0

[robot]
start = [0.4, 1.0, 0.3]
goal = [1.6, 1.2]

[[static]]
polygon = [[1.0, 0.0], [1.1, 0.0], [1.1, 0.9], [1.0, 0.9]]

[[random_moving]]
count = [1, 1]
radius = [0.1, 0.12]
vertices = [3, 6]
concave_fraction = 0.5
speed = [0.2, 0.3]
region = [[1.3, 0.2], [2.8, 0.2], [2.8, 1.8], [1.3, 1.8]]
"""


def difference(one: Any, other: Any, at: str = "") -> str:
    """Where two records first differ, be it in a bit; empty where they do not. Wall times aside."""
    if type(one) is not type(other):
        return f"{at}: {type(one)} and {type(other)}"
    if is_dataclass(one):
        for field in fields(one):
            if field.name not in WALL_TIMES:
                name = field.name
                found = difference(getattr(one, name), getattr(other, name), f"{at}.{name}")
                if found:
                    return found
        return ""
    if isinstance(one, np.ndarray):
        same = one.shape == other.shape and one.tobytes() == other.tobytes()
        return "" if same else f"{at}: arrays differ"
    if isinstance(one, tuple):
        if len(one) != len(other):
            return f"{at}: {len(one)} and {len(other)} entries"
        pairs = enumerate(zip(one, other, strict=True))
        return next((d for i, (a, b) in pairs if (d := difference(a, b, f"{at}[{i}]"))), "")
    if isinstance(one, float):
        same = np.float64(one).tobytes() == np.float64(other).tobytes()
        return "" if same else f"{at}: {one!r} and {other!r}"
    return "" if one == other else f"{at}: {one!r} and {other!r}"


def compare(one: Episode, other: Episode) -> str:
    """Where two episodes differ."""
    return difference(one.record, other.record, "record") or difference(
        one.steps, other.steps, "steps"
    )


@pytest.fixture
def small(tmp_path: Path) -> Scenario:
    """The small world."""
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return load_scenario(str(path))


@pytest.mark.parametrize("planner", ["fuzzy", "multilayer"])
def test_same_seed_same_episode(small: Scenario, planner: str) -> None:
    first = play_episode(small, planner, 7)
    assert len(first.steps) > 10
    assert compare(first, play_episode(small, planner, 7)) == ""


def test_episodes_in_between_leave_no_trace() -> None:
    """Alone or after others, of another world, planner and seed, in the same process; and with
    the scenario loaded anew."""
    narrow = load_scenario("narrow")
    alone = play_episode(narrow, "fuzzy", 1)
    play_episode(load_scenario("convex"), "multilayer", 3)
    assert compare(alone, play_episode(narrow, "fuzzy", 1)) == ""
    assert compare(alone, play_episode(load_scenario("narrow"), "fuzzy", 1)) == ""


IN_A_FRESH_PROCESS = """
import sys
from fuzzynav_mj.runner import play_episode
from fuzzynav_mj.scenarios import load_scenario
for step in play_episode(load_scenario(sys.argv[1]), "fuzzy", 7).steps:
    print(*(value.hex() for value in (step.pose.x, step.pose.y, step.pose.yaw)))
"""


def test_fresh_process_plays_the_same_episode(small: Scenario) -> None:
    play_episode(load_scenario("convex"), "multilayer", 3)
    here = [
        " ".join(value.hex() for value in (step.pose.x, step.pose.y, step.pose.yaw))
        for step in play_episode(small, "fuzzy", 7).steps
    ]
    there = subprocess.run(
        [sys.executable, "-c", IN_A_FRESH_PROCESS, small.source],
        env={**os.environ, "PYTHONHASHSEED": "12345"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert there.stdout.splitlines() == here


def test_other_seeds_are_other_episodes(small: Scenario) -> None:
    first, second = (play_episode(small, "fuzzy", seed) for seed in (7, 8))
    assert compare(first, second).startswith("record.seed")
    assert difference(first.steps, second.steps) != ""


def test_comparison_sees_a_single_bit(small: Scenario) -> None:
    first = play_episode(small, "fuzzy", 7)
    nudged = float(np.nextafter(first.record.path_length_m, 9.0))
    other = replace(first, record=replace(first.record, path_length_m=nudged))
    assert compare(first, other).startswith("record.path_length_m")
    assert compare(first, replace(first, record=replace(first.record, wall_s=9.9))) == ""
