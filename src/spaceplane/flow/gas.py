"""What the kernels know of the gas: a ratio of specific heats, or the heat of every cell.

Kernels are compiled for each kind of gas apart: those for the perfect gas know no array and cost nothing more.

For any gas the enthalpy is h = B p / rho, with B = gamma / (gamma - 1) where gamma is constant. Else B belongs to the
cell, is refilled in every iteration, and goes with its slopes: a face takes the enthalpy of its own density and
pressure, and the Jacobian is that of the gas. gamma~ = B / (B - 1) is the equivalent ratio of specific heats of
M. Vinokur and J.-L. Montagne, J. Comput. Phys. 89 (1990) 276-300, sections 2 and 3, with which the perfect gas's fluxes
hold.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import types
from numba.extending import overload

from spaceplane.flow.compiled import LANES, OPTIONS, PRS, RHO, inlined

FACTOR, BY_DENSITY, BY_PRESSURE = range(0, 3 * LANES, LANES)
"""Where a row of heats has B, rho dB/drho at constant pressure and p dB/dp at constant density, each for all lanes."""

OUTSIDE = np.int32(-1)
"""Number of the cell that stands for the free stream, of the type of all others."""


FARTHEST = 1.5
"""Most that slopes may make of a cell's B."""


class PerfectGas(NamedTuple):
    """A gas with constant specific heats.

    Attributes:
        gamma: their ratio, in the working precision.
    """

    gamma: float


class HeatedGas(NamedTuple):
    """A gas whose enthalpy is known cell by cell.

    Attributes:
        gamma: ratio of specific heats of the cold gas, on which velocity and pressure are scaled.
        heats: [cell, 3 x lane] B and its slopes, see `FACTOR`; outside: [1, 3 x lane] those of the free stream.
    """

    gamma: float
    heats: np.ndarray
    outside: np.ndarray


def by_gas(perfect: Callable, heated: Callable) -> Callable:
    """One name for two functions of a gas: kernels take in the one for the kind that they are compiled for."""

    def chosen(gas, *others):
        return (perfect if isinstance(gas, PerfectGas) else heated)(gas, *others)

    @overload(chosen, strict=False, jit_options={"forceinline": True, **OPTIONS})
    def choose(gas, *others):
        if isinstance(gas, types.BaseNamedTuple):
            return perfect if gas.instance_class is PerfectGas else heated
        return None

    return chosen


@inlined
def ratio_of(factor):
    """Equivalent ratio of specific heats gamma~ from B."""
    return factor / (factor - type(factor)(1))


def _perfect_factor(gas, i, n, r0, p0, r, p):
    return gas.gamma / (gas.gamma - type(gas.gamma)(1))


def _heated_factor(gas, i, n, r0, p0, r, p):
    one = type(gas.gamma)(1)
    heats = gas.heats
    near = heats[i, FACTOR + n] + heats[i, BY_DENSITY + n] * (r / r0 - one) + heats[i, BY_PRESSURE + n] * (p / p0 - one)
    # Heat only ever adds to the cold gas's, and slopes hold nearby only.
    return min(max(near, gas.gamma / (gas.gamma - one)), type(gas.gamma)(FARTHEST) * heats[i, FACTOR + n])


#: (gas, i, n, r0, p0, r, p) -> B in lane n at density r and pressure p, near those of cell i, r0 and p0.
factor_near = by_gas(_perfect_factor, _heated_factor)


def _perfect_ratios(gas, rows, i, side, out):
    return


def _heated_ratios(gas, rows, i, side, out):
    for n in range(LANES):
        r0 = rows[i, RHO + n]
        p0 = rows[i, PRS + n]
        out[n] = ratio_of(factor_near(gas, i, n, r0, p0, side[RHO + n], side[PRS + n]))


#: (gas, rows, i, side, out): fill `out` [lane] with gamma~ of the state `side`, reconstructed from cell i of `rows`.
fill_ratios = by_gas(_perfect_ratios, _heated_ratios)


def _perfect_nothing(gas, out):
    return


def _heated_outside(gas, out):
    for n in range(LANES):
        out[n] = ratio_of(gas.outside[0, FACTOR + n])


#: (gas, out): fill `out` [lane] with gamma~ of the free stream.
fill_outside_ratios = by_gas(_perfect_nothing, _heated_outside)


def _perfect_ratio(gas, ratios, n):
    return gas.gamma


def _heated_ratio(gas, ratios, n):
    return ratios[n]


#: (gas, ratios, n) -> gamma~ in lane n of what `fill_ratios` filled.
ratio_in = by_gas(_perfect_ratio, _heated_ratio)


def _perfect_heat(gas, i, n, r, p):
    gamma = gas.gamma
    one = type(gamma)(1)
    return gamma, gamma / (gamma - one), gamma - one, type(gamma)(0)


def _heated_heat(gas, i, n, r, p):
    heats = gas.heats
    factor = heats[i, FACTOR + n]
    one = type(factor)(1)
    stiff = factor + heats[i, BY_PRESSURE + n]
    return ratio_of(factor), stiff, one / (stiff - one), heats[i, BY_DENSITY + n] * p / r


#: (gas, i, n, r, p) -> (gamma~, d(rho h)/dp, 1 / (d(rho e)/dp), d(rho h)/drho) of cell i in lane n, its density r and
#: pressure p; for the perfect gas gamma, gamma/(gamma - 1), gamma - 1, 0. Here h and e are functions of rho and p.
heat_of = by_gas(_perfect_heat, _heated_heat)


def _perfect_between(gas, i, j, n):
    return gas.gamma


def _heated_between(gas, i, j, n):
    heats = gas.heats
    other = gas.outside[0, FACTOR + n] if j < 0 else heats[j, FACTOR + n]
    return ratio_of(type(gas.gamma)(0.5) * (heats[i, FACTOR + n] + other))


#: (gas, i, j, n) -> gamma~ in lane n between cells i and j (or `OUTSIDE`), for the speed of sound there.
ratio_between = by_gas(_perfect_between, _heated_between)
