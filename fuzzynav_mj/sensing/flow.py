"""Motion evidence of single points: where did the surface that a ray hits now lie before?

A current hit is compared with the outline that an earlier look drew at the same bearing from the
earlier pose. On a surface that stands still the hit lies on that outline, however the robot moved;
the signed distance to it, along the outline's normal, is the surface's motion.
"""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from fuzzynav_mj.sensing.looks import SAME_FACE, Look
from fuzzynav_mj.types import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True, eq=False)
class PointFlow:
    """Motion of each current hit since an earlier look.

    Attributes:
        known: (m,) True where the hit can be compared with a surface of the earlier look.
        distance: (m,) how far the surface moved along `normals`, m, positive towards the robot.
        normals: (m, 2) unit normals of the earlier surface, towards the earlier pose.
        intruding: (m,) True where the hit lies well inside what was free space before.
        elapsed: s between the two looks.
        sigma: (m,) uncertainty of `distance` that comes from the ranges', m; None for exact ones.
    """

    known: BoolArray
    distance: FloatArray
    normals: FloatArray
    intruding: BoolArray
    elapsed: float
    sigma: FloatArray | None = None


REACH_MARGIN = 0.01  # m: how much farther than the fastest motion believed a surface may have gone


def point_flow(
    rays: IntArray, now: Look, before: Look, top_speed: float, margin: float, max_range: float
) -> PointFlow:
    """Flow of current hits against an earlier look.

    Args:
        rays: (m,) the rays that hit.
        now: the look they belong to.
        before: the earlier look.
        top_speed: the fastest motion believed, m/s: a hit farther off belongs to another surface.
        margin: how far inside free space a hit must lie to count as intruding, m.
        max_range: the sensor's range, m.
    """
    count = len(before.ranges)
    elapsed = now.stamp - before.stamp
    x, y = now.points.T.take(rays, axis=1)
    dx, dy = x - before.pose.x, y - before.pose.y
    c, s = cos(before.pose.yaw), sin(before.pose.yaw)
    forward, left = c * dx + s * dy, c * dy - s * dx
    distance = np.hypot(forward, left)
    ray = ((np.arctan2(left, forward) + pi) * (count / (2 * pi))).astype(np.intp) % count
    normals = before.normals.T.take(ray, axis=1)
    surface = before.points.T.take(ray, axis=1)
    moved = (x - surface[0]) * normals[0] + (y - surface[1]) * normals[1]
    sigma = _uncertainty(normals, rays, now, ray, before)
    reach: FloatArray | float = top_speed * elapsed + REACH_MARGIN
    if sigma is not None:
        reach = reach + 2.0 * sigma
    known = before.joined.take(ray) & (np.abs(moved) <= reach) & (distance < max_range)
    # Beside a corner that moved, the hit may lie on another face than the one seen there before.
    known &= _faces_along(normals, rays, now)
    # Behind the earlier surface: either that one moved away, or it is still there and merely hid
    # this hit before. It has moved if the place where it was is seen to be free now.
    behind = (known & (moved < 0.0)).nonzero()[0]
    if len(behind):
        known[behind] = _depth_behind(surface.take(behind, axis=1), now) > -0.5 * moved[behind]
    # Between two rays only what is nearer than both was certainly seen to be free.
    free = np.minimum(before.ranges.take(ray), before.ranges.take(ray + 1, mode="wrap"))
    if sigma is not None and now.sigma is not None and before.sigma is not None:
        margin = margin + 2.0 * np.hypot(now.sigma.take(rays), before.sigma.take(ray))
    intruding = distance < free - margin
    return PointFlow(known, moved, normals.T, intruding, elapsed, sigma)


def _uncertainty(
    normals: FloatArray, rays: IntArray, now: Look, earlier: IntArray, before: Look
) -> FloatArray | None:
    """(m,) uncertainty along the normals (2, m) of the distances between the outlines, m."""
    if now.sigma is None or before.sigma is None:
        return None
    x, y = now.points.T.take(rays, axis=1) - np.array([[now.pose.x], [now.pose.y]])
    incidence = (x * normals[0] + y * normals[1]) / np.maximum(np.hypot(x, y), 1e-9)
    ranges = np.hypot(now.sigma.take(rays), before.sigma.take(earlier))
    sigma: FloatArray = np.abs(incidence) * ranges
    return sigma


def _faces_along(normals: FloatArray, rays: IntArray, look: Look) -> BoolArray:
    """(m,) True where the surface on either side of the hit has the given normal (2, m)."""
    agrees = np.zeros(len(rays), dtype=bool)
    for neighbour in (rays, rays - 1):
        x, y = look.normals.T.take(neighbour, axis=1)
        along = x * normals[0] + y * normals[1] > SAME_FACE
        agrees |= along & look.joined.take(neighbour)
    return agrees


def _depth_behind(points: FloatArray, look: Look) -> FloatArray:
    """(m,) how much farther than each point (2, m) the look's rays reach beside it, m."""
    count = len(look.ranges)
    dx, dy = points[0] - look.pose.x, points[1] - look.pose.y
    bearing = np.arctan2(dy, dx) - look.pose.yaw + pi
    ray = (bearing * (count / (2 * pi))).astype(np.intp)
    reach = np.minimum(look.ranges.take(ray, mode="wrap"), look.ranges.take(ray + 1, mode="wrap"))
    depth: FloatArray = reach - np.hypot(dx, dy)
    return depth
