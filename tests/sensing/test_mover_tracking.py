"""The filter of movers' velocities, against the same algebra written with matrices."""

from math import cos, exp, hypot, pi, sin

import numpy as np
import pytest

from fuzzynav_mj.robot import DEFAULT_ROBOT
from fuzzynav_mj.sensing.flow import PointFlow
from fuzzynav_mj.sensing.lidar import ray_bearings
from fuzzynav_mj.sensing.looks import Look, take_look
from fuzzynav_mj.sensing.perception import Perceiver
from fuzzynav_mj.sensing.tracking import (
    ACCELERATION_SIGMA,
    ACCELERATION_TIME,
    SPEED_NOISE,
    UNSEEN,
    Beliefs,
    Track,
)
from fuzzynav_mj.types import FloatArray, LaserScan, Pose2D

BELIEFS = Beliefs(
    flow_sigma=0.006, noise=0.0, independent_hits=6.0, outlier=0.06, outline_sigma=0.017
)
SPAN = (2, 9)  # the obstacle's hits among others


def look_at(stamp: float) -> Look:
    empty = LaserScan(stamp, ray_bearings(12), np.full(12, 0.8), np.zeros(12, dtype=bool), 0.8)
    return take_look(empty, Pose2D(0.0, 0.0, 0.0))


def flow_of(rng: np.random.Generator, velocity: FloatArray, elapsed: FloatArray) -> PointFlow:
    """Of twelve hits with normals all around, all of which move with `velocity`."""
    shape = len(elapsed), 12
    angle = rng.uniform(-pi, pi, shape)
    normals = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    distance = (normals * velocity[None, :, None]).sum(axis=1) * elapsed[:, None]
    known = rng.random(shape) < 0.7
    return PointFlow(known, distance, normals, np.zeros(shape, bool), elapsed, np.zeros(shape))


def some_track(rng: np.random.Generator) -> Track:
    track = Track.begin(rng.normal(size=2))
    track.state = rng.normal(0.0, 0.2, 4)
    root = rng.normal(0.0, 0.2, (4, 4))
    track.covariance = root @ root.T + 0.01 * np.eye(4)
    return track


@pytest.mark.parametrize("seed", range(5))
def test_prediction_is_the_linear_model(seed: int) -> None:
    track, elapsed = some_track(np.random.default_rng(seed)), 0.1
    fade = exp(-elapsed / ACCELERATION_TIME)
    model = np.eye(4) + elapsed * np.eye(4, k=2)
    model[2:] *= fade
    noise = ACCELERATION_SIGMA**2 * (1.0 - fade**2)
    added = np.diag([SPEED_NOISE**2, SPEED_NOISE**2, noise, noise])
    centre = track.centre + elapsed * track.velocity
    state, covariance = model @ track.state, model @ track.covariance @ model.T + added
    track.predict(elapsed)
    np.testing.assert_allclose(track.state, state, atol=1e-14)
    np.testing.assert_allclose(track.covariance, covariance, atol=1e-14)
    np.testing.assert_allclose(track.centre, centre, atol=1e-14)
    assert track.missed == 1


@pytest.mark.parametrize("seed", range(5))
def test_update_is_weighted_least_squares(seed: int) -> None:
    rng = np.random.default_rng(seed)
    track, elapsed = some_track(rng), np.array([0.2, 0.1])
    flow = flow_of(rng, rng.normal(0.0, 0.2, 2), elapsed)
    flow.distance[...] += rng.normal(0.0, 0.005, flow.distance.shape)
    known = flow.known[:, slice(*SPAN)]
    seconds = np.repeat(elapsed, known.sum(axis=1))
    directions = flow.normals[:, :, slice(*SPAN)].transpose(0, 2, 1)[known]
    rates = flow.distance[:, slice(*SPAN)][known] / seconds
    rows = np.hstack((directions, -directions * seconds[:, None] / 2))
    variance = BELIEFS.flow_sigma**2 * max(1.0, len(rates) / BELIEFS.independent_hits)
    weights = seconds**2 / variance
    prior = np.linalg.inv(track.covariance)

    def fitted(weights: FloatArray) -> tuple[FloatArray, FloatArray]:
        information = prior + rows.T @ (rows * weights[:, None])
        return np.linalg.solve(
            information, prior @ track.state + rows.T @ (weights * rates)
        ), np.linalg.inv(information)

    spread = BELIEFS.outlier**2 + ((rows @ track.covariance) * rows).sum(axis=1)
    first, _ = fitted(weights / (1.0 + (rates - rows @ track.state) ** 2 / spread))
    second, covariance = fitted(weights / (1.0 + ((rates - rows @ first) / BELIEFS.outlier) ** 2))
    track.take_in(flow, SPAN, np.zeros(2), UNSEEN, look_at(0.0), BELIEFS)
    np.testing.assert_allclose(track.state, second, atol=1e-12)
    np.testing.assert_allclose(track.covariance, covariance, atol=1e-12)


def test_steady_motion_is_learnt_to_the_full() -> None:
    rng, velocity = np.random.default_rng(0), np.array([0.3, -0.2])
    track = Track.begin(np.zeros(2))
    for number in range(1, 21):
        track.predict(0.1)
        flow = flow_of(rng, velocity, np.array([0.2, 0.1]))
        track.take_in(flow, SPAN, np.zeros(2), UNSEEN, look_at(0.1 * number), BELIEFS)
    np.testing.assert_allclose(track.velocity, velocity, atol=2e-3)
    assert abs(track.turn_rate) < 0.02


def test_ends_of_the_outline_tell_the_speed_across_the_line_of_sight_only() -> None:
    """A mover 0.5 m ahead on the left of which one end shows; no hit can be compared."""
    nothing = flow_of(np.random.default_rng(0), np.zeros(2), np.empty(0))
    sight = np.array([cos(0.3), sin(0.3)])
    across, speed = np.array([-sight[1], sight[0]]), 0.05
    track = Track.begin(np.zeros(2))
    for number in range(30):
        stamp = 0.1 * number
        ends = UNSEEN.copy()
        ends[1] = 0.5 * sight + speed * stamp * across
        if number:
            track.predict(0.1)
        here = look_at(stamp)._replace(x=float(ends[1, 0] - 0.5 * sight[0]),
                                       y=float(ends[1, 1] - 0.5 * sight[1]))  # fmt: skip
        track.take_in(nothing, SPAN, np.zeros(2), ends, here, BELIEFS)
    assert float(track.velocity @ across) == pytest.approx(speed, abs=2e-3)
    assert float(track.velocity @ sight) == pytest.approx(0.0, abs=1e-12)
    assert track.sigma_along(*sight.tolist()) > 5.0 * track.sigma_along(*across.tolist())


def test_looks_at_the_same_time_give_no_speed_and_no_error() -> None:
    ranges = np.full(180, 0.8)
    ranges[80:90] = 0.5
    perceiver, here = Perceiver(DEFAULT_ROBOT), Pose2D(0.0, 0.0, 0.0)
    for shift in (0.0, 0.02, 0.04, 0.08):
        nearer = np.where(ranges < 0.8, ranges - shift, ranges)
        scan = LaserScan(1.0, ray_bearings(180), nearer, ranges < 0.8, 0.8)
        seen = perceiver.perceive(scan, here)
    assert len(seen.obstacles) == 1
    assert seen.obstacles[0].distance == pytest.approx(0.42)
    assert np.isfinite(seen.obstacles[0].velocity).all()


def test_uncertainty_along_a_direction_is_that_of_the_covariance() -> None:
    track = some_track(np.random.default_rng(4))
    direction = np.array([3.0, -4.0]) / hypot(3.0, 4.0)
    expected = float(np.sqrt(direction @ track.covariance[:2, :2] @ direction))
    assert track.sigma_along(*direction.tolist()) == pytest.approx(expected, rel=1e-12)
