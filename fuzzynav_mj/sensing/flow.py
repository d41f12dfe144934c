"""Motion evidence of single points: where did the surface that a ray hits now lie before?

A current hit is compared with the outline that an earlier look drew at the same bearing from the
earlier pose. On a surface that stands still the hit lies on that outline, however the robot moved;
the signed distance to it, along the outline's normal, is the surface's motion.
"""

from math import cos, hypot, pi, sin
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.bearings import ray_before
from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.evidence import Evidence
from fuzzynav_mj.sensing.looks import SAME_FACE, Look, depth_behind
from fuzzynav_mj.sensing.segmentation import MOVING, STATIC, UNKNOWN, Hits
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray

LEVEL = 0.005  # m: a hit no farther behind the earlier surface lies on it
REACH_MARGIN = 0.01  # m: how much farther than the fastest motion believed a surface may have gone


class PointFlow(NamedTuple):
    """Motion of each of m current hits since f earlier looks.

    Attributes:
        known: (f, m) True where the hit can be compared with a surface of the earlier look; none
            where that look is of the same time.
        distance: (f, m) how far the surface moved along `normals`, m, positive towards the robot.
        normals: (f, 2, m) unit normals of the earlier surface, towards the earlier pose.
        intruding: (m,) True where the hit lies well inside what was free space in any of them.
        elapsed: (f,) s between the two looks.
        sigma: (f, m) uncertainty of `distance` that comes from the ranges', m.
    """

    known: BoolArray
    distance: FloatArray
    normals: FloatArray
    intruding: BoolArray
    elapsed: FloatArray
    sigma: FloatArray


@compiled
def seen_to_move(
    hits: Hits,
    now: Look,
    earlier: tuple[Look, ...],
    count: int,
    evidence: Evidence,
) -> tuple[IntArray, BoolArray]:
    """(m,) MOVING, STATIC or UNKNOWN for each hit, against earlier looks; and (m,) True for hits
    well inside of what was free space then.

    Args:
        hits: m of them.
        now: the look they belong to.
        earlier: of the first two, the newest last, the first `count` count. Where rays are
            unreliable, looks before those follow, that tell what stands.
        evidence: what shows that a hit moves.
    """
    shape = count, len(hits.rays)
    flow = PointFlow(
        known=np.empty(shape, dtype=np.bool_),
        distance=np.empty(shape),
        normals=np.empty((shape[0], 2, shape[1])),
        intruding=np.zeros(shape[1], dtype=np.bool_),
        elapsed=np.empty(count),
        sigma=np.empty(shape),
    )
    for row in range(count):
        flow.elapsed[row] = now.stamp - earlier[row].stamp
        _compare(hits, now, earlier[row], evidence, flow, row)
    if evidence.unreliable:
        within = max(evidence.certainty * evidence.noise, LEVEL)
        for i in flow.intruding.nonzero()[0]:
            x, y = hits.points[0, i], hits.points[1, i]
            for k in range(2, len(earlier)):
                if _met_before(x, y, now, earlier[k], within):
                    flow.intruding[i] = False
    return _flags(flow, evidence.still, evidence.certainty), flow.intruding


@compiled
def _compare(
    hits: Hits,
    now: Look,
    before: Look,
    evidence: Evidence,
    flow: PointFlow,
    row: int,
) -> None:
    """Fills in the row of `flow` for one earlier look; see `seen_to_move`."""
    count, c, s = len(before.ranges), cos(before.yaw), sin(before.yaw)
    reach = evidence.top_speed * flow.elapsed[row] + REACH_MARGIN
    for i in range(len(hits.rays)):
        x, y = hits.points[0, i], hits.points[1, i]
        dx, dy = x - before.x, y - before.y
        forward, left = c * dx + s * dy, c * dy - s * dx
        distance = hypot(forward, left)
        ray = ray_before(forward, left, -pi, count)
        nx, ny = before.normals[0, ray], before.normals[1, ray]
        surface_x, surface_y = before.points[0, ray], before.points[1, ray]
        moved = (x - surface_x) * nx + (y - surface_y) * ny
        unsure = hypot(now.sigma[hits.rays[i]], before.sigma[ray])
        sigma = 0.0
        if unsure > 0.0:
            sigma = _incidence(x - now.x, y - now.y, nx, ny) * unsure
        known = (
            flow.elapsed[row] > 0.0
            and before.joined[ray]
            and before.straight[ray]
            and abs(moved) <= reach + 2.0 * sigma
            and distance < evidence.max_range
            # Beside a corner that moved, the hit may lie on another face than the one seen there
            # before.
            and _faces_along(nx, ny, hits.rays[i], now)
        )
        # Behind the earlier surface: either that one moved away, or it is still there and merely
        # hid this hit before. It has moved if the place where it was is seen to be free now.
        if known and moved < -LEVEL:
            known = depth_behind(surface_x, surface_y, now) > -0.5 * moved
        # Noise along the ray of now shifts the hit across the one of then: beside the end of a wall
        # even to where rays went by.
        range_now = max(now.ranges[hits.rays[i]], 1e-9)
        across = abs(dx * (y - now.y) - dy * (x - now.x)) / range_now
        free = _surely_free(before, ray, 2.0 * unsure * across / max(distance, 1e-9) ** 2)
        flow.known[row, i], flow.distance[row, i], flow.sigma[row, i] = known, moved, sigma
        flow.normals[row, 0, i], flow.normals[row, 1, i] = nx, ny
        flow.intruding[i] |= distance < free - (evidence.margin + 2.0 * unsure)


@compiled
def _surely_free(look: Look, ray: int, aside: float) -> float:
    """How far it was certainly free around a place, m: only what is nearer than all rays beside it.

    Args:
        look: of that time.
        ray: its last ray before the place; the next one is after it.
        aside: angle by which the place may be off, rad.
    """
    count = len(look.ranges)
    more, free = int(aside * count / (2 * pi)), np.inf
    for k in range(ray - more, ray + more + 2):
        free = min(free, look.ranges[k % count])
    return free


@compiled
def _met_before(x: float, y: float, now: Look, before: Look, within: float) -> bool:
    """True if a look met something where a hit of now may truly be. A ray that was lost since then
    passes for one that went by.

    Args:
        x, y: the hit; it may lie half the way to the next ray to either side and, ...
        now: the look it belongs to.
        before: an earlier one.
        within: ... on its ray, so much farther or nearer, m.
    """
    reach = max(hypot(x - now.x, y - now.y), 1e-9)
    c, s = (x - now.x) / reach, (y - now.y) / reach
    beside = reach * pi / len(now.ranges)
    for ray in range(len(before.hit)):
        if not before.hit[ray]:
            continue
        # From this hit to the next one on its surface, as seen from the hit of now.
        after = (ray + 1) % len(before.hit) if before.joined[ray] else ray
        dx, dy = before.points[0, ray] - x, before.points[1, ray] - y
        ahead, aside = c * dx + s * dy, c * dy - s * dx
        dx, dy = before.points[0, after] - x, before.points[1, after] - y
        on_ahead, on_aside = c * dx + s * dy - ahead, c * dy - s * dx - aside
        # The shares of the way between which it lies on the ray.
        first, last = (0.0, 1.0) if abs(aside) <= beside else (1.0, 0.0)
        if abs(on_aside) > 1e-9:
            one, other = (-beside - aside) / on_aside, (beside - aside) / on_aside
            first, last = max(min(one, other), 0.0), min(max(one, other), 1.0)
        if first > last:
            continue
        one, other = ahead + first * on_ahead, ahead + last * on_ahead
        if min(one, other) <= within and max(one, other) >= -within:
            return True
    return False


@compiled
def _incidence(x: float, y: float, nx: float, ny: float) -> float:
    """Cosine of the angle between a ray that ends at (x, y) from the sensor, m, and a normal."""
    return abs((x * nx + y * ny) / max(hypot(x, y), 1e-9))


@compiled
def _faces_along(nx: float, ny: float, ray: int, look: Look) -> bool:
    """True where the surface on either side of a ray's hit has the given normal."""
    for k in (ray, ray - 1):
        if look.joined[k] and look.straight[k]:
            along = look.normals[0, k] * nx + look.normals[1, k] * ny
            if along > SAME_FACE:
                return True
    return False


@compiled
def _flags(flow: PointFlow, still: float, certainty: float) -> IntArray:
    """(m,) MOVING, STATIC or UNKNOWN for each hit, as far as it can be told.

    It moves if any comparison shows that: what turned back is where it was before.

    Args:
        flow: the comparisons.
        still: a surface that moved less than this stands still, m.
        certainty: standard deviations of noise beyond `still` that show motion.
    """
    looks, count = flow.known.shape
    flags = np.full(count, UNKNOWN)
    for i in range(count):
        for look in range(looks):
            if flags[i] != MOVING and flow.known[look, i]:
                moved = abs(flow.distance[look, i]) > still + certainty * flow.sigma[look, i]
                flags[i] = MOVING if moved else STATIC
        if flow.intruding[i]:
            flags[i] = MOVING
    return flags
