"""Enthalpy of equilibrium air as a table over density and pressure over density, for a flow solver to read."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from spaceplane.environment.equilibrium_air import GAS_CONSTANT, HIGHEST_TEMPERATURE, heat_at_density

LOWEST_TEMPERATURE = 30.0
"""K; air that cold is ideal, and what is colder is taken as this cold."""
LOWEST_DENSITY, HIGHEST_DENSITY = 1e-9, 1e2
"""kg/m3; beyond them the nearest is taken."""

_DENSITIES, _ENERGIES, _TEMPERATURES = 128, 768, 1500
COLUMNS = ("factor", "by_density", "by_pressure", "temperature")


@dataclass(frozen=True)
class AirTable:
    """What is tabulated at equal steps of ln(density) and ln(pressure / density), SI units.

    Attributes:
        log_density: (first, step) of ln(rho); log_energy: (first, step) of ln(p/rho).
        values: [density, energy, column] B = h rho / p; rho dB/drho at constant pressure; p dB/dp at constant density;
            temperature, K.
    """

    log_density: tuple[float, float]
    log_energy: tuple[float, float]
    values: np.ndarray

    def look(self, density: np.ndarray, pressure: np.ndarray) -> dict[str, np.ndarray]:
        """`COLUMNS` at densities, kg/m3, and pressures, Pa, by linear interpolation; the nearest beyond the table."""
        density, pressure = np.broadcast_arrays(np.asarray(density, dtype=float), np.asarray(pressure, dtype=float))
        i, f = _place(np.log(density), *self.log_density, self.values.shape[0])
        j, g = _place(np.log(pressure / density), *self.log_energy, self.values.shape[1])
        low = (1 - g) * self.values[i, j] + g * self.values[i, j + 1]
        high = (1 - g) * self.values[i + 1, j] + g * self.values[i + 1, j + 1]
        found = np.moveaxis((1 - f) * low + f * high, -1, 0)
        return dict(zip(COLUMNS, found, strict=True))


def _place(value: np.ndarray, first: float, step: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """(number of the knot below, share of the way to the next [..., 1]) of values within equal steps."""
    x = np.clip((value - first) / step, 0.0, count - 1.0)
    i = np.minimum(x.astype(int), count - 2)
    return i, (x - i)[..., None]


@cache
def air_table() -> AirTable:
    """The table, made once in about half a second.

    Against `heat_at_density` itself, B is within 2e-4 from 50 to 12000 K, 1e-8 to 50 kg/m3.
    """
    from scipy.interpolate import CubicSpline  # slow to import

    density = np.linspace(np.log(LOWEST_DENSITY), np.log(HIGHEST_DENSITY), _DENSITIES)
    temperature = np.geomspace(LOWEST_TEMPERATURE, HIGHEST_TEMPERATURE, _TEMPERATURES)
    factor, enthalpy = heat_at_density(*np.broadcast_arrays(temperature, np.exp(density)[:, None]))
    energy = factor * GAS_CONSTANT * temperature
    knots = np.linspace(np.log(energy[:, 0].max()), np.log(energy[:, -1].min()), _ENERGIES)
    values = np.empty((_DENSITIES, _ENERGIES, len(COLUMNS)))
    by_energy = np.empty((_DENSITIES, _ENERGIES))
    for row in range(_DENSITIES):
        along = np.log(energy[row])
        spline = CubicSpline(along, enthalpy[row] / energy[row])
        values[row, :, 0], by_energy[row] = spline(knots), spline(knots, 1)
        values[row, :, 3] = np.exp(np.interp(knots, along, np.log(temperature)))
    at_energy = CubicSpline(density, values[:, :, 0], axis=0)(density, 1)
    # With y = ln(p/rho), rho d/drho at constant p is d/dln(rho) - d/dy, and p d/dp at constant rho is d/dy.
    values[:, :, 1], values[:, :, 2] = at_energy - by_energy, by_energy
    steps = (float(density[1] - density[0]), float(knots[1] - knots[0]))
    return AirTable((float(density[0]), steps[0]), (float(knots[0]), steps[1]), values)
