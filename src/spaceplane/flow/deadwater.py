"""Dead water: separated air behind a blunt base, which inviscid flow leaves to swing and the real one to turbulence.

A wake without viscosity has no steady state on a fine mesh: its shear layers roll up, the base pressure wanders, and
derivatives taken from it are noise. Real wakes are calmed by eddy viscosity. Here the slopes are taken out of dead
water, so that the upwind flux acts there as the eddy viscosity; attached flow never enters.
"""

from __future__ import annotations

from spaceplane.flow.compiled import inlined

HEAD_BEGINS, HEAD_FULL = 0.5, 1.0 / 6.0
"""Head below which slopes begin to go, and below which they are gone."""


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
