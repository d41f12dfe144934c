"""From a scan to perceived obstacles: what is where, does it move, and how fast.

The memory is a few looks and the tracks of movers in sight: nothing of the world is kept.
"""

from collections import deque
from dataclasses import dataclass
from itertools import pairwise
from math import atan2, hypot, pi

import numpy as np

from fuzzynav_mj.disturbance import PERFECT, Disturbance
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.sensing.claims import NEW, claimed, divide
from fuzzynav_mj.sensing.cleaning import clean_scan
from fuzzynav_mj.sensing.flow import PointFlow, motion_flags, point_flow
from fuzzynav_mj.sensing.looks import Look, take_clean_look, take_look
from fuzzynav_mj.sensing.outline import outlines, whole_ends
from fuzzynav_mj.sensing.registration import outline_of
from fuzzynav_mj.sensing.segmentation import STATIC, Hits, drop_single, gather_hits, split_by_motion
from fuzzynav_mj.sensing.splitting import OverlapCutter
from fuzzynav_mj.sensing.tracking import FORGET_AFTER, Beliefs, Track, expected_outlines
from fuzzynav_mj.sensing.visibility import visibility_matrix
from fuzzynav_mj.types import FloatArray, IntArray, LaserScan, PerceivedObstacle, Perception, Pose2D


@dataclass(frozen=True, slots=True)
class PerceptionSettings:
    """What is believed of movers and of the sensor.

    Attributes:
        looks: how many looks back the longer comparison reaches.
        still: a surface that moved less than this between the compared looks stands still, m.
        margin: how far inside former free space a hit must lie to count as intruding, m.
        top_speed: the fastest motion believed, m/s.
        flow_sigma: uncertainty of one hit's surface motion, m.
        independent_hits: hits on one obstacle beyond this number tell nothing new.
        outlier: deviation from the obstacle's motion at which a hit counts half, m/s.
        outline_sigma: uncertainty of the place of a visible outline's end, m.
        slowest: movers below this speed count as static, m/s.
        mover_extent: the largest extent believed of a mover's visible side, m.
        certainty: standard deviations of noise beyond `still` that show motion.
        significance: standard deviations by which a mover's speed must differ from none.
    """

    looks: int = 2
    still: float = 0.010
    margin: float = 0.05
    top_speed: float = 0.9
    flow_sigma: float = 0.003
    independent_hits: float = 6.0
    outlier: float = 0.06
    outline_sigma: float = 0.03
    slowest: float = 0.04
    mover_extent: float = 0.7
    certainty: float = 2.0
    significance: float = 1.0


JOIN = 0.06
DEFAULT_SETTINGS = PerceptionSettings()


class Perceiver:
    """Turns one scan after the other into perceived obstacles.

    Args:
        spec: the robot's parameters.
        settings: what is believed of movers and of the sensor.
        sensor: the noise and the missing rays that its maker states.
    """

    def __init__(
        self,
        spec: RobotSpec,
        settings: PerceptionSettings = DEFAULT_SETTINGS,
        sensor: Disturbance = PERFECT,
    ) -> None:
        self._spec = spec
        self._settings = settings
        self._noise = sensor.range_noise_m
        self._unreliable = sensor.range_noise_m > 0.0 or sensor.dropouts > 0.0
        self._looks: deque[Look] = deque(maxlen=settings.looks)
        self._tracks: list[Track] = []
        self._cutter = OverlapCutter(settings.looks)
        self._beliefs = Beliefs(
            settings.flow_sigma,
            self._noise,
            settings.independent_hits,
            settings.outlier,
            settings.outline_sigma,
        )

    def perceive(self, scan: LaserScan, pose: Pose2D) -> Perception:
        """What this scan shows, in the light of the looks before it."""
        if self._unreliable:
            clean = clean_scan(scan, self._noise)
            scan = clean.scan
            now = take_clean_look(clean, pose) if self._noise > 0.0 else take_look(scan, pose)
        else:
            now = take_look(scan, pose)
        previous = self._looks[-1] if self._looks else None
        visibility = visibility_matrix(now, previous, scan.bearings, self._spec.rings)
        hits = gather_hits(now)
        settings = self._settings
        flow = point_flow(
            hits, now, self._looks, settings.top_speed, settings.margin, self._spec.sensor_range
        )
        flags = motion_flags(flow, settings.still, settings.certainty)
        if self._unreliable:
            flags = drop_single(hits.first, flags)
        if previous is not None:
            for track in self._tracks:
                track.predict(now.stamp - previous.stamp)
        expected = expected_outlines(self._tracks)
        elapsed = float(flow.elapsed[0]) if len(flow.elapsed) else 0.0
        owners = claimed(hits, flags, expected, elapsed, settings.still)
        bounds, kinds = divide(
            hits, flags, owners, flow, expected.velocity, expected.centre, now, settings.mover_extent
        )
        bounds, kinds = self._cutter.cut(hits, bounds, kinds, flow, now)
        obstacles = self._obstacles(hits, bounds, kinds, flags, now)
        self._tracks = [track for track in self._tracks if track.missed <= FORGET_AFTER]
        self._looks.append(now)
        return Perception(scan, obstacles, visibility)

    def _obstacles(
        self, hits: Hits, bounds: IntArray, kinds: IntArray, flags: IntArray, now: Look
    ) -> tuple[PerceivedObstacle, ...]:
        owners = np.repeat(kinds, np.diff(bounds))
        fresh = bounds[:-1]
        for number, track in enumerate(list(self._tracks)):
            chosen = (owners == number).nonzero()[0]
            if len(chosen):
                stray = self._follow(track, chosen, hits, now)
                owners[chosen[stray]] = NEW
        first = np.zeros(len(owners), dtype=bool)
        first[fresh] = True
        first[1:] |= owners[1:] != owners[:-1]
        bounds = np.append(first.nonzero()[0], len(owners))
        kinds = owners[bounds[:-1]]
        found = outlines(hits, bounds, now)
        spans, nearest, kind = list(pairwise(bounds.tolist())), found.nearest.tolist(), kinds.tolist()
        known = list(self._tracks)
        tracks: list[Track | None] = [None] * len(spans)
        for k, (first, end) in enumerate(spans):
            track = known[kind[k]] if kind[k] >= 0 else None
            if kind[k] == NEW and end - first >= 2:
                track = Track.begin(found.middles[k])
                self._look_back(track, hits.points[:, first:end])
                self._tracks.append(track)
                chosen = np.arange(first, end)
                moves = flags[chosen] != STATIC
                self._follow(track, chosen[moves] if moves.sum() >= 2 else chosen, hits, now)
            tracks[k] = track if track is not None and self._is_mover(track) else None
        self._join(spans, tracks, hits)
        return tuple(
            _perceived(hits.points[:, first:end].T, hits.points[:, hit], now, track)
            for (first, end), hit, track in zip(spans, nearest, tracks, strict=True)
        )

    def _follow(self, track: Track, chosen: IntArray, hits: Hits, now: Look) -> np.ndarray:
        """Which of the chosen hits the track does not explain."""
        seen = outline_of(hits, chosen, whole_ends(hits, chosen, now), now)
        new = track.missed > 0 and len(track.outlines) > 0 and track.settled
        track.take_in(seen, seen.points.mean(axis=1), now, self._beliefs)
        stray = np.zeros(len(chosen), dtype=bool)
        if new:
            stray = track.strays(seen, self._beliefs)
            if stray.any() and (~stray).sum() >= 2:
                rest = chosen[~stray]
                seen = outline_of(hits, rest, whole_ends(hits, rest, now), now)
            else:
                stray[:] = False
        track.settled = True
        track.outlines.append(seen)
        return stray

    def _join(self, spans, tracks, hits) -> None:
        for k in range(1, len(spans)):
            a, b = tracks[k - 1], tracks[k]
            if a is None or b is None or a is b or hits.first[spans[k][0]]:
                continue
            if hypot(*(a.velocity - b.velocity).tolist()) < JOIN and b in self._tracks and a in self._tracks:
                drop = a if a.looks < b.looks else b
                self._tracks = [t for t in self._tracks if t is not drop]

    def _look_back(self, track: Track, points: FloatArray) -> None:
        middle = points.mean(axis=1)
        for look in self._looks:
            x, y = look.points[0]-middle[0], look.points[1]-middle[1]
            rays = (look.hit & (x*x+y*y < 0.35**2)).nonzero()[0]
            before = Hits(look.points[:, rays].copy(), rays, np.zeros(len(rays), dtype=bool))
            track.outlines.append(outline_of(before, np.arange(len(rays)), np.full((2, 2), np.nan), look))

    def _is_mover(self, track: Track) -> bool:
        settings = self._settings
        if track.speed < settings.slowest or track.speed > settings.top_speed:
            return False
        return self._noise == 0.0 or track.moves_for_certain(settings.significance)


def _perceived(
    points: FloatArray, nearest: FloatArray, now: Look, track: Track | None
) -> PerceivedObstacle:
    """An obstacle of these points (k, 2), the nearest of which is given (2,)."""
    x, y = nearest.tolist()
    x, y = x - now.x, y - now.y
    distance = hypot(x, y)
    bearing = (atan2(y, x) - now.yaw + pi) % (2 * pi) - pi
    if track is None:
        return PerceivedObstacle(
            points=points,
            nearest_point=nearest,
            distance=distance,
            bearing=bearing,
            dynamic=False,
            approaching=False,
            velocity=np.zeros(2),
        )
    velocity, reach = track.velocity, max(distance, 1e-9)
    return PerceivedObstacle(
        points=points,
        nearest_point=nearest,
        distance=distance,
        bearing=bearing,
        dynamic=True,
        approaching=float(velocity[0] * x + velocity[1] * y) < 0.0,
        velocity=velocity,
        turn_rate=track.turn_rate,
        closing_sigma=track.sigma_along(x / reach, y / reach),
    )
