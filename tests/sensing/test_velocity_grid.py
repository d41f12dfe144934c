"""The velocities that are tried, and what is believed when none of them is ruled out."""

import numpy as np

from fuzzynav_mj.sensing.velocity_grid import KNOWN, SPAN, frame_of, velocities, without
from fuzzynav_mj.types import FloatArray


def covariance(most: float, least: float, turned: float) -> FloatArray:
    """(4, 4) with these standard deviations of the velocity, the larger one turned so far."""
    c, s = np.cos(turned), np.sin(turned)
    axes = np.array([[c, -s], [s, c]])
    full = np.eye(4)
    full[:2, :2] = axes @ np.diag([most**2, least**2]) @ axes.T
    return full


def test_velocities_fill_the_ellipse_of_the_uncertainty() -> None:
    spread = covariance(0.3, 0.2, 0.7)
    places, tried, likely = velocities(frame_of(spread))
    squared = np.einsum("ki,ij,kj->k", tried, np.linalg.inv(spread[:2, :2]), tried)
    np.testing.assert_allclose(squared, (places**2).sum(axis=1), atol=1e-9)
    assert squared.max() <= SPAN**2 + 1e-6
    # The ends of the axes are among them, and with each velocity its opposite.
    assert abs(np.abs(places).max() - SPAN) < 1e-12
    np.testing.assert_allclose(likely @ tried, 0.0, atol=1e-12)
    np.testing.assert_allclose(likely, np.exp(-0.5 * squared))


def test_what_is_known_well_enough_is_not_tried() -> None:
    places, _, _ = velocities(frame_of(covariance(0.3, 0.9 * KNOWN, 0.0)))
    assert (places[:, 1] == 0.0).all()
    assert len(velocities(frame_of(covariance(0.9 * KNOWN, 0.5 * KNOWN, 0.0)))[0]) == 1


def test_half_of_the_velocities_open_moves_the_mean_to_their_side() -> None:
    spread = covariance(0.3, 0.9 * KNOWN, 0.0)
    frame = frame_of(spread)
    places, tried, likely = velocities(frame)
    forward = np.where(tried[:, 0] > 0.0, likely, 0.0)
    state, narrowed = without(np.zeros(4), spread, frame, places, forward, likely)
    assert abs(state[0] - 0.3 * np.sqrt(2.0 / np.pi)) < 0.02  # the mean of half a normal law
    assert state[1] == 0.0
    assert narrowed[0, 0] < 0.5 * spread[0, 0]
    same, _ = without(np.zeros(4), spread, frame, places, likely, likely)
    np.testing.assert_allclose(same, 0.0, atol=1e-12)
