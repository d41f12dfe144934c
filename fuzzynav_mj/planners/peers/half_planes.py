"""Small optimisation problems in the plane under half-planes, solved exactly.

The incremental method of M. de Berg et al., "Computational Geometry", chapter 4: half-planes are
added one by one, and only one that the present optimum violates changes it, to a point on its
border.
"""

from dataclasses import dataclass

import numpy as np

from fuzzynav_mj.types import FloatArray

SLACK = 1e-9  # a point violates a half-plane if it lies farther outside


@dataclass(frozen=True, slots=True, eq=False)
class HalfPlanes:
    """Points x with normals @ x <= offsets.

    Attributes:
        normals: (n, 2) outward; of any length, zero where the half-plane is all or nothing.
        offsets: (n,).
    """

    normals: FloatArray
    offsets: FloatArray

    def and_(self, others: "HalfPlanes") -> "HalfPlanes":
        """These, then the others."""
        return HalfPlanes(
            np.concatenate((self.normals, others.normals)),
            np.concatenate((self.offsets, others.offsets)),
        )

    def excess(self, point: FloatArray) -> FloatArray:
        """(n,) by how much a point (2,) violates each; negative inside."""
        result: FloatArray = self.normals @ point - self.offsets
        return result


def box(lowest: FloatArray, highest: FloatArray) -> HalfPlanes:
    """The rectangle between two corners (2,)."""
    normals = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    return HalfPlanes(normals, np.array([highest[0], -lowest[0], highest[1], -lowest[1]]))


def nearest(wanted: FloatArray, planes: HalfPlanes) -> FloatArray | None:
    """(2,) the point of all half-planes that is nearest to the wanted one (2,); None: no point."""
    point = wanted
    for i, (normal, offset) in enumerate(zip(planes.normals, planes.offsets, strict=True)):
        if normal @ point <= offset + SLACK:
            continue
        border = _border(i, planes)
        if border is None:
            return None
        along = float(border.direction @ (wanted - border.origin))
        point = border.at(min(max(along, border.first), border.last))
    return point


def lowest(slope: FloatArray, planes: HalfPlanes) -> FloatArray | None:
    """(2,) a point of all half-planes where slope @ x is smallest; None: no point.

    Args:
        slope: (2,).
        planes: the first four are a `box`.
    """
    point = np.where(slope > 0, -planes.offsets[1:4:2], planes.offsets[0:4:2])
    for i in range(4, len(planes.offsets)):
        if planes.normals[i] @ point <= planes.offsets[i] + SLACK:
            continue
        border = _border(i, planes)
        if border is None:
            return None
        point = border.at(border.first if slope @ border.direction > 0 else border.last)
    return point


def least_violating(hard: HalfPlanes, soft: HalfPlanes) -> FloatArray | None:
    """(2,) the point of all hard half-planes whose largest excess over a soft one is smallest, as
    the three-dimensional program of van den Berg et al. finds it; None: no point.

    Args:
        hard: the first four are a `box`.
        soft: with normals of length one.
    """
    point, worst = lowest(np.zeros(2), hard), -np.inf
    if point is None:
        return None
    for i in range(len(soft.offsets)):
        normal, offset = soft.normals[i], soft.offsets[i]
        if normal @ point - offset <= worst + SLACK:
            continue
        # This one is now the worst: where it is least violated, but no other one more.
        others = HalfPlanes(soft.normals[:i] - normal, soft.offsets[:i] - offset)
        better = lowest(normal, hard.and_(others))
        if better is not None:  # there is one, up to rounding
            point = better
        worst = float(normal @ point - offset)
    return point


@dataclass(frozen=True, slots=True, eq=False)
class _Border:
    """The part of a border line, origin + t direction with t from `first` to `last`."""

    origin: FloatArray
    direction: FloatArray
    first: float
    last: float

    def at(self, t: float) -> FloatArray:
        point: FloatArray = self.origin + t * self.direction
        return point


def _border(i: int, planes: HalfPlanes) -> _Border | None:
    """The part of the i-th border inside of the half-planes before it; None: there is none."""
    normal = planes.normals[i]
    length = float(np.hypot(*normal))
    if length < SLACK:
        return None
    origin = normal * (planes.offsets[i] / length**2)
    direction = np.array([-normal[1], normal[0]]) / length
    gain = planes.normals[:i] @ direction
    room = planes.offsets[:i] - planes.normals[:i] @ origin
    parallel = np.abs(gain) < SLACK
    if (room[parallel] < -SLACK).any():
        return None
    gain, room = gain[~parallel], room[~parallel]
    limit = room / gain
    last = float(limit[gain > 0].min(initial=np.inf))
    first = float(limit[gain < 0].max(initial=-np.inf))
    if first > last + SLACK:
        return None
    return _Border(origin, direction, first, max(first, last))
