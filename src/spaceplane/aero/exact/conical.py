"""Exact supersonic flow past a circular cone at zero incidence.

Taylor and Maccoll, "The air pressure on a cone moving at high speeds", Proc. R. Soc. A 139 (1933);
equations numbered as in Anderson, Modern Compressible Flow, 3rd ed., chapter 10.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize_scalar

from spaceplane.aero.exact.oblique import behind
from spaceplane.errors import InputError


@dataclass(frozen=True)
class ConeFlow:
    """Axisymmetric flow past a cone.

    Attributes:
        mach: free-stream Mach number.
        half_angle: half angle of the cone, rad.
        shock_angle: angle of the attached shock from the axis, rad.
        surface_cp: pressure coefficient on the cone.
        surface_mach: Mach number on the cone.
    """

    mach: float
    half_angle: float
    shock_angle: float
    surface_cp: float
    surface_mach: float


def taylor_maccoll(mach: float, half_angle: float, gamma: float = 1.4) -> ConeFlow:
    """Solve the conical flow with the weak attached shock.

    Args:
        mach: free-stream Mach number, above 1.
        half_angle: half angle of the cone, rad.
        gamma: ratio of specific heats.

    Raises:
        InputError: if the Mach number is not supersonic or the shock is detached.
    """
    if not mach > 1.0:
        raise InputError(f"mach = {mach}: the conical flow needs a Mach number above 1")
    mach_angle = math.asin(1.0 / mach)
    widest = minimize_scalar(
        lambda shock: -_cone_behind(mach, shock, gamma)[0],
        bounds=(mach_angle + 1e-6, 0.5 * math.pi - 1e-4),
        method="bounded",
    )
    if not 0.0 < half_angle < -widest.fun:
        raise InputError(
            f"half_angle_deg = {math.degrees(half_angle):.4g}: at Mach {mach:g} the shock is attached for half angles "
            f"between 0 and {math.degrees(-widest.fun):.2f} deg"
        )
    lower = mach_angle * (1.0 + 1e-9) + 1e-9
    shock = brentq(lambda angle: _cone_behind(mach, angle, gamma)[0] - half_angle, lower, widest.x, xtol=1e-12)
    _, speed = _cone_behind(mach, shock, gamma)
    return ConeFlow(
        mach=mach,
        half_angle=half_angle,
        shock_angle=shock,
        surface_cp=float(surface_cp(mach, shock, speed, gamma)),
        surface_mach=float(_mach_of(speed, gamma)),
    )


def center_of_pressure(half_angle: float) -> float:
    """Centre of pressure behind the apex over the length, 2 / (3 cos^2 half_angle) with the angle in rad: exact."""
    return 2.0 / (3.0 * math.cos(half_angle) ** 2)


def _mach_of(speed: np.ndarray, gamma: float) -> np.ndarray:
    """Mach number from the speed over the maximum speed (Anderson 10.16 inverted)."""
    return np.sqrt(2.0 / (gamma - 1.0) * speed**2 / (1.0 - speed**2))


def velocity_behind(mach: float, shock: ArrayLike, gamma: float) -> tuple[np.ndarray, np.ndarray]:
    """Radial and normal velocity over the maximum speed just behind a conical shock at the angle `shock`, rad."""
    mach_2, deflection, _ = behind(mach, shock, gamma)
    speed = (2.0 / ((gamma - 1.0) * mach_2**2) + 1.0) ** -0.5
    return speed * np.cos(shock - deflection), -speed * np.sin(shock - deflection)


def _normal_slope(theta: float, radial: float, normal: float, gamma: float) -> float:
    """Derivative of the normal velocity by the ray's angle theta, rad: the Taylor-Maccoll equation (Anderson 10.15).

    The derivative of the radial velocity is the normal velocity. Velocities are fractions of the maximum speed.
    """
    a2 = 0.5 * (gamma - 1.0) * (1.0 - radial**2 - normal**2)
    return (normal**2 * radial - a2 * (2.0 * radial + normal / math.tan(theta))) / (a2 - normal**2)


def surface_cp(mach: float, shock: ArrayLike, speed: ArrayLike, gamma: float) -> np.ndarray:
    """Pressure coefficient on cones: jump at the shock, then isentropic compression.

    Args:
        mach: free-stream Mach number.
        shock: angle of the shock, rad.
        speed: speed on the cone over the maximum speed.
        gamma: ratio of specific heats.
    """
    mach_2, _, jump = behind(mach, shock, gamma)
    base = (1.0 + 0.5 * (gamma - 1.0) * mach_2**2) / (1.0 + 0.5 * (gamma - 1.0) * _mach_of(speed, gamma) ** 2)
    return (jump * base ** (gamma / (gamma - 1.0)) - 1.0) * 2.0 / (gamma * mach**2)


def _cone_behind(mach: float, shock: float, gamma: float) -> tuple[float, float]:
    """Half angle of the cone that holds this shock, and the speed on it over the maximum speed.

    Integrates from the shock until the velocity across the ray vanishes.
    """

    def rates(theta: float, velocity: np.ndarray) -> list[float]:
        return [velocity[1], _normal_slope(theta, velocity[0], velocity[1], gamma)]

    def at_wall(theta: float, velocity: np.ndarray) -> float:
        return velocity[1]

    at_wall.terminal = True
    start = np.array(velocity_behind(mach, shock, gamma))
    path = solve_ivp(rates, (shock, 1e-8), start, method="DOP853", rtol=1e-11, atol=1e-12, events=at_wall)
    if not len(path.t_events[0]):
        return 0.0, float(path.y[0, -1])
    return float(path.t_events[0][0]), float(path.y_events[0][0][0])
