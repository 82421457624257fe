"""Equilibrium air in an ensemble: its check at the door, its scales, the heat of every cell of every lane.

The state is scaled on the free stream as ever, with the 1.4 of cold air: density on rho_inf, velocity on
a = sqrt(1.4 p_inf / rho_inf), pressure on rho_inf a^2. What air at another altitude does differently is in the table
only, which is read at the density and pressure in SI units.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from spaceplane.environment.air_table import AirTable, air_table
from spaceplane.environment.equilibrium_air import GAS_CONSTANT, behind_normal_shock
from spaceplane.environment.validity import FASTEST, IONISATION_TEMPERATURE
from spaceplane.errors import InputError
from spaceplane.flow.compiled import LANES, PRS, RHO, ROW, distinct, kernel
from spaceplane.flow.gas import HeatedGas
from spaceplane.flow.solution import EQUILIBRIUM, FlowConditions

COLD_RATIO = 1.4
"""Ratio of specific heats of the free stream."""
THIN, DENSE = 1e-6, 2.0
"""kg/m3; free streams whose wakes and shock layers stay within the table."""
COLD, WARM = 100.0, 500.0
"""K; free streams whose air is cold: neither liquid nor with a ratio of specific heats that differs by 1 % from 1.4."""
_HARMLESS = 2500.0
"""m/s; no flow so slow passes the highest temperature."""


def check_air(conditions: FlowConditions) -> None:
    """Refuse free streams, checked otherwise, that the model of equilibrium air does not hold for.

    Raises:
        InputError: no density or pressure, air that is not cold or too thin or dense, or a stagnation temperature at
            which air ionises.
    """
    for name in ("density", "pressure"):
        value = getattr(conditions, name)
        if value is None:
            raise InputError(f"{name}: missing; gas {EQUILIBRIUM} needs the air's density and pressure (its altitude)")
        value = np.asarray(value, dtype=float)
        if value.shape != (len(conditions),) or not (np.isfinite(value).all() and (value > 0).all()):
            raise InputError(f"{name}: {value} is not allowed; a positive number for each condition")
    if conditions.gamma != COLD_RATIO:
        raise InputError(
            f"gamma: {conditions.gamma} is not allowed with gas {EQUILIBRIUM}; {COLD_RATIO}, that of cold air"
        )
    density, pressure = np.asarray(conditions.density), np.asarray(conditions.pressure)
    temperature = pressure / (density * GAS_CONSTANT)
    for name, value, low, high, unit in (
        ("density", density, THIN, DENSE, "kg/m3"),
        ("temperature of the free stream", temperature, COLD, WARM, "K"),
    ):
        bad = value[(value < low) | (value > high)]
        if len(bad):
            raise InputError(f"{name}: {bad[0]:g} {unit} is not allowed with gas {EQUILIBRIUM}; {low:g} to {high:g}")
    speed = np.asarray(conditions.mach) * np.sqrt(COLD_RATIO * pressure / density)
    if (speed > FASTEST).any():
        raise InputError(
            f"mach: {conditions.mach[speed.argmax()]:g} is not allowed with gas {EQUILIBRIUM}: {speed.max():.0f} m/s, "
            f"where air ionises; at most {FASTEST:.0f} m/s"
        )
    fast = speed > _HARMLESS
    for p, T, v in np.unique(np.stack([pressure, temperature, speed], axis=1)[fast], axis=0):
        behind = behind_normal_shock(p, T, v).temperature
        if behind > IONISATION_TEMPERATURE:
            raise InputError(
                f"mach: {v:.0f} m/s at {p:.3g} Pa is not allowed with gas {EQUILIBRIUM}: {behind:.0f} K behind the "
                f"shock, where air ionises; at most {IONISATION_TEMPERATURE:.0f} K"
            )


class HeatTable(NamedTuple):
    """`AirTable` for the kernels, in the working precision.

    Attributes:
        first, per_step: [2] ln(rho) and ln(p/rho), SI, of the first knot, and knots per unit of them.
        values: [density, energy, (B, rho dB/drho, p dB/dp)].
    """

    first: np.ndarray
    per_step: np.ndarray
    values: np.ndarray


class Heating:
    """Keeps the heats of an ensemble's cells.

    Attributes:
        gas: for the kernels.
    """

    def __init__(self, cells: int, dtype: type):
        table = air_table()
        first, step = np.array([table.log_density, table.log_energy]).T
        values = np.ascontiguousarray(table.values[:, :, :3], dtype=dtype)
        self.table = HeatTable(first.astype(dtype), (1.0 / step).astype(dtype), values)
        self.unit = np.zeros((2, LANES), dtype)
        self.gas = HeatedGas(dtype(COLD_RATIO), np.zeros((cells, 3 * LANES), dtype), np.zeros((1, 3 * LANES), dtype))

    def scale(self, conditions: FlowConditions, free: np.ndarray) -> None:
        """Take in which conditions [lane] the lanes hold, their free streams [5, lane] in the ensemble's units."""
        self.unit[0] = np.log(conditions.density)
        self.unit[1] = np.log(COLD_RATIO * conditions.pressure / conditions.density)
        heats(self.table, self.unit, free[None], self.gas.outside)

    def fill(self, state: np.ndarray) -> None:
        """Make the heats those of `state` [cell, 5, lane]."""
        heats(self.table, self.unit, state, self.gas.heats)


@distinct
def heat_row(first, per_step, values, unit, rows, i, out):
    """The part of `heats` for cell i."""
    real = type(first[0])
    zero = real(0)
    last = real(values.shape[0] - 1)
    end = real(values.shape[1] - 1)
    for n in range(LANES):
        r = rows[i, RHO + n]
        e = rows[i, PRS + n] / r
        x = min(max((math.log(r) + unit[0, n] - first[0]) * per_step[0], zero), last)
        y = min(max((math.log(e) + unit[1, n] - first[1]) * per_step[1], zero), end)
        # Not a number falls through both bounds as zero or as itself: no index may come of it.
        x = x if x >= zero else zero
        y = y if y >= zero else zero
        a = min(int(x), values.shape[0] - 2)
        b = min(int(y), values.shape[1] - 2)
        f = x - real(a)
        g = y - real(b)
        for k in range(3):
            low = values[a, b, k] + g * (values[a, b + 1, k] - values[a, b, k])
            high = values[a + 1, b, k] + g * (values[a + 1, b + 1, k] - values[a + 1, b, k])
            out[i, k * LANES + n] = low + f * (high - low)


@kernel
def heats(table, unit, state, out):
    """Fill `out` [cell, 3 x lane] with B and its slopes (see `gas.FACTOR`) of `state` [cell, 5, lane].

    Args:
        table: `HeatTable`; unit: [2, lane] logarithms of the units of density and of pressure over density, SI.
    """
    rows = state.reshape(state.shape[0], ROW)
    for i in prange(state.shape[0]):
        heat_row(table.first, table.per_step, table.values, unit, rows, i, out)


def heat(
    conditions: FlowConditions, condition: int, density: np.ndarray, pressure: np.ndarray
) -> dict[str, np.ndarray]:
    """What `AirTable` holds, of scaled densities and pressures of one condition."""
    unit = conditions.density[condition]
    energy = COLD_RATIO * conditions.pressure[condition]
    table: AirTable = air_table()
    return table.look(np.asarray(density, dtype=float) * unit, np.asarray(pressure, dtype=float) * energy)


def enthalpy(conditions: FlowConditions, condition: int, density: np.ndarray, pressure: np.ndarray) -> np.ndarray:
    """Static enthalpy, scaled as a velocity squared, at scaled densities and pressures of one condition, any gas."""
    if conditions.gas != EQUILIBRIUM:
        return conditions.gamma / (conditions.gamma - 1.0) * pressure / density
    return heat(conditions, condition, density, pressure)["factor"] * pressure / density


def speed_of_sound(conditions: FlowConditions, condition: int, density: np.ndarray, pressure: np.ndarray) -> np.ndarray:
    """Scaled speed of sound at scaled densities and pressures of one condition, any gas.

    a^2 = (p/rho^2 - de/drho) / (de/dp), e being a function of p and rho: in equilibrium at every instant.
    """
    if conditions.gas != EQUILIBRIUM:
        return np.sqrt(conditions.gamma * pressure / density)
    found = heat(conditions, condition, density, pressure)
    stiff = found["factor"] + found["by_pressure"]
    return np.sqrt((found["factor"] - found["by_density"]) / (stiff - 1.0) * pressure / density)
