"""Limited least-squares gradients and the shock sensor, one pass over the cells."""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from spaceplane.flow.compiled import WIDTH, inlined, kernel
from spaceplane.flow.deadwater import dead_water
from spaceplane.flow.limiters import barth_jespersen, venkatakrishnan


@inlined
def limit(kind, room, step, eps2):
    """The limiter chosen by number (see `limiters.LIMITERS`)."""
    real = type(room)
    if kind == 1:
        return venkatakrishnan(room, step, eps2)
    if kind == 2:
        return barth_jespersen(room, step, eps2)
    return real(1)


@inlined
def shock_weight(ratio, compression, low, high):
    """Weight of HLLE: 0 below the pressure ratio 2.5, 1 above 3.5, smooth between, within [low, high].

    `compression` is the velocity lost across the cell over the speed of sound: the weight is full from a fifth on and
    falls to none in expansion, by a ramp, for a switch would keep single cells flipping for ever.
    """
    real = type(ratio)
    x = min(max(ratio - real(2.5), real(0)), real(1))
    weight = x * x * (real(3) - real(2) * x) * min(max(real(5) * compression, real(0)), real(1))
    return min(max(weight, low), high)


@kernel
def gradients(
    topology, state, gradient, sensor, limiter, theta_low, theta_high, smallness, gamma, per_pressure, calming, hold
):
    """Fill `gradient` [cell, 15, lane] (variable-major: 3 variable + axis) and `sensor` [cell, lane].

    Gradients come out limited, and scaled by (1 - sensor) in strong shocks and by (1 - dead_water) in wakes.

    Args:
        state: [cell, 5, lane] rho, u, v, w, p.
        limiter: number of the limiter.
        theta_low, theta_high: bounds of the weight of HLLE.
        smallness: eps^2 of the limiter = min(smallness * size^3, 1e-2) on the local scale of each variable.
        per_pressure: [lane] 1/q_inf; calming: most that is taken out of slopes in dead water.
        hold: [lane] 1 where the sensor may only rise from here on, else 0.
    """
    lanes = state.shape[2]
    start = topology.start
    reach = topology.reach
    stencil_start = topology.stencil_start
    stencil_other = topology.stencil_other
    weight = topology.stencil_weight
    chunk_cells = topology.chunk_cells
    for chunk in prange(chunk_cells.shape[0] - 1):
        high = np.empty((5, WIDTH), state.dtype)
        low = np.empty((5, WIDTH), state.dtype)
        phi = np.empty((5, WIDTH), state.dtype)
        eps2 = np.empty((5, WIDTH), state.dtype)
        g = np.empty((15, WIDTH), state.dtype)
        keep = np.empty(WIDTH, state.dtype)
        for i in range(chunk_cells[chunk], chunk_cells[chunk + 1]):
            real = type(topology.volume[i])
            one = real(1)
            p0 = one / gamma
            g[:] = real(0)
            for k in range(5):
                for n in range(lanes):
                    high[k, n] = state[i, k, n]
                    low[k, n] = state[i, k, n]
                    phi[k, n] = one
            for e in range(stencil_start[i], stencil_start[i + 1]):
                j = stencil_other[e]
                cx = weight[e, 0]
                cy = weight[e, 1]
                cz = weight[e, 2]
                for k in range(5):
                    for n in range(lanes):
                        value = state[j, k, n]
                        d = value - state[i, k, n]
                        g[3 * k, n] += cx * d
                        g[3 * k + 1, n] += cy * d
                        g[3 * k + 2, n] += cz * d
                        high[k, n] = max(high[k, n], value)
                        low[k, n] = min(low[k, n], value)
            h = topology.size[i]
            noise = min(smallness * h * h * h, real(1e-2)) + real(1e-12)
            for n in range(lanes):
                r = state[i, 0, n]
                p = state[i, 4, n]
                # The sound speed, not the flow's, is the scale of velocities: a tenth of Mach 10 would be no noise.
                sound2 = noise * gamma * p / r
                eps2[0, n] = noise * r * r
                eps2[1, n] = sound2
                eps2[2, n] = sound2
                eps2[3, n] = sound2
                eps2[4, n] = noise * (gamma * p) * (gamma * p)
                ratio = max(high[4, n] / p, p / low[4, n])
                squeeze = -(g[3, n] + g[7, n] + g[11, n]) * h / math.sqrt(gamma * p / r)
                sensor[i, n] = max(shock_weight(ratio, squeeze, theta_low, theta_high), hold[n] * sensor[i, n])
                calm = dead_water(state[i, 1, n], state[i, 2, n], state[i, 3, n], p, p0, per_pressure[n], calming)
                keep[n] = (one - sensor[i, n]) * (one - calm)
            if limiter != 0:
                for k in range(5):
                    for n in range(lanes):
                        high[k, n] -= state[i, k, n]
                        low[k, n] = state[i, k, n] - low[k, n]
                for e in range(start[i], start[i + 1]):
                    dx = reach[e, 0]
                    dy = reach[e, 1]
                    dz = reach[e, 2]
                    for k in range(5):
                        for n in range(lanes):
                            step = g[3 * k, n] * dx + g[3 * k + 1, n] * dy + g[3 * k + 2, n] * dz
                            room = high[k, n] if step > real(0) else low[k, n]
                            phi[k, n] = min(phi[k, n], limit(limiter, room, abs(step), eps2[k, n]))
            for k in range(5):
                for n in range(lanes):
                    factor = phi[k, n] * keep[n]
                    gradient[i, 3 * k, n] = factor * g[3 * k, n]
                    gradient[i, 3 * k + 1, n] = factor * g[3 * k + 1, n]
                    gradient[i, 3 * k + 2, n] = factor * g[3 * k + 2, n]
