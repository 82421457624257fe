"""Limited least-squares gradients and the shock sensor, one pass over the cells."""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from spaceplane.flow.compiled import LANES, PRS, RHO, ROW, VX, VY, VZ, distinct, inlined, kernel
from spaceplane.flow.deadwater import dead_water
from spaceplane.flow.limiters import barth_jespersen, venkatakrishnan

FINEST = 255
"""Steps in which the factor on a frozen gradient is kept: one byte."""


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
    """Weight of HLLE: 0 below the pressure ratio 1.4 between neighbours, 1 above 2, smooth between, within [low, high].

    A captured shock is spread over two or three cells: the weight has to rise well below the ratio of the whole shock,
    else bow shocks along the grid grow carbuncles even at Mach 1.5.

    `compression` is the velocity lost across the cell over the speed of sound: the weight is full from a fifth on and
    falls to none in expansion, by a ramp, for a switch would keep single cells flipping for ever.
    """
    real = type(ratio)
    x = min(max((ratio - real(1.4)) / real(0.6), real(0)), real(1))
    weight = x * x * (real(3) - real(2) * x) * min(max(real(5) * compression, real(0)), real(1))
    return min(max(weight, low), high)


@inlined
def mach2(rows, i, n, gamma):
    """Square of the Mach number of cell i in lane n."""
    u = rows[i, VX + n]
    v = rows[i, VY + n]
    w = rows[i, VZ + n]
    return (u * u + v * v + w * w) * rows[i, RHO + n] / (gamma * rows[i, PRS + n])


@distinct
def spare_oblique(topology, rows, i, gamma, cut):
    """Lower `cut` [lane], the part of the slopes of cell i to be taken out, where the flow stays supersonic behind the
    shock.

    Only shocks with subsonic flow behind them grow carbuncles. An oblique shock keeps its slopes, from a Mach number of
    1.6 behind it on: without them it would smear over the thin layer of air on a slender body at hypersonic speed.
    """
    real = type(gamma)
    for n in range(LANES):
        slowest = mach2(rows, i, n, gamma)
        for e in range(topology.stencil_start[i], topology.stencil_start[i + 1]):
            slowest = min(slowest, mach2(rows, topology.stencil_other[e], n, gamma))
        cut[n] *= min(max((real(2.5) - slowest) / real(1.25), real(0)), real(1))


@distinct
def gather(rows, i, j, cx, cy, cz, gx, gy, gz, high, low):
    """Add neighbour j's part to the gradient of cell i and to the extremes of its neighbourhood."""
    for m in range(ROW):
        value = rows[j, m]
        d = value - rows[i, m]
        gx[m] += cx * d
        gy[m] += cy * d
        gz[m] += cz * d
        high[m] = max(high[m], value)
        low[m] = min(low[m], value)


@distinct
def restrict(limiter, gx, gy, gz, dx, dy, dz, middle, reach, eps2, phi):
    """Lower `phi` to what the limiter allows at the face (dx, dy, dz) away; room there is `middle` +- `reach`."""
    for m in range(ROW):
        step = gx[m] * dx + gy[m] * dy + gz[m] * dz
        # A choice between two arrays would be a gather: choose a sign instead.
        half = reach[m]
        room = middle[m] + (half if step > type(step)(0) else -half)
        phi[m] = min(phi[m], limit(limiter, room, abs(step), eps2[m]))


@distinct
def gradient_chunk(
    topology,
    first,
    last,
    rows,
    gradient,
    sensor,
    limiter,
    theta_low,
    theta_high,
    smallness,
    gamma,
    per_pressure,
    calming,
    hold,
    frozen,
    limits,
    high,
    low,
    phi,
    eps2,
    gx,
    gy,
    gz,
    cut,
    keep,
):
    """The part of `gradients` for cells `first` to `last`; scratch rows from `high` on."""
    start = topology.start
    reach = topology.reach
    stencil_start = topology.stencil_start
    stencil_other = topology.stencil_other
    weight = topology.stencil_weight
    real = type(gamma)
    zero = real(0)
    one = real(1)
    p0 = one / gamma
    for i in range(first, last):
        for m in range(ROW):
            gx[m] = zero
            gy[m] = zero
            gz[m] = zero
            high[m] = rows[i, m]
            low[m] = rows[i, m]
            phi[m] = one
        for e in range(stencil_start[i], stencil_start[i + 1]):
            j = stencil_other[e]
            gather(rows, i, j, weight[e, 0], weight[e, 1], weight[e, 2], gx, gy, gz, high, low)
        h = topology.size[i]
        highest = zero
        noise = min(smallness * h * h * h, real(1e-2)) + real(1e-12)
        for n in range(LANES):
            r = rows[i, RHO + n]
            p = rows[i, PRS + n]
            # The sound speed, not the flow's, is the scale of velocities: a tenth of Mach 10 would be no noise.
            sound2 = noise * gamma * p / r
            eps2[RHO + n] = noise * r * r
            eps2[VX + n] = sound2
            eps2[VY + n] = sound2
            eps2[VZ + n] = sound2
            eps2[PRS + n] = noise * (gamma * p) * (gamma * p)
            ratio = max(high[PRS + n] / p, p / low[PRS + n])
            squeeze = -(gx[VX + n] + gy[VY + n] + gz[VZ + n]) * h / math.sqrt(gamma * p / r)
            # Not a number, left by a step that was taken back, compares false.
            held = sensor[i, n] if hold[n] * sensor[i, n] > zero else zero
            theta = max(shock_weight(ratio, squeeze, theta_low, theta_high), held)
            theta = sensor[i, n] if frozen[n] > zero else theta
            sensor[i, n] = theta
            cut[n] = theta
            highest = max(highest, theta)
        if highest > zero:
            spare_oblique(topology, rows, i, gamma, cut)
        for n in range(LANES):
            u = rows[i, VX + n]
            v = rows[i, VY + n]
            w = rows[i, VZ + n]
            calm = dead_water(u, v, w, rows[i, PRS + n], p0, per_pressure[n], calming)
            factor = (one - cut[n]) * (one - calm)
            keep[RHO + n] = factor
            keep[VX + n] = factor
            keep[VY + n] = factor
            keep[VZ + n] = factor
            keep[PRS + n] = factor
        if limiter != 0:
            for m in range(ROW):
                up = high[m] - rows[i, m]
                down = rows[i, m] - low[m]
                high[m] = real(0.5) * (up + down)
                low[m] = real(0.5) * (up - down)
            for e in range(start[i], start[i + 1]):
                restrict(limiter, gx, gy, gz, reach[e, 0], reach[e, 1], reach[e, 2], high, low, eps2, phi)
        for k in range(0, ROW, LANES):
            for n in range(LANES):
                factor = phi[k + n] * keep[k + n]
                kept = frozen[n] > zero
                limits[i, k + n] = limits[i, k + n] if kept else np.uint8(factor * real(FINEST) + real(0.5))
                phi[k + n] = real(limits[i, k + n]) * real(1 / FINEST) if kept else factor
        for m in range(ROW):
            factor = phi[m]
            gradient[i, 0, m] = factor * gx[m]
            gradient[i, 1, m] = factor * gy[m]
            gradient[i, 2, m] = factor * gz[m]


@kernel
def gradients(
    topology,
    state,
    gradient,
    sensor,
    limiter,
    theta_low,
    theta_high,
    smallness,
    gamma,
    per_pressure,
    calming,
    hold,
    frozen,
    limits,
):
    """Fill `gradient` [cell, axis, 5 x lane] and `sensor` [cell, lane].

    Gradients come out limited, and scaled by (1 - sensor) in shocks with slow flow behind them (see `spare_oblique`)
    and by (1 - dead_water) in wakes.

    Args:
        state: [cell, 5, lane] rho, u, v, w, p.
        limiter: number of the limiter.
        theta_low, theta_high: bounds of the weight of HLLE.
        smallness: eps^2 of the limiter = min(smallness * size^3, 1e-2) on the local scale of each variable.
        per_pressure: [lane] 1/q_inf; calming: most that is taken out of slopes in dead water.
        hold: [lane] 1 where the sensor may only rise from here on, else 0.
        frozen: [lane] 1 where sensor and factors on the gradients stay what they are, else 0.
        limits: [cell, 5 x lane] those factors on 0 to 255, kept up to date for lanes that freeze later.
    """
    rows = state.reshape(state.shape[0], ROW)
    chunk_cells = topology.chunk_cells
    for chunk in prange(chunk_cells.shape[0] - 1):
        first = chunk_cells[chunk]
        last = chunk_cells[chunk + 1]
        high = np.empty(ROW, state.dtype)
        low = np.empty(ROW, state.dtype)
        phi = np.empty(ROW, state.dtype)
        eps2 = np.empty(ROW, state.dtype)
        gx = np.empty(ROW, state.dtype)
        gy = np.empty(ROW, state.dtype)
        gz = np.empty(ROW, state.dtype)
        cut = np.empty(LANES, state.dtype)
        keep = np.empty(ROW, state.dtype)
        gradient_chunk(
            topology,
            first,
            last,
            rows,
            gradient,
            sensor,
            limiter,
            theta_low,
            theta_high,
            smallness,
            gamma,
            per_pressure,
            calming,
            hold,
            frozen,
            limits,
            high,
            low,
            phi,
            eps2,
            gx,
            gy,
            gz,
            cut,
            keep,
        )
