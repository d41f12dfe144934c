"""From a scan to perceived obstacles: what is where, does it move, and how fast.

The memory is a few looks and the tracks of movers in sight: nothing of the world is kept.
"""

from collections import deque
from dataclasses import dataclass
from math import atan2, hypot, pi

import numpy as np

from fuzzynav_mj.disturbance import PERFECT, Disturbance
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.sensing.cleaning import clean_scan
from fuzzynav_mj.sensing.flow import PointFlow, point_flow
from fuzzynav_mj.sensing.looks import Look, take_clean_look, take_look
from fuzzynav_mj.sensing.outline import end_rates, outline_ends
from fuzzynav_mj.sensing.segmentation import (
    MOVING,
    STATIC,
    UNKNOWN,
    Hits,
    drop_single,
    gather_hits,
    split_by_motion,
)
from fuzzynav_mj.sensing.splitting import OverlapCutter
from fuzzynav_mj.sensing.tracking import FORGET_AFTER, Track, nearest_track, speed_rows
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
        flows = self._flows(hits.rays, now)
        flags = self._point_flags(hits.points, flows)
        if self._unreliable:
            flags = drop_single(hits.first, flags)
        if previous is not None:
            for track in self._tracks:
                track.predict(now.stamp - previous.stamp)
        expected = np.array([track.centre for track in self._tracks]).reshape(-1, 2)
        begin, flags = split_by_motion(hits, flags, expected, self._settings.mover_extent)
        begin, flags = self._cutter.cut(hits, begin, flags, flows, now)
        obstacles = self._obstacles(hits, begin, flags, flows, now)
        self._tracks = [track for track in self._tracks if track.missed <= FORGET_AFTER]
        self._looks.append(now)
        return Perception(scan, obstacles, visibility)

    def _flows(self, rays: IntArray, now: Look) -> list[PointFlow]:
        """Flow against the oldest and the newest remembered look, the longer first."""
        looks = [self._looks[0], self._looks[-1]] if len(self._looks) > 1 else list(self._looks)
        settings = self._settings
        return [
            point_flow(
                rays, now, look, settings.top_speed, settings.margin, self._spec.sensor_range
            )
            for look in looks
        ]

    def _point_flags(self, points: FloatArray, flows: list[PointFlow]) -> IntArray:
        """(m,) whether each hit moves, as far as it can be told."""
        flags = np.full(len(points), UNKNOWN)
        for flow in reversed(flows):  # the longer comparison has the last word
            still: FloatArray | float = self._settings.still
            if flow.sigma is not None:
                still = still + self._settings.certainty * flow.sigma
            moved = np.where(np.abs(flow.distance) > still, MOVING, STATIC)
            flags = np.where(flow.known, moved, flags)
        for flow in flows:
            flags = np.where(flow.intruding, MOVING, flags)
        return flags

    def _obstacles(
        self,
        hits: Hits,
        begin: IntArray,
        flags: IntArray,
        flows: list[PointFlow],
        now: Look,
    ) -> tuple[PerceivedObstacle, ...]:
        ends = np.append(begin, len(hits.points))[1:]
        spans = [slice(a, b) for a, b in zip(begin.tolist(), ends.tolist(), strict=True)]
        tracks: list[Track | None] = [None] * len(spans)
        # Moving ones take the tracks first, and of those the ones with the most hits.
        for index in np.lexsort((begin - ends, -flags)).tolist():
            moving = bool(flags[index] == MOVING)
            tracks[index] = self._track(hits, spans[index], flows, moving, now)
        offsets = hits.points.T - np.array([[now.pose.x], [now.pose.y]])
        squared = offsets[0] ** 2 + offsets[1] ** 2
        nearest = [span.start + int(squared[span].argmin()) for span in spans]
        return tuple(
            _perceived(hits.points[span], hits.points[hit], offsets[:, hit], track, now.pose.yaw)
            for span, hit, track in zip(spans, nearest, tracks, strict=True)
        )

    def _track(
        self, hits: Hits, span: slice, flows: list[PointFlow], moving: bool, now: Look
    ) -> Track | None:
        """The updated track of one obstacle; None if it stands still."""
        settings, points = self._settings, hits.points[span]
        if not moving and not self._tracks:
            return None
        if not moving and hypot(*(points[-1] - points[0]).tolist()) > settings.mover_extent:
            return None
        centre = points.mean(axis=0)
        track = nearest_track(self._tracks, centre)
        if track is None:
            if not moving or len(points) < 2:
                return None
            track = Track.begin(centre)
            self._tracks.append(track)
        prior = track.information
        rows, rates = self._surface_motion(span, flows, track, prior)
        ends = outline_ends(hits, span, now)
        if track.outlines:
            row, rate = self._outline_motion(now, ends, track)
            rows, rates = np.concatenate((rows, row)), np.concatenate((rates, rate))
        track.outlines.append((now.stamp, ends))
        track.update(centre, prior, rows, rates)
        if track.speed < settings.slowest or track.speed > settings.top_speed:
            return None
        if self._noise > 0.0 and not track.moves_for_certain(settings.significance):
            return None
        return track

    def _surface_motion(
        self, span: slice, flows: list[PointFlow], track: Track, prior: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Measurement rows and rates of the normal motions of the hits, over their sigma."""
        settings = self._settings
        known = [span.start + flow.known[span].nonzero()[0] for flow in flows]
        pairs = list(zip(flows, known, strict=True))
        elapsed = np.array([flow.elapsed for flow in flows]).repeat([len(hit) for hit in known])
        rate = np.concatenate([flow.distance.take(hit) for flow, hit in pairs]) / elapsed
        normals = np.concatenate([flow.normals.T.take(hit, axis=1) for flow, hit in pairs], axis=1)
        rows = speed_rows(np.ascontiguousarray(normals.T), elapsed)
        # Smoothing spreads one hit's noise over its neighbours, so all that the hits tell together
        # is limited by the raw noise over their number.
        count = max(len(rate), 1)
        variance = settings.flow_sigma**2 * max(1.0, count / settings.independent_hits)
        weight = elapsed**2 / (variance + 2.0 * self._noise**2)
        # Some hits are compared with another face, or another obstacle, than their own. They count
        # less: first those that contradict what is known of the mover, then those that
        # contradict the fit to the rest.
        spread = settings.outlier**2 + ((rows @ track.covariance) * rows).sum(axis=1)
        trusted = weight / (1.0 + (rate - rows @ track.state) ** 2 / spread)
        scaled = rows.T * trusted
        state = np.linalg.solve(prior + scaled @ rows, prior @ track.state + scaled @ rate)
        weight /= 1.0 + ((rows @ state - rate) / settings.outlier) ** 2
        root = np.sqrt(weight)
        return rows * root[:, None], rate * root

    def _outline_motion(
        self, now: Look, ends: FloatArray, track: Track
    ) -> tuple[FloatArray, FloatArray]:
        """The same for the shift of the visible outline's ends across the line of sight."""
        stamp, before = track.outlines[0]
        elapsed = now.stamp - stamp
        across, rates = end_rates(ends, before, elapsed, now)
        root = elapsed / self._settings.outline_sigma
        return speed_rows(across, np.full(len(rates), elapsed)) * root, rates * root


def _perceived(
    points: FloatArray, nearest: FloatArray, offset: FloatArray, track: Track | None, yaw: float
) -> PerceivedObstacle:
    """An obstacle of these points, the nearest of which lies off the robot by `offset` (2,)."""
    x, y = offset.tolist()
    distance = hypot(x, y)
    bearing = (atan2(y, x) - yaw + pi) % (2 * pi) - pi
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
    velocity = track.velocity
    return PerceivedObstacle(
        points=points,
        nearest_point=nearest,
        distance=distance,
        bearing=bearing,
        dynamic=True,
        approaching=float(velocity[0] * x + velocity[1] * y) < 0.0,
        velocity=velocity,
        turn_rate=track.turn_rate,
        closing_sigma=track.sigma_along(offset / max(distance, 1e-9)),
    )
