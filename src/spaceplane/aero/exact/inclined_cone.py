"""Exact slope of the normal force of a circular cone in supersonic flow: first order in incidence.

A. H. Stone, "On supersonic flow past a slightly yawing cone", J. Math. Phys. 27 (1948) 67-81. About the axisymmetric
conical flow (Taylor and Maccoll) every perturbation is a function of the ray's angle theta times the cosine, or for the
velocity round the axis the sine, of the meridian angle phi, which is 0 on the lee side. The entropy's amplitude is the
same on all rays; the thin layer at the wall in which the real one is not has no effect on the pressure to this order.

Density and speed of sound of the free stream are 1; angles are measured from the cone's axis, not the wind's.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp

from spaceplane.aero.exact.conical import taylor_maccoll

NEAR_WALL = 1e-7
"""Distance from the wall, rad, to which equations are integrated that are singular there."""


def normal_force_slope(mach: float, half_angle: float, gamma: float = 1.4) -> float:
    """C_N_alpha per rad on the area of the base, at zero incidence.

    Args:
        mach: free-stream Mach number, above 1.
        half_angle: half angle of the cone, rad.
        gamma: ratio of specific heats.

    Raises:
        InputError: if the Mach number is not supersonic or the shock is detached.
    """
    pressure = _solved(mach, half_angle, gamma)[1]
    # C_N = -(surface integral of pressure * cos(phi)^2 * cos(half angle)) / (q * base).
    return -pressure / (mach**2 * math.tan(half_angle))


def shock_tilt(mach: float, half_angle: float, gamma: float = 1.4) -> float:
    """Turn of the shock against the cone per rad of incidence: 0 where it stays with the cone, 1 with the wind.

    On the lee side the shock's angle to the cone's axis grows by it, on the windward side it falls.

    Args:
        mach, half_angle, gamma: see `normal_force_slope`.

    Raises:
        InputError: if the Mach number is not supersonic or the shock is detached.
    """
    return _solved(mach, half_angle, gamma)[0]


def _solved(mach: float, half_angle: float, gamma: float) -> tuple[float, float]:
    """Tilt of the shock, and amplitude of the pressure at the wall, per rad of incidence."""
    shock = taylor_maccoll(mach, half_angle, gamma).shock_angle
    # Amplitudes are linear in the shock's tilt, of which the wall lets through no air.
    still, tilted = (_amplitudes_at_wall(mach, half_angle, shock, tilt, gamma) for tilt in (0.0, 1.0))
    tilt = -still[0] / (tilted[0] - still[0])
    return tilt, still[1] + tilt * (tilted[1] - still[1])


def _amplitudes_at_wall(mach: float, half_angle: float, shock: float, tilt: float, gamma: float) -> tuple[float, float]:
    """Amplitudes of the velocity across the ray and of the pressure at the wall, per rad of incidence, where the shock
    at the angle `shock`, rad, tilts by `tilt` rad per rad against the cone."""
    enthalpy = 1.0 / (gamma - 1.0) + 0.5 * mach**2
    behind = _behind(mach * math.sin(shock), gamma)
    rho, p, across = behind
    radial = mach * math.cos(shock)
    entropy = p / rho**gamma

    def base(theta: float, u: float, v: float) -> tuple[float, float, float, float, float]:
        """Density, pressure, and slopes over theta of velocity across, density and pressure."""
        a2 = (gamma - 1.0) * (enthalpy - 0.5 * (u * u + v * v))
        rho = (a2 / (gamma * entropy)) ** (1.0 / (gamma - 1.0))
        v_slope = (u * v * v - a2 * (2.0 * u + v / math.tan(theta))) / (a2 - v * v)
        rho_slope = -rho * v * (u + v_slope) / a2
        return rho, rho * a2 / gamma, v_slope, rho_slope, a2 * rho_slope

    # Jump conditions at the displaced shock, carried back to its undisturbed place.
    step = 1e-6
    ahead = mach * math.sin(shock)
    slopes = (np.array(_behind(ahead + step, gamma)) - np.array(_behind(ahead - step, gamma))) / (2.0 * step)
    jump = -mach * math.cos(shock) * (1.0 - tilt) * slopes
    _, _, v_slope, rho_slope, p_slope = base(shock, radial, across)
    d_rho, d_p, d_v = jump - tilt * np.array([rho_slope, p_slope, v_slope])
    d_u = mach * math.sin(shock) * (1.0 - tilt) - tilt * across
    d_w = -mach * (1.0 - tilt) + tilt * across / math.sin(shock)
    d_s = d_p / p - gamma * d_rho / rho

    def rates(theta: float, values: np.ndarray) -> list[float]:
        """Slopes over theta of the base flow and of the amplitudes."""
        u, v, d_u, d_v, d_w, d_p = values
        rho, p, v_slope, rho_slope, p_slope = base(theta, u, v)
        sine, cotangent = math.sin(theta), 1.0 / math.tan(theta)
        d_rho = rho * (d_p / p - d_s) / gamma
        # Without its part in the slope of d_p.
        d_rho_slope = rho_slope * (d_p / p - d_s) / gamma - rho * d_p * p_slope / (gamma * p * p)
        mass = 2.0 * (rho * d_u + d_rho * u) + rho_slope * d_v + d_rho * v_slope + d_rho_slope * v
        mass += (rho * d_v + d_rho * v) * cotangent + rho * d_w / sine
        force = rho * (d_v * v_slope + u * d_v + d_u * v) - d_rho * p_slope / rho
        matrix = np.array([[rho, v * rho / (gamma * p)], [rho * v, 1.0]])
        d_v_slope, d_p_slope = np.linalg.solve(matrix, [-mass, -force])
        d_w_slope = (d_p / (rho * sine) - u * d_w - v * d_w * cotangent) / v
        return [v, v_slope, d_v, d_v_slope, d_w_slope, d_p_slope]

    start = [radial, across, d_u, d_v, d_w, d_p]
    path = solve_ivp(rates, (shock, half_angle + NEAR_WALL), start, method="LSODA", rtol=1e-9, atol=1e-12)
    return float(path.y[3, -1]), float(path.y[5, -1])


def _behind(ahead: float, gamma: float) -> tuple[float, float, float]:
    """Density, pressure and velocity across (towards the axis) behind a shock that air meets at `ahead` across it."""
    density = (gamma + 1.0) * ahead**2 / ((gamma - 1.0) * ahead**2 + 2.0)
    pressure = (1.0 + 2.0 * gamma / (gamma + 1.0) * (ahead**2 - 1.0)) / gamma
    return density, pressure, -ahead / density
