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
from fuzzynav_mj.types import BoolArray, FloatArray

MARGIN = 0.02  # m kept between a mover and what it must not touch
START_GAP = 1.0  # m between a mover and the robot at time 0
CORRIDOR = 1.2  # m beside the straight line to the goal: curves that enter it are preferred
SCALES = (1.0, 0.85, 0.7, 0.55, 0.45, 0.35, 0.28, 0.22, 0.17, 0.13, 0.1, 0.07, 0.05)
CANDIDATES = 32  # curves tried at every scale
ROUNDS = 60  # shapes and speeds tried before giving up
SAMPLES = 64  # points of a candidate curve
KNOTS = 512  # points of an accepted curve
SLACK = 0.95  # share of the acceleration bound that a curve may use
SHARPEST = 0.08  # m; no curve turns on less, however slow: the knots resolve it


def draw_movers(scenario: Scenario, rng: np.random.Generator) -> tuple[Mover, ...]:
    """Draw all random obstacles of `scenario`.

    Radius, corners and speed are uniform in the ranges of the scenario, given that the region has
    room for them: where nothing fits, all three are drawn anew.

    Raises:
        ScenarioError: no curve was found on which an obstacle keeps clear of the static ones,
            inside its region and away from the robot's start.
    """
    static = shapely.union_all([shape.footprint for shape in scenario.static])
    arena = shapely.difference(shapely.box(*scenario.bounds), static)
    movers: list[Mover] = []
    for index, spec in enumerate(scenario.random_moving):
        area = shapely.intersection(shapely.Polygon(spec.region), arena)
        for _ in range(int(rng.integers(spec.count[0], spec.count[1] + 1))):
            mover = _draw_mover(spec, scenario, area, rng)
            if mover is None:
                raise ScenarioError(
                    f"{scenario.source}: random_moving.{index}: given a region, radius, speed and "
                    "acceleration for which no free motion was found; allowed those that leave "
                    "room for a closed curve between the static obstacles, with a place on it "
                    f"{START_GAP} m away from the robot's start"
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
        tightest = max(speed**2 / (SLACK * spec.acceleration), SHARPEST)
        keep_off = START_GAP + radius + DEFAULT_ROBOT.half_diagonal
        motion = _draw_motion(area.buffer(-radius - MARGIN), ends, keep_off, speed, tightest, rng)
        if motion is not None:
            return Mover(Shape(polygon, None), motion)
    return None


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
    jitter = 0.1 if concave else 0.2  # below a quarter, so that no gap reaches a half turn
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


def _draw_motion(
    free: BaseGeometry,
    ends: FloatArray,
    keep_off: float,
    speed: float,
    tightest: float,
    rng: np.random.Generator,
) -> ClosedCurveMotion | None:
    """Return a motion within `free`, the larger and the nearer to the robot's way the better.

    Args:
        free: where the obstacle's origin may be.
        ends: (2, 2) the robot's start and goal.
        keep_off: distance of the obstacle's origin from the start at time 0, m.
        speed: m/s.
        tightest: smallest radius of curvature, m.
        rng: source of the draw.
    """
    if free.is_empty:
        return None
    shapely.prepare(free)
    x_min, y_min, x_max, y_max = free.bounds
    corner, size = np.array([x_min, y_min]), np.array([x_max - x_min, y_max - y_min])
    unit_curves = _unit_curves(rng)
    near_way = free.distance(shapely.LineString(ends)) < CORRIDOR
    fallback: ClosedCurveMotion | None = None
    for scale in SCALES:
        longest = np.minimum(size, scale * size.max())
        if longest.min() <= 2 * tightest:  # no closed curve is narrower than its gentlest circle
            break
        span = rng.uniform(np.maximum(0.4 * longest, 2 * tightest), longest, (CANDIDATES, 2))
        low = corner + rng.random((CANDIDATES, 2)) * (size - span)
        for curve in _fitting(low[:, None] + unit_curves * span[:, None], free, tightest):
            motion = _motion(curve, speed, tightest, ends[0], keep_off, free, rng)
            if motion is None:
                continue
            if not near_way or _distance_to_segment(motion.knots, ends).min() < CORRIDOR:
                return motion
            fallback = fallback or motion
    return fallback


def _unit_curves(rng: np.random.Generator) -> FloatArray:
    """Return (CANDIDATES, SAMPLES, 2) smooth closed curves, each with the unit square as its box.

    Each is a racetrack: two half turns whose curvature swells and fades, and two straights
    between them, some so short that the track is all but round. It may be tilted, and it is
    dented a little by a second harmonic.
    """
    place = (np.arange(SAMPLES // 2) + 0.5) / (SAMPLES // 2)  # along one half of the track
    turn = rng.uniform(0.15, 0.5, (CANDIDATES, 1))  # share of the half on either side of its middle
    curvature = np.clip(2.0 * (1.0 - np.abs(place - 0.5) / turn), 0.0, 1.0)
    heading = np.pi * np.cumsum(curvature, axis=1) / curvature.sum(axis=1, keepdims=True)
    steps = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    tracks = np.cumsum(np.concatenate([steps, -steps], axis=1), axis=1)  # closed by symmetry
    tilt = rng.uniform(0.0, np.pi, CANDIDATES) * (rng.random(CANDIDATES) < 0.5)
    curves = _boxed(_boxed(tracks) @ rotation(tilt))
    harmonic = 2 * (2 * np.pi / SAMPLES) * np.arange(SAMPLES)
    shift = rng.uniform(0.0, 2 * np.pi, (CANDIDATES, 1, 2))
    dents = rng.normal(0.0, 0.04, (CANDIDATES, 1, 2)) * np.cos(harmonic[:, None] + shift)
    return _boxed(curves + dents)


def _boxed(curves: FloatArray) -> FloatArray:
    low, high = curves.min(axis=1, keepdims=True), curves.max(axis=1, keepdims=True)
    boxed: FloatArray = (curves - low) / (high - low)
    return boxed


def _fitting(curves: FloatArray, free: BaseGeometry, tightest: float) -> FloatArray:
    """Return those of the (c, samples, 2) curves that lie in `free` and are gentle enough."""
    curves = curves[_inside(curves[:, ::8], free)]  # most misfits show on a few points
    curves = curves[_curvature(curves).max(axis=1, initial=0.0) * tightest <= 1.0]
    return curves[_inside(curves, free)]


def _inside(curves: FloatArray, free: BaseGeometry) -> BoolArray:
    points: BoolArray = np.asarray(shapely.contains_xy(free, curves[..., 0], curves[..., 1]))
    inside: BoolArray = np.all(points, axis=1)
    return inside


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
    tightest: float,
    start: FloatArray,
    keep_off: float,
    free: BaseGeometry,
    rng: np.random.Generator,
) -> ClosedCurveMotion | None:
    """Return a motion around the (samples, 2) curve, or None.

    None if the curve between the samples turns more sharply than `tightest` or leaves `free`, or
    if it keeps too near to `start` all around.
    """
    fine = 4 * KNOTS
    dense = np.fft.irfft(np.fft.rfft(curve, axis=0), fine, axis=0) * (fine / len(curve))
    closed = np.vstack([dense, dense[:1]])
    if _curvature(dense[None]).max() * tightest > 1.0:
        return None
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
    along = np.clip((points - ends[0]) @ leg / max(leg @ leg, 1e-12), 0.0, 1.0)
    distance: FloatArray = np.hypot(*(points - ends[0] - along[:, None] * leg).T)
    return distance
