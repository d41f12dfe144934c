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
    earlier: tuple[Look, Look],
    count: int,
    top_speed: float,
    margin: float,
    max_range: float,
    still: float,
    certainty: float,
) -> tuple[IntArray, BoolArray]:
    """(m,) MOVING, STATIC or UNKNOWN for each hit, against earlier looks; and (m,) True for hits
    well inside of what was free space then.

    Args:
        hits: m of them.
        now: the look they belong to.
        earlier: of these, the newest last, the first `count` count.
        top_speed: the fastest motion believed, m/s: a hit farther off belongs to another surface.
        margin: how far inside free space a hit must lie to count as intruding, m.
        max_range: the sensor's range, m.
        still: a surface that moved less than this stands still, m.
        certainty: standard deviations of noise beyond `still` that show motion.
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
        _compare(hits, now, earlier[row], top_speed, margin, max_range, flow, row)
    return _flags(flow, still, certainty), flow.intruding


@compiled
def _compare(
    hits: Hits,
    now: Look,
    before: Look,
    top_speed: float,
    margin: float,
    max_range: float,
    flow: PointFlow,
    row: int,
) -> None:
    """Fills in the row of `flow` for one earlier look; see `seen_to_move`."""
    count, c, s = len(before.ranges), cos(before.yaw), sin(before.yaw)
    reach = top_speed * flow.elapsed[row] + REACH_MARGIN
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
            and distance < max_range
            # Beside a corner that moved, the hit may lie on another face than the one seen there
            # before.
            and _faces_along(nx, ny, hits.rays[i], now)
        )
        # Behind the earlier surface: either that one moved away, or it is still there and merely
        # hid this hit before. It has moved if the place where it was is seen to be free now.
        if known and moved < -LEVEL:
            known = depth_behind(surface_x, surface_y, now) > -0.5 * moved
        # Between two rays only what is nearer than both was certainly seen to be free.
        free = min(before.ranges[ray], before.ranges[(ray + 1) % count])
        flow.known[row, i], flow.distance[row, i], flow.sigma[row, i] = known, moved, sigma
        flow.normals[row, 0, i], flow.normals[row, 1, i] = nx, ny
        flow.intruding[i] |= distance < free - (margin + 2.0 * unsure)


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
