"""Writes an episode as a Rerun recording; the only module that imports rerun.

Everything is written in columns after the episode, on the timelines `step` (decisions) and
`sim_time` (simulated seconds). `fuzzynav_mj.recording` says what is shown, this module how.
"""

import contextlib
import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from rerun.error_utils import RerunWarning

from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.metrics import record_to_row
from fuzzynav_mj.recording import colours, plots, tracks
from fuzzynav_mj.recording.colours import Colour
from fuzzynav_mj.recording.guide import guide
from fuzzynav_mj.recording.plots import Curves
from fuzzynav_mj.recording.scene import (
    DECK_HEIGHT,
    FOLLOWER,
    MAGNIFICATION,
    MAGNIFIED,
    MARK_HEIGHT,
    MOVING,
    OBSTACLE_HEIGHT,
    ROBOT,
    Label,
    Lines,
    Solid,
    arena,
    robot_parts,
)
from fuzzynav_mj.recording.tracks import Ragged
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.types import Behaviour, EpisodeRecord, FloatArray, IntArray, StepRecord

if TYPE_CHECKING:
    from fuzzynav_mj.scenarios.world import World

TRAIL = "/world/trail"
DECISION_HEIGHT = DECK_HEIGHT + 0.02  # above the robot, which hides the floor beneath
SCAN_HEIGHT = 0.115
LABEL_COLOUR = (255, 255, 255)  # the viewer puts labels on dark plates


def write_recording(
    path: Path | str,
    world: "World",
    steps: Sequence[StepRecord],
    record: EpisodeRecord,
    robot: RobotSpec,
    risk_limit: float = 76.0,
) -> None:
    """Write one episode as a Rerun file, with a layout that explains itself.

    Args:
        path: the file, replaced as a whole or left alone.
        world: the episode's obstacles, start, goal and bounds.
        steps: what happened, in order of time.
        record: the episode's numbers; they become properties of the recording.
        robot: the robot's measures.
        risk_limit: the gate's limit, for plot and events; 76 in section 4 of the paper.

    Raises:
        FuzzyNavError: the file cannot be written, or the environment turns recordings off.
    """
    stream = rr.RecordingStream("fuzzynav_mj", send_properties=False)
    if not rr.is_enabled(stream):
        given = os.environ.get("RERUN")
        raise FuzzyNavError(f"{path}: the environment variable RERUN={given} turns recordings off")
    with warnings.catch_warnings():
        # Rerun warns of data that it cannot take, and leaves it out.
        warnings.simplefilter("error", RerunWarning)
        data = _encode(stream, world, steps, record, robot, risk_limit)
    _replace(Path(path), data)


def _replace(path: Path, data: bytes) -> None:
    if path.exists() and not path.is_file():
        raise FuzzyNavError(f"{path}: cannot write the recording: not a regular file")
    part = path.parent / f".{path.name}.{os.getpid()}.part"
    try:
        part.write_bytes(data)
        part.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):
            part.unlink()
        raise FuzzyNavError(f"{path}: cannot write the recording: {error.strerror}") from None


@dataclass(frozen=True, slots=True)
class _Sink:
    """A recording that takes things once for all times, or as columns over the steps."""

    stream: rr.RecordingStream
    times: FloatArray  # (n,) of the steps, s

    def static(self, entity: str, thing: rr.AsComponents) -> None:
        self.stream.log(entity, thing, static=True)

    def rows(
        self,
        entity: str,
        columns: rr.ComponentColumnList,
        steps: IntArray | None = None,
        times: FloatArray | None = None,
    ) -> None:
        """Send one row for each of `steps` (default: all), at `times` (default: the steps')."""
        steps = np.arange(len(self.times)) if steps is None else steps
        times = self.times[steps] if times is None else times
        index = [rr.TimeColumn("step", sequence=steps), rr.TimeColumn("sim_time", duration=times)]
        self.stream.send_columns(entity, index, columns)


def _encode(
    stream: rr.RecordingStream,
    world: "World",
    steps: Sequence[StepRecord],
    record: EpisodeRecord,
    robot: RobotSpec,
    risk_limit: float,
) -> bytes:
    memory = stream.memory_recording()
    sink = _Sink(stream, np.array([step.time for step in steps], dtype=np.float64))
    scenario = world.scenario

    stream.send_recording_name(f"{record.scenario}, {record.planner}, seed {record.seed}")
    values = {name: value for name, value in record_to_row(record).items() if value is not None}
    stream.send_property("episode", rr.AnyValues(**values))
    page = rr.TextDocument(guide(record, scenario.description), media_type="text/markdown")
    sink.static("/guide", page)

    for thing in (*arena(world), *robot_parts(robot)):
        _draw(sink, thing)
    _motions(sink, steps, len(world.movers))
    _decisions(sink, steps)
    curves = plots.all_curves(steps, record.sim_time_s, risk_limit)
    for group in curves:
        _plot(sink, group)
    _texts(sink, steps, record, risk_limit)
    stream.send_blueprint(_blueprint(world, curves))
    data = memory.drain_as_bytes()
    stream.disconnect()
    return data


# The scene ------------------------------------------------------------------------------------


def _level(points: FloatArray, height: float) -> FloatArray:
    """(n, 3) points at `height` over (n, 2) points of the floor."""
    return np.column_stack([points, np.full(len(points), height)])


def _draw(sink: _Sink, thing: Solid | Lines | Label) -> None:
    if isinstance(thing, Solid):
        mesh, colour = thing.mesh, thing.colour
        shape: rr.AsComponents = rr.Mesh3D(
            vertex_positions=mesh.vertices, vertex_normals=mesh.normals, albedo_factor=colour
        )
    elif isinstance(thing, Lines):
        shape = rr.LineStrips3D(thing.strips, colors=thing.colour, radii=thing.radius)
    else:
        shape = rr.Points3D(
            [thing.place], labels=[thing.text], show_labels=True, colors=LABEL_COLOUR, radii=0.0
        )
    sink.static(thing.entity, shape)


def _motions(sink: _Sink, steps: Sequence[StepRecord], movers: int) -> None:
    poses = tracks.poses(steps)
    places, half_yaw = _level(poses[:, :2], 0.0), poses[:, 2] / 2
    turned = np.column_stack([np.zeros((len(poses), 2)), np.sin(half_yaw), np.cos(half_yaw)])
    sink.rows(ROBOT, rr.Transform3D.columns(translation=places, quaternion=turned))
    sink.rows(FOLLOWER, rr.Transform3D.columns(translation=places))
    origins = tracks.mover_positions(steps, movers)
    for index in range(movers):
        way = rr.Transform3D.columns(translation=_level(origins[:, index], 0.0))
        sink.rows(f"{MOVING}/{index}", way)

    # One leg a step; the layout shows all of them up to the present.
    trail = _level(poses[:, :2], MARK_HEIGHT).astype(np.float32)
    legs = rr.LineStrips3D.columns(strips=np.stack([trail[:-1], trail[1:]], axis=1))
    sink.static(TRAIL, rr.LineStrips3D.from_fields(colors=colours.SKY_BLUE, radii=0.025))
    sink.rows(TRAIL, legs, np.arange(1, len(steps)))


def _decisions(sink: _Sink, steps: Sequence[StepRecord]) -> None:
    def points(entity: str, rows: Ragged, colour: Colour, radius: float, height: float) -> None:
        sink.static(entity, rr.Points3D.from_fields(colors=colour, radii=radius))
        columns = rr.Points3D.columns(positions=_level(rows.values, height))
        sink.rows(entity, columns.partition(rows.lengths))

    points("/world/scan", tracks.hit_points(steps), colours.VERMILLION, 0.012, SCAN_HEIGHT)
    points("/world/decision/subgoal", tracks.subgoals(steps), colours.PURPLE, 0.03, MARK_HEIGHT)

    # Scaled about the robot's place c, p is seen at c + s (p - c) = s p + (1 - s) c.
    scale, places = MAGNIFICATION, tracks.poses(steps)[:, :2]
    about = rr.Transform3D.columns(
        translation=_level((1.0 - scale) * places, 0.0), scale=np.full((len(steps), 3), scale)
    )
    sink.rows(MAGNIFIED, about)
    height = DECISION_HEIGHT / scale
    # Larger than a candidate and below it: seen as a black rim around the one taken.
    taken = tracks.next_positions(steps)
    points(f"{MAGNIFIED}/next_position", taken, colours.BLACK, 0.017 / scale, 0.95 * height)
    weighed = tracks.candidates(steps)
    admissible = weighed.values[:, 3] > 0.0
    dots = rr.Points3D.columns(
        positions=_level(weighed.values[:, :2], height),
        colors=colours.candidate_colours(weighed.values[:, 2], admissible),
        radii=np.where(admissible, 0.012, 0.008) / scale,
    )
    sink.rows(f"{MAGNIFIED}/candidates", dots.partition(weighed.lengths))

    paths = tracks.predicted_paths(steps)
    origins, ways = paths.values[:, 0], paths.values[:, 1]
    arrows = rr.Arrows3D.columns(
        origins=_level(origins, OBSTACLE_HEIGHT + 0.02), vectors=_level(ways, 0.0)
    )
    sink.static(
        "/world/decision/predicted", rr.Arrows3D.from_fields(colors=colours.VERMILLION, radii=0.012)
    )
    sink.rows("/world/decision/predicted", arrows.partition(paths.lengths))


# Plots, texts, layout --------------------------------------------------------------------------


def _plot(sink: _Sink, curves: Curves) -> None:
    inks = [(*colour, 255) for colour in curves.colours]
    style = (
        rr.SeriesPoints(names=curves.names, colors=inks, markers="diamond", marker_sizes=5.0)
        if curves.as_points
        else rr.SeriesLines(names=curves.names, colors=inks, widths=[1.5] * len(inks))
    )
    sink.static(curves.entity, style)
    columns = rr.Scalars.columns(scalars=curves.values.ravel())
    lengths = np.full(len(curves.steps), len(curves.names))
    sink.rows(curves.entity, columns.partition(lengths), curves.steps, curves.times)


def _texts(
    sink: _Sink, steps: Sequence[StepRecord], record: EpisodeRecord, risk_limit: float
) -> None:
    kinds = list(Behaviour)
    states = rr.StateConfiguration(
        values=[kind.value for kind in kinds],
        labels=[tracks.spoken(kind.value) for kind in kinds],
        colors=[plots.BEHAVIOURS[kind] for kind in kinds],
    )
    sink.static("/behaviour", states)
    changes = tracks.behaviour_changes(steps)
    entered = [steps[index].decision.behaviour.value for index in changes]
    sink.rows("/behaviour", rr.StateChange.columns(state=entered), np.array(changes, dtype=np.intp))

    events = tracks.events(steps, record, risk_limit)
    lines = rr.TextLog.columns(text=[e.text for e in events], level=[e.level for e in events])
    numbers = np.array([event.step for event in events], dtype=np.intp)
    sink.rows("/events", lines, numbers, np.array([event.time for event in events]))


def _blueprint(world: "World", curves: Sequence[Curves]) -> rrb.Blueprint:
    scenario = world.scenario
    x_min, y_min, x_max, y_max = scenario.bounds
    x, y = (x_min + x_max) / 2, (y_min + y_max) / 2
    # The pane is twice as wide as high; the near edge of the floor fills it first.
    size = max(0.82 * (x_max - x_min), y_max - y_min)
    background = rrb.Background((250, 250, 250))
    whole_trail = rrb.VisibleTimeRanges(
        [
            rrb.VisibleTimeRange(
                timeline,
                start=rrb.TimeRangeBoundary.infinite(),
                end=rrb.TimeRangeBoundary.cursor_relative(),
            )
            for timeline in ("sim_time", "step")
        ]
    )
    arena = rrb.Spatial3DView(
        name="Arena",
        origin="/world",
        background=background,
        line_grid=False,
        eye_controls=rrb.EyeControls3D(
            position=(x, y - 0.64 * size, 0.59 * size),
            look_target=(x, y - 0.19 * size, 0.0),
            eye_up=(0, 0, 1),
        ),
        overrides={TRAIL: whole_trail},
    )
    robot = rrb.Spatial3DView(
        name="Around the robot",
        origin=FOLLOWER,
        contents="/world/**",
        background=background,
        line_grid=False,
        eye_controls=rrb.EyeControls3D(
            position=(0.0, -0.4, 1.3), look_target=(0.0, 0.06, 0.0), eye_up=(0, 0, 1)
        ),
        overrides={TRAIL: whole_trail},
    )
    drawn = {part.entity.split("/")[1] for part in curves}
    views = [
        rrb.TimeSeriesView(
            name=title,
            origin=f"/{plot}",
            axis_y=rrb.ScalarAxis(range=(-3.0, 103.0)) if plot == "risk" else None,
            plot_legend=rrb.PlotLegend(plots.LEGENDS[plot], visible=plot != "clearance"),
        )
        for plot, title in plots.TITLES.items()
        if plot in drawn
    ]
    behaviour = rrb.StateTimelineView(name="Behaviour", origin="/behaviour")
    notes = rrb.Tabs(
        rrb.TextDocumentView(name="Guide", origin="/guide"),
        rrb.TextLogView(
            name="Events",
            origin="/events",
            columns=rrb.TextLogColumns(text_log_columns=["loglevel", "body"]),
        ),
        active_tab=0,
    )
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(arena, rrb.Horizontal(robot, notes), row_shares=[4, 3]),
            rrb.Vertical(behaviour, *views, row_shares=[1, *[2] * len(views)]),
            column_shares=[3, 2],
        ),
        rrb.TimePanel(timeline="sim_time", state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
    )
