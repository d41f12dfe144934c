"""What the robot is told by imperfect sensors: noisy, late scans, and a pose that drifts."""

from dataclasses import dataclass, replace
from math import copysign, cos, hypot, pi, sin, sqrt

import numpy as np

from fuzzynav_mj.disturbance import PERFECT, Disturbance
from fuzzynav_mj.geometry import wrap_angle
from fuzzynav_mj.types import LaserScan, Pose2D


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """One reading of the sensors.

    Attributes:
        estimate: where the robot believes it is now.
        scan: the newest scan that has arrived; its stamp tells when it was taken.
        scan_estimate: where the robot believed it was when that scan was taken.
    """

    estimate: Pose2D
    scan: LaserScan | None
    scan_estimate: Pose2D


class Sensors:
    """The sensors of one episode. Without disturbance they pass the truth on as it is.

    The pose estimate is dead reckoning: each period's true motion, in the robot's frame, with
    errors, added to the estimate. It starts at the truth. The errors are
    (a) systematic: every way is measured longer or shorter by the share `drift_distance`, every
        turn by the share `drift_turn_rad` / 2 pi; both signs are drawn once;
    (b) random, Gaussian, of the same size after 1 m and after one turn, and growing with the
        square root of way and turn.
    So after L metres straight the estimate is off by L * `drift_distance`, give or take
    sqrt(L * 1 m) * `drift_distance`.

    Args:
        disturbance: what is wrong with them.
        rng: the episode's sensor stream.

    Attributes:
        disturbance: as given.
    """

    def __init__(self, disturbance: Disturbance, rng: np.random.Generator) -> None:
        self.disturbance = disturbance
        # A stream for each, so that one disturbance does not change what another draws.
        self._noise, self._drops, self._drift = rng.spawn(3)
        way, turn = (copysign(1.0, draw - 0.5) for draw in self._drift.random(2).tolist())
        self._way_error = way * disturbance.drift_distance
        self._turn_error = turn * disturbance.drift_turn_rad / (2 * pi)
        self._truth: Pose2D | None = None
        self._estimate: Pose2D | None = None
        self._held: Look | None = None

    def look(self, truth: Pose2D, scan: LaserScan | None) -> Look:
        """What is known at a decision; call it once per decision.

        Args:
            truth: present pose.
            scan: the true scan of the present state; None for a robot that does not look.
        """
        estimate = self._dead_reckoning(truth)
        now = Look(estimate, None if scan is None else self._spoil(scan), estimate)
        late = self._held if self.disturbance.delay_periods else None
        self._held = now
        # There is no scan before the first, which therefore is seen twice.
        return now if late is None else replace(late, estimate=estimate)

    def target(
        self, truth: Pose2D, look: Look, position: tuple[float, float]
    ) -> tuple[float, float]:
        """Where the wheels take a robot that means to go to `position`, world frame, m.

        The robot drives from where it is as it would have to from where it believes to be.
        """
        if not self.disturbance.drifts:
            return position
        return from_frame(truth, *in_frame(look.estimate, *position))

    def _spoil(self, scan: LaserScan) -> LaserScan:
        disturbance = self.disturbance
        ranges, hit = scan.ranges, scan.hit
        if disturbance.range_noise_m > 0.0:
            noise = self._noise.normal(0.0, disturbance.range_noise_m, len(ranges))
            ranges = np.where(hit, np.maximum(ranges + noise, 0.0), scan.max_range)
            hit = hit & (ranges < scan.max_range)
        if disturbance.dropouts > 0.0:
            hit = hit & (self._drops.random(len(ranges)) >= disturbance.dropouts)
        if hit is scan.hit:
            return scan
        return replace(scan, ranges=np.where(hit, ranges, scan.max_range), hit=hit)

    def _dead_reckoning(self, truth: Pose2D) -> Pose2D:
        before, estimate = self._truth, self._estimate
        self._truth = truth
        if before is None or estimate is None or not self.disturbance.drifts:
            self._estimate = truth
            return truth
        forward, left = in_frame(before, truth.x, truth.y)
        turn = float(wrap_angle(truth.yaw - before.yaw))
        way = hypot(forward, left)
        by_way, by_turn = self._drift.standard_normal(2).tolist()
        scale = 1.0 + self._way_error
        if way > 0.0:
            scale += by_way * self.disturbance.drift_distance / sqrt(way)
        turned = turn * (1.0 + self._turn_error)
        turned += by_turn * self.disturbance.drift_turn_rad * sqrt(abs(turn) / (2 * pi))
        x, y = from_frame(estimate, scale * forward, scale * left)
        self._estimate = Pose2D(x, y, float(wrap_angle(estimate.yaw + turned)))
        return self._estimate


def perfect_sensors() -> Sensors:
    """Sensors that tell the truth at once."""
    return Sensors(PERFECT, np.random.default_rng(0))  # which nothing is drawn from


def in_frame(frame: Pose2D, x: float, y: float) -> tuple[float, float]:
    """The world's point (x, y) as seen from `frame`: forward and left, m."""
    c, s = cos(frame.yaw), sin(frame.yaw)
    dx, dy = x - frame.x, y - frame.y
    return c * dx + s * dy, c * dy - s * dx


def from_frame(frame: Pose2D, forward: float, left: float) -> tuple[float, float]:
    """Inverse of `in_frame`."""
    c, s = cos(frame.yaw), sin(frame.yaw)
    return frame.x + c * forward - s * left, frame.y + s * forward + c * left
