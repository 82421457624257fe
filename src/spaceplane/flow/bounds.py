"""Least density and pressure of the flow, and which cells stand at them."""

from __future__ import annotations

from spaceplane.flow.compiled import inlined

THINNEST = 1e-3
"""Least density, on the free stream's: bases at Mach 10 pull a vacuum that single precision cannot hold."""

FAINTEST = 0.5 * THINNEST**1.4
"""Least pressure, on the free stream's: half of what air at the least density has that came there without loss. Were it
higher, such air would be heated, and go on expanding to more than the free stream's total enthalpy. At Mach 3 it is
5e-6 in Cp."""


@inlined
def bounded(r, p, dr, dp, gamma):
    """The increments of density and pressure, raised where they would lead below the least values."""
    real = type(r)
    return max(dr, real(THINNEST) - r), max(dp, real(FAINTEST) / gamma - p)


@inlined
def at_bound(r, p, gamma):
    """Whether a cell stands at the least density or pressure: what it draws from its neighbours is the bound's."""
    real = type(r)
    return r <= real(1.00001 * THINNEST) or gamma * p <= real(1.00001 * FAINTEST)
