"""HLLC flux: resolves contacts and shear; used away from strong shocks.

E. F. Toro, M. Spruce, W. Speares, Shock Waves 4 (1994) 25-34; wave speed of the contact from P. Batten et al.,
SIAM J. Sci. Comput. 18 (1997) 1553-1570, eq. 37. The energy flux is the mass flux times the upwind total enthalpy,
as in M.-S. Liou, J. Comput. Phys. 129 (1996) 364-382: steady flow then keeps the free stream's everywhere, shocks
included.
"""

from __future__ import annotations

import math

from spaceplane.flow.compiled import inlined
from spaceplane.flow.fluxes.waves import wave_speeds


@inlined
def hllc(rl, ul, vl, wl, pl, rr, ur, vr, wr, pr, nx, ny, nz, gl, gr, p0):
    """Flux of mass, momentum and energy per unit area through a face with unit normal n.

    States are (density, velocity xyz, pressure), `gl` and `gr` their ratios of specific heats (equivalent ones, see
    `flow.gas`); `p0` is taken off
    the pressure in the momentum flux, which changes nothing on closed cells and saves digits.
    """
    real = type(rl)
    zero = real(0)
    one = real(1)
    half = real(0.5)
    unl = ul * nx + vl * ny + wl * nz
    unr = ur * nx + vr * ny + wr * nz
    al = math.sqrt(gl * pl / rl)
    ar = math.sqrt(gr * pr / rr)
    slow, fast = wave_speeds(rl, unl, al, rr, unr, ar)
    ml = rl * (slow - unl)
    mr = rr * (fast - unr)
    contact = (pr - pl + ml * unl - mr * unr) / (ml - mr)
    left = contact >= zero
    r = rl if left else rr
    u = ul if left else ur
    v = vl if left else vr
    w = wl if left else wr
    p = pl if left else pr
    un = unl if left else unr
    gamma = gl if left else gr
    s = slow if left else fast
    c = min(slow, zero) if left else max(fast, zero)
    energy = p / (gamma - one) + half * r * (u * u + v * v + w * w)
    star = r * (s - un) / (s - contact)
    push = star * (contact - un)
    mass = r * un + c * (star - r)
    gain = star - r
    flux_energy = mass * (energy + p) / r
    q = p - p0
    return (
        mass,
        r * un * u + q * nx + c * (gain * u + push * nx),
        r * un * v + q * ny + c * (gain * v + push * ny),
        r * un * w + q * nz + c * (gain * w + push * nz),
        flux_energy,
    )
