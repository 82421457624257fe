"""Prandtl-Meyer expansion of a plane supersonic stream, down to vacuum.

Equation numbers of NACA Report 1135 (1953).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from spaceplane.errors import InputError

_STEPS = 60


def prandtl_meyer_angle(mach: float, gamma: float = 1.4) -> float:
    """Angle through which the stream has turned since Mach 1, rad (eq. 171c).

    Raises:
        InputError: a Mach number below 1.
    """
    if not mach >= 1.0:
        raise InputError(f"mach = {mach}: an expansion needs a Mach number of 1 or more")
    k = math.sqrt((gamma + 1.0) / (gamma - 1.0))
    y = math.sqrt(mach**2 - 1.0)
    return k * math.atan(y / k) - math.atan(y)


def vacuum_cp(mach: float, gamma: float = 1.4) -> float:
    """Pressure coefficient of vacuum: the lowest there is."""
    return -2.0 / (gamma * mach**2)


def expanded_cp(mach: float, turning: ArrayLike, gamma: float = 1.4) -> np.ndarray:
    """Pressure coefficient after an expansion; that of vacuum where the stream cannot turn so far.

    Newton's method in w = 1 / sqrt(M^2 - 1), in which the angle left to vacuum is concave and increasing: from the left
    it converges from any start.

    Args:
        mach: Mach number ahead, at least 1.
        turning: angle by which the stream is turned away from itself, rad, 0 or more.
        gamma: ratio of specific heats.

    Returns:
        Cp in the shape of `turning`.

    Raises:
        InputError: a Mach number below 1.
    """
    k = math.sqrt((gamma + 1.0) / (gamma - 1.0))
    most = 0.5 * math.pi * (k - 1.0)
    left = np.maximum(most - prandtl_meyer_angle(mach, gamma) - np.asarray(turning, dtype=float), 0.0)
    w = left / (k**2 - 1.0)
    for _ in range(_STEPS):
        gap = left - (k * np.arctan(k * w) - np.arctan(w))
        step = gap * (1.0 + (k * w) ** 2) * (1.0 + w**2) / (k**2 - 1.0)
        w = w + step
        if np.all(np.abs(step) <= 1e-14 * w):
            break
    # 1 + (gamma - 1)/2 M^2 = half of (gamma + 1 + (gamma - 1) / w^2), so that vacuum (w = 0) needs no division.
    ahead = 1.0 + 0.5 * (gamma - 1.0) * mach**2
    ratio = 2.0 * ahead * w**2 / ((gamma + 1.0) * w**2 + gamma - 1.0)
    return (ratio ** (gamma / (gamma - 1.0)) - 1.0) * 2.0 / (gamma * mach**2)
