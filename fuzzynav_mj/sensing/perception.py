"""From a scan to perceived obstacles: what is where, does it move, and how fast.

The memory is a few looks and the tracks of movers in sight: nothing of the world is kept.
"""

from collections import deque
from dataclasses import dataclass
from itertools import pairwise
from math import hypot

import numpy as np

from fuzzynav_mj.disturbance import PERFECT, Disturbance
from fuzzynav_mj.robot import RobotSpec
from fuzzynav_mj.sensing.cleaning import clean_scan
from fuzzynav_mj.sensing.evidence import Evidence
from fuzzynav_mj.sensing.expected import expected_outlines
from fuzzynav_mj.sensing.free_space import LOOKS, FreeSpace
from fuzzynav_mj.sensing.hidden import hidden_part
from fuzzynav_mj.sensing.looks import Look, take_clean_look, take_look
from fuzzynav_mj.sensing.outline import outline_around, outline_of
from fuzzynav_mj.sensing.ownership import Owned, owners_of
from fuzzynav_mj.sensing.perceived import perceived
from fuzzynav_mj.sensing.segmentation import NEW, STATIC, Hits, owners_anew, run_bounds
from fuzzynav_mj.sensing.tracking import FORGET_AFTER, Track
from fuzzynav_mj.sensing.uniting import absorb, are_one
from fuzzynav_mj.sensing.velocity_filter import Beliefs
from fuzzynav_mj.sensing.visibility import visibility_matrix
from fuzzynav_mj.types import (
    BoolArray,
    IntArray,
    LaserScan,
    PerceivedObstacle,
    Perception,
    Pose2D,
)

SETTLED = 4  # looks after which a track is more than a guess
TURNED_OFF = 0.15  # m from where it should be within which a mover that has turned is looked for
GONE = 0.3  # share of an outline seen to be free that shows that the mover went elsewhere


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
        unsure: uncertainty of a speed above which what newly moves is no slow mover yet, m/s.
    """

    looks: int = 2
    still: float = 0.010
    margin: float = 0.05
    top_speed: float = 0.9
    flow_sigma: float = 0.0003
    independent_hits: float = 6.0
    outlier: float = 0.06
    outline_sigma: float = 0.03
    slowest: float = 0.04
    mover_extent: float = 0.7
    certainty: float = 2.0
    significance: float = 1.0
    unsure: float = 0.18


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
        self._looks: deque[tuple[Look, BoolArray]] = deque(maxlen=max(LOOKS, settings.looks))
        self._tracks: list[Track] = []
        self._evidence = Evidence(
            settings.top_speed,
            settings.margin,
            spec.sensor_range,
            settings.still,
            settings.certainty,
            self._noise,
            self._unreliable,
            settings.mover_extent,
        )
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
        past = [look for look, _ in self._looks]
        earlier = past[-self._settings.looks :]
        previous = earlier[-1] if earlier else None
        visibility = visibility_matrix(now, previous, scan.bearings, self._spec.rings)
        since = 0.0 if previous is None else now.stamp - previous.stamp
        for track in self._tracks:
            track.predict(since)
        expected = expected_outlines(self._tracks, 2.0 * self._noise)
        compared: tuple[Look, ...] = (earlier[0], earlier[-1]) if earlier else (now, now)
        if self._unreliable:
            # The looks before the compared ones, as far as they are kept, or else the oldest one.
            compared += (past[0], past[max(len(past) - 3, 0)]) if past else (now, now)
        owned = owners_of(now, compared, min(len(earlier), 2), expected, self._evidence)
        obstacles = self._obstacles(owned, now) + self._hidden(now)
        self._tracks = [track for track in self._tracks if track.missed <= FORGET_AFTER]
        return Perception(scan, obstacles, visibility)

    def _obstacles(self, owned: Owned, now: Look) -> tuple[PerceivedObstacle, ...]:
        """What the hits belong to; takes them in."""
        hits, flags, owners = owned
        known = list(self._tracks)
        space = FreeSpace(now, [look for look, _ in self._looks], self._noise)
        for number, track in enumerate(known):
            chosen = (owners == number).nonzero()[0]
            if len(chosen):
                others = track.take_in(outline_of(hits, chosen, now), space, self._beliefs)
                if others.any():
                    owners[chosen[others]] = owners_anew(hits, flags, chosen[others])
        lost = [track for track in known if track.missed == 1 and track.seen >= 2]
        taken = np.zeros(len(now.ranges), dtype=bool)
        taken[hits.rays[owners >= 0]] = True
        bounds = run_bounds(hits.first, owners)
        spans = list(pairwise(bounds.tolist()))
        tracks: list[Track | None] = [None] * len(spans)
        for index, (first, end) in enumerate(spans):
            owner = int(owners[first])
            if owner >= 0:
                tracks[index] = known[owner]
            elif owner == NEW and end - first >= 2:
                chosen = np.arange(first, end)
                tracks[index] = self._found_again(lost, chosen, hits, taken, space)
                if tracks[index] is None:
                    tracks[index] = self._begin(chosen, hits, flags, taken, space)
        self._looks.append((now, taken))
        self._unite(spans, tracks, hits)
        points = np.ascontiguousarray(hits.points.T)
        return tuple(
            perceived(
                points[first:end],
                now,
                track if self._moves(track) else None,
                self._noise,
            )
            for (first, end), track in zip(spans, tracks, strict=True)
        )

    def _found_again(
        self,
        lost: list[Track],
        chosen: IntArray,
        hits: Hits,
        taken: BoolArray,
        space: FreeSpace,
    ) -> Track | None:
        """That of the lost tracks whose mover has turned at once, to be where some hits are."""
        if not lost:
            return None
        outline = outline_of(hits, chosen, space.now)
        x, y = outline.points.mean(axis=1).tolist()
        for track in lost:
            if hypot(x - track.centre[0], y - track.centre[1]) >= TURNED_OFF:
                continue
            if track.turn(outline, space, self._beliefs) is not None:
                lost.remove(track)
                taken[hits.rays[chosen]] = True
                return track
        return None

    def _begin(
        self, chosen: IntArray, hits: Hits, flags: IntArray, taken: BoolArray, space: FreeSpace
    ) -> Track:
        """Begins a track of some hits, in the light of what was seen about their place before."""
        shown = chosen[flags[chosen] != STATIC]
        chosen = shown if len(shown) >= 2 else chosen
        centre = hits.points[:, chosen].mean(axis=1)
        x, y = centre.tolist()
        extent = self._settings.mover_extent / 2
        recent = list(self._looks)[-self._settings.looks :]
        before = [outline_around(look, others, x, y, extent) for look, others in recent]
        elapsed = space.now.stamp - before[-1].stamp if before else 0.0
        track = Track.begin(centre, before, elapsed)
        track.take_in(outline_of(hits, chosen, space.now), space, self._beliefs)
        self._tracks.append(track)
        taken[hits.rays[chosen]] = True
        return track

    def _unite(self, spans: list[tuple[int, int]], tracks: list[Track | None], hits: Hits) -> None:
        """Makes one track of two that are faces of one mover."""
        for index in range(1, len(spans)):
            one, other = tracks[index - 1], tracks[index]
            beside = not hits.first[spans[index][0]]
            if one is None or other is None or one is other or not beside:
                continue
            if min(one.seen, other.seen) >= SETTLED and are_one(one, other):
                absorb(one, other)
                self._tracks.remove(other)
                tracks[:] = [one if track is other else track for track in tracks]

    def _hidden(self, now: Look) -> tuple[PerceivedObstacle, ...]:
        """Known movers, or parts of them, that something nearer hides; forgets those that should
        be in sight but are not."""
        found = []
        for track in list(self._tracks):
            if track.seen < SETTLED or not track.partly_hidden or not self._moves(track):
                continue
            outline = track.expected_outline
            unseen = track.missed > 0
            points, free = hidden_part(outline, now, self._spec.sensor_range, unseen)
            if unseen and free > GONE * outline.shape[1]:
                self._tracks.remove(track)
            elif len(points) >= 2:
                found.append(perceived(points, now, track, self._noise))
        return tuple(found)

    def _moves(self, track: Track | None) -> bool:
        """True if a track is a mover's, as far as can be told."""
        settings = self._settings
        if track is None:
            return False
        if track.seen < SETTLED and track.speed_sigma > settings.unsure:
            return True
        if not settings.slowest <= track.speed <= settings.top_speed:
            return False
        return self._noise == 0.0 or track.moves_for_certain(settings.significance)
