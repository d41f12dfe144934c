"""Scans with noise and missing rays, put back on their surfaces."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav_mj.sensing.cleaning import clean_scan
from fuzzynav_mj.types import FloatArray, LaserScan

COUNT, RANGE = 180, 0.8
BEARINGS = -pi + np.arange(COUNT) * (2 * pi / COUNT)
WALL = 0.5  # m ahead
TRUE: FloatArray = np.where(
    np.cos(BEARINGS) * RANGE > WALL, WALL / np.maximum(np.cos(BEARINGS), 1e-9), RANGE
)
ON_WALL = TRUE < RANGE


def scan_of(ranges: FloatArray) -> LaserScan:
    return LaserScan(0.0, BEARINGS, ranges, ranges < RANGE, RANGE)


@pytest.mark.parametrize("sigma", [0.005, 0.01, 0.02])
def test_noise_on_a_wall_is_more_than_halved(sigma: float) -> None:
    rng = np.random.default_rng(7)
    errors = []
    for _ in range(40):
        noisy = np.where(ON_WALL, TRUE + rng.normal(0.0, sigma, COUNT), RANGE)
        cleaned = clean_scan(scan_of(np.minimum(noisy, RANGE)), sigma).scan
        seen = ON_WALL & cleaned.hit
        errors.append(cleaned.ranges[seen] - TRUE[seen])
    assert float(np.sqrt(np.mean(np.concatenate(errors) ** 2))) < sigma / 2


def test_exact_ranges_of_a_wall_stay_as_they_are() -> None:
    cleaned = clean_scan(scan_of(TRUE), 0.0).scan
    np.testing.assert_allclose(cleaned.ranges, TRUE, atol=1e-6)
    assert (cleaned.hit == ON_WALL).all()


def test_missing_rays_on_a_surface_are_filled_in_and_free_ones_are_not() -> None:
    rays = np.flatnonzero(ON_WALL)
    ranges = TRUE.copy()
    ranges[rays[[10, 20, 21]]] = RANGE
    cleaned = clean_scan(scan_of(ranges), 0.0).scan
    np.testing.assert_allclose(cleaned.ranges[rays], TRUE[rays], atol=1e-6)
    assert not cleaned.hit[~ON_WALL].any()


def test_uncertainty_told_is_that_of_the_ranges() -> None:
    """Errors over the uncertainties given with them have a spread of about one."""
    rng = np.random.default_rng(3)
    scaled = []
    for _ in range(60):
        noisy = np.where(ON_WALL, TRUE + rng.normal(0.0, 0.01, COUNT), RANGE)
        clean = clean_scan(scan_of(np.minimum(noisy, RANGE)), 0.01)
        seen = ON_WALL & clean.scan.hit
        scaled.append((clean.scan.ranges[seen] - TRUE[seen]) / clean.sigma[seen])
    assert 0.5 < float(np.std(np.concatenate(scaled))) < 2.0


def test_mirrored_scan_is_cleaned_to_the_mirror_image() -> None:
    """Ray k and ray -k look to either side of the robot's axis."""
    rng = np.random.default_rng(1)
    noisy = np.minimum(np.where(ON_WALL, TRUE + rng.normal(0.0, 0.01, COUNT), RANGE), RANGE)
    mirrored = np.roll(noisy[::-1], 1)
    one = clean_scan(scan_of(noisy), 0.01).scan.ranges
    other = clean_scan(scan_of(mirrored), 0.01).scan.ranges
    assert float(np.abs(one - np.roll(other[::-1], 1)).mean()) < 2e-3


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.1), st.floats(0.0, 1.0), st.floats(0.0, 0.5))
def test_any_scan_comes_out_with_positive_ranges_and_uncertainties(
    seed: int, noise: float, near: float, lost: float
) -> None:
    """Also one with ranges of nought, which noise makes of near ones."""
    rng = np.random.default_rng(seed)
    ranges = np.where(rng.random(COUNT) < near, 0.0, np.clip(rng.normal(0.1, 0.1, COUNT), 0.0, 0.7))
    ranges[rng.random(COUNT) < lost] = RANGE
    clean = clean_scan(scan_of(ranges), noise)
    assert (clean.scan.ranges > 0.0).all() and (clean.scan.ranges <= RANGE).all()
    assert (clean.sigma > 0.0).all() and np.isfinite(clean.normals).all()
