"""Anderson acceleration of the implicit iteration, condition by condition.

D. G. Anderson, J. ACM 12 (1965) 547-560; as least squares on differences: H. F. Walker, P. Ni, SIAM J. Numer. Anal. 49
(2011) 1715-1735, eq. 2.1. The fixed point is state -> state + change; the change is its residual.
"""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from spaceplane.flow.compiled import WIDTH, inlined, kernel
from spaceplane.flow.topology import Topology


@kernel
def record_difference(
    topology, change, last_change, last_step, scale, slot, slots, differences, combined, products, gram
):
    """Store the newest differences and their inner products.

    Args:
        change, last_change, last_step: [cell, 5, lane] this and the last change, and the step last applied.
        scale: [5, lane] weights of the variables in the inner product.
        slot: where the newest difference goes; `slots` are in use.
        differences: [cell, slot, 5, lane] differences of the change; `combined`: plus those of the state.
        products: [chunk, slot, lane] fp64, <difference, change>; gram: the same with the newest difference.
    """
    lanes = change.shape[2]
    chunk_cells = topology.chunk_cells
    for chunk in prange(chunk_cells.shape[0] - 1):
        b = np.zeros((slots, WIDTH), np.float64)
        g = np.zeros((slots, WIDTH), np.float64)
        f = np.empty((5, WIDTH), change.dtype)
        d = np.empty((5, WIDTH), change.dtype)
        for i in range(chunk_cells[chunk], chunk_cells[chunk + 1]):
            for k in range(5):
                for n in range(lanes):
                    difference = change[i, k, n] - last_change[i, k, n]
                    differences[i, slot, k, n] = difference
                    combined[i, slot, k, n] = difference + last_step[i, k, n]
                    d[k, n] = difference * scale[k, n]
                    f[k, n] = change[i, k, n] * scale[k, n]
            for s in range(slots):
                for n in range(lanes):
                    d0 = differences[i, s, 0, n] * scale[0, n]
                    d1 = differences[i, s, 1, n] * scale[1, n]
                    d2 = differences[i, s, 2, n] * scale[2, n]
                    d3 = differences[i, s, 3, n] * scale[3, n]
                    d4 = differences[i, s, 4, n] * scale[4, n]
                    b[s, n] += d0 * f[0, n] + d1 * f[1, n] + d2 * f[2, n] + d3 * f[3, n] + d4 * f[4, n]
                    g[s, n] += d0 * d[0, n] + d1 * d[1, n] + d2 * d[2, n] + d3 * d[3, n] + d4 * d[4, n]
        products[chunk] = b[:, :lanes]
        gram[chunk] = g[:, :lanes]


@inlined
def cooling(u, v, w, r, p, gamma, ceiling):
    """Factor on pressure and on the square of velocity that brings the total enthalpy down to `ceiling`, at most 1."""
    real = type(r)
    enthalpy = gamma / (gamma - real(1)) * p / r + real(0.5) * (u * u + v * v + w * w)
    return min(real(1), ceiling / enthalpy)


@kernel
def apply_step(
    topology, state, change, last_change, last_step, combined, weights, slots, largest, gamma, ceiling, limited
):
    """state += change - sum of weights[slot, lane] combined[:, slot], held within physical bounds cell by cell.

    The step is scaled so that density and pressure fall by at most `largest` of themselves and rise by twice that, and
    left out where it is not a number; then the total enthalpy is brought down to `ceiling` [lane] at unchanged density
    and Mach number. Steady flow has the free stream's total enthalpy everywhere, so that the ceiling acts on transients
    only: in them, large steps would heat wakes until they break.

    Keeps the change and the step for the next call. `limited` [chunk, lane] counts cells that were held back.
    """
    lanes = state.shape[2]
    chunk_cells = topology.chunk_cells
    for chunk in prange(chunk_cells.shape[0] - 1):
        count = np.zeros(lanes, state.dtype)
        step = np.empty((5, WIDTH), state.dtype)
        for i in range(chunk_cells[chunk], chunk_cells[chunk + 1]):
            for k in range(5):
                for n in range(lanes):
                    step[k, n] = change[i, k, n]
                    last_change[i, k, n] = change[i, k, n]
            for s in range(slots):
                for k in range(5):
                    for n in range(lanes):
                        step[k, n] -= weights[s, n] * combined[i, s, k, n]
            for n in range(lanes):
                real = type(largest)
                x = step[0, n] / state[i, 0, n]
                y = step[4, n] / state[i, 4, n]
                size = max(max(real(-1) * x, real(0.5) * x), max(real(-1) * y, real(0.5) * y))
                factor = largest / size if size > largest else real(1)
                count[n] += real(1) if size > largest else real(0)
                sound = size < real(1e30)
                for k in range(5):
                    last_step[i, k, n] = state[i, k, n]
                    state[i, k, n] += factor * step[k, n] if sound else real(0)
                cool = cooling(
                    state[i, 1, n], state[i, 2, n], state[i, 3, n], state[i, 0, n], state[i, 4, n], gamma, ceiling[n]
                )
                slow = math.sqrt(cool)
                state[i, 1, n] *= slow
                state[i, 2, n] *= slow
                state[i, 3, n] *= slow
                state[i, 4, n] *= cool
                count[n] += real(1) if cool < real(1) else real(0)
            for k in range(5):
                for n in range(lanes):
                    last_step[i, k, n] = state[i, k, n] - last_step[i, k, n]
        limited[chunk] = count


class Anderson:
    """History of differences of an ensemble; depth 0 keeps nothing and applies the plain change."""

    def __init__(self, cells: int, free: np.ndarray, depth: int, regularisation: float = 1e-6):
        """`free` [5, lane] sets the precision and, by its size, the weights of density, velocity and pressure."""
        dtype, lanes = free.dtype, free.shape[1]
        self.depth, self.regularisation = depth, regularisation
        self.used = self.next = 0
        self.started = False
        self.last_change = np.zeros((cells, 5, lanes), dtype)
        self.last_step = np.zeros((cells, 5, lanes), dtype)
        self.differences = np.zeros((cells, max(depth, 1), 5, lanes), dtype)
        self.combined = np.zeros((cells, max(depth, 1), 5, lanes), dtype)
        self.gram = np.zeros((max(depth, 1), max(depth, 1), lanes))
        speed = np.maximum(np.linalg.norm(free[1:4], axis=0), 1.0)
        self.scale = np.stack([1.0 / free[0], 1 / speed, 1 / speed, 1 / speed, 1.0 / (free[0] * speed**2)]).astype(
            dtype
        )

    def keep(self, source: np.ndarray) -> None:
        """Keep the lanes `source` [new lane] only."""
        for name in ("last_change", "last_step", "differences", "combined", "gram", "scale"):
            setattr(self, name, np.ascontiguousarray(getattr(self, name)[..., source]))

    def weights(self, topology: Topology, change: np.ndarray, calm: np.ndarray) -> np.ndarray:
        """[slot, lane] weights of the stored differences; zero for lanes that are not `calm` (their residual
        jumped)."""
        lanes = change.shape[2]
        if not self.depth or not self.started:
            self.started = True
            return np.zeros((max(self.depth, 1), lanes), change.dtype)
        slot = self.next
        self.next = (slot + 1) % self.depth
        self.used = min(self.used + 1, self.depth)
        shape = (len(topology.chunk_cells) - 1, self.used, lanes)
        products, gram = np.zeros(shape), np.zeros(shape)
        record_difference(
            topology,
            change,
            self.last_change,
            self.last_step,
            self.scale,
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
        trace = np.trace(matrix, axis1=1, axis2=2)
        good &= trace > 0
        matrix = matrix + (self.regularisation * trace)[:, None, None] * np.eye(self.used)
        matrix[~good] = np.eye(self.used)
        gamma = np.linalg.solve(matrix, np.where(good[:, None, None], right, 0.0))[..., 0]
        weights = np.zeros((self.depth, lanes), change.dtype)
        weights[: self.used] = gamma.T
        return weights
