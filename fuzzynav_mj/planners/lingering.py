"""What comes of staying about one place: backing out, waiting no longer for movers, giving up."""

from collections import deque
from math import dist, inf

from fuzzynav_mj.planners.boundary import Point
from fuzzynav_mj.planners.settings import DecisionSettings
from fuzzynav_mj.types import FloatArray, Perception


class Lingering:
    """Where the robot has been for how long, and what kept it there.

    Its memory is of places and times, and of the movers of the last seconds.

    Args:
        settings: times and distances.
    """

    def __init__(self, settings: DecisionSettings) -> None:
        self._settings = settings
        self._anchor: Point | None = None  # the place that the robot stays about ...
        self._since = 0.0  # ... from this time on
        self._way_in: Point | None = None  # the anchor before
        self._mover_seen = -inf
        self._trails: deque[tuple[float, FloatArray]] = deque()
        self._impatient_at: Point | None = None  # where patience ended, until it is back
        self._impatient_since = 0.0
        self._patient_since = -inf

    def note_movers(self, seen: Perception, stamp: float) -> None:
        """Movers are in sight."""
        self._mover_seen = stamp
        self._trails.extend((stamp, mover.points) for mover in seen.obstacles if mover.dynamic)
        self._forget_trails(stamp)

    def mover_seen_within(self, time: float, stamp: float) -> bool:
        """True if a mover was in sight less than this time ago, s."""
        return stamp - self._mover_seen < time

    def trails(self, stamp: float) -> list[FloatArray]:
        """(k, 2) hits of movers, world frame, in each of the last looks."""
        self._forget_trails(stamp)
        return [hits for _, hits in self._trails]

    def _forget_trails(self, stamp: float) -> None:
        """Forgets what is older than the last looks."""
        while self._trails and stamp - self._trails[0][0] > self._settings.trail_time:
            self._trails.popleft()

    def way_out(self, stamp: float) -> Point | None:
        """Where the robot came from, if it has been getting nowhere though nothing moved.

        Askew in the mouth of a narrow gap no single motion helps; backing out and coming again
        does.
        """
        wedged = self._settings.wedged_time
        if self._anchor is None or self.mover_seen_within(wedged, stamp):
            return None
        return self._way_in if stamp - self._since > wedged else None

    def impatient(self, place: Point, stamp: float) -> bool:
        """True while movers count as standing, because they have kept the robot here for long.

        One that goes to and fro on the spot is foreseen to go away again and again. So the robot
        looks for a way around it, until it is well away or has tried for long enough.
        """
        settings = self._settings
        if self._impatient_at is not None:
            here = dist(place, self._impatient_at) <= settings.well_away
            if here and stamp - self._impatient_since <= settings.impatience:
                return True
            self._impatient_at, self._patient_since = None, stamp
        if self._anchor is None or not self.mover_seen_within(settings.wedged_time, stamp):
            return False
        if stamp - max(self._since, self._patient_since) <= settings.patience:
            return False
        self._impatient_at, self._impatient_since = place, stamp
        return True

    def stuck(self, place: Point, stamp: float) -> bool:
        """Notes where the robot is; True if it has been there for too long, whatever moves."""
        settings, anchor = self._settings, self._anchor
        if anchor is None or dist(place, anchor) > settings.stuck_radius:
            self._way_in, self._anchor, self._since = anchor, place, stamp
        return stamp - self._since > settings.stuck_time
