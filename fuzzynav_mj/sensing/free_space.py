"""What free space tells of a mover's motion: where rays went by unhindered, it was not.

A flat side does not show how it moves along itself, and its ends are known no better than the rays
beside them are apart. But its outline of now, carried back, must not lie across a ray that went by
earlier, nor an earlier outline, carried onward, across a ray of now. Motions for which one would
are ruled out, and what several looks leave open together is far less than any two of them. So even
the first look at a mover tells how fast it must be to have come into view, and later ones how the
motion of a side along itself changes.

If the velocity that is believed is ruled out itself, the outline is that of two movers, which no
common motion explains.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from fuzzynav_mj.compiled import compiled
from fuzzynav_mj.sensing.crossing import first_across, pieces_across
from fuzzynav_mj.sensing.looks import Look
from fuzzynav_mj.sensing.outline import Outline
from fuzzynav_mj.sensing.parts import convex_parts
from fuzzynav_mj.sensing.velocity_filter import LARGEST_ACCELERATION
from fuzzynav_mj.sensing.velocity_grid import anything_open, frame_of, motions, without
from fuzzynav_mj.types import BoolArray, FloatArray

LOOKS = 4  # earlier looks whose free space counts ...
OUTLINES = 2  # ... and earlier outlines that are carried onward
FREE = 0.015  # m: a ray went by if it reached this much farther; ...
CONTRADICTION = 0.03  # ... this much, to put what is believed in doubt; besides ...
FREE_NOISE = 3.0  # ... so many standard deviations of the ranges
TURNING = 0.5  # m/s2: what a mover may have turned by since then, unnoticed
SURPRISE = 0.3  # share of what newer looks leave open that an older one must leave, to be believed
RECENT = 2  # looks that may contradict a belief: over more a mover may have turned


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
        """State (6,) and covariance (6, 6), as in velocity_filter.py, without the motions that
        are ruled out; as they are where all are, or none.

        A mover that has turned at once was elsewhere before: an older look that leaves next to
        nothing of what newer ones left open is not believed, nor are those before it.

        Args:
            state, covariance: of the mover.
            outline: of the mover, now.
            before: its outlines in earlier looks.
            since: stamp of the first look since which it may have moved like this, s.
        """
        if not anything_open(covariance):
            return state, covariance
        looks = self.past[: -LOOKS - 1 : -1]
        shown = before[: -OUTLINES - 1 : -1]
        # Compiled code takes the same number each time.
        more_looks = (self.now,) * (LOOKS - len(looks))
        more_shown = (outline,) * (OUTLINES - len(shown))
        return _narrow(
            state, covariance, outline, (*shown, *more_shown), len(shown), self.now,
            (*looks, *more_looks), len(looks), self.noise, since,
        )  # fmt: skip

    def contradicts(self, state: FloatArray, outline: Outline, last: Outline) -> bool:
        """True if a mover of this state (6,), with an outline of one part, would have been where
        rays went by in the last look, or its outline of then would be where they do now; and
        whichever way it had changed its velocity in a bend, too."""
        if not self.past:
            return False
        return _contradicts(state, outline, last, self.past[-1], self.now, self.noise)

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
        part = convex_parts(outline.points, outline.joined)
        across = np.zeros(len(part), dtype=bool)
        if part[-1] == 0:
            return across, False
        margin = _contradiction(self.noise)
        for look in self.past[-RECENT:]:
            across |= pieces_across(outline, state, look, margin)
        unseen = any(pieces_across(shown, state, self.now, margin).any() for shown in before)
        if not unseen and not across.any():
            return across, False
        largest = int(np.bincount(part).argmax())
        contradicting = np.unique(part[across])
        if len(contradicting) == 0 or largest in contradicting:
            return part != largest, True
        return np.isin(part, contradicting), False


@compiled
def _contradiction(noise: float) -> float:
    """By how much farther a ray must have reached to put what is believed in doubt, m."""
    return CONTRADICTION + FREE_NOISE * noise


@compiled
def _margin(noise: float, elapsed: float) -> float:
    """By how much farther a ray must have reached, so long ago, to rule anything out, m."""
    return FREE + FREE_NOISE * noise + TURNING / 2 * elapsed**2


@compiled
def _narrow(
    state: FloatArray,
    covariance: FloatArray,
    outline: Outline,
    shown: tuple[Outline, ...],
    shown_count: int,
    now: Look,
    looks: tuple[Look, ...],
    look_count: int,
    noise: float,
    since: float,
) -> tuple[FloatArray, FloatArray]:
    """See `FreeSpace.narrow`, where something is uncertain; of earlier outlines and looks, the
    newest first, so many count."""
    frame = frame_of(covariance)
    places, tried, likely = motions(frame)
    ruled_out = np.zeros(len(tried), dtype=np.bool_)
    for n in range(look_count):
        margin = _margin(noise, looks[n].stamp - outline.stamp)
        if looks[n].stamp < since or not _rule_out(
            ruled_out, likely, outline, state, tried, looks[n], margin, n > 0
        ):
            break
    for n in range(shown_count):
        margin = _margin(noise, now.stamp - shown[n].stamp)
        if not _rule_out(ruled_out, likely, shown[n], state, tried, now, margin, n > 0):
            break
    if ruled_out.all() or not ruled_out.any():
        return state, covariance
    return without(state, covariance, frame, places, np.where(ruled_out, 0.0, likely), likely)


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
    """Marks the motions (h,) with which an outline, at the time of a look, would lie across rays
    that went by. False, and none marked, where an older look leaves too little to be believed."""
    found = first_across(outline, state, tried, ruled_out, look, margin) >= 0
    open_ = left = 0.0
    for h in range(len(tried)):
        open_ += 0.0 if ruled_out[h] else likely[h]
        left += 0.0 if ruled_out[h] or found[h] else likely[h]
    if older and left < SURPRISE * open_:
        return False
    ruled_out |= found
    return True


@compiled
def _contradicts(
    state: FloatArray, outline: Outline, last: Outline, before: Look, now: Look, noise: float
) -> bool:
    """See `FreeSpace.contradicts`; `before` is the last look."""
    if convex_parts(outline.points, outline.joined)[-1] > 0:
        return False
    margin = _contradiction(noise)
    change = LARGEST_ACCELERATION * (outline.stamp - last.stamp)
    tried = np.zeros((5, 4))
    tried[1, 0], tried[2, 0], tried[3, 1], tried[4, 1] = change, -change, change, -change
    none = np.zeros(len(tried), dtype=np.bool_)
    ruled_out = first_across(outline, state, tried, none, before, margin) >= 0
    ruled_out |= first_across(last, state, tried, ruled_out, now, margin) >= 0
    return bool(ruled_out.all())
