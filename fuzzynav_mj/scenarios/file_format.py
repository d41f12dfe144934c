"""The keys of a scenario file, and what each may hold.

Every key's description is the "allowed" half of the message that a wrong value gets.
"""

from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from fuzzynav_mj.scenarios.motion import Interpolation, Repeat

LARGEST = 10_000.0  # m, s, m/s: far beyond any arena, and safe to square
COUNT_LIMIT = 100
VERTEX_LIMIT = 32

Number = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-LARGEST, le=LARGEST)]
NotNegative = Annotated[Number, Field(ge=0.0)]
Positive = Annotated[Number, Field(gt=0.0)]
Text = Annotated[str, Field(strict=True)]
Flag = Annotated[bool, Field(strict=True)]
Count = Annotated[int, Field(strict=True, ge=0, le=COUNT_LIMIT)]
Vertices = Annotated[int, Field(strict=True, ge=3, le=VERTEX_LIMIT)]
Point = tuple[Number, Number]
Corners = Annotated[list[Point], Field(min_length=3)]

SIMPLE_POLYGON = (
    "a simple polygon: at least 3 different corners [x, y] in m, with edges that meet only there"
)


def _none_if_random(value: Any) -> Any:
    return None if value == "random" else value


class Table(BaseModel):
    """A table of the file: no unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class RobotTable(Table):
    """`[robot]`."""

    start: tuple[Number, Number, Number] = Field(description="3 numbers x, y, yaw in m and rad")
    goal: list[Number] = Field(
        min_length=2, max_length=3, description="2 numbers x, y or 3 numbers x, y, yaw"
    )
    goal_tolerance: Positive = Field(default=0.10, description="a number above 0 (m)")


class StaticTable(Table):
    """One `[[static]]`."""

    polygon: Corners | None = Field(default=None, description=SIMPLE_POLYGON)
    circle: tuple[Number, Number, Positive] | None = Field(
        default=None, description="3 numbers x, y, radius in m, the radius above 0"
    )


class MovingTable(Table):
    """One `[[moving]]`.

    A phase of None, `"random"` in the file, is drawn for every seed. `speed` is held against the
    robot's top speed; keyframes state times and places and are taken as they are, however fast.
    """

    polygon: Corners | None = Field(default=None, description=SIMPLE_POLYGON)
    circle: Positive | None = Field(default=None, description="a radius above 0 (m)")
    waypoints: Annotated[list[Point], Field(min_length=2)] | None = Field(
        default=None, description="at least 2 points [x, y] in m, not all the same"
    )
    speed: NotNegative | None = Field(
        default=None, description="a number not below 0 (m/s), beside waypoints"
    )
    keyframes: Annotated[list[tuple[Number, Number, Number]], Field(min_length=2)] | None = Field(
        default=None, description="at least 2 rows [time, x, y] in s and m, with increasing times"
    )
    interpolation: Interpolation | None = Field(
        default=None, description="'linear' or 'catmull-rom', beside keyframes"
    )
    repeat: Repeat = Field(default="reverse", description="'reverse', 'loop' or 'once'")
    phase: Annotated[Number | None, BeforeValidator(_none_if_random)] = Field(
        default=0.0, description="a number (s) or 'random'"
    )


class RandomMovingTable(Table):
    """One `[[random_moving]]`."""

    count: tuple[Count, Count] = Field(
        description=f"2 integers, smallest and largest, in 0..{COUNT_LIMIT}"
    )
    radius: tuple[Positive, Positive] = Field(
        description="2 numbers above 0 (m), smallest and largest"
    )
    vertices: tuple[Vertices, Vertices] = Field(
        default=(3, 8), description=f"2 integers, smallest and largest, in 3..{VERTEX_LIMIT}"
    )
    concave_fraction: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        default=0.3, description="a number in 0..1"
    )
    speed: tuple[NotNegative, NotNegative] = Field(
        description="2 numbers not below 0 (m/s), smallest and largest"
    )
    acceleration: Positive = Field(default=1.0, description="a number above 0 (m/s2)")
    region: Corners = Field(description=SIMPLE_POLYGON)


class ScenarioFile(Table):
    """The whole file."""

    schema_: Annotated[int, Field(strict=True, ge=1, le=1)] = Field(alias="schema", description="1")
    name: Annotated[Text, Field(min_length=1)] = Field(description="a text of at least 1 letter")
    description: Text = Field(default="", description="a text")
    bounds: tuple[Number, Number, Number, Number] = Field(
        description="4 numbers x_min, y_min, x_max, y_max in m, each minimum below its maximum"
    )
    walls: Flag = Field(default=True, description="true or false")
    time_limit: Positive = Field(default=120.0, description="a number above 0 (s)")
    allow_faster: Flag = Field(default=False, description="true or false")
    robot: RobotTable = Field(description="a table [robot]")
    static: list[StaticTable] = Field(default=[], description="tables [[static]]")
    moving: list[MovingTable] = Field(default=[], description="tables [[moving]]")
    random_moving: list[RandomMovingTable] = Field(
        default=[], description="tables [[random_moving]]"
    )


SECTIONS: dict[str, type[Table]] = {
    "robot": RobotTable,
    "static": StaticTable,
    "moving": MovingTable,
    "random_moving": RandomMovingTable,
}
