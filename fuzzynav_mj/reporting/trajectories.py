"""The ways of all planners through each world, and one run in frames (figures 8 and 10)."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch

from fuzzynav_mj.recording.colours import BLUE, GREEN
from fuzzynav_mj.reporting.style import (
    LineStyle,
    Picture,
    hex_colour,
    line_styles,
    look,
    new_figure,
)
from fuzzynav_mj.reporting.traces import Trace
from fuzzynav_mj.reporting.worlds import MOVING, STANDING, draw_movers, draw_robot, draw_world
from fuzzynav_mj.results import slug
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.types import Outcome

FRAMES = 8
MARKS = 4  # markers along a way, so that it can be followed where several lie on each other


def trajectory_pictures(
    traces: Sequence[Trace], planners: Sequence[str], labels: Mapping[str, str]
) -> Iterator[Picture]:
    """One picture for each world: the ways of all planners on the same seed.

    Args:
        traces: world by world.
        planners: the order of the legend; a planner looks the same in every world.
        labels: of the planners.
    """
    styles = line_styles(planners)
    taken: set[str] = set()
    for name in dict.fromkeys(trace.job.scenario.name for trace in traces):
        own = [trace for trace in traces if trace.job.scenario.name == name]
        own.sort(key=lambda trace: planners.index(trace.job.planner))
        file_name = f"ways_{slug(name)}"
        while file_name in taken:
            file_name += "_"
        taken.add(file_name)
        yield Picture(
            file_name,
            f"Ways through {name}, seed {own[0].job.seed} (as figure 10)",
            f"The ways of all planners through {name} on the same seed. Grey stands; orange moves, "
            "shown where it is at the start, with its way as a thin line. Square: start; star: "
            "goal; cross: where an episode ended that failed. The marks along a way only help to "
            "follow it.",
            _ways(own, styles, labels),
        )


def frame_picture(trace: Trace) -> Picture:
    """One run in frames, one of them at its highest risk."""
    name = trace.job.scenario.name
    return Picture(
        f"frames_{slug(name)}",
        f"Planner {trace.job.planner} in {name}, seed {trace.job.seed}, in frames (as figure 8)",
        "Square: the robot, with its four sensor rings; blue: its way so far; orange moves. One "
        "frame shows the step of the highest risk.",
        _frames(trace),
    )


def _ways(
    traces: Sequence[Trace], styles: Mapping[str, LineStyle], labels: Mapping[str, str]
) -> Figure:
    scenario = traces[0].job.scenario
    texts = {t.job.planner: f"{labels[t.job.planner]}: {_ending(t)}" for t in traces}
    x_min, y_min, x_max, y_max = scenario.bounds
    ratio = (y_max - y_min) / (x_max - x_min)
    wide = min(5.2, 6.5 / ratio)
    legend = 1.0 + 0.075 * max(24, *map(len, texts.values()))
    tall = max(wide * ratio, 0.21 * (len(traces) + 6))
    with look():
        figure = new_figure(wide + 0.6 + legend, tall + 0.6)
        axes = figure.subplots()
        draw_world(axes, scenario)
        longest = max(traces, key=lambda trace: len(trace.times))
        if len(longest.times):
            for way in longest.movers.transpose(1, 0, 2):
                axes.plot(way[:, 0], way[:, 1], color=MOVING, linewidth=0.6, alpha=0.7, zorder=2)
            draw_movers(axes, longest.shapes, longest.movers[0])
        handles: list[Line2D | Patch] = []
        for index, trace in enumerate(traces):
            style = styles[trace.job.planner]
            _way(axes, trace, style, index / max(1, len(traces)))
            handles.append(
                Line2D(
                    [], [], color=style.colour, linestyle=style.dashes, marker=style.marker,
                    markersize=5, linewidth=1.6, label=texts[trace.job.planner],
                )
            )  # fmt: skip
        handles += [
            Patch(facecolor=STANDING, edgecolor="0.35", label="stands"),
            Patch(facecolor=MOVING, edgecolor="black", hatch="////", label="moves"),
            Line2D([], [], linestyle="", marker="s", markerfacecolor="white", label="start",
                   markeredgecolor="black"),
            Line2D([], [], linestyle="", marker="*", markerfacecolor=hex_colour(GREEN),
                   markeredgecolor="black", markersize=11, label="goal"),
            Line2D([], [], linestyle="", marker="X", color="black", markersize=8,
                   label="end of a failed episode"),
        ]  # fmt: skip
        figure.legend(handles=handles, loc="outside right center", frameon=False, handlelength=3.5)
        axes.set_xlabel("x, m")
        axes.set_ylabel("y, m")
    return figure


def _way(axes: Axes, trace: Trace, style: LineStyle, shift: float) -> None:
    if not len(trace.times):
        return
    x, y = trace.poses[:, 0], trace.poses[:, 1]
    spacing = max(1, len(x) // MARKS)
    axes.plot(
        x, y, color=style.colour, linestyle=style.dashes, linewidth=1.6, marker=style.marker,
        markersize=5, markeredgecolor="black", markeredgewidth=0.5, zorder=4,
        markevery=(int(shift * spacing), spacing),
    )  # fmt: skip
    if trace.outcome is not Outcome.GOAL_REACHED:
        axes.plot(
            x[-1], y[-1], marker="X", color=style.colour, markersize=10, zorder=7,
            markeredgecolor="black",
        )  # fmt: skip


def _ending(trace: Trace) -> str:
    how = trace.outcome.value.replace("_", " ")
    return f"{how}, {trace.path_length_m:.1f} m"


def _frames(trace: Trace) -> Figure:
    steps = np.linspace(0, len(trace.times) - 1, FRAMES).round().astype(int)
    if trace.peak is not None:
        steps[1 + np.abs(steps[1:-1] - trace.peak.step).argmin()] = trace.peak.step
    with look():
        figure = new_figure(10.0, 5.6)
        for axes, step in zip(figure.subplots(2, FRAMES // 2).flat, steps, strict=True):
            draw_world(axes, trace.job.scenario)
            draw_movers(axes, trace.shapes, trace.movers[step])
            way = trace.poses[: step + 1]
            axes.plot(way[:, 0], way[:, 1], color=hex_colour(BLUE), linewidth=1.4, zorder=4)
            for ring in DEFAULT_ROBOT.rings:
                axes.add_patch(
                    Circle(way[-1, :2], ring, fill=False, linewidth=0.5, edgecolor="0.2", zorder=4)
                )
            draw_robot(axes, way[-1])
            at_peak = trace.peak is not None and step == trace.peak.step
            risk = trace.peak.risk if at_peak and trace.peak is not None else trace.risks[step]
            title = f"step {step}, {trace.times[step]:.1f} s"
            title += f", risk {risk:.0f}" if risk == risk else ""
            axes.set_title(title, fontweight="bold" if at_peak else "normal")
            axes.set_xticks([])
            axes.set_yticks([])
    return figure
