"""Episodes in small worlds, written as scenario files."""

from pathlib import Path

from fuzzynav_mj.episode import Episode
from fuzzynav_mj.runner import play_episode
from fuzzynav_mj.scenarios import load_scenario

Point = tuple[float, float]

HEADER = """\
schema = 1
name = "{name}"
description = "Made for one test."
bounds = [0.0, 0.0, {width}, {height}]
time_limit = {time_limit}

[robot]
start = {start}
goal = {goal}
"""


def box(x_min: float, y_min: float, x_max: float, y_max: float) -> str:
    """A rectangle that stands."""
    corners = [[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]]
    return f"[[static]]\npolygon = {corners}\n"


def disc(radius: float, speed: float, *waypoints: Point, repeat: str = "once") -> str:
    """A round mover that goes from waypoint to waypoint."""
    places = [list(point) for point in waypoints]
    motion = f'waypoints = {places}\nspeed = {speed}\nrepeat = "{repeat}"\n'
    return f"[[moving]]\ncircle = {radius}\n{motion}"


def play(
    folder: Path,
    *obstacles: str,
    start: tuple[float, float, float],
    goal: tuple[float, ...],
    size: Point = (3.0, 2.0),
    time_limit: float = 30.0,
    planner: str = "fuzzy",
    seed: int = 0,
) -> Episode:
    """Writes the world to a file in `folder`, loads it and plays one episode."""
    path = folder / "world.toml"
    header = HEADER.format(
        name="world",
        width=size[0],
        height=size[1],
        time_limit=time_limit,
        start=list(start),
        goal=list(goal),
    )
    path.write_text("\n".join((header, *obstacles)))
    return play_episode(load_scenario(str(path)), planner, seed)
