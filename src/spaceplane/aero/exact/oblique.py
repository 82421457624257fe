"""Plane oblique shocks.

Equation numbers of NACA Report 1135 (1953); those with an A are of Anderson, Modern Compressible Flow, 3rd ed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spaceplane.errors import InputError


@dataclass(frozen=True)
class Detachment:
    """The strongest attached shock.

    Attributes:
        deflection: largest deflection of the flow, rad.
        shock_angle: angle of that shock from the stream, rad.
    """

    deflection: float
    shock_angle: float


def behind(mach: float, shock_angle: ArrayLike, gamma: float = 1.4) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mach number, flow deflection (rad) and pressure ratio behind shocks at `shock_angle`, rad (A4.7 to A4.17)."""
    shock_angle = np.asarray(shock_angle, dtype=float)
    normal = (mach * np.sin(shock_angle)) ** 2
    turn = 2.0 / np.tan(shock_angle) * (normal - 1.0) / (mach**2 * (gamma + np.cos(2.0 * shock_angle)) + 2.0)
    deflection = np.arctan(turn)
    normal_behind = (normal + 2.0 / (gamma - 1.0)) / (2.0 * gamma / (gamma - 1.0) * normal - 1.0)
    mach_behind = np.sqrt(normal_behind) / np.sin(shock_angle - deflection)
    return mach_behind, deflection, 1.0 + 2.0 * gamma / (gamma + 1.0) * (normal - 1.0)


def detachment(mach: float, gamma: float = 1.4) -> Detachment:
    """The largest deflection by an attached plane shock (eq. 168).

    Raises:
        InputError: a Mach number of 1 or below.
    """
    if not mach > 1.0:
        raise InputError(f"mach = {mach}: a shock needs a Mach number above 1")
    m2 = mach**2
    root = math.sqrt((gamma + 1.0) * (1.0 + 0.5 * (gamma - 1.0) * m2 + (gamma + 1.0) / 16.0 * m2**2))
    shock_angle = math.asin(math.sqrt(((gamma + 1.0) / 4.0 * m2 - 1.0 + root) / (gamma * m2)))
    return Detachment(float(behind(mach, shock_angle, gamma)[1]), shock_angle)


def weak_shock_cp(mach: float, deflection: ArrayLike, gamma: float = 1.4) -> np.ndarray:
    """Pressure coefficient behind the weak shock that turns the stream.

    The cubic for the square of the shock angle's sine (eq. 150) is solved for its excess y over that of a Mach wave,
    1 / M^2: written in y, small deflections lose no digits.

    Args:
        mach: Mach number ahead, above 1.
        deflection: rad, from 0 to that of `detachment`; the latter's value is taken beyond.
        gamma: ratio of specific heats.

    Returns:
        Cp in the shape of `deflection`.
    """
    most = detachment(mach, gamma)
    deflection = np.asarray(deflection, dtype=float)
    s2 = np.sin(np.clip(deflection, 0.0, most.deflection)) ** 2
    a, g = 1.0 / mach**2, gamma + 1.0
    b, c, d = -(1.0 - a + gamma * s2), s2 * g * (0.25 * g - a), 0.25 * s2 * a * g**2
    # Three real roots, one negative and, of the two positive ones, the smaller for the weak shock.
    p = c - b * b / 3.0
    q = b * (2.0 * b * b - 9.0 * c) / 27.0 + d
    reach = np.sqrt(-p / 3.0)
    turn = np.arccos(np.clip(-0.5 * q / reach**3, -1.0, 1.0))
    cubic = 2.0 * reach * np.cos((turn - 2.0 * np.pi) / 3.0) - b / 3.0
    # Close to zero the small roots are a pair that the arc cosine cannot part; there y^3 is negligible.
    y = np.where(s2 < 1e-6, (c + np.sqrt(c * c - 4.0 * b * d)) / (-2.0 * b), cubic)
    y = _polished(y, b, c, d)
    strongest = math.sin(most.shock_angle) ** 2 - a
    return 4.0 / g * np.where(deflection < most.deflection, np.minimum(y, strongest), strongest)


def _polished(y: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Newton steps on y^3 + b y^2 + c y + d; none where the roots of weak and strong shock meet."""
    for _ in range(3):
        slope = (3.0 * y + 2.0 * b) * y + c
        value = ((y + b) * y + c) * y + d
        step = np.divide(value, slope, out=np.zeros_like(y), where=slope != 0.0)
        y = np.where(np.abs(step) < 0.1 * y, y - step, y)
    return y
