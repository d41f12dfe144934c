"""Takes noise and missing rays out of a scan, as far as the surfaces in it allow.

Seen from the sensor, the inverse ranges of a straight line are a combination of the cosine and the
sine of the bearing. Each hit is put on the line that fits the longest stretch of hits around it
that is straight as far as the noise lets one tell; an outline's corners end such stretches.
"""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.types import BoolArray, FloatArray, LaserScan

STRETCHES = (3, 4, 6, 8, 12, 16, 24, 36)  # rays, first to last
PLACES = 4  # a hit lies at one of so many parts of its stretch, or at its end
FEWEST = 3  # hits on a stretch
MISFIT = 2.0  # standard deviations of the sum of squares around what the noise explains
BEND = 2.0  # standard deviations by which the middle may stand out from the line
JUMP = 0.10  # m: neighbouring hits farther apart in range, noise aside, end a stretch
LONGEST_GAP = 3  # missing rays that a stretch bridges
NEAREST = 0.02  # m: noise may tell of less, even of none, but nothing comes so near
LEAST_NOISE = 0.001  # m: less is not worth the effort; more must be believed of missing rays


@dataclass(frozen=True, slots=True, eq=False)
class CleanScan:
    """A scan on smoothed outlines.

    Attributes:
        scan: with smoothed ranges; rays that were missing on a surface hit it.
        sigma: (n,) what the ranges are still uncertain by, m.
        normals: (n, 2) unit normals of the outline at each ray, towards the sensor, robot frame;
            zero where it is not straight.
    """

    scan: LaserScan
    sigma: FloatArray
    normals: FloatArray


def clean_scan(scan: LaserScan, noise: float) -> CleanScan:
    """Smooths a scan.

    Args:
        scan: evenly spaced rays all around.
        noise: standard deviation of its ranges, m.
    """
    noise = max(noise, LEAST_NOISE)
    margin = STRETCHES[-1]
    ring = np.arange(-margin, len(scan.ranges) + margin) % len(scan.ranges)
    ranges, hit, sigma, normals = _on_lines(
        scan.ranges.take(ring),
        scan.hit.take(ring),
        np.cos(scan.bearings).take(ring),
        np.sin(scan.bearings).take(ring),
        noise,
        scan.max_range,
    )
    cleaned = LaserScan(scan.stamp, scan.bearings, ranges, hit, scan.max_range)
    return CleanScan(cleaned, sigma, normals)


@compiled
def _on_lines(
    ranges: FloatArray,
    hit: BoolArray,
    c: FloatArray,
    s: FloatArray,
    noise: float,
    max_range: float,
) -> tuple[FloatArray, BoolArray, FloatArray, FloatArray]:
    """Ranges, hits, uncertainties and normals of the rays; those given go on past both ends."""
    total, margin = len(ranges), STRETCHES[-1]
    count = total - 2 * margin
    # Sums over all rays before each: of weights times cc, cs, ss, qc, qs, qq, and of hits.
    sums = np.zeros((total + 1, 7))
    breaks = np.zeros(total + 1, dtype=np.intp)  # places before each ray that end a stretch
    gap, last, recent = LONGEST_GAP + 1, 0.0, 0.0
    for k in range(total):
        breaks[k + 1] = breaks[k]
        for term in range(7):
            sums[k + 1, term] = sums[k, term]
        if not hit[k]:
            gap += 1
            continue
        here = max(ranges[k], NEAREST)
        if gap > LONGEST_GAP or abs(here - last) > JUMP + 3.0 * noise + 0.1 * here * gap:
            breaks[k + 1] += 1
            recent = here
        # The weight must not follow the noise of the very hit that it weighs.
        around, number = 0.0, 0
        for j in range(max(k - 2, 0), min(k + 3, total)):
            if hit[j] and abs(ranges[j] - here) < JUMP + 3.0 * noise:
                around += max(ranges[j], NEAREST)
                number += 1
        recent = around / number
        last, gap = here, 0
        weight = recent**4 / noise**2
        q = 1.0 / here
        sums[k + 1, 0] += weight * c[k] * c[k]
        sums[k + 1, 1] += weight * c[k] * s[k]
        sums[k + 1, 2] += weight * s[k] * s[k]
        sums[k + 1, 3] += weight * q * c[k]
        sums[k + 1, 4] += weight * q * s[k]
        sums[k + 1, 5] += weight * q * q
        sums[k + 1, 6] += 1.0
    new_ranges = np.full(count, max_range)
    new_hit = np.zeros(count, dtype=np.bool_)
    sigma = np.full(count, noise)
    normals = np.zeros((count, 2))
    for i in range(count):
        k = i + margin
        if hit[k]:
            new_ranges[i], new_hit[i] = max(ranges[k], NEAREST), True
        best = np.inf
        for length in STRETCHES:
            for place in range(PLACES + 1):
                first = k - (length * place) // PLACES
                end = first + length + 1
                if breaks[end] != breaks[first + 1]:
                    continue
                # A missing ray must lie between hits of the stretch.
                if not hit[k] and (place == 0 or place == PLACES):
                    continue
                number = sums[end, 6] - sums[first, 6]
                if number < FEWEST or not hit[first] or not hit[end - 1]:
                    continue
                xx = sums[end, 0] - sums[first, 0]
                xy = sums[end, 1] - sums[first, 1]
                yy = sums[end, 2] - sums[first, 2]
                xq = sums[end, 3] - sums[first, 3]
                yq = sums[end, 4] - sums[first, 4]
                det = xx * yy - xy * xy
                if det <= 1e-9 * xx * yy:
                    continue
                a, b = (yy * xq - xy * yq) / det, (xx * yq - xy * xq) / det
                q = a * c[k] + b * s[k]
                if q * max_range <= 1.0:
                    continue
                variance = (yy * c[k] * c[k] - 2.0 * xy * c[k] * s[k] + xx * s[k] * s[k]) / det
                spread = sqrt(variance) / (q * q)
                if spread >= best:
                    continue
                free = number - 2.0
                misfit = sums[end, 5] - sums[first, 5] - a * xq - b * yq
                if misfit > free + MISFIT * sqrt(2.0 * free):
                    continue
                # Does the middle half stand out from the line?
                inner, outer = first + (length + 1) // 4, end - (length + 1) // 4
                mxx = sums[outer, 0] - sums[inner, 0]
                mxy = sums[outer, 1] - sums[inner, 1]
                myy = sums[outer, 2] - sums[inner, 2]
                middle = (inner + outer) // 2
                u, v = c[middle], s[middle]
                tx, ty = mxx * u + mxy * v, mxy * u + myy * v
                bend = (
                    u * (sums[outer, 3] - sums[inner, 3])
                    + v * (sums[outer, 4] - sums[inner, 4])
                    - tx * a
                    - ty * b
                )
                expected = (
                    tx * u + ty * v - (yy * tx * tx - 2.0 * xy * tx * ty + xx * ty * ty) / det
                )
                if bend * bend > BEND * BEND * max(expected, 1e-9):
                    continue
                best = spread
                new_ranges[i], new_hit[i], sigma[i] = 1.0 / q, True, spread
                norm = sqrt(a * a + b * b)
                normals[i, 0], normals[i, 1] = -a / norm, -b / norm
    _bridge(new_ranges, new_hit, sigma)
    return new_ranges, new_hit, sigma, normals


@compiled
def _bridge(ranges: FloatArray, hit: BoolArray, sigma: FloatArray) -> None:
    """Has what few rays are still missing between two hits hit something on a line between them."""
    count = len(ranges)
    for first in range(count):
        if hit[first] or not hit[first - 1]:
            continue
        for length in range(1, LONGEST_GAP + 1):
            end = (first + length) % count
            if hit[end]:
                for step in range(length):
                    k = (first + step) % count
                    share = (step + 1) / (length + 1)
                    ranges[k] = 1.0 / ((1.0 - share) / ranges[first - 1] + share / ranges[end])
                    hit[k], sigma[k] = True, max(sigma[first - 1], sigma[end])
                break
