"""Where the moving obstacles are at each physics step, worked out many steps at a time."""

from collections.abc import Sequence

import numpy as np

from fuzzynav_mj.scenarios.world import Mover
from fuzzynav_mj.types import FloatArray

STEPS = 2000  # worked out at a time


class MoverPlaces:
    """Positions of moving obstacles.

    Args:
        movers: the obstacles.
        period: of a physics step, s.
    """

    def __init__(self, movers: Sequence[Mover], period: float) -> None:
        self._movers, self._period = movers, period
        self._first, self._rows = 0, np.empty((0, len(movers), 2))

    def rows(self, first: int, count: int) -> FloatArray:
        """(count, movers, 2) origins at the physics steps first, first + 1, ..., m."""
        offset = first - self._first
        if offset < 0 or offset + count > len(self._rows):
            steps = first + np.arange(STEPS + count, dtype=np.float64)
            times = steps * self._period
            self._rows = np.empty((len(times), len(self._movers), 2))
            for number, mover in enumerate(self._movers):
                self._rows[:, number] = mover.motion.positions(times)
            self._first, offset = first, 0
        return self._rows[offset : offset + count]
