"""The world under a picture: what stands, what moves, start and goal."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon, Rectangle
from matplotlib.transforms import Affine2D

from fuzzynav_mj.recording.colours import BLACK, GREEN, ORANGE
from fuzzynav_mj.reporting.style import hex_colour
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.types import FloatArray

STANDING = "#9a9a9a"
MOVING = hex_colour(ORANGE)


def draw_world(axes: Axes, scenario: Scenario) -> None:
    """Bounds, what stands, start (square) and goal (star), in m, both axes to the same scale."""
    x_min, y_min, x_max, y_max = scenario.bounds
    edge = {"edgecolor": "black", "linewidth": 1.2, "linestyle": "-" if scenario.walls else ":"}
    axes.add_patch(Rectangle((x_min, y_min), x_max - x_min, y_max - y_min, fill=False, **edge))
    for shape in scenario.static:
        axes.add_patch(_patch(shape, (0.0, 0.0), facecolor=STANDING, edgecolor="0.35"))
    start = (scenario.start.x, scenario.start.y)
    mark = {"markeredgecolor": "black", "zorder": 6, "clip_on": False}
    axes.plot(*start, "s", markerfacecolor="white", markersize=7, **mark)
    axes.plot(*scenario.goal, "*", markerfacecolor=hex_colour(GREEN), markersize=13, **mark)
    margin = 0.02 * max(x_max - x_min, y_max - y_min)
    axes.set_xlim(x_min - margin, x_max + margin)
    axes.set_ylim(y_min - margin, y_max + margin)
    axes.set_aspect("equal")
    axes.spines[:].set_visible(False)


def draw_movers(axes: Axes, shapes: tuple[Shape, ...], places: FloatArray) -> None:
    """The moving obstacles at `places` (m, 2), in the world frame."""
    for shape, place in zip(shapes, places, strict=True):
        x, y = float(place[0]), float(place[1])
        axes.add_patch(
            _patch(shape, (x, y), facecolor=MOVING, edgecolor="black", hatch="////", zorder=3)
        )


def draw_robot(axes: Axes, pose: FloatArray) -> None:
    """The footprint at `pose` (3,) x, y, yaw, with a tick forwards."""
    half = DEFAULT_ROBOT.half_side
    turn = Affine2D().rotate(float(pose[2])).translate(float(pose[0]), float(pose[1]))
    corners = turn.transform(np.array([[-half, -half], [half, -half], [half, half], [-half, half]]))
    axes.add_patch(Polygon(corners, facecolor="white", edgecolor=hex_colour(BLACK), zorder=5))
    nose = turn.transform(np.array([[0.0, 0.0], [half, 0.0]]))
    axes.plot(nose[:, 0], nose[:, 1], color="black", linewidth=1.2, zorder=5)


def _patch(shape: Shape, origin: tuple[float, float], **style: object) -> Circle | Polygon:
    if shape.circle is not None:
        x, y, radius = shape.circle
        return Circle((x + origin[0], y + origin[1]), radius, linewidth=0.6, **style)
    assert shape.polygon is not None
    return Polygon(shape.polygon + np.array(origin), linewidth=0.6, **style)
