"""Block symmetric Gauss-Seidel on the first-order Jacobian, in increments of the primitive variables.

Kernels: inverse diagonal blocks, one coloured sweep. Off-diagonal products are recomputed, never stored.
Method: block LU-SGS of R. F. Chen, Z. J. Wang, AIAA J. 38 (2000) 2238-2245, with the dissipation of `jacobian`.
"""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from spaceplane.flow.compiled import WIDTH, inlined, kernel
from spaceplane.flow.jacobian import dissipation_increment, face_average, flux_increment, wave_dissipation


@inlined
def add_dissipation(block, n, scale, r, u, v, w, a, un, d0, dp, dm, nx, ny, nz, gamma):
    """Add scale * Q (see `jacobian.dissipation_increment`) to `block` [25, lane], row-major 5 row + column."""
    real = type(r)
    one = real(1)
    half = real(0.5)
    kinetic = half * (u * u + v * v + w * w)
    enthalpy = a * a / (gamma - one) + kinetic
    d0 = d0 * scale
    mean = half * (dp + dm) * scale
    skew = half * (dp - dm) * scale
    # Column of rho: entropy wave only.
    block[0, n] += d0
    block[5, n] += d0 * u
    block[10, n] += d0 * v
    block[15, n] += d0 * w
    block[20, n] += d0 * kinetic
    # Column of p.
    inverse = one / (a * a)
    s = (mean - d0) * inverse
    t = skew / a
    block[4, n] += s
    block[9, n] += u * s + nx * t
    block[14, n] += v * s + ny * t
    block[19, n] += w * s + nz * t
    block[24, n] += enthalpy * mean * inverse - kinetic * d0 * inverse + un * t
    # Columns of velocity: sound waves along n, shear across it.
    s = skew * r / a
    t = mean * r
    z = d0 * r
    tz = t - z
    eu = enthalpy * s + un * tz
    block[1, n] += s * nx
    block[2, n] += s * ny
    block[3, n] += s * nz
    su = u * s + nx * tz
    sv = v * s + ny * tz
    sw = w * s + nz * tz
    block[6, n] += su * nx + z
    block[7, n] += su * ny
    block[8, n] += su * nz
    block[11, n] += sv * nx
    block[12, n] += sv * ny + z
    block[13, n] += sv * nz
    block[16, n] += sw * nx
    block[17, n] += sw * ny
    block[18, n] += sw * nz + z
    block[21, n] += eu * nx + z * u
    block[22, n] += eu * ny + z * v
    block[23, n] += eu * nz + z * w


@inlined
def add_flux(block, n, scale, r, u, v, w, p, nx, ny, nz, gamma):
    """Add scale * A_n (see `jacobian.flux_increment`) to `block`."""
    real = type(r)
    one = real(1)
    un = u * nx + v * ny + w * nz
    kinetic = real(0.5) * (u * u + v * v + w * w)
    stiff = gamma / (gamma - one)
    m = scale * r * un
    c = scale * un
    block[0, n] += c
    block[5, n] += c * u
    block[10, n] += c * v
    block[15, n] += c * w
    block[20, n] += c * kinetic
    block[9, n] += scale * nx
    block[14, n] += scale * ny
    block[19, n] += scale * nz
    block[24, n] += c * stiff
    s = scale * r
    e = scale * (stiff * p + r * kinetic)
    block[1, n] += s * nx
    block[2, n] += s * ny
    block[3, n] += s * nz
    block[6, n] += s * u * nx + m
    block[7, n] += s * u * ny
    block[8, n] += s * u * nz
    block[11, n] += s * v * nx
    block[12, n] += s * v * ny + m
    block[13, n] += s * v * nz
    block[16, n] += s * w * nx
    block[17, n] += s * w * ny
    block[18, n] += s * w * nz + m
    block[21, n] += e * nx + m * u
    block[22, n] += e * ny + m * v
    block[23, n] += e * nz + m * w


@inlined
def add_mass(block, n, scale, r, u, v, w, gamma):
    """Add scale * dq/d(primitive) to `block`."""
    real = type(r)
    block[0, n] += scale
    block[5, n] += scale * u
    block[10, n] += scale * v
    block[15, n] += scale * w
    block[20, n] += scale * real(0.5) * (u * u + v * v + w * w)
    s = scale * r
    block[6, n] += s
    block[12, n] += s
    block[18, n] += s
    block[21, n] += s * u
    block[22, n] += s * v
    block[23, n] += s * w
    block[24, n] += scale / (gamma - real(1))


@inlined
def invert(block, lanes):
    """Invert the 5 x 5 blocks [25, lane] in place (Gauss-Jordan; the blocks are diagonally dominant enough for no
    pivoting)."""
    for k in range(5):
        for n in range(lanes):
            block[6 * k, n] = type(block[0, n])(1) / block[6 * k, n]
        for c in range(5):
            if c != k:
                for n in range(lanes):
                    block[5 * k + c, n] *= block[6 * k, n]
        for r in range(5):
            if r != k:
                for c in range(5):
                    if c != k:
                        for n in range(lanes):
                            block[5 * r + c, n] -= block[5 * r + k, n] * block[5 * k + c, n]
                for n in range(lanes):
                    block[5 * r + k, n] *= -block[6 * k, n]


@kernel
def diagonals(topology, state, sensor, free, cfl, gamma, stiffness, out):
    """Fill `out` [cell, 25, lane] with the inverse diagonal blocks, pseudo-time term included.

    Args:
        free: [far face, 5, lane] state outside the far field.
        cfl: [lane] CFL number on the sum of spectral radii over the faces.
    """
    lanes = state.shape[2]
    start = topology.start
    other = topology.other
    normal = topology.normal
    areas = topology.area
    edge_start = topology.edge_start
    edge_row = topology.edge_row
    edge_normal = topology.boundary_normal
    edge_area = topology.boundary_area
    walls = topology.walls
    chunk_cells = topology.chunk_cells
    for chunk in prange(chunk_cells.shape[0] - 1):
        block = np.empty((25, WIDTH), state.dtype)
        radius = np.empty(WIDTH, state.dtype)
        for i in range(chunk_cells[chunk], chunk_cells[chunk + 1]):
            real = type(gamma)
            half = real(0.5)
            block[:] = real(0)
            radius[:] = real(0)
            for e in range(start[i], start[i + 1]):
                j = other[e]
                nx = normal[e, 0]
                ny = normal[e, 1]
                nz = normal[e, 2]
                scale = half * areas[e]
                for n in range(lanes):
                    r, u, v, w, a, un = face_average(
                        state[i, 0, n],
                        state[i, 1, n],
                        state[i, 2, n],
                        state[i, 3, n],
                        state[i, 4, n],
                        state[j, 0, n],
                        state[j, 1, n],
                        state[j, 2, n],
                        state[j, 3, n],
                        state[j, 4, n],
                        nx,
                        ny,
                        nz,
                        gamma,
                    )
                    theta = max(sensor[i, n], sensor[j, n])
                    d0, dp, dm = wave_dissipation(un, a, theta)
                    radius[n] += scale * (abs(un) + a)
                    add_dissipation(block, n, scale, r, u, v, w, a, un, d0, dp, dm, nx, ny, nz, gamma)
            for m in range(edge_start[i], edge_start[i + 1]):
                row = edge_row[m]
                nx = edge_normal[row, 0]
                ny = edge_normal[row, 1]
                nz = edge_normal[row, 2]
                area = edge_area[row]
                scale = half * area
                if row < walls:
                    for n in range(lanes):
                        r = state[i, 0, n]
                        u = state[i, 1, n]
                        v = state[i, 2, n]
                        w = state[i, 3, n]
                        p = state[i, 4, n]
                        a = math.sqrt(gamma * p / r)
                        radius[n] += scale * a
                        # Half of A_n is what the closed sum over faces leaves out; the wall's own flux is pressure.
                        add_flux(block, n, -scale, r, u, v, w, p, nx, ny, nz, gamma)
                        push = area * max(stiffness, half) * r * a
                        block[9, n] += area * nx
                        block[14, n] += area * ny
                        block[19, n] += area * nz
                        block[6, n] += push * nx * nx
                        block[7, n] += push * nx * ny
                        block[8, n] += push * nx * nz
                        block[11, n] += push * ny * nx
                        block[12, n] += push * ny * ny
                        block[13, n] += push * ny * nz
                        block[16, n] += push * nz * nx
                        block[17, n] += push * nz * ny
                        block[18, n] += push * nz * nz
                else:
                    far = row - walls
                    for n in range(lanes):
                        r, u, v, w, a, un = face_average(
                            state[i, 0, n],
                            state[i, 1, n],
                            state[i, 2, n],
                            state[i, 3, n],
                            state[i, 4, n],
                            free[far, 0, n],
                            free[far, 1, n],
                            free[far, 2, n],
                            free[far, 3, n],
                            free[far, 4, n],
                            nx,
                            ny,
                            nz,
                            gamma,
                        )
                        d0, dp, dm = wave_dissipation(un, a, real(0))
                        radius[n] += scale * (abs(un) + a)
                        add_dissipation(block, n, scale, r, u, v, w, a, un, d0, dp, dm, nx, ny, nz, gamma)
            for n in range(lanes):
                add_mass(
                    block, n, radius[n] / cfl[n], state[i, 0, n], state[i, 1, n], state[i, 2, n], state[i, 3, n], gamma
                )
            invert(block, lanes)
            for k in range(25):
                for n in range(lanes):
                    out[i, k, n] = block[k, n]


@kernel
def sweep(topology, state, sensor, residual, inverse, change, gamma, forward):
    """One Gauss-Seidel pass over all cells, colour by colour: change_i = D^-1 (-residual_i - sum of off-diagonal
    products).

    Blocks of one colour do not touch, so that the result does not depend on the number of threads.
    """
    lanes = state.shape[2]
    start = topology.start
    other = topology.other
    normal = topology.normal
    areas = topology.area
    block_cells = topology.block_cells
    color_start = topology.color_start
    color_blocks = topology.color_blocks
    colors = color_start.shape[0] - 1
    for step in range(colors):
        color = step if forward else colors - 1 - step
        begin = color_start[color]
        for b in prange(color_start[color + 1] - begin):
            block = color_blocks[begin + b]
            first = block_cells[block]
            count = block_cells[block + 1] - first
            rhs = np.empty((5, WIDTH), state.dtype)
            for m in range(count):
                i = first + m if forward else first + count - 1 - m
                real = type(gamma)
                half = real(0.5)
                for k in range(5):
                    for n in range(lanes):
                        rhs[k, n] = -residual[i, k, n]
                for e in range(start[i], start[i + 1]):
                    j = other[e]
                    nx = normal[e, 0]
                    ny = normal[e, 1]
                    nz = normal[e, 2]
                    scale = half * areas[e]
                    for n in range(lanes):
                        rj = state[j, 0, n]
                        uj = state[j, 1, n]
                        vj = state[j, 2, n]
                        wj = state[j, 3, n]
                        pj = state[j, 4, n]
                        d_r = change[j, 0, n]
                        d_u = change[j, 1, n]
                        d_v = change[j, 2, n]
                        d_w = change[j, 3, n]
                        d_p = change[j, 4, n]
                        r, u, v, w, a, un = face_average(
                            state[i, 0, n],
                            state[i, 1, n],
                            state[i, 2, n],
                            state[i, 3, n],
                            state[i, 4, n],
                            rj,
                            uj,
                            vj,
                            wj,
                            pj,
                            nx,
                            ny,
                            nz,
                            gamma,
                        )
                        theta = max(sensor[i, n], sensor[j, n])
                        d0, dp, dm = wave_dissipation(un, a, theta)
                        f0, f1, f2, f3, f4 = flux_increment(
                            rj, uj, vj, wj, pj, d_r, d_u, d_v, d_w, d_p, nx, ny, nz, gamma
                        )
                        g0, g1, g2, g3, g4 = dissipation_increment(
                            r, u, v, w, a, d0, dp, dm, d_r, d_u, d_v, d_w, d_p, nx, ny, nz, gamma
                        )
                        rhs[0, n] -= scale * (f0 - g0)
                        rhs[1, n] -= scale * (f1 - g1)
                        rhs[2, n] -= scale * (f2 - g2)
                        rhs[3, n] -= scale * (f3 - g3)
                        rhs[4, n] -= scale * (f4 - g4)
                for k in range(5):
                    for n in range(lanes):
                        change[i, k, n] = (
                            inverse[i, 5 * k, n] * rhs[0, n]
                            + inverse[i, 5 * k + 1, n] * rhs[1, n]
                            + inverse[i, 5 * k + 2, n] * rhs[2, n]
                            + inverse[i, 5 * k + 3, n] * rhs[3, n]
                            + inverse[i, 5 * k + 4, n] * rhs[4, n]
                        )


@kernel
def squared_norms(topology, residual, out):
    """Fill `out` [chunk, lane] (fp64) with the sum of (net mass outflow)^2/volume over the chunk's cells."""
    lanes = residual.shape[2]
    chunk_cells = topology.chunk_cells
    for chunk in prange(chunk_cells.shape[0] - 1):
        total = np.zeros(lanes, np.float64)
        for i in range(chunk_cells[chunk], chunk_cells[chunk + 1]):
            scale = 1.0 / topology.volume[i]
            for n in range(lanes):
                value = np.float64(residual[i, 0, n])
                total[n] += value * value * scale
        out[chunk] = total
