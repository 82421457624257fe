"""The residual: net flux out of every cell, conservative, for all lanes."""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from spaceplane.flow.compiled import LANES, PRS, RHO, ROW, VX, VY, VZ, distinct, inlined, kernel
from spaceplane.flow.fluxes import blend, hllc, shrink_normal_jump
from spaceplane.flow.gas import fill_outside_ratios, fill_ratios, heat_of, ratio_in
from spaceplane.flow.rotation import add_turning, carry_back, face_speed, follow


@inlined
def guarded(value, new):
    """`new`, but at least a fifth of `value`: densities and pressures stay positive. Without a jump, which would leave
    strong expansions without a steady state."""
    return max(new, type(value)(0.2) * value)


@inlined
def wall_pressure(r, u, v, w, p, p_wall, nx, ny, nz, gamma, stiffness):
    """Pressure on a slip wall: the reconstructed one plus `stiffness` times the acoustic response to flow through the
    wall."""
    real = type(r)
    un = u * nx + v * ny + w * nz
    push = stiffness * r * math.sqrt(gamma * p / r) * un
    return max(p_wall + push, real(0.02) * p_wall)


@distinct
def reconstruct(rows, gradient, i, dx, dy, dz, side):
    """Fill `side` with the state of cell i at (dx, dy, dz) from its centroid."""
    for m in range(ROW):
        side[m] = rows[i, m] + (gradient[i, 0, m] * dx + gradient[i, 1, m] * dy + gradient[i, 2, m] * dz)
    for n in range(LANES):
        side[RHO + n] = guarded(rows[i, RHO + n], side[RHO + n])
        side[PRS + n] = guarded(rows[i, PRS + n], side[PRS + n])


@inlined
def with_flux(flux, left, right, ratio_l, ratio_r, theta, nx, ny, nz, area, gas, p0, low_mach, f):
    """Fill `f` with area * flux between the states `left` and `right`, their normal jump scaled at low Mach numbers.

    `ratio_l` and `ratio_r` hold the states' ratios of specific heats, see `gas.fill_ratios`.
    """
    for n in range(LANES):
        rl = left[RHO + n]
        ul = left[VX + n]
        vl = left[VY + n]
        wl = left[VZ + n]
        pl = left[PRS + n]
        rr = right[RHO + n]
        ur = right[VX + n]
        vr = right[VY + n]
        wr = right[VZ + n]
        pr = right[PRS + n]
        gl = ratio_in(gas, ratio_l, n)
        gr = ratio_in(gas, ratio_r, n)
        m2l = (ul * ul + vl * vl + wl * wl) * rl / (gl * pl)
        m2r = (ur * ur + vr * vr + wr * wr) * rr / (gr * pr)
        mach = max(math.sqrt(max(m2l, m2r)), low_mach)
        ul, vl, wl, ur, vr, wr = shrink_normal_jump(ul, vl, wl, ur, vr, wr, nx, ny, nz, mach)
        f0, f1, f2, f3, f4 = flux(rl, ul, vl, wl, pl, rr, ur, vr, wr, pr, nx, ny, nz, gl, gr, p0, theta[n])
        f[RHO + n] = area * f0
        f[VX + n] = area * f1
        f[VY + n] = area * f2
        f[VZ + n] = area * f3
        f[PRS + n] = area * f4


@inlined
def plain(rl, ul, vl, wl, pl, rr, ur, vr, wr, pr, nx, ny, nz, gl, gr, p0, theta):
    """HLLC, called like `blend`."""
    return hllc(rl, ul, vl, wl, pl, rr, ur, vr, wr, pr, nx, ny, nz, gl, gr, p0)


@distinct
def hllc_face(left, right, ratio_l, ratio_r, theta, nx, ny, nz, area, gas, p0, low_mach, f):
    """`with_flux` without HLLE: where no lane has a shock, which is nearly everywhere."""
    with_flux(plain, left, right, ratio_l, ratio_r, theta, nx, ny, nz, area, gas, p0, low_mach, f)


@distinct
def blend_face(left, right, ratio_l, ratio_r, theta, nx, ny, nz, area, gas, p0, low_mach, f):
    """`with_flux` with both."""
    with_flux(blend, left, right, ratio_l, ratio_r, theta, nx, ny, nz, area, gas, p0, low_mach, f)


@distinct
def flux_chunk(
    topology,
    first,
    last,
    begin,
    end,
    rows,
    gradient,
    sensor,
    free,
    frame,
    residual,
    gas,
    low_mach,
    stiffness,
    order,
    left,
    right,
    ratio_l,
    ratio_r,
    theta,
    speed,
    f,
):
    """The part of `fluxes` for cells `first` to `last`, entries `begin` to `end` of `chunk_faces`; scratch rows from
    `left` on."""
    chunk_faces = topology.chunk_faces
    face_cells = topology.face_cells
    normal = topology.face_normal
    face_area = topology.face_area
    reach = topology.face_reach
    swirl = topology.face_swirl
    edge_normal = topology.boundary_normal
    reach_of_wall = topology.boundary_reach
    edge_swirl = topology.boundary_swirl
    turns = frame.turns[0] != 0
    edge_start = topology.edge_start
    edge_row = topology.edge_row
    walls = topology.walls
    real = type(gas.gamma)
    zero = real(0)
    p0 = real(1) / gas.gamma
    for i in range(first, last):
        for m in range(ROW):
            residual[i, m] = zero
    for entry in range(begin, end):
        face = chunk_faces[entry]
        i = face_cells[face, 0]
        j = face_cells[face, 1]
        nx = normal[face, 0]
        ny = normal[face, 1]
        nz = normal[face, 2]
        area = face_area[face]
        if order == 1:
            for m in range(ROW):
                left[m] = rows[i, m]
                right[m] = rows[j, m]
        else:
            reconstruct(rows, gradient, i, reach[face, 0], reach[face, 1], reach[face, 2], left)
            reconstruct(rows, gradient, j, reach[face, 3], reach[face, 4], reach[face, 5], right)
        fill_ratios(gas, rows, i, left, ratio_l)
        fill_ratios(gas, rows, j, right, ratio_r)
        if turns:
            face_speed(frame, swirl[face, 0], swirl[face, 1], swirl[face, 2], nx, ny, nz, speed)
            follow(left, speed, nx, ny, nz)
            follow(right, speed, nx, ny, nz)
        highest = zero
        for n in range(LANES):
            theta[n] = max(sensor[i, n], sensor[j, n])
            highest = max(highest, theta[n])
        if highest > zero:
            blend_face(left, right, ratio_l, ratio_r, theta, nx, ny, nz, area, gas, p0, low_mach, f)
        else:
            hllc_face(left, right, ratio_l, ratio_r, theta, nx, ny, nz, area, gas, p0, low_mach, f)
        if turns:
            carry_back(f, speed, nx, ny, nz)
        if i >= first and i < last:
            for m in range(ROW):
                residual[i, m] += f[m]
        if j >= first and j < last:
            for m in range(ROW):
                residual[j, m] -= f[m]
    for n in range(LANES):
        theta[n] = zero
    for i in range(first, last):
        for m in range(edge_start[i], edge_start[i + 1]):
            row = edge_row[m]
            nx = edge_normal[row, 0]
            ny = edge_normal[row, 1]
            nz = edge_normal[row, 2]
            area = topology.boundary_area[row]
            if turns:
                face_speed(frame, edge_swirl[row, 0], edge_swirl[row, 1], edge_swirl[row, 2], nx, ny, nz, speed)
            if row < walls:
                push_wall(reach_of_wall, edge_normal, rows, gradient, i, row, gas, stiffness, order, f)
                for n in range(LANES):
                    q = area * (f[n] - p0)
                    residual[i, VX + n] += q * nx
                    residual[i, VY + n] += q * ny
                    residual[i, VZ + n] += q * nz
                if turns:
                    for n in range(LANES):
                        residual[i, PRS + n] += area * (f[n] - p0) * speed[n]
            else:
                for k in range(ROW):
                    left[k] = rows[i, k]
                    right[k] = free[row - walls, k]
                if turns:
                    follow(left, speed, nx, ny, nz)
                    follow(right, speed, nx, ny, nz)
                fill_ratios(gas, rows, i, left, ratio_l)
                fill_outside_ratios(gas, ratio_r)
                hllc_face(left, right, ratio_l, ratio_r, theta, nx, ny, nz, area, gas, p0, real(1), f)
                if turns:
                    carry_back(f, speed, nx, ny, nz)
                for k in range(ROW):
                    residual[i, k] += f[k]
        if turns:
            add_turning(frame, rows, residual, i, topology.volume[i])


@distinct
def push_wall(boundary_reach, boundary_normal, rows, gradient, i, row, gas, stiffness, order, out):
    """Fill `out` [lane] with the pressure on wall face `row` of cell i."""
    real = type(gas.gamma)
    reach = real(0) if order == 1 else real(1)
    dx = boundary_reach[row, 0] * reach
    dy = boundary_reach[row, 1] * reach
    dz = boundary_reach[row, 2] * reach
    nx = boundary_normal[row, 0]
    ny = boundary_normal[row, 1]
    nz = boundary_normal[row, 2]
    for n in range(LANES):
        p = rows[i, PRS + n]
        step = gradient[i, 0, PRS + n] * dx + gradient[i, 1, PRS + n] * dy + gradient[i, 2, PRS + n] * dz
        p_wall = guarded(p, p + step)
        r = rows[i, RHO + n]
        u = rows[i, VX + n]
        v = rows[i, VY + n]
        w = rows[i, VZ + n]
        heat = heat_of(gas, i, n, r, p)
        out[n] = wall_pressure(r, u, v, w, p, p_wall, nx, ny, nz, heat[0], stiffness)


@kernel
def fluxes(topology, state, gradient, sensor, free, frame, residual, gas, low_mach, stiffness, order):
    """Fill `residual` [cell, 5, lane] with the net outflow of mass, momentum and energy.

    Args:
        state: [cell, 5, lane]; gradient: [cell, axis, 5 x lane] limited; sensor: [cell, lane] weight of HLLE.
        free: [far face, 5, lane] state outside the far field.
        frame: how the lanes turn, see `rotation.Frame`.
        gas: see `gas`; its heats are those of `state`.
        low_mach: smallest local Mach number to which the normal jump is scaled down; 1 switches the correction off.
        stiffness: see `wall_pressure`.
        order: 1 ignores the gradients.
    """
    rows = state.reshape(state.shape[0], ROW)
    outflow = residual.reshape(state.shape[0], ROW)
    outside = free.reshape(free.shape[0], ROW)
    chunk_cells = topology.chunk_cells
    chunk_start = topology.chunk_start
    for chunk in prange(chunk_cells.shape[0] - 1):
        left = np.empty(ROW, state.dtype)
        right = np.empty(ROW, state.dtype)
        ratio_l = np.empty(LANES, state.dtype)
        ratio_r = np.empty(LANES, state.dtype)
        theta = np.empty(LANES, state.dtype)
        speed = np.empty(LANES, state.dtype)
        f = np.empty(ROW, state.dtype)
        flux_chunk(
            topology,
            chunk_cells[chunk],
            chunk_cells[chunk + 1],
            chunk_start[chunk],
            chunk_start[chunk + 1],
            rows,
            gradient,
            sensor,
            outside,
            frame,
            outflow,
            gas,
            low_mach,
            stiffness,
            order,
            left,
            right,
            ratio_l,
            ratio_r,
            theta,
            speed,
            f,
        )


@kernel
def pressures_on_wall(topology, state, gradient, gas, stiffness, order, out):
    """Fill `out` [wall, lane] with the pressure that `fluxes` puts on each wall face."""
    rows = state.reshape(state.shape[0], ROW)
    cell = topology.boundary_cell
    normal = topology.boundary_normal
    reach = topology.boundary_reach
    for wall in prange(topology.walls):
        row = np.int32(wall)  # as in `fluxes`, so that `push_wall` is compiled once
        push_wall(reach, normal, rows, gradient, cell[row], row, gas, stiffness, order, out[row])
