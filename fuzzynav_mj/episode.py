"""Runs one episode: observe, perceive, decide, drive; and keeps the record.

The simulation is behind a protocol, so nothing here knows of MuJoCo or dm_control. The planner is
given what it declared and nothing else.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from time import perf_counter
from typing import Protocol

import numpy as np

from fuzzynav_mj.clearance import clearances, min_clearance
from fuzzynav_mj.metrics import (
    optimality,
    path_length,
    percentile_ms,
    summarise_risk,
    tracking_rms,
)
from fuzzynav_mj.planners.base import NavigationProblem, Observation, Planner
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.scenarios.world import World
from fuzzynav_mj.sensing.disturbed import Look, Sensors, perfect_sensors
from fuzzynav_mj.sensing.lateness import brought_up
from fuzzynav_mj.sensing.perception import Perceiver
from fuzzynav_mj.types import (
    Contact,
    Decision,
    EpisodeRecord,
    FloatArray,
    LaserScan,
    Outcome,
    Perception,
    Pose2D,
    StepRecord,
    Twist2D,
    WheelSpeeds,
)

NOTICEABLE = 1e-6  # s: a scan that is no older is of the present


@dataclass(frozen=True, slots=True, eq=False)
class BlockTruth:
    """What really happened during one block of physics steps (row i: after step i).

    Attributes:
        poses: (k, 3) x, y, yaw of the footprint's centre.
        movers: (k, movers, 2) origins of the moving obstacles.
        wheel_rates: (k, 2) left and right wheel speed, rad/s.
        slip: (k,) speed of the wheels' contact points over the floor, the larger one, m/s.
    """

    poses: FloatArray
    movers: FloatArray
    wheel_rates: FloatArray
    slip: FloatArray


class Simulation(Protocol):
    """One episode's physics."""

    @property
    def world(self) -> World:
        """The obstacles of this episode."""

    @property
    def spec(self) -> RobotSpec:
        """The robot's parameters."""

    @property
    def seed(self) -> int:
        """The episode's seed."""

    @property
    def pose(self) -> Pose2D:
        """Present pose."""

    @property
    def twist(self) -> Twist2D:
        """Present speeds."""

    @property
    def commanded(self) -> Twist2D:
        """Speeds commanded at the end of the last period, from which the next ones lead on."""

    @property
    def time(self) -> float:
        """Simulated time, s."""

    @property
    def scan(self) -> LaserScan:
        """The scan of the present state."""

    @property
    def mover_positions(self) -> FloatArray:
        """(movers, 2) present origins of the moving obstacles."""

    @property
    def outcome(self) -> Outcome | None:
        """How the episode ended; None while it goes on."""

    @property
    def contact(self) -> Contact | None:
        """The contact that ended the episode, if one did."""

    @property
    def wheel_command(self) -> WheelSpeeds:
        """The wheel speeds commanded last."""

    def drive(self, next_position: tuple[float, float]) -> BlockTruth:
        """Simulates one decision period towards the next position."""


@dataclass(frozen=True, slots=True, eq=False)
class Episode:
    """An episode as it happened: its record, every step, and the world it played in."""

    record: EpisodeRecord
    steps: tuple[StepRecord, ...]
    world: World


def run_episode(
    simulation: Simulation,
    planner: Planner,
    planner_name: str,
    planner_rng: np.random.Generator,
    shortest: float,
    versions: Mapping[str, str],
    sensors: Sensors | None = None,
) -> Episode:
    """Runs a freshly reset simulation to its end.

    Args:
        simulation: at the start of an episode.
        planner: any planner; it is reset here.
        planner_name: for the record.
        planner_rng: the planner's own random stream.
        shortest: length of the shortest path in hindsight, m; for the record.
        versions: of what the episode ran on; for the record.
        sensors: what the planner is told is read from these; perfect ones by default.
    """
    sensors = sensors or perfect_sensors()
    began = perf_counter()
    world, spec = simulation.world, simulation.spec
    scenario = world.scenario
    planner.reset(
        NavigationProblem(
            goal=scenario.goal,
            goal_yaw=scenario.goal_yaw,
            goal_tolerance=scenario.goal_tolerance,
            spec=spec,
            static_map=static_map(world) if planner.requires.static_map else None,
        ),
        planner_rng,
    )
    perceiver = Perceiver(spec, sensor=sensors.disturbance) if planner.requires.obstacles else None
    sees = planner.requires.scan or planner.requires.obstacles
    seen: Perception | None = None
    perception: Perception | None = None
    last_scan: LaserScan | None = None
    moments: list[_Moment] = []
    blocks: list[BlockTruth] = []
    start = simulation.pose
    outcome = simulation.outcome
    while outcome is None:
        before = perf_counter()
        time, pose, twist = simulation.time, simulation.pose, simulation.twist
        look = sensors.look(pose, simulation.scan if sees else None)
        scan = look.scan
        if perceiver is not None and scan is not None and scan is not last_scan:
            seen = perceiver.perceive(scan, look.scan_estimate)
            last_scan = scan
        if seen is not None:
            age = time - seen.scan.stamp
            perception = brought_up(seen, look.estimate, age) if age > NOTICEABLE else seen
        decision = planner.decide(
            Observation(time, look.estimate, simulation.commanded, scan, perception)
        )
        plan_time = perf_counter() - before
        movers = simulation.mover_positions
        if decision.give_up is not None:
            outcome = Outcome(decision.give_up)
            break
        target = sensors.target(pose, look, decision.next_position)
        block = simulation.drive(target)
        blocks.append(block)
        moments.append(
            _Moment(time, pose, twist, look, perception, decision, target, movers, plan_time,
                    simulation.wheel_command, block)
        )  # fmt: skip
        outcome = simulation.outcome
    poses = np.concatenate(
        [np.array([[start.x, start.y, start.yaw]])] + [block.poses for block in blocks]
    )
    first_movers = moments[0].movers if moments else simulation.mover_positions
    movers = np.concatenate([first_movers[None]] + [block.movers for block in blocks])
    touched = simulation.contact
    gap = min_clearance(poses, movers, world, spec.half_side)
    travelled = path_length(poses[:, :2])
    decisions = [moment.decision for moment in moments]
    risk = summarise_risk(decisions)
    full = [moment for moment in moments if len(moment.block.poses) == spec.substeps]
    times = [moment.plan_time for moment in moments]
    record = EpisodeRecord(
        scenario=scenario.name,
        planner=planner_name,
        seed=simulation.seed,
        outcome=outcome,
        sim_time_s=simulation.time,
        path_length_m=travelled,
        shortest_path_m=shortest,
        optimality=optimality(shortest, travelled, outcome),
        min_clearance_m=0.0 if touched is not None else gap,
        contacts=() if touched is None else (touched,),
        risk_max=risk.maximum,
        risk_mean=risk.mean,
        gate_vetoes=risk.vetoes,
        decisions=len(moments),
        plan_ms_p50=percentile_ms(times, 50),
        plan_ms_p99=percentile_ms(times, 99),
        wall_s=perf_counter() - began,
        physics_steps=sum(len(block.poses) for block in blocks),
        tracking_rms_m=tracking_rms(
            np.array([moment.target for moment in full]).reshape(-1, 2),
            np.array([moment.block.poses[-1, :2] for moment in full]).reshape(-1, 2),
        ),
        slip_max_mps=max((float(b.slip.max(initial=0.0)) for b in blocks), default=0.0),
        versions=versions,
        disturbance=sensors.disturbance,
        goal_distance_m=float(np.hypot(*(poses[-1, :2] - scenario.goal))),
    )
    return Episode(record, _steps(moments, world, spec), world)


@dataclass(frozen=True, slots=True, eq=False)
class _Moment:
    """One decision period while the episode runs."""

    time: float
    pose: Pose2D
    twist: Twist2D
    look: Look
    perception: Perception | None
    decision: Decision
    target: tuple[float, float]
    movers: FloatArray
    plan_time: float
    wheel_command: WheelSpeeds
    block: BlockTruth


def _steps(moments: list[_Moment], world: World, spec: RobotSpec) -> tuple[StepRecord, ...]:
    if not moments:
        return ()
    poses = np.array([[m.pose.x, m.pose.y, m.pose.yaw] for m in moments])
    movers = np.stack([m.movers for m in moments])
    gaps = clearances(poses, movers, world, spec.half_side)
    return tuple(
        StepRecord(
            time=moment.time,
            pose=moment.pose,
            twist=moment.twist,
            scan=moment.look.scan,
            perception=moment.perception,
            decision=moment.decision,
            mover_positions=moment.movers,
            wheel_command=moment.wheel_command,
            wheel_actual=WheelSpeeds(*_last(moment.block.wheel_rates).tolist()),
            clearance=float(gap),
            plan_time=moment.plan_time,
            estimate=moment.look.estimate,
        )
        for moment, gap in zip(moments, gaps, strict=True)
    )


def _last(rates: FloatArray) -> FloatArray:
    return rates[-1] if len(rates) else np.zeros(2)


def static_map(world: World) -> tuple[FloatArray, ...]:
    """(k, 2) outlines of the static obstacles and of the arena's bounds."""
    outlines = [np.asarray(s.footprint.exterior.coords)[:-1] for s in world.static]
    if world.scenario.walls:
        x_min, y_min, x_max, y_max = world.scenario.bounds
        outlines.append(np.array([[x_min, y_min], [x_max, y_min], [x_max, y_max], [x_min, y_max]]))
    return tuple(outlines)
