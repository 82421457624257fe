"""The residual: net flux out of every cell, conservative, for all lanes."""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from spaceplane.flow.compiled import WIDTH, inlined, kernel
from spaceplane.flow.fluxes import blend, shrink_normal_jump


@inlined
def guarded(value, step):
    """value + step, or value where that would fall below a fifth of it: densities and pressures stay positive."""
    real = type(value)
    return value + step if value + step > real(0.2) * value else value


@inlined
def wall_pressure(r, u, v, w, p, p_wall, nx, ny, nz, gamma, stiffness):
    """Pressure on a slip wall: the reconstructed one plus `stiffness` times the acoustic response to flow through the
    wall."""
    real = type(r)
    un = u * nx + v * ny + w * nz
    push = stiffness * r * math.sqrt(gamma * p / r) * un
    return max(p_wall + push, real(0.02) * p_wall)


@kernel
def fluxes(topology, state, gradient, sensor, free, residual, gamma, low_mach, stiffness, order):
    """Fill `residual` [cell, 5, lane] with the net outflow of mass, momentum and energy.

    Args:
        state: [cell, 5, lane]; gradient: [cell, 15, lane] limited; sensor: [cell, lane] weight of HLLE.
        free: [far face, 5, lane] state outside the far field.
        low_mach: smallest local Mach number to which the normal jump is scaled down; 1 switches the correction off.
        stiffness: see `wall_pressure`.
        order: 1 ignores the gradients.
    """
    lanes = state.shape[2]
    chunk_cells = topology.chunk_cells
    chunk_start = topology.chunk_start
    chunk_faces = topology.chunk_faces
    face_cells = topology.face_cells
    face_normal = topology.face_normal
    face_area = topology.face_area
    face_reach = topology.face_reach
    edge_start = topology.edge_start
    edge_row = topology.edge_row
    edge_normal = topology.boundary_normal
    edge_area = topology.boundary_area
    edge_reach = topology.boundary_reach
    walls = topology.walls
    for chunk in prange(chunk_cells.shape[0] - 1):
        first = chunk_cells[chunk]
        last = chunk_cells[chunk + 1]
        real = type(gamma)
        zero = real(0)
        p0 = real(1) / gamma
        left = np.empty((5, WIDTH), state.dtype)
        right = np.empty((5, WIDTH), state.dtype)
        f = np.empty((5, WIDTH), state.dtype)
        residual[first:last] = zero
        for entry in range(chunk_start[chunk], chunk_start[chunk + 1]):
            face = chunk_faces[entry]
            i = face_cells[face, 0]
            j = face_cells[face, 1]
            nx = face_normal[face, 0]
            ny = face_normal[face, 1]
            nz = face_normal[face, 2]
            area = face_area[face]
            if order == 1:
                for k in range(5):
                    for n in range(lanes):
                        left[k, n] = state[i, k, n]
                        right[k, n] = state[j, k, n]
            else:
                ix = face_reach[face, 0]
                iy = face_reach[face, 1]
                iz = face_reach[face, 2]
                jx = face_reach[face, 3]
                jy = face_reach[face, 4]
                jz = face_reach[face, 5]
                for k in range(5):
                    for n in range(lanes):
                        left[k, n] = (
                            gradient[i, 3 * k, n] * ix + gradient[i, 3 * k + 1, n] * iy + gradient[i, 3 * k + 2, n] * iz
                        )
                    for n in range(lanes):
                        right[k, n] = (
                            gradient[j, 3 * k, n] * jx + gradient[j, 3 * k + 1, n] * jy + gradient[j, 3 * k + 2, n] * jz
                        )
                for k in range(1, 4):
                    for n in range(lanes):
                        left[k, n] += state[i, k, n]
                        right[k, n] += state[j, k, n]
                for n in range(lanes):
                    left[0, n] = guarded(state[i, 0, n], left[0, n])
                    left[4, n] = guarded(state[i, 4, n], left[4, n])
                    right[0, n] = guarded(state[j, 0, n], right[0, n])
                    right[4, n] = guarded(state[j, 4, n], right[4, n])
            for n in range(lanes):
                rl = left[0, n]
                ul = left[1, n]
                vl = left[2, n]
                wl = left[3, n]
                pl = left[4, n]
                rr = right[0, n]
                ur = right[1, n]
                vr = right[2, n]
                wr = right[3, n]
                pr = right[4, n]
                m2l = (ul * ul + vl * vl + wl * wl) * rl / (gamma * pl)
                m2r = (ur * ur + vr * vr + wr * wr) * rr / (gamma * pr)
                mach = max(math.sqrt(max(m2l, m2r)), low_mach)
                ul, vl, wl, ur, vr, wr = shrink_normal_jump(ul, vl, wl, ur, vr, wr, nx, ny, nz, mach)
                theta = max(sensor[i, n], sensor[j, n])
                f0, f1, f2, f3, f4 = blend(rl, ul, vl, wl, pl, rr, ur, vr, wr, pr, nx, ny, nz, gamma, p0, theta)
                f[0, n] = area * f0
                f[1, n] = area * f1
                f[2, n] = area * f2
                f[3, n] = area * f3
                f[4, n] = area * f4
            if i >= first and i < last:
                for k in range(5):
                    for n in range(lanes):
                        residual[i, k, n] += f[k, n]
            if j >= first and j < last:
                for k in range(5):
                    for n in range(lanes):
                        residual[j, k, n] -= f[k, n]
        for i in range(first, last):
            for m in range(edge_start[i], edge_start[i + 1]):
                row = edge_row[m]
                nx = edge_normal[row, 0]
                ny = edge_normal[row, 1]
                nz = edge_normal[row, 2]
                area = edge_area[row]
                if row < walls:
                    reach = real(0) if order == 1 else real(1)
                    dx = edge_reach[row, 0] * reach
                    dy = edge_reach[row, 1] * reach
                    dz = edge_reach[row, 2] * reach
                    for n in range(lanes):
                        p = state[i, 4, n]
                        step = gradient[i, 12, n] * dx + gradient[i, 13, n] * dy + gradient[i, 14, n] * dz
                        q = area * (
                            wall_pressure(
                                state[i, 0, n],
                                state[i, 1, n],
                                state[i, 2, n],
                                state[i, 3, n],
                                p,
                                guarded(p, step),
                                nx,
                                ny,
                                nz,
                                gamma,
                                stiffness,
                            )
                            - p0
                        )
                        residual[i, 1, n] += q * nx
                        residual[i, 2, n] += q * ny
                        residual[i, 3, n] += q * nz
                else:
                    far = row - walls
                    for n in range(lanes):
                        f0, f1, f2, f3, f4 = blend(
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
                            p0,
                            zero,
                        )
                        residual[i, 0, n] += area * f0
                        residual[i, 1, n] += area * f1
                        residual[i, 2, n] += area * f2
                        residual[i, 3, n] += area * f3
                        residual[i, 4, n] += area * f4


@kernel
def pressures_on_wall(topology, state, gradient, gamma, stiffness, order, out):
    """Fill `out` [wall, lane] with the pressure that `fluxes` puts on each wall face."""
    lanes = state.shape[2]
    for row in prange(topology.walls):
        i = topology.boundary_cell[row]
        real = type(gamma)
        reach = real(0) if order == 1 else real(1)
        dx = topology.boundary_reach[row, 0] * reach
        dy = topology.boundary_reach[row, 1] * reach
        dz = topology.boundary_reach[row, 2] * reach
        nx = topology.boundary_normal[row, 0]
        ny = topology.boundary_normal[row, 1]
        nz = topology.boundary_normal[row, 2]
        for n in range(lanes):
            p = state[i, 4, n]
            step = gradient[i, 12, n] * dx + gradient[i, 13, n] * dy + gradient[i, 14, n] * dz
            out[row, n] = wall_pressure(
                state[i, 0, n],
                state[i, 1, n],
                state[i, 2, n],
                state[i, 3, n],
                p,
                guarded(p, step),
                nx,
                ny,
                nz,
                gamma,
                stiffness,
            )
