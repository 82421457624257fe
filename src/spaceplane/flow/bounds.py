"""Least density and pressure of the flow, and which cells stand at them."""

from __future__ import annotations

import numpy as np

from spaceplane.flow.compiled import inlined

THINNEST, THICKEST = 1e-3, 0.02
"""Smallest and largest least density, on the free stream's."""

UNSEEN = 1e-4
"""Cp that the least pressure may amount to."""

VACUUM_MACH = 2.5, 2.75
"""Air that turns by 90 deg round the edge of a base expands to a vacuum from Mach 2.5 on (a Prandtl-Meyer angle of 130
deg less 39 deg), which single precision cannot hold and in which no flow comes to rest. Slower flows reach it in
transients only, and a wake that is given more than it can draw stands otherwise: they have the smallest least density,
those beyond the second Mach number what is not seen in Cp."""


def least_values(mach: np.ndarray, gamma: float) -> np.ndarray:
    """[2, condition] least density and pressure, in the scaled units of `Solution`.

    The pressure is half of what air at the least density has that came there without loss. Were it higher, such air
    would be heated, and go on expanding to more than the free stream's total enthalpy.
    """
    fast = np.maximum(mach, VACUUM_MACH[1])
    unseen = np.minimum((2.0 * UNSEEN * 0.7 * fast**2) ** (1.0 / 1.4), THICKEST)
    share = np.interp(mach, VACUUM_MACH, [0.0, 1.0])
    density = THINNEST ** (1.0 - share) * unseen**share
    return np.array([density, 0.5 * density**1.4 / gamma])


@inlined
def bounded(r, p, dr, dp, thinnest, faintest):
    """The increments of density and pressure, raised where they would lead below the least values."""
    return max(dr, thinnest - r), max(dp, faintest - p)


@inlined
def at_bound(r, p, thinnest, faintest):
    """Whether a cell stands at the least density or pressure: what it draws from its neighbours is the bound's."""
    more = type(r)(1.00001)
    return r <= more * thinnest or p <= more * faintest
