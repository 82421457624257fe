"""Block symmetric Gauss-Seidel on the first-order Jacobian, in increments of the primitive variables.

Kernels: inverse diagonal blocks, one coloured sweep. Off-diagonal products are recomputed, never stored.
Method: block LU-SGS of R. F. Chen, Z. J. Wang, AIAA J. 38 (2000) 2238-2245, with the dissipation of `jacobian`.
"""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from spaceplane.flow.bounds import at_bound, bounded
from spaceplane.flow.compiled import LANES, PRS, RHO, ROW, VX, VY, VZ, distinct, inlined, kernel
from spaceplane.flow.gas import OUTSIDE, heat_of, ratio_between
from spaceplane.flow.jacobian import dissipation_increment, face_average, flux_increment, wave_dissipation


@inlined
def add_dissipation(block, n, scale, r, u, v, w, a, d0, dp, dm, nx, ny, nz, heat):
    """Add scale * Q (see `jacobian.dissipation_increment`) to `block` [25 x lane], row-major 5 row + column."""
    real = type(r)
    one = real(1)
    half = real(0.5)
    gamma, stiff, _, slope = heat
    kinetic = half * (u * u + v * v + w * w)
    enthalpy = a * a / (gamma - one) + kinetic
    d0 = d0 * scale
    mean = half * (dp + dm) * scale
    skew = half * (dp - dm) * scale
    # Column of rho: entropy wave only.
    block[0 * LANES + n] += d0
    block[5 * LANES + n] += d0 * u
    block[10 * LANES + n] += d0 * v
    block[15 * LANES + n] += d0 * w
    block[20 * LANES + n] += d0 * (kinetic + slope)
    # Column of p.
    inverse = one / (a * a)
    s = (mean - d0) * inverse
    t = skew / a
    block[4 * LANES + n] += s
    block[9 * LANES + n] += u * s + nx * t
    block[14 * LANES + n] += v * s + ny * t
    block[19 * LANES + n] += w * s + nz * t
    block[24 * LANES + n] += enthalpy * s + d0 * stiff
    # Columns of velocity: sound waves along n, shear across it.
    s = skew * r / a
    t = mean * r
    z = d0 * r
    tz = t - z
    es = enthalpy * s
    block[1 * LANES + n] += s * nx
    block[2 * LANES + n] += s * ny
    block[3 * LANES + n] += s * nz
    su = u * s + nx * tz
    sv = v * s + ny * tz
    sw = w * s + nz * tz
    block[6 * LANES + n] += su * nx + z
    block[7 * LANES + n] += su * ny
    block[8 * LANES + n] += su * nz
    block[11 * LANES + n] += sv * nx
    block[12 * LANES + n] += sv * ny + z
    block[13 * LANES + n] += sv * nz
    block[16 * LANES + n] += sw * nx
    block[17 * LANES + n] += sw * ny
    block[18 * LANES + n] += sw * nz + z
    block[21 * LANES + n] += es * nx + z * u
    block[22 * LANES + n] += es * ny + z * v
    block[23 * LANES + n] += es * nz + z * w


@inlined
def add_flux(block, n, scale, r, u, v, w, p, nx, ny, nz, heat):
    """Add scale * A_n (see `jacobian.flux_increment`) to `block`."""
    real = type(r)
    gamma, stiff, _, slope = heat
    un = u * nx + v * ny + w * nz
    kinetic = real(0.5) * (u * u + v * v + w * w)
    factor = gamma / (gamma - real(1))
    m = scale * r * un
    c = scale * un
    block[0 * LANES + n] += c
    block[5 * LANES + n] += c * u
    block[10 * LANES + n] += c * v
    block[15 * LANES + n] += c * w
    block[20 * LANES + n] += c * (kinetic + slope)
    block[9 * LANES + n] += scale * nx
    block[14 * LANES + n] += scale * ny
    block[19 * LANES + n] += scale * nz
    block[24 * LANES + n] += c * stiff
    s = scale * r
    e = scale * (factor * p + r * kinetic)
    block[1 * LANES + n] += s * nx
    block[2 * LANES + n] += s * ny
    block[3 * LANES + n] += s * nz
    block[6 * LANES + n] += s * u * nx + m
    block[7 * LANES + n] += s * u * ny
    block[8 * LANES + n] += s * u * nz
    block[11 * LANES + n] += s * v * nx
    block[12 * LANES + n] += s * v * ny + m
    block[13 * LANES + n] += s * v * nz
    block[16 * LANES + n] += s * w * nx
    block[17 * LANES + n] += s * w * ny
    block[18 * LANES + n] += s * w * nz + m
    block[21 * LANES + n] += e * nx + m * u
    block[22 * LANES + n] += e * ny + m * v
    block[23 * LANES + n] += e * nz + m * w


@inlined
def add_mass(block, n, scale, r, u, v, w, heat):
    """Add scale * dq/d(primitive) to `block`."""
    real = type(r)
    _, _, soft, slope = heat
    block[0 * LANES + n] += scale
    block[5 * LANES + n] += scale * u
    block[10 * LANES + n] += scale * v
    block[15 * LANES + n] += scale * w
    block[20 * LANES + n] += scale * (real(0.5) * (u * u + v * v + w * w) + slope)
    s = scale * r
    block[6 * LANES + n] += s
    block[12 * LANES + n] += s
    block[18 * LANES + n] += s
    block[21 * LANES + n] += s * u
    block[22 * LANES + n] += s * v
    block[23 * LANES + n] += s * w
    block[24 * LANES + n] += scale / soft


@distinct
def invert(block):
    """Invert the 5 x 5 blocks [25 x lane] in place (Gauss-Jordan; the blocks are diagonally dominant enough for no
    pivoting)."""
    one = type(block[0])(1)
    for k in range(5):
        pivot = 6 * k * LANES
        for n in range(LANES):
            block[pivot + n] = one / block[pivot + n]
        for c in range(5):
            if c != k:
                across = (5 * k + c) * LANES
                for n in range(LANES):
                    block[across + n] *= block[pivot + n]
        for r in range(5):
            if r != k:
                down = (5 * r + k) * LANES
                for c in range(5):
                    if c != k:
                        here = (5 * r + c) * LANES
                        across = (5 * k + c) * LANES
                        for n in range(LANES):
                            block[here + n] -= block[down + n] * block[across + n]
                for n in range(LANES):
                    block[down + n] *= -block[pivot + n]


@inlined
def between(rows, i, there, j, k, n, nx, ny, nz, gas):
    """`face_average` and gamma~ of cell i of `rows` and row j of `there`, in lane n; the gas knows the latter as k."""
    ratio = ratio_between(gas, i, k, n)
    mean = face_average(
        rows[i, RHO + n],
        rows[i, VX + n],
        rows[i, VY + n],
        rows[i, VZ + n],
        rows[i, PRS + n],
        there[j, RHO + n],
        there[j, VX + n],
        there[j, VY + n],
        there[j, VZ + n],
        there[j, PRS + n],
        nx,
        ny,
        nz,
        ratio,
    )
    return mean, ratio


@distinct
def add_face(block, radius, rows, i, there, j, k, theta, scale, nx, ny, nz, gas):
    """Add scale * Q of the face between cell i of `rows` and row j of `there` (see `between`) to `block`, its spectral
    radius to `radius`; `theta` [lane] weight of HLLE."""
    for n in range(LANES):
        (r, u, v, w, a, un), ratio = between(rows, i, there, j, k, n, nx, ny, nz, gas)
        # A face dissipates the jump of each side's own enthalpy: averages of its slopes across a shock are neither's.
        _, stiff, soft, slope = heat_of(gas, i, n, rows[i, RHO + n], rows[i, PRS + n])
        d0, dp, dm = wave_dissipation(un, a, theta[n])
        radius[n] += scale * (abs(un) + a)
        add_dissipation(block, n, scale, r, u, v, w, a, d0, dp, dm, nx, ny, nz, (ratio, stiff, soft, slope))


@distinct
def add_wall(block, radius, rows, i, area, nx, ny, nz, gas, stiffness):
    """Add a wall face of cell i to `block` and `radius`."""
    half = type(gas.gamma)(0.5)
    scale = half * area
    for n in range(LANES):
        r = rows[i, RHO + n]
        p = rows[i, PRS + n]
        heat = heat_of(gas, i, n, r, p)
        a = math.sqrt(heat[0] * p / r)
        radius[n] += scale * a
        # Half of A_n is what the closed sum over faces leaves out; the wall's own flux is pressure.
        add_flux(block, n, -scale, r, rows[i, VX + n], rows[i, VY + n], rows[i, VZ + n], p, nx, ny, nz, heat)
        push = area * max(stiffness, half) * r * a
        block[9 * LANES + n] += area * nx
        block[14 * LANES + n] += area * ny
        block[19 * LANES + n] += area * nz
        block[6 * LANES + n] += push * nx * nx
        block[7 * LANES + n] += push * nx * ny
        block[8 * LANES + n] += push * nx * nz
        block[11 * LANES + n] += push * ny * nx
        block[12 * LANES + n] += push * ny * ny
        block[13 * LANES + n] += push * ny * nz
        block[16 * LANES + n] += push * nz * nx
        block[17 * LANES + n] += push * nz * ny
        block[18 * LANES + n] += push * nz * nz


@distinct
def diagonal_chunk(
    topology, first, last, rows, sensor, free, cfl, pace, again, gas, stiffness, out, block, radius, theta
):
    """The part of `diagonals` for cells `first` to `last`; scratch rows from `block` on."""
    start = topology.start
    other = topology.other
    normal = topology.normal
    areas = topology.area
    edge_start = topology.edge_start
    edge_row = topology.edge_row
    edge_normal = topology.boundary_normal
    edge_area = topology.boundary_area
    walls = topology.walls
    half = type(gas.gamma)(0.5)
    zero = type(gas.gamma)(0)
    for i in range(first, last):
        for k in range(25 * LANES):
            block[k] = zero
        for n in range(LANES):
            radius[n] = zero
        for e in range(start[i], start[i + 1]):
            j = other[e]
            for n in range(LANES):
                theta[n] = max(sensor[i, n], sensor[j, n])
            nx = normal[e, 0]
            ny = normal[e, 1]
            nz = normal[e, 2]
            add_face(block, radius, rows, i, rows, j, j, theta, half * areas[e], nx, ny, nz, gas)
        for m in range(edge_start[i], edge_start[i + 1]):
            row = edge_row[m]
            nx = edge_normal[row, 0]
            ny = edge_normal[row, 1]
            nz = edge_normal[row, 2]
            area = edge_area[row]
            if row < walls:
                add_wall(block, radius, rows, i, area, nx, ny, nz, gas, stiffness)
            else:
                for n in range(LANES):
                    theta[n] = zero
                add_face(
                    block, radius, rows, i, free, np.int32(row - walls), OUTSIDE, theta, half * area, nx, ny, nz, gas
                )
        for n in range(LANES):
            u = rows[i, VX + n]
            v = rows[i, VY + n]
            w = rows[i, VZ + n]
            r = rows[i, RHO + n]
            heat = heat_of(gas, i, n, r, rows[i, PRS + n])
            add_mass(block, n, radius[n] / (cfl[n] * pace[i, n]), r, u, v, w, heat)
        invert(block)
        for k in range(0, 25 * LANES, LANES):
            for n in range(LANES):
                out[i, k + n] = block[k + n] if again[n] > zero else out[i, k + n]


@kernel
def diagonals(topology, state, sensor, free, cfl, pace, again, gas, stiffness, out):
    """Fill `out` [cell, 25 x lane] with the inverse diagonal blocks, pseudo-time term included.

    Args:
        free: [far face, 5, lane] state outside the far field.
        cfl: [lane] CFL number on the sum of spectral radii over the faces; `pace` [cell, lane] factor on it.
        again: [lane] 0 where the blocks stay as they are.
        gas: see `gas`; its heats are those of `state`.
    """
    rows = state.reshape(state.shape[0], ROW)
    outside = free.reshape(free.shape[0], ROW)
    chunk_cells = topology.chunk_cells
    for chunk in prange(chunk_cells.shape[0] - 1):
        first = chunk_cells[chunk]
        last = chunk_cells[chunk + 1]
        block = np.empty(25 * LANES, state.dtype)
        radius = np.empty(LANES, state.dtype)
        theta = np.empty(LANES, state.dtype)
        diagonal_chunk(
            topology, first, last, rows, sensor, outside, cfl, pace, again, gas, stiffness, out, block, radius, theta
        )


@distinct
def add_products(sums, rows, sensor, change, i, j, scale, nx, ny, nz, gas):
    """Add to `sums` the off-diagonal block of cell i for its neighbour j times the neighbour's change."""
    for n in range(LANES):
        rj = rows[j, RHO + n]
        uj = rows[j, VX + n]
        vj = rows[j, VY + n]
        wj = rows[j, VZ + n]
        pj = rows[j, PRS + n]
        d_r = change[j, RHO + n]
        d_u = change[j, VX + n]
        d_v = change[j, VY + n]
        d_w = change[j, VZ + n]
        d_p = change[j, PRS + n]
        (r, u, v, w, a, un), ratio = between(rows, i, rows, j, j, n, nx, ny, nz, gas)
        d0, dp, dm = wave_dissipation(un, a, max(sensor[i, n], sensor[j, n]))
        heat = heat_of(gas, j, n, rj, pj)
        f0, f1, f2, f3, f4 = flux_increment(rj, uj, vj, wj, pj, d_r, d_u, d_v, d_w, d_p, nx, ny, nz, heat)
        _, stiff, soft, slope = heat
        own = ratio, stiff, soft, slope
        g0, g1, g2, g3, g4 = dissipation_increment(r, u, v, w, a, d0, dp, dm, d_r, d_u, d_v, d_w, d_p, nx, ny, nz, own)
        sums[RHO + n] += scale * (f0 - g0)
        sums[VX + n] += scale * (f1 - g1)
        sums[VY + n] += scale * (f2 - g2)
        sums[VZ + n] += scale * (f3 - g3)
        sums[PRS + n] += scale * (f4 - g4)


@distinct
def sweep_block(
    topology, first, count, rows, sensor, residual, inverse, change, passed, gas, least, forward, sums, rhs
):
    """The part of `sweep` for `count` cells from `first` on, upwards or downwards; `sums`, `rhs` scratch rows."""
    start = topology.start
    split = topology.split
    other = topology.other
    normal = topology.normal
    areas = topology.area
    half = type(gas.gamma)(0.5)
    for m in range(count):
        i = first + m if forward else first + count - 1 - m
        for k in range(ROW):
            sums[k] = type(gas.gamma)(0)
        low = start[i] if forward else split[i]
        high = split[i] if forward else start[i + 1]
        for e in range(low, high):
            j = other[e]
            nx = normal[e, 0]
            ny = normal[e, 1]
            nz = normal[e, 2]
            add_products(sums, rows, sensor, change, i, j, half * areas[e], nx, ny, nz, gas)
        for k in range(ROW):
            rhs[k] = -residual[i, k] - passed[i, k] - sums[k]
            passed[i, k] = sums[k]
        for k in range(5):
            for n in range(LANES):
                change[i, k * LANES + n] = (
                    inverse[i, (5 * k + 0) * LANES + n] * rhs[RHO + n]
                    + inverse[i, (5 * k + 1) * LANES + n] * rhs[VX + n]
                    + inverse[i, (5 * k + 2) * LANES + n] * rhs[VY + n]
                    + inverse[i, (5 * k + 3) * LANES + n] * rhs[VZ + n]
                    + inverse[i, (5 * k + 4) * LANES + n] * rhs[PRS + n]
                )
        for n in range(LANES):
            dr, dp = bounded(
                rows[i, RHO + n], rows[i, PRS + n], change[i, RHO + n], change[i, PRS + n], least[0, n], least[1, n]
            )
            change[i, RHO + n] = dr
            change[i, PRS + n] = dp


@kernel
def sweep(topology, state, sensor, residual, inverse, change, passed, gas, least, forward):
    """One Gauss-Seidel pass over all cells, colour by colour: change_i = D^-1 (-residual_i - sum of off-diagonal
    products).

    A pass forms only the products with cells already visited in it. Those with the others are the ones that the pass
    before, in the other direction, formed with the same changes: it left them in `passed` [cell, 5, lane], zero before
    the first forward pass, so that two passes cost one
    (P. Knabner, L. Angermann, Numerical Methods for Elliptic and Parabolic Partial Differential Equations, 5.1).
    A change that would take density or pressure below the `least` [2, lane] stops there (projected Gauss-Seidel: O. L.
    Mangasarian, J. Optim. Theory Appl. 22 (1977) 465-485): neighbours of a cell at its bound must not count on more,
    or the march comes to rest where the residual does not.

    Blocks of one colour do not touch, so that the result does not depend on the number of threads.
    """
    cells = state.shape[0]
    rows = state.reshape(cells, ROW)
    outflow = residual.reshape(cells, ROW)
    changes = change.reshape(cells, ROW)
    others = passed.reshape(cells, ROW)
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
            sums = np.empty(ROW, state.dtype)
            rhs = np.empty(ROW, state.dtype)
            sweep_block(
                topology, first, count, rows, sensor, outflow, inverse, changes, others, gas, least, forward, sums, rhs
            )


@kernel
def squared_norms(topology, state, residual, least, out):
    """Fill `out` [chunk, lane] (fp64) with the sum of (net mass outflow)^2/volume over the chunk's cells.

    Cells at the `least` [2, lane] density or pressure do not count: the bound, not the balance, holds them.
    """
    chunk_cells = topology.chunk_cells
    volume = topology.volume
    for chunk in prange(chunk_cells.shape[0] - 1):
        for n in range(LANES):
            out[chunk, n] = 0.0
        for i in range(chunk_cells[chunk], chunk_cells[chunk + 1]):
            scale = 1.0 / volume[i]
            for n in range(LANES):
                value = np.float64(residual[i, 0, n])
                value = 0.0 if at_bound(state[i, 0, n], state[i, 4, n], least[0, n], least[1, n]) else value
                out[chunk, n] += value * value * scale
