"""What is done where limiters keep a residual from falling.

A shock sensor and a limiter that keep flipping in a few cells keep a residual from falling, though the forces stand
still. Where a residual gains nothing any more, the lane's sensor may first only rise. If the forces stand and still
nothing is gained, the lane keeps the sensor and the factors on its slopes: what is solved is the second-order scheme
with the limits of a flow whose forces already stand, and it converges (V. Venkatakrishnan, J. Comput. Phys. 118 (1995)
120-130, shows both the stall and what freezing does to it).

From there a base at high Mach number may still keep a residual up: the near vacuum behind it (see `bounds`) takes in a
few cells in each iteration and gives others back, and each of them stirs the wake. A run that is asked for more decades
than forces need therefore has an end game: limits, and the cells that stand at their bound, stay to the end.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spaceplane.flow.compiled import LANES
from spaceplane.flow.history import History

SPAN, GAIN = 6, 0.02
"""Iterations in which a residual that gains no more than this many decades stands still, so that something is done. One
that creeps on by a thousandth of a decade at a time stands as well."""

FROM_AGE, LATE_AGE = 20, 50
"""Iterations in which flows form: nothing is held in them; and from which on a flow that has still not settled has its
sensor held whenever its residual is near its best, rough as it may be."""

FROM_DROP, TO_DROP = 1.5, 4.0
"""Decades below which a flow is not formed yet, and above which single precision is what stops it."""

CALM, STEADY = 2e-3, 2e-4
"""Half peak-to-peak of the force over the span, on its size, below which a sensor is held and limits are frozen. In
rougher flow a sensor that may only rise would keep the mark of every wave that passes."""

THAWED_BY, REST = 2.0, 20
"""Rise of the residual since the freezing at which a lane is let go, and iterations until it may freeze again."""


class Freezer:
    """Which lanes of an ensemble are frozen.

    Attributes:
        held: [lane] whether the shock sensor may only rise.
        frozen: [lane] whether sensor and limits are kept.
        closing: [lane] whether it is in its end game, frozen to the end.
    """

    def __init__(self):
        self.held, self.frozen, self.closing = np.zeros((3, LANES), dtype=bool)
        self._mark, self._rest = np.zeros((2, LANES))

    def begin(self, lanes: np.ndarray) -> None:
        """Let the lanes of these indices go, which now hold other flows."""
        self.held[lanes] = self.frozen[lanes] = self.closing[lanes] = False
        self._rest[lanes] = 0

    def close(self, lanes: np.ndarray) -> None:
        """Begin the end game of the lanes of these indices."""
        self.held[lanes] = self.frozen[lanes] = self.closing[lanes] = True

    def update(self, histories: Sequence[History], norms: np.ndarray, best: np.ndarray, drop: np.ndarray) -> None:
        """Judge all lanes by their histories, residual, the best one so far and its drop in decades [lane]."""
        thawed = self.frozen & ~self.closing & (norms > THAWED_BY * self._mark)
        self.frozen &= ~thawed
        self._rest = np.where(thawed, REST, np.maximum(self._rest - 1, 0))
        for lane in np.flatnonzero(~self.frozen):
            history = histories[lane]
            spread = history.spread(SPAN)
            stalled = history.age > FROM_AGE and history.gain(SPAN) <= GAIN
            ready = self.held[lane] and not self._rest[lane] and FROM_DROP < drop[lane] < TO_DROP
            if stalled and ready and spread < STEADY:
                self.frozen[lane] = True
                self._mark[lane] = norms[lane]
            late = history.age >= LATE_AGE and norms[lane] < 2.0 * best[lane]
            self.held[lane] = late or (spread < CALM and (stalled or self.held[lane]))
