"""Venkatakrishnan limiter: differentiable; leaves variations below eps alone.

V. Venkatakrishnan, J. Comput. Phys. 118 (1995) 120-130, eq. 24.
"""

from __future__ import annotations

from spaceplane.flow.compiled import inlined


@inlined
def venkatakrishnan(room, step, eps2):
    """Factor on the gradient: (r^2 + 2 r s + eps2)/(r^2 + 2 s^2 + r s + eps2), at most 1.

    Args:
        room: r >= 0, distance from the cell's value to the extreme among its neighbours.
        step: s >= 0, what the gradient adds between the centroid and the face.
        eps2: square of the variation that is noise.
    """
    real = type(room)
    rs = room * step
    rr = room * room + eps2
    return min(real(1), (rr + rs + rs) / (rr + real(2) * step * step + rs))
