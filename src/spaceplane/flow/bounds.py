"""Least density and pressure of the flow, and which cells stand at them."""

from __future__ import annotations

from spaceplane.flow.compiled import inlined

THINNEST = 1e-3
"""Least density and pressure, on the free stream's: bases at Mach 10 pull a vacuum that single precision cannot hold.
At Mach 3 it is 1.6e-4 in Cp, at Mach 10 1.4e-5."""


@inlined
def bounded(r, p, dr, dp, gamma):
    """The increments of density and pressure, raised where they would lead below the least values."""
    thinnest = type(r)(THINNEST)
    return max(dr, thinnest - r), max(dp, thinnest / gamma - p)


@inlined
def at_bound(r, p, gamma):
    """Whether a cell stands at the least density or pressure: what it draws from its neighbours is the bound's."""
    nearly = type(r)(1.00001 * THINNEST)
    return r <= nearly or gamma * p <= nearly
