"""What several test files need."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

# dm_control looks for a display when it is imported.
os.environ.setdefault("MUJOCO_GL", "disable")

SMALL_ARENA = """\
schema = 1
name = "{name}"
description = "A goal 0.6 m straight ahead."
bounds = [0.0, 0.0, 2.0, 1.2]
time_limit = {time_limit}

[robot]
start = [0.5, 0.6, 0.0]
goal = [1.1, 0.6]
{rest}"""


@pytest.fixture
def write_scenario(tmp_path: Path) -> Callable[..., str]:
    """A function that writes a scenario whose episodes take a fraction of a second.

    It takes the name, what follows the [robot] table and the time limit; it returns the path.
    """

    def write(name: str, rest: str = "", time_limit: float = 10.0) -> str:
        path = tmp_path / f"{name}.toml"
        path.write_text(SMALL_ARENA.format(name=name, rest=rest, time_limit=time_limit))
        return str(path)

    return write
