"""Pressure at a stagnation point and behind a normal shock."""

from __future__ import annotations

from spaceplane.errors import InputError


def stagnation_cp(mach: float, gamma: float = 1.4) -> float:
    """Pressure coefficient at a stagnation point: isentropic below Mach 1, Rayleigh's pitot formula above.

    Source: NACA Report 1135 (1953), equations 44 and 100.

    Raises:
        InputError: a Mach number of 0 or below.
    """
    if not mach > 0.0:
        raise InputError(f"mach = {mach}: a positive number is needed")
    if mach <= 1.0:
        pressure = (1.0 + 0.5 * (gamma - 1.0) * mach**2) ** (gamma / (gamma - 1.0))
    else:
        rise = (0.5 * (gamma + 1.0) * mach**2) ** (gamma / (gamma - 1.0))
        shock = (2.0 * gamma / (gamma + 1.0) * mach**2 - (gamma - 1.0) / (gamma + 1.0)) ** (-1.0 / (gamma - 1.0))
        pressure = rise * shock
    return (pressure - 1.0) * 2.0 / (gamma * mach**2)


def normal_shock_pressure(mach: float, gamma: float = 1.4) -> float:
    """Static pressure ratio across a normal shock (NACA Report 1135, equation 93)."""
    return 1.0 + 2.0 * gamma / (gamma + 1.0) * (mach**2 - 1.0)
