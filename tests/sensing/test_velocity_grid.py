"""The motions that are tried, and what is believed when none of them is ruled out."""

import numpy as np
import pytest

from fuzzynav_mj.sensing.velocity_grid import KNOWN, SPAN, frame_of, motions, without
from fuzzynav_mj.types import FloatArray


def covariance(most: float, least: float, turned: float) -> FloatArray:
    """(6, 6) with these standard deviations of the velocity, the larger one turned so far; the
    acceleration depends on it as after steady acceleration for a second."""
    c, s = np.cos(turned), np.sin(turned)
    axes = np.array([[c, -s], [s, c]])
    full = np.zeros((6, 6))
    full[:2, :2] = axes @ np.diag([most**2, least**2]) @ axes.T
    full[2:4, :2] = full[:2, 2:4] = full[:2, :2]
    full[2:4, 2:4] = full[:2, :2] + 0.5**2 * np.eye(2)
    return full


def test_velocities_fill_the_ellipse_of_the_uncertainty() -> None:
    spread = covariance(0.3, 0.2, 0.7)
    places, tried, likely = motions(frame_of(spread))
    squared = np.einsum("ki,ij,kj->k", tried[:, :2], np.linalg.inv(spread[:2, :2]), tried[:, :2])
    np.testing.assert_allclose(squared, (places**2).sum(axis=1), atol=1e-9)
    assert squared.max() <= SPAN**2 + 1e-6
    # The ends of the axes are among them, and with each velocity its opposite.
    assert abs(np.abs(places).max() - SPAN) < 1e-12
    np.testing.assert_allclose(likely @ tried, 0.0, atol=1e-12)
    np.testing.assert_allclose(likely, np.exp(-0.5 * squared))
    # Each comes with the acceleration that it lets expect.
    np.testing.assert_allclose(tried[:, 2:], tried[:, :2], atol=1e-12)


@pytest.mark.parametrize("turned", [0.0, 0.7, -1.2])
def test_where_one_axis_is_known_accelerations_along_the_other_are_tried(turned: float) -> None:
    spread = covariance(0.3, 0.9 * KNOWN, turned)
    places, tried, likely = motions(frame_of(spread))
    axis = np.array([np.cos(turned), np.sin(turned)])
    along = np.stack((tried[:, :2] @ axis, tried[:, 2:] @ axis), axis=1)
    np.testing.assert_allclose(tried[:, :2], along[:, :1] * axis, atol=1e-9)
    both = np.array([[0.3**2, 0.3**2], [0.3**2, 0.3**2 + 0.5**2]])
    squared = np.einsum("ki,ij,kj->k", along, np.linalg.inv(both), along)
    np.testing.assert_allclose(squared, (places**2).sum(axis=1), atol=1e-9)
    np.testing.assert_allclose(likely, np.exp(-0.5 * squared))


def test_what_is_known_well_enough_is_not_tried() -> None:
    places, tried, _ = motions(frame_of(covariance(0.9 * KNOWN, 0.5 * KNOWN, 0.0)))
    assert places.tolist() == [[0.0, 0.0]]
    assert not tried.any()


def test_half_of_the_velocities_open_moves_the_mean_to_their_side() -> None:
    spread = covariance(0.3, 0.9 * KNOWN, 0.0)
    frame = frame_of(spread)
    places, tried, likely = motions(frame)
    forward = likely * (0.5 + 0.5 * np.sign(tried[:, 0].round(12)))
    state, narrowed = without(np.zeros(6), spread, frame, places, forward, likely)
    assert abs(state[0] - 0.3 * np.sqrt(2.0 / np.pi)) < 0.02  # the mean of half a normal law
    assert abs(state[1]) < 1e-12
    assert narrowed[0, 0] < 0.5 * spread[0, 0]
    same, _ = without(np.zeros(6), spread, frame, places, likely, likely)
    np.testing.assert_allclose(same, 0.0, atol=1e-12)
