"""Tangent cone: the exact flow past the circular cone at zero incidence whose half angle is the panel's inclination.

The Taylor-Maccoll equation (equation 10.15 of Anderson, Modern Compressible Flow, 3rd ed.) is integrated for many shock
angles at once; Cp over the cone's angle is then a table. The unknown is the departure f of the radial velocity from
that of the undisturbed stream U,

    f'' + f = -a^2 (f + f' cot theta) / (a^2 - v^2),    v = f' - U sin theta,

so that the weak shocks of slender cones lose no digits. Past detachment see `tables.shock_law`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline

from spaceplane.aero.exact.conical import surface_cp, velocity_behind
from spaceplane.aero.exact.stagnation import stagnation_cp
from spaceplane.aero.inclination.compiled import kernel
from spaceplane.aero.inclination.laws.tables import places, shock_law

STEP = 0.04
"""Size of a Runge-Kutta step on the distance to where the equation is singular: the axis, and the Mach wave."""
SHOCKS = 256
"""Shock angles between the weakest and the strongest."""
WEAKEST = 0.01
"""Where the shock angles begin; see `_shocks`."""


@lru_cache(maxsize=64)
def tangent_cone(mach: float, gamma: float) -> Callable[[np.ndarray], np.ndarray]:
    """The law at one Mach number: [panel] inclination, rad -> [panel] Cp."""
    shock = _shocks(mach, _strongest(mach, gamma))
    half_angle, speed = cones_behind(mach, shock, gamma)
    cp = surface_cp(mach, shock, speed, gamma)
    most = float(half_angle[-1])
    # Cp over sqrt(1 - angle / most), smooth at detachment; the cone of no angle, with the Mach wave, ends the curve.
    place = np.append(np.sqrt(np.maximum(1.0 - half_angle[::-1] / most, 0.0)), 1.0)
    attached = CubicSpline(place, np.append(cp[::-1], 0.0))(places())
    return shock_law(attached, most, stagnation_cp(mach, gamma))


def cones_behind(mach: float, shock: np.ndarray, gamma: float) -> tuple[np.ndarray, np.ndarray]:
    """Half angles of the cones that hold these shocks, rad, and the speed on them over the maximum speed.

    Args:
        mach: free-stream Mach number.
        shock: [shock] angle of each shock, rad.
        gamma: ratio of specific heats.
    """
    radial, normal = velocity_behind(mach, shock, gamma)
    stream = (2.0 / ((gamma - 1.0) * mach**2) + 1.0) ** -0.5
    return _march(shock, radial - stream * np.cos(shock), normal + stream * np.sin(shock), stream, gamma)


@kernel
def _curvature(theta, f, slope, stream, gamma):
    """f'', the normal velocity v, and 1 - v^2 / a^2."""
    sine, cosine = math.sin(theta), math.cos(theta)
    radial, normal = f + stream * cosine, slope - stream * sine
    a2 = 0.5 * (gamma - 1.0) * (1.0 - radial * radial - normal * normal)
    room = 1.0 - normal * normal / a2
    return -f - (f + slope * cosine / sine) / room, normal, room


@kernel
def _step(theta, f, slope, h, stream, gamma):
    """f and its derivative `slope` after one classical Runge-Kutta step by h in theta."""
    c1 = _curvature(theta, f, slope, stream, gamma)[0]
    s2 = slope + 0.5 * h * c1
    c2 = _curvature(theta + 0.5 * h, f + 0.5 * h * slope, s2, stream, gamma)[0]
    s3 = slope + 0.5 * h * c2
    c3 = _curvature(theta + 0.5 * h, f + 0.5 * h * s2, s3, stream, gamma)[0]
    s4 = slope + h * c3
    c4 = _curvature(theta + h, f + h * s3, s4, stream, gamma)[0]
    return f + h / 6.0 * (slope + 2.0 * (s2 + s3) + s4), slope + h / 6.0 * (c1 + 2.0 * (c2 + c3) + c4)


@kernel
def _march(shock, departure, departure_slope, stream, gamma):
    """From each shock towards the axis until the normal velocity vanishes: half angles and speeds there."""
    angle, speed = np.zeros(len(shock)), np.zeros(len(shock))
    for k in range(len(shock)):
        theta, f, slope = shock[k], departure[k], departure_slope[k]
        while theta > 1e-6:
            room = _curvature(theta, f, slope, stream, gamma)[2]
            h = -STEP * min(theta, room + 1e-9)
            after, slope_after = _step(theta, f, slope, h, stream, gamma)
            if slope_after - stream * math.sin(theta + h) >= 0.0:
                break
            theta, f, slope = theta + h, after, slope_after
        h = 0.0  # the last step ends on the cone: its length by Newton's method
        for _ in range(20):
            after, slope_after = _step(theta, f, slope, h, stream, gamma)
            curvature, normal, room = _curvature(theta + h, after, slope_after, stream, gamma)
            change = normal / (curvature - stream * math.cos(theta + h))
            h -= change
            if abs(change) < 1e-14:
                break
        after, slope_after = _step(theta, f, slope, h, stream, gamma)
        angle[k], speed[k] = theta + h, after + stream * math.cos(theta + h)
    return angle, speed


def _shocks(mach: float, strongest: float) -> np.ndarray:
    """[shock] angles, rad, dense at both ends.

    The cone's angle leaves zero with the fourth root of the shock's angle above the Mach wave, and has a maximum at
    the strongest shock.
    """
    wave = math.asin(1.0 / mach)
    share = 1.0 - (1.0 - np.linspace(WEAKEST, 1.0, SHOCKS) ** 4) ** 2
    return wave + (strongest - wave) * share


def _strongest(mach: float, gamma: float) -> float:
    """Shock angle, rad, of the widest cone that holds an attached shock: brackets narrowed to round-off of the cone."""
    low, high = math.asin(1.0 / mach) + 1e-6, 0.5 * math.pi - 1e-6
    while high - low > 1e-7:
        shock = np.linspace(low, high, 49)
        widest = int(np.argmax(cones_behind(mach, shock, gamma)[0]))
        low, high = shock[max(widest - 1, 0)], shock[min(widest + 1, 48)]
    return 0.5 * (low + high)
