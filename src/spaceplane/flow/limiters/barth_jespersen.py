"""Barth-Jespersen limiter: strict, not differentiable.

T. J. Barth, D. C. Jespersen, AIAA 89-0366 (1989), eq. 2.
"""

from __future__ import annotations

from spaceplane.flow.compiled import inlined


@inlined
def barth_jespersen(room, step, eps2):
    """Factor on the gradient: min(1, room/step). `room` and `step` >= 0: room to the neighbours' extreme, step to the
    face."""
    real = type(room)
    # Room that is nothing but round-off may be negative, and many times the step.
    return min(real(1), max(room, real(0)) / (step + real(1e-20)))
