"""Pieces of the first-order Jacobian, in increments of the primitive variables (rho, u, v, w, p).

The linearised flux through a face is half of (A_i dq_i + A_j dq_j) - Q (dq_j - dq_i), with Q the dissipation matrix
of the
flux actually used: eigenvalues |un +- a| on sound waves and `d0` on entropy and shear waves (|un| for HLLC, the chord
of
HLLE between the sound waves for HLLE); both carry total enthalpy with the mass, so that its jump is dissipated by `d0`.
Q must match the flux, else large CFL numbers diverge.
Wave decomposition: P. L. Roe, J. Comput. Phys. 43 (1981) 357-372.
"""

from __future__ import annotations

import math

from spaceplane.flow.compiled import inlined


@inlined
def wave_dissipation(un, a, theta):
    """(d0, dp, dm): dissipation of entropy and shear waves and of the two sound waves un + a, un - a."""
    real = type(un)
    zero = real(0)
    fast = max(un + a, zero)
    slow = min(un - a, zero)
    chord = ((fast + slow) * un - real(2) * slow * fast) / (fast - slow)
    floor = real(0.05) * a
    calm = max(abs(un), floor)
    return calm + theta * (max(chord, floor) - calm), max(abs(un + a), floor), max(abs(un - a), floor)


@inlined
def flux_increment(r, u, v, w, p, dr, du, dv, dw, dp, nx, ny, nz, heat):
    """A_n dq: increment of the physical flux through a unit area, conservative, from primitive increments.

    `heat` holds the gas's derivatives at the state, see `gas.heat_of`.
    """
    real = type(r)
    half = real(0.5)
    gamma, stiff, _, slope = heat
    un = u * nx + v * ny + w * nz
    dun = du * nx + dv * ny + dw * nz
    dm = r * dun + un * dr
    m = r * un
    kinetic = half * (u * u + v * v + w * w)
    factor = gamma / (gamma - real(1))
    energy = (factor * p + r * kinetic) * dun + un * (
        stiff * dp + (kinetic + slope) * dr + r * (u * du + v * dv + w * dw)
    )
    return dm, dm * u + m * du + dp * nx, dm * v + m * dv + dp * ny, dm * w + m * dw + dp * nz, energy


@inlined
def dissipation_increment(r, u, v, w, a, d0, dp_, dm_, dr, du, dv, dw, dp, nx, ny, nz, heat):
    """Q dq at a face with density r, velocity (u, v, w), sound speed a and wave dissipations d0, dp_, dm_.

    `heat` holds gamma~ at the face and the gas's derivatives at the side that dq belongs to, see `gas.heat_of`.
    """
    real = type(r)
    one = real(1)
    gamma, stiff, _, slope = heat
    half = real(0.5)
    dun = du * nx + dv * ny + dw * nz
    inverse = one / (a * a)
    up = half * dp_ * (dp * inverse + r * dun / a)
    down = half * dm_ * (dp * inverse - r * dun / a)
    s = up + down
    t = (up - down) * a
    z = d0 * (dr - dp * inverse)
    shear = d0 * r
    static = a * a / (gamma - one)
    enthalpy = static + half * (u * u + v * v + w * w)
    return (
        s + z,
        u * (s + z) + nx * t + shear * (du - nx * dun),
        v * (s + z) + ny * t + shear * (dv - ny * dun),
        w * (s + z) + nz * t + shear * (dw - nz * dun),
        enthalpy * (s + z) + d0 * (stiff * dp - (static - slope) * dr) + shear * (u * du + v * dv + w * dw),
    )


@inlined
def face_average(ri, ui, vi, wi, pi, rj, uj, vj, wj, pj, nx, ny, nz, gamma):
    """(r, u, v, w, a, un) of the plain average of two states."""
    real = type(ri)
    half = real(0.5)
    r = half * (ri + rj)
    u = half * (ui + uj)
    v = half * (vi + vj)
    w = half * (wi + wj)
    a = math.sqrt(gamma * (pi + pj) / (ri + rj))
    return r, u, v, w, a, u * nx + v * ny + w * nz
