"""Dead water and thin air: behind a blunt base, where inviscid flow is left to swing and the real one to turbulence.

A wake without viscosity has no steady state on a fine mesh: its shear layers roll up, the base pressure wanders, and
derivatives taken from it are noise. Real wakes are calmed by eddy viscosity. Here the slopes are taken out of dead
water, so that the upwind flux acts there as the eddy viscosity; attached flow never enters. The same holds for the
thin air round it at high Mach numbers, between the vacuum that the least density stands for and the jets that close
behind it: with slopes its residual falls by 2.3 decades and stays, without by four.
"""

from __future__ import annotations

from spaceplane.flow.compiled import inlined

HEAD_BEGINS, HEAD_FULL = 0.5, 1.0 / 6.0
"""Head below which slopes begin to go, and below which they are gone."""

THIN_BEGINS, THIN_FULL = 15.0, 5.0
"""Density, on the least one (see `bounds`), below which slopes begin to go, and below which they are gone: 0.3 and 0.1
of the free stream's from Mach 2.75 up, 0.015 and 0.005 up to Mach 2.5."""


@inlined
def dead_water(u, v, w, p, p0, per_pressure, share):
    """Part of the slopes to take out, 0 to `share`, by the head Cp + (V/V_inf)^2.

    The head is about 1 in any attached flow at any Mach number: Bernoulli gives 1 + O(M^2) without shocks, a stagnation
    point 1 to 1.84, a supersonic expansion 1 - 1.43/M^2 or more; it is near 0 only where air neither moves nor presses.

    Args:
        p0: free-stream pressure; `per_pressure` 1/q_inf, which is 1/(V_inf^2/2) as well in the scaled units.
    """
    real = type(p)
    head = (p - p0 + real(0.5) * (u * u + v * v + w * w)) * per_pressure
    x = (real(HEAD_BEGINS) - head) * real(1.0 / (HEAD_BEGINS - HEAD_FULL))
    return share * min(max(x, real(0)), real(1))


@inlined
def thin_air(r, thinnest, share):
    """Part of the slopes to take out, 0 to `share`, by the density on the least one."""
    real = type(r)
    x = (real(THIN_BEGINS) - r / thinnest) * real(1.0 / (THIN_BEGINS - THIN_FULL))
    return share * min(max(x, real(0)), real(1))
