"""Recordings read back: what was written is there, and nothing half-written stays."""

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
import rerun as rr
import shapely
from rerun.chunk import RrdReader

from fuzzynav_mj.errors import FuzzyNavError
from fuzzynav_mj.recording import colours, tracks
from fuzzynav_mj.recording.scene import MAGNIFICATION
from fuzzynav_mj.recording.solids import Mesh, lying, prism
from fuzzynav_mj.rerun_log import write_recording
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.motion import Mover, waypoint_motion
from fuzzynav_mj.scenarios.schema import Scenario
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.scenarios.world import World
from fuzzynav_mj.types import (
    Behaviour,
    CandidateSet,
    Contact,
    Decision,
    EpisodeRecord,
    FuzzyInputs,
    LaserScan,
    Outcome,
    PerceivedObstacle,
    Perception,
    Pose2D,
    StepRecord,
    Twist2D,
    VisibilityMatrix,
    WheelSpeeds,
)

STEPS = 12
PERIOD = 0.1


@pytest.fixture(scope="module", autouse=True)
def strict() -> Iterator[None]:
    before = rr.strict_mode()
    rr.set_strict_mode(True)
    yield
    rr.set_strict_mode(before)


def make_world(movers: int = 2) -> World:
    hook = np.array([[3, 3], [4, 3], [4, 4], [3.8, 4], [3.8, 3.2], [3, 3.2]], dtype=float)
    static = (Shape(hook, None), Shape(None, (1.0, 4.0, 0.3)))
    moving = (
        Mover(Shape(None, (0.0, 0.0, 0.2)), waypoint_motion(np.array([[2, 0.5], [2, 4]]), 0.3)),
        Mover(
            Shape(np.array([[-0.2, -0.1], [0.2, -0.1], [0.0, 0.2]]), None),
            waypoint_motion(np.array([[4, 1], [1, 1]]), 0.4),
        ),
    )[:movers]
    scenario = Scenario(
        name="yard",
        description="A hook and a drum.",
        bounds=(0.0, 0.0, 5.0, 5.0),
        walls=True,
        time_limit=60.0,
        allow_faster=False,
        start=Pose2D(0.5, 0.5, 0.0),
        goal=(4.5, 4.5),
        goal_yaw=None,
        goal_tolerance=0.1,
        static=static,
        moving=moving,
        random_moving=(),
        source="yard.toml",
    )
    return World(scenario, static, moving)


def make_step(index: int, world: World) -> StepRecord:
    time = index * PERIOD
    pose = Pose2D(0.5 + 0.04 * index, 0.5, 0.1 * index)
    movers = [mover.motion.positions(np.array([time]))[0] for mover in world.movers]
    bearings = np.arange(-4, 4) * math.pi / 4
    hit = np.arange(8) < index % 4
    scan = LaserScan(time, bearings, np.where(hit, 0.5, 0.8), hit, 0.8)
    point = np.array([2.0, 1.0])
    obstacle = PerceivedObstacle(
        point[None], point, 0.7, 0.0, index >= 6, index >= 6, np.array([0.2, -0.1])
    )
    none = np.zeros(4, dtype=np.intp)
    matrix = VisibilityMatrix(np.zeros((4, 8), dtype=bool), none, none)
    candidates = CandidateSet(
        positions=np.array([[pose.x + 0.05, 0.5], [pose.x, 0.55], [pose.x, 0.45]]),
        admissible=np.array([True, True, False]),
        clearance=np.array([0.3, 0.2, 0.0]),
        cost=np.array([1.0, 2.0, np.inf]),
        risk=np.array([7.0 * index, np.nan, np.nan]),
    )
    decision = Decision(
        next_position=(pose.x + 0.05, 0.5),
        behaviour=Behaviour.GOAL_SEEKING if index < 5 else Behaviour.DYNAMIC_AVOIDANCE,
        inputs=FuzzyInputs(0.1, 0.2, 0.3, 0.4, 0.5, 0.06 * index),
        risk=7.0 * index,
        vetoed=index == 11,
        candidates=candidates,
        subgoal=(3.0, 1.0) if index % 2 else None,
        note="keeps to the left" if index >= 3 else "",
    )
    return StepRecord(
        time=time,
        pose=pose,
        twist=Twist2D(0.4, 0.0),
        scan=scan,
        perception=Perception(scan, (obstacle,), matrix),
        decision=decision,
        mover_positions=np.array(movers).reshape(-1, 2),
        wheel_command=WheelSpeeds(10.0, 11.0),
        wheel_actual=WheelSpeeds(9.5, 10.5 + index),
        clearance=math.inf if index == 0 else 0.1 * index,
        plan_time=0.002,
    )


def make_record(outcome: Outcome = Outcome.CONTACT) -> EpisodeRecord:
    return EpisodeRecord(
        scenario="yard",
        planner="fuzzy",
        seed=3,
        outcome=outcome,
        sim_time_s=1.15,
        path_length_m=0.44,
        shortest_path_m=5.7,
        optimality=None,
        min_clearance_m=0.0,
        contacts=(Contact(1.15, "moving:1", 0.4, True),) if outcome is Outcome.CONTACT else (),
        risk_max=77.0,
        risk_mean=38.5,
        gate_vetoes=1,
        decisions=STEPS,
        plan_ms_p50=2.0,
        plan_ms_p99=2.0,
        wall_s=0.1,
        physics_steps=230,
        tracking_rms_m=0.01,
        slip_max_mps=0.001,
        versions={"mujoco": "3.17.0"},
    )


def rows(path: Path, entity: str, component: str, index: str = "step") -> tuple[list, list]:
    """The index and the values of every row of one component, in order of the index."""
    found = []
    for chunk in RrdReader(path).stream().filter(content=entity, is_static=False):
        batch = chunk.to_record_batch()
        if component in batch.schema.names:
            times = batch.column(index)
            times = times.cast(pa.int64()) if pa.types.is_duration(times.type) else times
            found += zip(times.to_pylist(), batch.column(component).to_pylist(), strict=True)
    found.sort(key=lambda row: row[0])
    return [time for time, _ in found], [value for _, value in found]


def static(path: Path, entity: str, component: str) -> list:
    (value,) = (
        batch.column(component).to_pylist()[0]
        for chunk in RrdReader(path).stream().filter(content=entity, is_static=True)
        if component in (batch := chunk.to_record_batch()).schema.names
    )
    return value


@pytest.fixture(scope="module")
def world() -> World:
    return make_world()


@pytest.fixture(scope="module")
def steps(world: World) -> list[StepRecord]:
    return [make_step(index, world) for index in range(STEPS)]


@pytest.fixture(scope="module")
def recording(
    tmp_path_factory: pytest.TempPathFactory, world: World, steps: list[StepRecord]
) -> Path:
    path = tmp_path_factory.mktemp("recording") / "episode.rrd"
    write_recording(path, world, steps, make_record(), DEFAULT_ROBOT)
    return path


class TestReadBack:
    def test_one_recording_with_its_layout(self, recording):
        reader = RrdReader(recording)
        assert len(reader.recordings()) == 1
        assert len(reader.blueprints()) == 1
        assert static(recording, "/__properties", "RecordingInfo:name") == ["yard, fuzzy, seed 3"]

    def test_timelines_are_steps_and_simulated_time_only(self, recording):
        names = {index.name for index in RrdReader(recording).store().schema().index_columns()}
        assert names == {"step", "sim_time"}

    def test_risk_and_limit(self, recording):
        index, risk = rows(recording, "/risk/taken", "Scalars:scalars")
        assert index == list(range(STEPS))
        assert [value for (value,) in risk] == [7.0 * step for step in range(STEPS)]
        assert rows(recording, "/risk/limit", "Scalars:scalars") == ([0, 11], [[76.0], [76.0]])
        assert rows(recording, "/risk/vetoes", "Scalars:scalars") == ([11], [[77.0]])

    def test_fuzzy_inputs_are_named(self, recording):
        _, inputs = rows(recording, "/fuzzy_inputs", "Scalars:scalars")
        assert inputs[10] == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
        names = static(recording, "/fuzzy_inputs", "SeriesLines:names")
        assert names == ["LS", "FS", "RS", "LD", "FD", "RD"]

    def test_infinite_gaps_are_left_out(self, recording):
        index, gaps = rows(recording, "/clearance", "Scalars:scalars")
        assert index == list(range(1, STEPS))
        assert gaps[0] == [0.1]

    def test_wheels_are_of_the_end_of_each_period(self, recording):
        times, speeds = rows(recording, "/wheels", "Scalars:scalars", "sim_time")
        assert times == pytest.approx([1e8 * step for step in range(1, STEPS)] + [1.15e9])
        assert speeds[4] == [10.0, 9.5, 11.0, 14.5]
        names = static(recording, "/wheels", "SeriesLines:names")
        assert names == ["left, commanded", "left", "right, commanded", "right"]

    def test_movers_are_where_they_were(self, recording, steps):
        for mover in range(2):
            entity = f"/world/moving/{mover}"
            index, places = rows(recording, entity, "Transform3D:translation")
            assert index == list(range(STEPS))
            truth = np.array([step.mover_positions[mover] for step in steps])
            assert np.array(places)[:, 0, :2] == pytest.approx(truth, abs=1e-6)

    def test_robot_stands_and_points_as_it_did(self, recording, steps):
        _, places = rows(recording, "/world/robot", "Transform3D:translation")
        _, turns = rows(recording, "/world/robot", "Transform3D:quaternion")
        for step, (place,), ((x, y, z, w),) in zip(steps, places, turns, strict=True):
            assert place == pytest.approx([step.pose.x, step.pose.y, 0.0], abs=1e-6)
            assert (x, y) == (0.0, 0.0)
            assert 2 * math.atan2(z, w) == pytest.approx(step.pose.yaw, abs=1e-6)

    def test_trail_has_one_leg_a_step_and_no_gap(self, recording):
        index, legs = rows(recording, "/world/trail", "LineStrips3D:strips")
        assert index == list(range(1, STEPS))
        assert all(len(leg) == 1 and len(leg[0]) == 2 for leg in legs)
        assert [leg[0][0] for leg in legs[1:]] == [leg[0][1] for leg in legs[:-1]]

    def test_only_rays_that_hit_are_shown(self, recording):
        _, points = rows(recording, "/world/scan", "Points3D:positions")
        assert [len(hits) for hits in points] == [step % 4 for step in range(STEPS)]
        # Step 1: pose (0.54, 0.5, 0.1); its first ray looks backwards and hits at 0.5 m.
        assert points[1][0][:2] == pytest.approx(
            [0.54 - 0.5 * math.cos(0.1), 0.5 - 0.5 * math.sin(0.1)], abs=1e-6
        )

    def test_candidates_keep_their_places_and_show_their_risk(self, recording, steps):
        entity = "/world/decision/magnified/candidates"
        _, points = rows(recording, entity, "Points3D:positions")
        _, inks = rows(recording, entity, "Points3D:colors")
        positions = steps[4].decision.candidates.positions
        assert np.array(points[4])[:, :2] == pytest.approx(positions, abs=1e-6)
        wanted = (risk_colour(28.0), colours.SLATE, colours.BROWN)
        for ink, colour in zip(inks[4], wanted, strict=True):
            assert ink >> 8 == int("".join(f"{c:02x}" for c in colour), 16)

    def test_magnification_leaves_the_robot_in_place(self, recording, steps):
        entity = "/world/decision/magnified"
        _, shifts = rows(recording, entity, "Transform3D:translation")
        _, scales = rows(recording, entity, "Transform3D:scale")
        pose = steps[7].pose
        assert scales[7] == [[MAGNIFICATION] * 3]
        seen = MAGNIFICATION * np.array([pose.x, pose.y]) + shifts[7][0][:2]
        assert seen == pytest.approx([pose.x, pose.y], abs=1e-5)

    def test_only_perceived_movers_are_predicted(self, recording):
        entity = "/world/decision/predicted"
        _, ways = rows(recording, entity, "Arrows3D:vectors")
        _, origins = rows(recording, entity, "Arrows3D:origins")
        assert [len(arrows) for arrows in ways] == [0] * 6 + [1] * 6
        assert ways[6][0] == pytest.approx([0.3, -0.15, 0.0])
        assert origins[6][0][:2] == [2.0, 1.0]

    def test_subgoal_vanishes_where_there_is_none(self, recording):
        _, points = rows(recording, "/world/decision/subgoal", "Points3D:positions")
        assert [len(point) for point in points] == [0, 1] * 6

    def test_behaviour_is_written_where_it_changes(self, recording):
        assert rows(recording, "/behaviour", "StateChange:state") == (
            [0, 5],
            [["goal_seeking"], ["dynamic_avoidance"]],
        )
        assert len(static(recording, "/behaviour", "StateConfiguration:values")) == len(Behaviour)

    def test_events_in_order(self, recording):
        index, texts = rows(recording, "/events", "TextLog:text")
        assert list(zip(index, (text for (text,) in texts), strict=True)) == [
            (0, "behaviour: goal seeking"),
            (3, "keeps to the left"),
            (5, "behaviour: dynamic avoidance"),
            (11, "the gate changed the next position; its risk is now 77"),
            (11, "risk 77: no alternative below 76"),
            (11, "contact with moving:1; the robot moved (0.40 m/s)"),
            (11, "the episode ends: contact"),
        ]

    def test_properties_hold_the_record(self, recording):
        def value(name: str) -> object:
            return static(recording, "/__properties/episode", name)

        assert value("outcome") == ["contact"]
        assert value("planner") == ["fuzzy"]
        assert value("seed") == [3]
        assert value("contact_with") == ["moving:1"]
        assert value("version_mujoco") == ["3.17.0"]

    def test_every_obstacle_is_there(self, recording, world):
        entities = {chunk.entity_path for chunk in RrdReader(recording).stream()}
        wanted = {f"/world/static/{index}" for index in range(len(world.static))}
        wanted |= {f"/world/moving/{index}" for index in range(len(world.movers))}
        assert wanted <= entities
        assert "/world/arena/walls" in entities


def risk_colour(risk: float, admissible: bool = True) -> tuple[int, ...]:
    (colour,) = colours.candidate_colours(np.array([risk]), np.array([admissible]))
    return tuple(int(channel) for channel in colour)


class TestBareEpisodes:
    def test_without_scan_gate_candidates_and_movers(self, tmp_path):
        world = make_world(movers=0)
        full = make_step(1, world)
        bare = StepRecord(
            time=0.0,
            pose=full.pose,
            twist=full.twist,
            scan=None,
            perception=None,
            decision=Decision((1.0, 1.0), Behaviour.WAITING),
            mover_positions=np.empty((0, 2)),
            wheel_command=full.wheel_command,
            wheel_actual=full.wheel_actual,
            clearance=0.2,
            plan_time=0.0,
        )
        path = tmp_path / "bare.rrd"
        write_recording(path, world, [bare], make_record(Outcome.TIMEOUT), DEFAULT_ROBOT)
        entities = {chunk.entity_path for chunk in RrdReader(path).stream()}
        assert not {"/risk/taken", "/risk/limit", "/fuzzy_inputs"} & entities
        assert {"/clearance", "/wheels", "/behaviour"} <= entities
        assert rows(path, "/world/scan", "Points3D:positions") == ([0], [[]])

    def test_without_any_step(self, tmp_path):
        path = tmp_path / "none.rrd"
        write_recording(path, make_world(), [], make_record(Outcome.NO_PATH), DEFAULT_ROBOT)
        assert rows(path, "/events", "TextLog:text") == ([0], [["the episode ends: no path"]])


class TestFile:
    def test_missing_folder(self, tmp_path, world, steps):
        path = tmp_path / "missing" / "episode.rrd"
        with pytest.raises(FuzzyNavError) as caught:
            write_recording(path, world, steps, make_record(), DEFAULT_ROBOT)
        assert str(caught.value) == f"{path}: cannot write the recording: No such file or directory"

    def test_folder_and_device_are_left_alone(self, tmp_path, world, steps):
        for path in (tmp_path, Path("/dev/null")):
            with pytest.raises(FuzzyNavError) as caught:
                write_recording(path, world, steps, make_record(), DEFAULT_ROBOT)
            assert str(caught.value) == f"{path}: cannot write the recording: not a regular file"
        assert list(tmp_path.iterdir()) == []

    def test_failure_keeps_the_old_file_and_leaves_nothing(
        self, tmp_path, world, steps, monkeypatch
    ):
        path = tmp_path / "episode.rrd"
        path.write_bytes(b"old")

        def full_disk(self: Path, target: Path) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(Path, "replace", full_disk)
        with pytest.raises(FuzzyNavError, match=r"No space left on device$"):
            write_recording(path, world, steps, make_record(), DEFAULT_ROBOT)
        assert [entry.name for entry in tmp_path.iterdir()] == ["episode.rrd"]
        assert path.read_bytes() == b"old"

    def test_replaces_an_older_recording(self, tmp_path, world, steps):
        path = tmp_path / "episode.rrd"
        path.write_bytes(b"old")
        write_recording(str(path), world, steps, make_record(), DEFAULT_ROBOT)
        assert [entry.name for entry in tmp_path.iterdir()] == ["episode.rrd"]
        assert len(RrdReader(path).recordings()) == 1

    def test_environment_that_turns_recordings_off(self, tmp_path, world, steps, monkeypatch):
        monkeypatch.setenv("RERUN", "0")
        path = tmp_path / "episode.rrd"
        with pytest.raises(FuzzyNavError) as caught:
            write_recording(path, world, steps, make_record(), DEFAULT_ROBOT)
        assert str(caught.value) == (
            f"{path}: the environment variable RERUN=0 turns recordings off"
        )
        assert list(tmp_path.iterdir()) == []


def volume(mesh: Mesh) -> float:
    """Of a closed mesh with outward faces, by the divergence theorem."""
    a, b, c = mesh.vertices.reshape(-1, 3, 3).transpose(1, 0, 2)
    return float(np.sum(a * np.cross(b, c)) / 6)


class TestSolids:
    concave = shapely.Polygon([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)])
    frame = shapely.Polygon([(0, 0), (4, 0), (4, 4), (0, 4)], [[(1, 1), (3, 1), (3, 3), (1, 3)]])

    @pytest.mark.parametrize(
        ("footprint", "area"), [(concave, 5.0), (concave.reverse(), 5.0), (frame, 12.0)]
    )
    def test_prism_is_closed_and_faces_outwards(self, footprint, area):
        assert volume(prism(footprint, 0.5, 2.5)) == pytest.approx(2.0 * area)

    def test_laid_on_its_side_it_keeps_its_volume(self):
        mesh = lying(prism(self.concave, 0.5, 2.5))
        assert volume(mesh) == pytest.approx(10.0)
        assert (mesh.vertices[:, 1].min(), mesh.vertices[:, 1].max()) == (0.5, 2.5)
        assert mesh.vertices[:, 2].max() == 3.0

    def test_normals_are_those_of_the_faces(self):
        mesh = prism(self.frame, 0.0, 1.0)
        a, b, c = mesh.vertices.reshape(-1, 3, 3).transpose(1, 0, 2)
        across = np.cross(b - a, c - a)
        across /= np.linalg.norm(across, axis=1, keepdims=True)
        assert mesh.normals.reshape(-1, 3, 3) == pytest.approx(
            np.repeat(across[:, None], 3, axis=1)
        )


class TestColours:
    def test_scale_at_its_marks(self):
        assert [risk_colour(risk) for risk in (0.0, 50.0, 100.0)] == [
            colours.BLUE,
            colours.YELLOW,
            colours.VERMILLION,
        ]
        assert risk_colour(25.0) == (120, 171, 122)

    def test_admissibility_shows_only_where_the_risk_is_unknown(self):
        assert risk_colour(math.nan, admissible=True) == colours.SLATE
        assert risk_colour(math.nan, admissible=False) == colours.BROWN
        assert risk_colour(50.0, admissible=False) == colours.YELLOW


class TestEvents:
    def test_note_is_told_when_it_changes(self, world):
        steps = [make_step(index, world) for index in (0, 3, 4, 0, 3)]
        texts = [event.text for event in tracks.events(steps, make_record(Outcome.STUCK), 76.0)]
        assert texts == [
            "behaviour: goal seeking",
            "keeps to the left",
            "keeps to the left",
            "the episode ends: stuck",
        ]

    @staticmethod
    def warnings(decisions: list[Decision], limit: float) -> list[tuple[int, str]]:
        world = make_world()
        steps = [replace(make_step(0, world), decision=decision) for decision in decisions]
        found = tracks.events(steps, make_record(Outcome.STUCK), limit)
        return [(event.step, event.text) for event in found if event.level == "WARN"]

    @staticmethod
    def weighing(taken: float, other: float, other_admissible: bool = True) -> Decision:
        found = CandidateSet(
            positions=np.zeros((2, 2)),
            admissible=np.array([True, other_admissible]),
            clearance=np.ones(2),
            cost=np.array([1.0, 2.0]),
            risk=np.array([taken, other]),
        )
        return Decision((0.0, 0.0), Behaviour.EVASION, risk=taken, candidates=found)

    def test_risk_above_the_limit_is_told_once_per_run(self):
        low, high, higher = (self.weighing(risk, 90.0) for risk in (76.0, 77.0, 84.0))
        assert self.warnings([high, higher, low, higher, high], 76.0) == [
            (0, "risk 77: no alternative below 76"),
            (3, "risk 84: no alternative below 76"),
        ]
        assert self.warnings([high, higher], 80.0) == [(1, "risk 84: no alternative below 80")]

    @pytest.mark.parametrize(
        ("other", "admissible", "told"),
        [(70.0, True, False), (70.0, False, True), (77.0, True, True), (math.nan, True, True)],
    )
    def test_only_evaluated_admissible_alternatives_count(self, other, admissible, told):
        assert bool(self.warnings([self.weighing(84.0, other, admissible)], 76.0)) == told

    def test_without_gate_no_risk_is_told(self):
        assert self.warnings([Decision((0.0, 0.0), Behaviour.WAITING)], 76.0) == []
