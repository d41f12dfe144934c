"""True gap between the square footprint and whatever it could touch."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import shapely

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.geometry import footprints
from fuzzynav_mj.types import FloatArray, IntArray

if TYPE_CHECKING:
    from fuzzynav_mj.scenarios.world import Shape, World


def clearances(
    poses: FloatArray, mover_positions: FloatArray, world: "World", half_side: float
) -> FloatArray:
    """Exact gap between the square footprint and the nearest obstacle or wall at each pose.

    Args:
        poses: (n, 3) x, y, yaw of the footprint's centre, world frame; finite.
        mover_positions: (n, movers, 2) origins of the moving obstacles, world frame.
        world: its static obstacles, movers' shapes, bounds and walls.
        half_side: half the side of the footprint, m.

    Returns:
        (n,) m; 0 where they touch or overlap, inf where there is nothing to touch.
    """
    gaps = _wall_and_circle_gaps(poses, mover_positions, world, half_side)
    approach = _approach(poses, mover_positions, world, half_side)
    every_step = np.arange(len(poses))
    bounds = approach.lower_bounds(every_step[:, None], np.arange(len(approach.polygons)))
    # From the likeliest polygon of each pose to the least: most rounds have hardly a pose left.
    for nearest in np.argsort(bounds, axis=1).T:
        steps = np.flatnonzero(bounds[every_step, nearest] < gaps)
        if len(steps) == 0:
            break
        gaps[steps] = np.minimum(gaps[steps], approach.gaps(steps, nearest[steps]))
    return gaps


def min_clearance(
    poses: FloatArray,
    mover_positions: FloatArray,
    world: "World",
    half_side: float,
    stride: int = 200,
) -> float:
    """The smallest of `clearances` over all steps, without computing most of them.

    The gap to an obstacle changes by no more than the way that the footprint's points travel
    relative to it. So polygons are measured at every `stride`-th step, and an interval between
    two samples is halved only while that bound lets it hold a smaller gap than the smallest yet.

    Args:
        poses: (n, 3) x, y, yaw at every physics step; steps that are not finite are left out.
        mover_positions: (n, movers, 2) at the same steps.
        world: as in `clearances`.
        half_side: half the side of the footprint, m.
        stride: steps between the first samples; changes the cost, not the result.

    Returns:
        m; 0 where they touched, inf where there is nothing to touch.
    """
    finite = np.isfinite(poses).all(axis=1)
    if not finite.all():
        poses, mover_positions = poses[finite], mover_positions[finite]
    if len(poses) == 0:
        return math.inf
    smallest = float(_wall_and_circle_gaps(poses, mover_positions, world, half_side).min())
    approach = _approach(poses, mover_positions, world, half_side)
    if len(approach.polygons) == 0:
        return smallest
    travelled = approach.travelled()

    marks = np.unique(np.append(np.arange(0, len(poses), stride), len(poses) - 1))
    steps, obstacles = np.meshgrid(marks, np.arange(len(approach.polygons)), indexing="ij")
    gaps, smallest = approach.gaps_below(steps.ravel(), obstacles.ravel(), smallest)
    gaps = gaps.reshape(steps.shape)
    first, last, obstacles = steps[:-1].ravel(), steps[1:].ravel(), obstacles[:-1].ravel()
    gap_first, gap_last = gaps[:-1].ravel(), gaps[1:].ravel()
    while len(first) and smallest > 0.0:
        way = travelled[obstacles, last] - travelled[obstacles, first]
        live = (last - first > 1) & (gap_first + gap_last - way < 2 * smallest)
        first, last, obstacles = first[live], last[live], obstacles[live]
        gap_first, gap_last = gap_first[live], gap_last[live]
        middle = (first + last) // 2
        gap_middle, smallest = approach.gaps_below(middle, obstacles, smallest)
        first, last = np.concatenate([first, middle]), np.concatenate([middle, last])
        gap_first = np.concatenate([gap_first, gap_middle])
        gap_last = np.concatenate([gap_middle, gap_last])
        obstacles = np.tile(obstacles, 2)
    return smallest


@dataclass(frozen=True, slots=True, eq=False)
class _Approach:
    """The footprint's motion as each polygonal obstacle sees it; obstacles do not turn.

    Attributes:
        polygons: (k,) shapely polygons in their own frames.
        mover: (k,) number of the mover that each one is, -1 for those that stand.
        poses: (n, 3) of the footprint, world frame.
        mover_positions: (n, movers, 2) origins of the movers' frames, world frame.
        half_side: m.
    """

    polygons: npt.NDArray[np.object_]
    mover: IntArray
    poses: FloatArray
    mover_positions: FloatArray
    half_side: float

    def centres(self, steps: IntArray, obstacles: IntArray) -> FloatArray:
        """(..., 2) the footprint's centre in the polygons' frames, m, for (...) pairs of both."""
        steps, obstacles = np.broadcast_arrays(steps, obstacles)
        centres = self.poses[steps, :2]
        mover = self.mover[obstacles]
        moves = mover >= 0
        centres[moves] -= self.mover_positions[steps[moves], mover[moves]]
        return centres

    def lower_bounds(self, steps: IntArray, obstacles: IntArray) -> FloatArray:
        """Gaps between the footprint's outer circle and the obstacles' bounding boxes."""
        box = shapely.bounds(self.polygons)[obstacles]
        centre = self.centres(steps, obstacles)
        outside = np.maximum(np.maximum(box[..., :2] - centre, centre - box[..., 2:]), 0.0)
        reach = self.half_side * math.sqrt(2.0)
        return np.maximum(np.hypot(outside[..., 0], outside[..., 1]) - reach, 0.0)

    def gaps(self, steps: IntArray, obstacles: IntArray) -> FloatArray:
        """(p,) exact gaps of p pairs of step and obstacle."""
        poses = np.column_stack([self.centres(steps, obstacles), self.poses[steps, 2]])
        return shapely.distance(self.polygons[obstacles], footprints(poses, self.half_side))

    def gaps_below(
        self, steps: IntArray, obstacles: IntArray, smallest: float
    ) -> tuple[FloatArray, float]:
        """(p,) gaps, or for those that cannot be below `smallest` a lower bound not below it.

        Also returns the new smallest gap.
        """
        gaps = self.lower_bounds(steps, obstacles)
        near = gaps < smallest
        gaps[near] = self.gaps(steps[near], obstacles[near])
        return gaps, float(gaps.min(initial=smallest))

    def travelled(self) -> FloatArray:
        """(k, n) way since the start that no point of the footprint can have exceeded, m."""
        reach = self.half_side * math.sqrt(2.0)
        poses, movers = map(np.ascontiguousarray, (self.poses, self.mover_positions))
        ways = _travelled(poses, movers, reach)
        return ways[self.mover]  # the last row is that of what stands


@compiled
def _travelled(poses: FloatArray, movers: FloatArray, reach: float) -> FloatArray:
    """(movers + 1, n) way of the footprint relative to each mover, and to what stands, m.

    Args:
        poses: (n, 3).
        movers: (n, movers, 2).
        reach: of the footprint from its centre, m.
    """
    count = movers.shape[1]
    ways = np.zeros((count + 1, len(poses)))
    for o in range(count + 1):
        for k in range(1, len(poses)):
            x, y = poses[k, 0], poses[k, 1]
            before_x, before_y = poses[k - 1, 0], poses[k - 1, 1]
            if o < count:
                x, y = x - movers[k, o, 0], y - movers[k, o, 1]
                before_x, before_y = before_x - movers[k - 1, o, 0], before_y - movers[k - 1, o, 1]
            turned = reach * abs(poses[k, 2] - poses[k - 1, 2])
            ways[o, k] = ways[o, k - 1] + (math.hypot(x - before_x, y - before_y) + turned)
    return ways


def _shapes(mover_positions: FloatArray, world: "World") -> Iterator[tuple["Shape", FloatArray]]:
    """Every obstacle's shape with the origins, (n, 2) or (2,), of the frame it is given in."""
    for shape in world.static:
        yield shape, np.zeros(2)
    for index, mover in enumerate(world.movers):
        yield mover.shape, mover_positions[:, index]


def _approach(
    poses: FloatArray, mover_positions: FloatArray, world: "World", half_side: float
) -> _Approach:
    standing = [shape for shape in world.static if shape.circle is None]
    numbers = [i for i, mover in enumerate(world.movers) if mover.shape.circle is None]
    shapes = standing + [world.movers[number].shape for number in numbers]
    polygons = np.array([shape.footprint for shape in shapes], dtype=object)
    shapely.prepare(polygons)
    mover = np.array([-1] * len(standing) + numbers, dtype=np.intp)
    return _Approach(polygons, mover, poses, mover_positions, half_side)


def _wall_and_circle_gaps(
    poses: FloatArray, mover_positions: FloatArray, world: "World", half_side: float
) -> FloatArray:
    """(n,) gaps to the walls and circles, which have closed forms; inf without any."""
    gaps: FloatArray = np.full(len(poses), np.inf)
    cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    if world.scenario.walls:
        x_min, y_min, x_max, y_max = world.scenario.bounds
        reach = half_side * (np.abs(cos) + np.abs(sin))  # of the footprint along either axis
        x, y = poses[:, 0], poses[:, 1]
        gaps = np.minimum.reduce([x - x_min, x_max - x, y - y_min, y_max - y]) - reach
    for shape, origins in _shapes(mover_positions, world):
        if shape.circle is not None:
            centre, radius = shape.circle[:2], shape.circle[2]
            to_centre = origins + np.array(centre) - poses[:, :2]
            ahead = np.abs(cos * to_centre[:, 0] + sin * to_centre[:, 1])
            aside = np.abs(cos * to_centre[:, 1] - sin * to_centre[:, 0])
            outside = np.hypot(np.maximum(ahead - half_side, 0), np.maximum(aside - half_side, 0))
            gaps = np.minimum(gaps, outside - radius)
    return gaps.clip(min=0.0)
