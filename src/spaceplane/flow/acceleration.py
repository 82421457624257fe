"""Anderson acceleration of the implicit iteration, condition by condition.

D. G. Anderson, J. ACM 12 (1965) 547-560; as least squares on differences: H. F. Walker, P. Ni, SIAM J. Numer. Anal. 49
(2011) 1715-1735, eq. 2.1. The fixed point is state -> state + change; the change is its residual.
"""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from spaceplane.flow.bounds import bounded
from spaceplane.flow.compiled import LANES, PRS, RHO, ROW, VX, VY, VZ, distinct, inlined, kernel
from spaceplane.flow.gas import factor_near
from spaceplane.flow.topology import Chunks, Topology

SLOWEST = 0.02
"""Least share of the CFL number that a cell marches with."""


SHORT_FROM_MACH, SHORT_DEPTH = 1.2, 3
"""Supersonic flows forget fast: more differences than these would cost a fifth of the memory for nothing."""


def depth_for(mach: np.ndarray, depth: int) -> int:
    """How many differences an ensemble of flows at these Mach numbers keeps, of `depth` asked."""
    return min(depth, SHORT_DEPTH) if (mach >= SHORT_FROM_MACH).all() else depth


@distinct
def difference_chunk(
    first,
    last,
    change,
    last_change,
    last_step,
    known,
    scale,
    slot,
    slots,
    differences,
    combined,
    products,
    gram,
    f,
    d,
):
    """The part of `record_difference` for cells `first` to `last`; `f`, `d` scratch rows."""
    zero = type(scale[0])(0)
    for i in range(first, last):
        for m in range(ROW):
            new = change[i, m]
            difference = new - last_change[i, m] if known[m] > zero else zero
            differences[i, slot, m] = difference
            combined[i, slot, m] = difference + last_step[i, m] if known[m] > zero else zero
            f[m] = new * scale[m] * scale[m]
            d[m] = difference * scale[m] * scale[m]
        for s in range(slots):
            for n in range(LANES):
                b = zero
                g = zero
                for k in range(0, ROW, LANES):
                    value = differences[i, s, k + n]
                    b += value * f[k + n]
                    g += value * d[k + n]
                products[s, n] += b
                gram[s, n] += g


@kernel
def record_difference(
    topology, change, last_change, last_step, known, scale, slot, slots, differences, combined, products, gram
):
    """Store the newest differences and their inner products.

    Args:
        change, last_change, last_step: [cell, 5 x lane] this and the last change, and the step last applied.
        known: [5 x lane] 0 where the last change and step are of no use: their difference is stored as zero.
        scale: [5 x lane] weights of the variables in the inner product.
        slot: where the newest difference goes; `slots` are in use.
        differences: [cell, slot, 5 x lane] differences of the change; `combined`: plus those of the state.
        products: [chunk, slot, lane] fp64, <difference, change>; gram: the same with the newest difference.
    """
    chunk_cells = topology.chunk_cells
    for chunk in prange(chunk_cells.shape[0] - 1):
        f = np.empty(ROW, change.dtype)
        d = np.empty(ROW, change.dtype)
        for s in range(slots):
            for n in range(LANES):
                products[chunk, s, n] = 0.0
                gram[chunk, s, n] = 0.0
        difference_chunk(
            chunk_cells[chunk],
            chunk_cells[chunk + 1],
            change,
            last_change,
            last_step,
            known,
            scale,
            slot,
            slots,
            differences,
            combined,
            products[chunk],
            gram[chunk],
            f,
            d,
        )


@inlined
def cooling(u, v, w, r, p, factor, ceiling):
    """Factor on pressure and on the square of velocity that brings the total enthalpy down to `ceiling`, at most 1.

    The enthalpy is `factor` p/r.
    """
    real = type(r)
    enthalpy = factor * p / r + real(0.5) * (u * u + v * v + w * w)
    return min(real(1), ceiling / enthalpy)


@distinct
def step_chunk(
    first,
    last,
    rows,
    change,
    last_change,
    last_step,
    combined,
    weights,
    slots,
    largest,
    gas,
    least,
    ceiling,
    pace,
    count,
    step,
    factor,
):
    """The part of `apply_step` for cells `first` to `last`; `step`, `factor` scratch rows."""
    real = type(largest)
    zero = real(0)
    one = real(1)
    half = real(0.5)
    for i in range(first, last):
        for m in range(ROW):
            new = change[i, m]
            step[m] = new
            last_change[i, m] = new
        for s in range(slots):
            for m in range(ROW):
                step[m] -= weights[s, m] * combined[i, s, m]
        for n in range(LANES):
            x = step[RHO + n] / rows[i, RHO + n]
            y = step[PRS + n] / rows[i, PRS + n]
            u = rows[i, VX + n]
            v = rows[i, VY + n]
            w = rows[i, VZ + n]
            fastest = u * u + v * v + w * w + gas.gamma * rows[i, PRS + n] / rows[i, RHO + n]
            wild = step[VX + n] * step[VX + n] + step[VY + n] * step[VY + n] + step[VZ + n] * step[VZ + n]
            z = largest * math.sqrt(wild / fastest)
            size = max(max(max(-x, half * x), max(-y, half * y)), z)
            share = largest / size if size > largest else one
            # Not a number compares false.
            share = share if max(size, zero) + wild < real(1e30) else zero
            count[n] += one if share < one else zero
            pace[i, n] = max(half * pace[i, n], real(SLOWEST)) if share < one else min(real(1.5) * pace[i, n], one)
            factor[RHO + n] = share
            factor[VX + n] = share
            factor[VY + n] = share
            factor[VZ + n] = share
            factor[PRS + n] = share
        for m in range(ROW):
            step[m] = factor[m] * step[m] if factor[m] > zero else zero
        for n in range(LANES):
            dr, dp = bounded(rows[i, RHO + n], rows[i, PRS + n], step[RHO + n], step[PRS + n], least[0, n], least[1, n])
            r = rows[i, RHO + n] + dr
            u = rows[i, VX + n] + step[VX + n]
            v = rows[i, VY + n] + step[VY + n]
            w = rows[i, VZ + n] + step[VZ + n]
            p = rows[i, PRS + n] + dp
            factor_here = factor_near(gas, i, n, rows[i, RHO + n], rows[i, PRS + n], r, p)
            cool = cooling(u, v, w, r, p, factor_here, ceiling[n])
            slow = math.sqrt(cool)
            step[RHO + n] = r - rows[i, RHO + n]
            step[VX + n] = slow * u - rows[i, VX + n]
            step[VY + n] = slow * v - rows[i, VY + n]
            step[VZ + n] = slow * w - rows[i, VZ + n]
            step[PRS + n] = cool * p - rows[i, PRS + n]
        for m in range(ROW):
            last_step[i, m] = step[m]
            rows[i, m] += step[m]


@kernel
def apply_step(
    topology,
    state,
    change,
    last_change,
    last_step,
    combined,
    weights,
    slots,
    largest,
    gas,
    least,
    ceiling,
    pace,
    limited,
):
    """state += change - sum of weights[slot, 5 x lane] combined[:, slot], held within physical bounds cell by cell.

    The step is scaled so that density and pressure fall by at most `largest` of themselves and rise by twice that, and
    velocity changes by no more than root(V^2 + a^2): a wilder one, brought down to the ceiling, would leave no
    pressure. It is left out where it is not a number. No density or pressure falls below the `least` ones [2, lane]
    (see `bounds`); then the total enthalpy is brought down to `ceiling` [lane] at unchanged density and Mach number.
    Steady flow has the free stream's total enthalpy everywhere, so that the ceiling acts on transients only: in them,
    large steps would heat wakes until they break.

    Keeps the change and the step for the next call. `limited` [chunk, lane] counts cells whose step was scaled; their
    `pace` [cell, lane], a factor on the CFL number, is halved, while that of the others grows back to 1: a few cells in
    a wake do not slow the march of all.
    """
    rows = state.reshape(state.shape[0], ROW)
    changes = change.reshape(state.shape[0], ROW)
    chunk_cells = topology.chunk_cells
    for chunk in prange(chunk_cells.shape[0] - 1):
        step = np.empty(ROW, state.dtype)
        factor = np.empty(ROW, state.dtype)
        for n in range(LANES):
            limited[chunk, n] = 0.0
        step_chunk(
            chunk_cells[chunk],
            chunk_cells[chunk + 1],
            rows,
            changes,
            last_change,
            last_step,
            combined,
            weights,
            slots,
            largest,
            gas,
            least,
            ceiling,
            pace,
            limited[chunk],
            step,
            factor,
        )


class Anderson:
    """History of differences of an ensemble; depth 0 keeps nothing and applies the plain change.

    Attributes:
        last_change, last_step: [cell, 5 x lane]; differences, combined: [cell, slot, 5 x lane].
        known: [lane] whether the last change and step belong to the lane's present state.
        short: [lane] whether only the last `SHORT_DEPTH` differences are used.
    """

    def __init__(self, cells: int, free: np.ndarray, depth: int, regularisation: float = 1e-6):
        """`free` [5, lane] sets the precision and, by its size, the weights of density, velocity and pressure."""
        dtype = free.dtype
        self.depth, self.regularisation = depth, regularisation
        self.used = self.next = 0
        self.known = np.zeros(LANES, dtype=bool)
        self.last_change = np.zeros((cells, ROW), dtype)
        self.last_step = np.zeros((cells, ROW), dtype)
        self.differences = np.zeros((cells, max(depth, 1), ROW), dtype)
        self.combined = np.zeros((cells, max(depth, 1), ROW), dtype)
        self.gram = np.zeros((max(depth, 1), max(depth, 1), LANES))
        self.scale = np.ones((5, LANES), dtype)
        self.short = np.zeros(LANES, dtype=bool)
        for lane in range(LANES):
            self.weigh(lane, free)

    def weigh(self, lane: int, free: np.ndarray) -> None:
        """Set the weights of a lane's variables from its free stream."""
        mach = float(np.linalg.norm(free[1:4, lane]))
        self.short[lane] = mach > SHORT_FROM_MACH - 1e-6
        speed = max(mach, 1.0)
        self.scale[:, lane] = 1.0, 1.0 / speed, 1.0 / speed, 1.0 / speed, 1.0 / speed**2

    def forget(self, lane: int, free: np.ndarray) -> None:
        """Begin anew in a lane that has been given to another condition."""
        rows = slice(lane, ROW, LANES)
        self.known[lane] = False
        self.differences[:, :, rows] = 0
        self.combined[:, :, rows] = 0
        self.gram[:, :, lane] = 0
        self.weigh(lane, free)

    def weights(self, topology: Topology, change: np.ndarray, calm: np.ndarray) -> np.ndarray:
        """[slot, 5 x lane] weights of the stored differences; zero for lanes that are not `calm` (their residual
        jumped)."""
        known = self.known.copy()
        self.known[:] = True
        if not self.depth or not known.any():
            return np.zeros((max(self.depth, 1), ROW), change.dtype)
        slot = self.next
        self.next = (slot + 1) % self.depth
        self.used = min(self.used + 1, self.depth)
        shape = (len(topology.chunk_cells) - 1, self.used, LANES)
        products, gram = np.empty(shape), np.empty(shape)
        record_difference(
            topology.part(Chunks),
            change.reshape(-1, ROW),
            self.last_change,
            self.last_step,
            np.tile(known, 5).astype(change.dtype),
            self.scale.reshape(ROW),
            slot,
            self.used,
            self.differences,
            self.combined,
            products,
            gram,
        )
        row = gram.sum(axis=0)
        self.gram[slot, : self.used] = row
        self.gram[: self.used, slot] = row
        matrix = np.moveaxis(self.gram[: self.used, : self.used], -1, 0)
        right = products.sum(axis=0).T[..., None]
        # A condition that has just broken is left alone here; the march will find it.
        good = calm & np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(right).all(axis=(1, 2))
        matrix = np.where(good[:, None, None], matrix, 0.0)
        age = (slot - np.arange(self.used)) % self.depth
        left_out = self.short[:, None] & (age >= SHORT_DEPTH)
        either = left_out[:, :, None] | left_out[:, None, :]
        matrix = np.where(either, 0.0, matrix)
        trace = np.trace(matrix, axis1=1, axis2=2)
        good &= trace > 0
        matrix = matrix + (self.regularisation * trace)[:, None, None] * np.eye(self.used)
        matrix[~good] = np.eye(self.used)
        matrix = np.where(either, np.eye(self.used), matrix)
        right = np.where(left_out[..., None], 0.0, right)
        gamma = np.linalg.solve(matrix, np.where(good[:, None, None], right, 0.0))[..., 0]
        weights = np.zeros((self.depth, LANES), change.dtype)
        weights[: self.used] = gamma.T
        return np.tile(weights, 5)
