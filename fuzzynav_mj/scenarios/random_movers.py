"""Moving obstacles drawn for one episode: polygons that roam along smooth closed curves."""

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from fuzzynav_mj.errors import ScenarioError
from fuzzynav_mj.geometry import rotation
from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.scenarios.motion import ClosedCurveMotion, Mover
from fuzzynav_mj.scenarios.schema import RandomMovingSpec, Scenario
from fuzzynav_mj.scenarios.shape import Shape
from fuzzynav_mj.types import FloatArray

MARGIN = 0.02  # m kept between a mover and what it must not touch
START_GAP = 1.0  # m between a mover and the robot at time 0
CORRIDOR = 1.2  # m beside the straight line to the goal: curves that come into it are preferred
SAMPLES = 64  # points of a candidate curve
KNOTS = 512  # points of an accepted curve
CANDIDATES = 24  # curves tried at once
SCALES = (1.0, 0.85, 0.7, 0.55, 0.45, 0.35, 0.28, 0.22, 0.17, 0.13, 0.1, 0.07, 0.05)
ROUNDS = 20  # shapes and speeds tried before giving up
SLACK = 0.9  # share of the acceleration bound that the sampled curves may use


def draw_movers(scenario: Scenario, rng: np.random.Generator) -> tuple[Mover, ...]:
    """Draw all random obstacles of `scenario`.

    Raises:
        ScenarioError: no curve was found on which an obstacle keeps clear of the static ones,
            inside its region and away from the robot's start.
    """
    static = shapely.union_all([shape.footprint for shape in scenario.static])
    movers: list[Mover] = []
    for index, spec in enumerate(scenario.random_moving):
        area = shapely.intersection(shapely.Polygon(spec.region), shapely.box(*scenario.bounds))
        area = shapely.difference(area, static)
        for _ in range(int(rng.integers(spec.count[0], spec.count[1] + 1))):
            mover = _draw_mover(spec, scenario, area, rng)
            if mover is None:
                raise ScenarioError(
                    f"{scenario.source}: random_moving.{index}: given a region and shapes for which"
                    " no free motion was found; allowed a region with room for movers between the"
                    f" static obstacles and {START_GAP} m away from the robot's start"
                )
            movers.append(mover)
    return tuple(movers)


def _draw_mover(
    spec: RandomMovingSpec, scenario: Scenario, area: BaseGeometry, rng: np.random.Generator
) -> Mover | None:
    ends = np.array([[scenario.start.x, scenario.start.y], scenario.goal])
    for _ in range(ROUNDS):
        radius = rng.uniform(*spec.radius)
        concave = rng.random() < spec.concave_fraction
        polygon = draw_polygon(spec.vertices, concave, radius, rng)
        speed = rng.uniform(*spec.speed)
        keep_off = START_GAP + radius + DEFAULT_ROBOT.half_diagonal
        motion = _draw_motion(area.buffer(-(radius + MARGIN)), ends, keep_off, speed, spec, rng)
        if motion is not None:
            return Mover(Shape(polygon, None), motion)
    return None


def _draw_motion(
    free: BaseGeometry,
    ends: FloatArray,
    keep_off: float,
    speed: float,
    spec: RandomMovingSpec,
    rng: np.random.Generator,
) -> ClosedCurveMotion | None:
    """Return a motion within `free`, the larger and the nearer to the robot's way the better."""
    if free.is_empty:
        return None
    shapely.prepare(free)
    fallback: ClosedCurveMotion | None = None
    for scale in SCALES:
        curves = _candidate_curves(free, scale, rng)
        for curve in _fitting(curves, free, speed, spec.acceleration):
            motion = _motion(curve, speed, ends[0], keep_off, free, rng)
            if motion is None:
                continue
            if _distance_to_segment(motion.knots, ends).min() < CORRIDOR:
                return motion
            fallback = fallback or motion
    return fallback


def draw_polygon(
    vertices: tuple[int, int], concave: bool, radius: float, rng: np.random.Generator
) -> FloatArray:
    """Draw a polygon that its origin sees wholly, with `radius` as circumscribed radius.

    Returns:
        (n, 2) corners, m, counter-clockwise, with n in `vertices`; convex, or with at least one
        reflex corner.
    """
    low, high = vertices
    count = int(rng.integers(max(low, 4) if concave else low, high + 1))
    notches = int(rng.integers(1, min(count // 2, count - 3) + 1)) if concave else 0
    outer = count - notches
    jitter = 0.1 if concave else 0.2
    turns = (np.arange(outer) + rng.uniform(-jitter, jitter, outer)) / outer
    angles = 2 * np.pi * turns + rng.uniform(0.0, 2 * np.pi)
    gaps = np.diff(np.append(angles, angles[0] + 2 * np.pi))
    notched = rng.choice(outer, notches, replace=False)
    # a corner nearer than the chord between its neighbours is reflex
    depths = rng.uniform(0.35, 0.75, notches) * np.cos(gaps[notched] / 2)
    angles = np.append(angles, angles[notched] + gaps[notched] / 2)
    radii = radius * np.append(np.ones(outer), depths)
    order = np.argsort(angles)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])[order]


def _candidate_curves(free: BaseGeometry, scale: float, rng: np.random.Generator) -> FloatArray:
    """Return (CANDIDATES, SAMPLES, 2) closed curves, `scale` of `free`'s longer side at most.

    Each is an ellipse, more or less squared (a third harmonic, so that it can run along a
    corridor and turn gently at its ends), turned, dented (a second harmonic) and stretched to a
    box of its own.
    """
    x_min, y_min, x_max, y_max = free.bounds
    size = np.array([x_max - x_min, y_max - y_min])
    turns = np.arange(SAMPLES) * (2 * np.pi / SAMPLES)
    squareness = rng.uniform(0.0, 0.09, (CANDIDATES, 1))
    ovals = np.stack(
        [
            np.cos(turns) - squareness * np.cos(3 * turns),
            rng.uniform(0.4, 1.0, (CANDIDATES, 1))
            * (np.sin(turns) + squareness * np.sin(3 * turns)),
        ],
        axis=-1,
    )
    tilt = rng.uniform(0.0, np.pi, CANDIDATES) * (rng.random(CANDIDATES) < 0.5)
    shift = rng.uniform(0.0, 2 * np.pi, (CANDIDATES, 1, 2))
    dents = rng.normal(0.0, 0.08, (CANDIDATES, 1, 2)) * np.cos(2 * turns[:, None] + shift)
    curves = ovals @ rotation(tilt) + dents
    low, high = curves.min(axis=1), curves.max(axis=1)
    span = np.minimum(size, scale * size.max()) * rng.uniform(0.4, 1.0, (CANDIDATES, 2))
    corner = np.array([x_min, y_min]) + rng.random((CANDIDATES, 2)) * (size - span)
    placed: FloatArray = (curves - low[:, None]) * (span / (high - low))[:, None] + corner[:, None]
    return placed


def _fitting(
    curves: FloatArray, free: BaseGeometry, speed: float, acceleration: float
) -> FloatArray:
    """Return those of the (c, samples, 2) curves that lie in `free` and are gentle enough."""
    for stride in (8, 1):  # most misfits show on a few points
        points = curves[:, ::stride]
        curves = curves[shapely.contains_xy(free, points[..., 0], points[..., 1]).all(axis=1)]
    bend = _curvature(curves).max(axis=1, initial=0.0)
    gentle: FloatArray = curves[bend * speed**2 <= SLACK * acceleration]
    return gentle


def _curvature(curves: FloatArray) -> FloatArray:
    """Return the (c, samples) curvatures of closed Fourier curves, 1/m, by exact derivatives."""
    samples = curves.shape[1]
    wave = 1j * np.fft.rfftfreq(samples, 1 / samples)[None, :, None]
    spectrum = np.fft.rfft(curves, axis=1)
    first = np.fft.irfft(spectrum * wave, samples, axis=1)
    second = np.fft.irfft(spectrum * wave**2, samples, axis=1)
    cross = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    pace = np.maximum(np.hypot(first[..., 0], first[..., 1]), 1e-9)
    curvature: FloatArray = np.abs(cross) / pace**3
    return curvature


def _motion(
    curve: FloatArray,
    speed: float,
    start: FloatArray,
    keep_off: float,
    free: BaseGeometry,
    rng: np.random.Generator,
) -> ClosedCurveMotion | None:
    """Return a motion around the (samples, 2) curve, or None if it leaves `free` or the start."""
    fine = 4 * KNOTS
    spectrum = np.fft.rfft(curve, axis=0)
    dense = np.fft.irfft(spectrum, fine, axis=0) * (fine / len(curve))
    closed = np.vstack([dense, dense[:1]])
    if not shapely.covers(free, shapely.linestrings(closed)):
        return None
    arcs = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    length = float(arcs[-1])
    steps = np.arange(KNOTS) * (length / KNOTS)
    knots = np.column_stack([np.interp(steps, arcs, closed[:, axis]) for axis in (0, 1)])
    away = np.flatnonzero(np.hypot(*(knots - start).T) >= keep_off)
    if len(away) == 0:
        return None
    offset = float(steps[rng.choice(away)])
    direction = 1.0 if rng.random() < 0.5 else -1.0
    return ClosedCurveMotion(knots, length, direction * speed, offset)


def _distance_to_segment(points: FloatArray, ends: FloatArray) -> FloatArray:
    leg = ends[1] - ends[0]
    along = np.clip((points - ends[0]) @ leg / (leg @ leg), 0.0, 1.0)
    distance: FloatArray = np.hypot(*(points - ends[0] - along[:, None] * leg).T)
    return distance
