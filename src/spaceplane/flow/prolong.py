"""Carry a coarse level's solution to the next finer one, linearly within each coarse cell."""

from __future__ import annotations

from numba import prange

from spaceplane.flow.compiled import LANES, kernel
from spaceplane.flow.residual import guarded


@kernel
def prolong(parent, offset, state, gradient, order, lane, out, column):
    """Fill `out[:, :, column]` of the finer level from one lane of a coarse level.

    Args:
        parent: [fine cell] coarse cell in the kernels' numbering; offset: [fine cell, xyz] from its centroid.
        state: [coarse cell, 5, lane]; gradient: [coarse cell, axis, 5 x lane], limited; used when `order` is 2.
    """
    for i in prange(parent.shape[0]):
        j = parent[i]
        for k in range(5):
            value = state[j, k, lane]
            if order == 2:
                step = value - value
                for a in range(3):
                    step += gradient[j, a, k * LANES + lane] * offset[i, a]
                value = guarded(value, value + step) if k == 0 or k == 4 else value + step
            out[i, k, column] = value
