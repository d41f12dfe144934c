"""What free space tells of a mover's motion: where rays went by unhindered, it was not.

A flat side does not show how it moves along itself, and its ends are known no better than the rays
beside them are apart. But its outline of now, carried back, must not lie across a ray that went by
earlier, nor an earlier outline, carried onward, across a ray of now. Velocities for which one would
are ruled out, and what several looks leave open together is far less than any two of them. So even
the first look at a mover tells how fast it must be to have come into view.

If the velocity that is believed is ruled out itself, the outline is that of two movers, which no
common motion explains.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, ceil, cos, exp, floor, inf, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.looks import Look, ray_number
from fuzzynav_mj.sensing.outline import Outline, convex_parts
from fuzzynav_mj.sensing.velocity_filter import LARGEST_ACCELERATION, gone_since
from fuzzynav_mj.types import BoolArray, FloatArray

LOOKS = 4  # earlier looks whose free space counts
KNOWN = 0.08  # m/s: a smaller uncertainty of a velocity is left as it is
SPAN = 2.5  # standard deviations within which velocities are tried ...
TRIED = 21  # ... so many of them, along each axis
FREE = 0.015  # m: a ray went by if it reached this much farther; ...
CONTRADICTION = 0.03  # ... this much, to put what is believed in doubt; besides ...
FREE_NOISE = 3.0  # ... so many standard deviations of the ranges
TURNING = 0.5  # m/s2: what a mover may have turned by since then, unnoticed
SURPRISE = 0.3  # share of what newer looks leave open that an older one must leave, to be believed
RECENT = 2  # looks that may contradict a belief: over more a mover may have turned


class _Frame(NamedTuple):
    """The velocities to try, more or less than the one believed: a grid along the axes of its
    uncertainty.

    Attributes:
        x, y: the axis of the largest uncertainty; the other one is (-y, x).
        most, least: standard deviations along them, m/s.
        steps: how many are tried along the first ...
        side_steps: ... and along the other axis; one where little is uncertain.
    """

    x: float
    y: float
    most: float
    least: float
    steps: int
    side_steps: int


@dataclass(frozen=True, slots=True, eq=False)
class FreeSpace:
    """A look, and the free space of some before it.

    Attributes:
        now: the look.
        past: earlier ones, the newest last; the last `LOOKS` of them count.
        noise: standard deviation of their ranges, m.
    """

    now: Look
    past: Sequence[Look] = ()
    noise: float = 0.0

    def narrow(
        self,
        state: FloatArray,
        covariance: FloatArray,
        outline: Outline,
        before: Sequence[Outline],
        since: float = -inf,
    ) -> tuple[FloatArray, FloatArray]:
        """State (4,) and covariance (4, 4), as in velocity_filter.py, without the velocities that
        are ruled out; as they are where all are, or none.

        A mover that has turned at once was elsewhere before: an older look that leaves next to
        nothing of what newer ones left open is not believed, nor are those before it.

        Args:
            state, covariance: of the mover.
            outline: of the mover, now.
            before: its outlines in earlier looks.
            since: stamp of the first look since which it may have moved like this, s.
        """
        frame = _frame(covariance)
        if frame.steps * frame.side_steps == 1:
            return state, covariance
        places, tried, likely = _grid(frame)
        ruled_out = np.zeros(len(tried), dtype=np.bool_)
        looks = [look for look in reversed(self.past[-LOOKS:]) if look.stamp >= since]
        earlier = [(outline, look) for look in looks]
        onward = [(shown, self.now) for shown in reversed(before)]
        for pairs in (earlier, onward):
            for number, (shown, look) in enumerate(pairs):
                margin, older = self._margin(look.stamp - shown.stamp), number > 0
                if not _rule_out(ruled_out, likely, shown, state, tried, look, margin, older):
                    break
        if ruled_out.all() or not ruled_out.any():
            return state, covariance
        return _without(state, covariance, frame, places, np.where(ruled_out, 0.0, likely), likely)

    def contradicts(self, state: FloatArray, outline: Outline, last: Outline) -> bool:
        """True if a mover of this state (4,), with an outline of one part, would have been where
        rays went by in the last look, or its outline of then would be where they do now; and
        whichever way it had changed its velocity in a bend, too."""
        if not self.past or convex_parts(outline)[-1] > 0:
            return False
        change = LARGEST_ACCELERATION * (outline.stamp - last.stamp)
        tried = change * np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
        back = _across(outline, state, tried, self.past[-1], self._contradiction, False)
        onward = _across(last, state, tried, self.now, self._contradiction, False)
        return bool((back.any(axis=1) | onward.any(axis=1)).all())

    def strangers(
        self, state: FloatArray, outline: Outline, before: Sequence[Outline]
    ) -> tuple[BoolArray, bool]:
        """(k,) True for hits of an outline that are not the mover's, and whether the motion of what
        is left has to be learnt anew. The arguments are those of `narrow`.

        Of the outline's parts (`convex_parts`) those that contradict what is believed are not the
        mover's. If the largest does, too, or the contradiction is in what should be seen now and is
        not, then the belief is wrong, and only the largest part is kept. An outline of one part
        belongs to one mover, which began to turn.
        """
        part = convex_parts(outline)
        across = np.zeros(len(part), dtype=bool)
        if part[-1] == 0:
            return across, False
        margin, believed = self._contradiction, np.zeros((1, 2))
        for look in self.past[-RECENT:]:
            across |= _across(outline, state, believed, look, margin, True)[0]
        unseen = any(
            _across(earlier, state, believed, self.now, margin, False).any() for earlier in before
        )
        if not unseen and not across.any():
            return across, False
        largest = int(np.bincount(part).argmax())
        contradicting = np.unique(part[across])
        if len(contradicting) == 0 or largest in contradicting:
            return part != largest, True
        return np.isin(part, contradicting), False

    @property
    def _contradiction(self) -> float:
        """By how much farther a ray must have reached to put what is believed in doubt, m."""
        return CONTRADICTION + FREE_NOISE * self.noise

    def _margin(self, elapsed: float) -> float:
        """By how much farther a ray must have reached, so long ago, to rule anything out, m."""
        return FREE + FREE_NOISE * self.noise + TURNING / 2 * elapsed**2


@compiled
def _frame(covariance: FloatArray) -> _Frame:
    """The frame of a state's covariance (4, 4)."""
    xx, xy, yy = covariance[0, 0], covariance[0, 1], covariance[1, 1]
    angle = atan2(2.0 * xy, xx - yy) / 2.0
    x, y = cos(angle), sin(angle)
    most = sqrt(max(xx * x * x + 2.0 * xy * x * y + yy * y * y, 0.0))
    least = sqrt(max(xx * y * y - 2.0 * xy * x * y + yy * x * x, 0.0))
    steps = TRIED if most > KNOWN else 1
    return _Frame(x, y, most, least, steps, TRIED if least > KNOWN else 1)


@compiled
def _place(number: int, steps: int) -> float:
    """Place on an axis, in standard deviations, of one of so many steps."""
    return SPAN * (2.0 * number / (steps - 1) - 1.0) if steps > 1 else 0.0


@compiled
def _grid(frame: _Frame) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The velocities of a frame: (h, 2) places on its axes, in standard deviations, (h, 2) m/s more
    than the one believed, and (h,) how likely each is, next to it."""
    count = frame.steps * frame.side_steps
    places, tried, likely = np.empty((count, 2)), np.empty((count, 2)), np.empty(count)
    for k in range(count):
        a = _place(k // frame.side_steps, frame.steps)
        b = _place(k % frame.side_steps, frame.side_steps)
        along, aside = frame.most * a, frame.least * b
        places[k, 0], places[k, 1] = a, b
        tried[k, 0] = along * frame.x - aside * frame.y
        tried[k, 1] = along * frame.y + aside * frame.x
        likely[k] = exp(-0.5 * (a * a + b * b))
    return places, tried, likely


@compiled
def _without(
    state: FloatArray,
    covariance: FloatArray,
    frame: _Frame,
    places: FloatArray,
    open_: FloatArray,
    likely: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """State (4,) and covariance (4, 4) if a frame's velocities, at `places` (h, 2), are as
    likely as `open_` (h,) says, not as `likely` (h,).

    The velocity gets the mean and the covariance of what is open; the acceleration follows as far
    as it depends on the velocity.
    """
    # Sums over all of the grid and over what is left of it: of 1, a, b, aa, ab, bb, where a and b
    # are the places on the axes, each as often as it is likely.
    every, left = np.zeros(6), np.zeros(6)
    for k in range(len(likely)):
        a, b = places[k]
        terms = (1.0, a, b, a * a, a * b, b * b)
        for i in range(6):
            every[i] += likely[k] * terms[i]
            left[i] += open_[k] * terms[i]
    every, left = every / every[0], left / left[0]
    # What the covariance, the identity on the grid before, becomes. The grid's own is smaller, for
    # it ends; and between its steps nothing is known.
    between = (2.0 * SPAN / (TRIED - 1)) ** 2 / 12.0
    change = np.zeros((2, 2))
    if frame.steps > 1:
        change[0, 0] = (left[3] - left[1] ** 2) / every[3] + between - 1.0
    if frame.side_steps > 1:
        change[1, 1] = (left[5] - left[2] ** 2) / every[5] + between - 1.0
    if frame.steps > 1 and frame.side_steps > 1:
        change[0, 1] = (left[4] - left[1] * left[2]) / sqrt(every[3] * every[5])
        change[1, 0] = change[0, 1]
    gain, x, y = np.zeros((4, 2)), frame.x, frame.y
    for i in range(4):
        gain[i, 0] = (covariance[i, 0] * x + covariance[i, 1] * y) / frame.most
        if frame.side_steps > 1:
            gain[i, 1] = (covariance[i, 1] * x - covariance[i, 0] * y) / frame.least
    state, covariance = state.copy(), covariance.copy()
    for i in range(4):
        state[i] += gain[i, 0] * left[1] + gain[i, 1] * left[2]
        for j in range(4):
            for m in range(2):
                for n in range(2):
                    covariance[i, j] += gain[i, m] * change[m, n] * gain[j, n]
    return state, covariance


@compiled
def _rule_out(
    ruled_out: BoolArray,
    likely: FloatArray,
    outline: Outline,
    state: FloatArray,
    tried: FloatArray,
    look: Look,
    margin: float,
    older: bool,
) -> bool:
    """Marks the velocities (h,) with which an outline, at the time of a look, would lie across rays
    that went by. False, and none marked, where an older look leaves too little to be believed."""
    candidates = (~ruled_out).nonzero()[0]
    across = _across(outline, state, tried[candidates], look, margin, False)
    found, open_, left = ruled_out.copy(), 0.0, 0.0
    for n in range(len(candidates)):
        found[candidates[n]] = across[n].any()
    for h in range(len(tried)):
        open_ += 0.0 if ruled_out[h] else likely[h]
        left += 0.0 if found[h] else likely[h]
    if older and left < SURPRISE * open_:
        return False
    ruled_out[:] = found
    return True


@compiled
def _across(
    outline: Outline,
    state: FloatArray,
    tried: FloatArray,
    look: Look,
    margin: float,
    every: bool,
) -> BoolArray:
    """(h, k) True for hits of an outline that begin a piece which, at the time of a look, would lie
    across rays that went by unhindered, with each of the velocities (h, 2), more than that of the
    state; without `every` only the first such piece of each."""
    points, joined, ranges, count = outline.points, outline.joined, look.ranges, len(look.ranges)
    found = np.zeros((len(tried), len(joined)), dtype=np.bool_)
    bearings = np.arange(count) * (2 * pi / count) - pi + look.yaw
    ahead, aside = np.cos(bearings), np.sin(bearings)
    elapsed = look.stamp - outline.stamp
    x, y = _gone(state, elapsed)
    for h in range(len(tried)):
        at_x, at_y = x + elapsed * tried[h, 0] - look.x, y + elapsed * tried[h, 1] - look.y
        ax = ay = last = 0.0
        for k in range(len(joined)):
            bx, by = points[0, k] + at_x, points[1, k] + at_y
            ray = ray_number(atan2(by, bx) - look.yaw, count)
            if k > 0 and joined[k - 1]:
                # A piece spans less than half a turn.
                before = last + count if ray - last > count / 2 else last
                near = ray if before - ray <= count / 2 else ray + count
                for i in range(ceil(min(before, near)), floor(max(before, near)) + 1):
                    met = i % count
                    across = ahead[met] * (by - ay) - aside[met] * (bx - ax)
                    if across != 0.0:
                        reach = (ax * by - ay * bx) / across
                        if 0.0 < reach < ranges[met] - margin:
                            found[h, k - 1] = True
            ax, ay, last = bx, by, ray
            if not every and k > 0 and found[h, k - 1]:
                break
    return found


@compiled
def _gone(state: FloatArray, elapsed: float) -> tuple[float, float]:
    """How far a mover is from an outline's place, at a time before (elapsed < 0) or after it, m.

    The state is that of the later one of the two.
    """
    x, y = gone_since(state, abs(elapsed))
    return (-x, -y) if elapsed < 0.0 else (x, y)
