"""The direction from which the air comes, in geometry axes: the one place that turns angles into vectors."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def direction(alpha: ArrayLike, beta: ArrayLike) -> np.ndarray:
    """Unit vector of the free-stream velocity relative to the body, in geometry axes (x aft, y right, z up).

    The vehicle's velocity in body axes (x forward, y right, z down) is V (cos a cos b, sin b, sin a cos b); the air
    moves the other way, and geometry axes reverse x and z. Sideslip is positive with the wind from the right, so
    that the air then moves towards the left (negative y).

    Args:
        alpha: [condition] angle of attack, rad, positive nose up.
        beta: [condition] sideslip, rad, positive with the wind from the right.

    Returns:
        [condition, xyz] unit vectors; [xyz] for scalar angles.
    """
    alpha, beta = np.broadcast_arrays(np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float))
    return np.stack([np.cos(alpha) * np.cos(beta), -np.sin(beta), np.sin(alpha) * np.cos(beta)], axis=-1)


def velocity(mach: ArrayLike, alpha: ArrayLike, beta: ArrayLike) -> np.ndarray:
    """Free-stream velocity on the free-stream speed of sound, [condition, xyz], geometry axes."""
    return np.asarray(mach, dtype=float)[..., None] * direction(alpha, beta)
