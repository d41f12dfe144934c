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
from fuzzynav_mj.sensing.cleaning import clean_scan
from fuzzynav_mj.sensing.flow import PointFlow, motion_flags, point_flow
from fuzzynav_mj.sensing.looks import Look, take_clean_look, take_look
from fuzzynav_mj.sensing.outline import Outlines, outlines
from fuzzynav_mj.sensing.segmentation import MOVING, Hits, drop_single, gather_hits, split_by_motion
from fuzzynav_mj.sensing.splitting import OverlapCutter
from fuzzynav_mj.sensing.tracking import FORGET_AFTER, Beliefs, Track, nearest_track
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
    flow_sigma: float = 0.006
    independent_hits: float = 6.0
    outlier: float = 0.06
    outline_sigma: float = 0.017
    slowest: float = 0.04
    mover_extent: float = 0.7
    certainty: float = 2.0
    significance: float = 1.0


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
        expected = np.array([track.centre for track in self._tracks]).reshape(-1, 2)
        bounds, flags = split_by_motion(hits, flags, expected, settings.mover_extent)
        bounds, flags = self._cutter.cut(hits, bounds, flags, flow, now)
        obstacles = self._obstacles(hits, bounds, flags, flow, now)
        self._tracks = [track for track in self._tracks if track.missed <= FORGET_AFTER]
        self._looks.append(now)
        return Perception(scan, obstacles, visibility)

    def _obstacles(
        self, hits: Hits, bounds: IntArray, flags: IntArray, flow: PointFlow, now: Look
    ) -> tuple[PerceivedObstacle, ...]:
        found = outlines(hits, bounds, now)
        tracks = self._follow(hits, bounds, flags, flow, found, now)
        spans, nearest = pairwise(bounds.tolist()), found.nearest.tolist()
        return tuple(
            _perceived(hits.points[:, first:end].T, hits.points[:, hit], now, track)
            for (first, end), hit, track in zip(spans, nearest, tracks, strict=True)
        )

    def _follow(
        self,
        hits: Hits,
        bounds: IntArray,
        flags: IntArray,
        flow: PointFlow,
        found: Outlines,
        now: Look,
    ) -> list[Track | None]:
        """The updated tracks of the obstacles; None for those that stand still."""
        tracks: list[Track | None] = [None] * len(flags)
        kinds, spans = flags.tolist(), list(pairwise(bounds.tolist()))
        if not self._tracks and MOVING not in kinds:
            return tracks
        # Moving ones take the tracks first, and of those the ones with the most hits.
        for index in sorted(
            range(len(spans)), key=lambda k: (-kinds[k], spans[k][0] - spans[k][1])
        ):
            first, end = spans[index]
            moving = kinds[index] == MOVING
            track = self._matched(hits.points[:, first:end], found.middles[index], moving)
            if track is not None:
                ends = found.ends[index]
                track.take_in(flow, (first, end), found.middles[index], ends, now, self._beliefs)
                tracks[index] = track if self._is_mover(track) else None
        return tracks

    def _matched(self, points: FloatArray, middle: FloatArray, moving: bool) -> Track | None:
        """The track of an obstacle with these hits (2, k); None if it is believed to stand."""
        if not moving:
            x, y = (points[:, -1] - points[:, 0]).tolist()
            if not self._tracks or hypot(x, y) > self._settings.mover_extent:
                return None
        track = nearest_track(self._tracks, middle)
        if track is None and moving and points.shape[1] >= 2:
            track = Track.begin(middle)
            self._tracks.append(track)
        return track

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
