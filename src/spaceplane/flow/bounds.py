"""Least density and pressure of the flow, and which cells stand at them."""

from __future__ import annotations

import numpy as np

from spaceplane.flow.compiled import inlined

THINNEST = 1e-3, 2e-2
"""Least density, on the free stream's, up to the first and from the second Mach number of `VACUUM_MACH` on."""

VACUUM_MACH = 2.5, 2.75
"""Air that turns by 90 deg round the edge of a base expands to a vacuum from Mach 2.5 on (a Prandtl-Meyer angle of 130
deg less 39 deg), which single precision cannot hold and in which no flow comes to rest. Slower flows reach it in
transients only, and a wake that is given more than it can draw stands otherwise."""


NEAR = 1.00001
"""Density or pressure, on its least value, up to which a cell stands at the bound."""


def least_values(mach: np.ndarray, gamma: float) -> np.ndarray:
    """[2, condition] least density and pressure, in the scaled units of `Solution`.

    The pressure is half of what air at the least density has that came there without loss: 4e-4 in Cp at Mach 2.75,
    1e-4 at Mach 5. Were it higher, such air would be heated, and go on expanding to more than the free stream's total
    enthalpy.
    """
    density = np.exp(np.interp(mach, VACUUM_MACH, np.log(THINNEST)))
    return np.array([density, 0.5 * density**gamma / gamma])


@inlined
def bounded(r, p, dr, dp, thinnest, faintest):
    """The increments of density and pressure, raised where they would lead below the least values."""
    return max(dr, thinnest - r), max(dp, faintest - p)


@inlined
def at_bound(r, p, thinnest, faintest):
    """Whether a cell stands at the least density or pressure: what it draws from its neighbours is the bound's."""
    more = type(r)(NEAR)
    return r <= more * thinnest or p <= more * faintest


def cells_at_bound(state: np.ndarray, least: np.ndarray) -> np.ndarray:
    """Indices of the cells of `state` [cell, 5] that stand at one of the `least` [2] values."""
    near = state.dtype.type(NEAR) * least
    return np.flatnonzero((state[:, 0] <= near[0]) | (state[:, 4] <= near[1]))
