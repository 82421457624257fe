"""HLLE flux: smears contacts, has no carbuncle; used in strong shocks.

A. Harten, P. D. Lax, B. van Leer, SIAM Rev. 25 (1983) 35-61, with the speeds of Einfeldt (1988). The jump that is
dissipated in the energy equation is that of rho H, not of rho E (A. Jameson, Int. J. Comput. Fluid Dyn. 4 (1995)
171-218): total enthalpy travels with the mass, and steady flow keeps the free stream's everywhere.
"""

from __future__ import annotations

import math

from spaceplane.flow.compiled import inlined
from spaceplane.flow.fluxes.waves import wave_speeds


@inlined
def hlle(rl, ul, vl, wl, pl, rr, ur, vr, wr, pr, nx, ny, nz, gl, gr, p0):
    """Flux of mass, momentum and energy per unit area; arguments as in `hllc`."""
    real = type(rl)
    zero = real(0)
    one = real(1)
    half = real(0.5)
    unl = ul * nx + vl * ny + wl * nz
    unr = ur * nx + vr * ny + wr * nz
    al = math.sqrt(gl * pl / rl)
    ar = math.sqrt(gr * pr / rr)
    slow, fast = wave_speeds(rl, unl, al, rr, unr, ar)
    slow = min(slow, zero)
    fast = max(fast, zero)
    scale = one / (fast - slow)
    a = fast * scale
    b = -slow * scale
    d = slow * fast * scale
    ml = rl * (a * unl - d)
    mr = rr * (b * unr + d)
    hl = gl / (gl - one) * pl / rl + half * (ul * ul + vl * vl + wl * wl)
    hr = gr / (gr - one) * pr / rr + half * (ur * ur + vr * vr + wr * wr)
    q = a * (pl - p0) + b * (pr - p0)
    return (
        ml + mr,
        ml * ul + mr * ur + q * nx,
        ml * vl + mr * vr + q * ny,
        ml * wl + mr * wr + q * nz,
        ml * hl + mr * hr,
    )
