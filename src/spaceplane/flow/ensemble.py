"""The working arrays of an ensemble on one level, and one implicit iteration on them."""

from __future__ import annotations

import numpy as np

from spaceplane.flow import implicit
from spaceplane.flow.acceleration import Anderson, apply_step
from spaceplane.flow.fluxes import FLUXES
from spaceplane.flow.freestream import velocity
from spaceplane.flow.limiters import LIMITERS
from spaceplane.flow.reconstruction import gradients
from spaceplane.flow.residual import fluxes, pressures_on_wall
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.symmetry import symmetrise
from spaceplane.flow.topology import Topology
from spaceplane.mesh.mesh import Mesh

# Ensembles are padded to full vectors of this many lanes.
LANE_UNIT = 8

HIGHEST_ENTHALPY = 1.2
"""Total enthalpy that a transient may reach in a cell, on the free stream's."""


def padded(conditions: int) -> int:
    """Lanes of an ensemble of this many conditions: full vectors."""
    return LANE_UNIT * -(-conditions // LANE_UNIT)


def free_stream(conditions: FlowConditions) -> np.ndarray:
    """[5, condition] rho, u, v, w, p in the scaled units of `Solution`."""
    count = len(conditions)
    speed = velocity(conditions.mach, conditions.alpha, conditions.beta)
    return np.concatenate([np.ones((1, count)), speed.T, np.full((1, count), 1.0 / conditions.gamma)])


class Ensemble:
    """State and scratch arrays [cell, variable, lane] of some conditions on one mesh.

    Lanes beyond the conditions repeat the last one, so that vector loops are full; nothing is read from them.

    Attributes:
        lanes: [lane] condition of each lane.
        state, residual, change: [cell, 5, lane]; gradient: [cell, 15, lane]; sensor: [cell, lane];
        inverse: [cell, 25, lane] inverse diagonal blocks.
    """

    def __init__(self, mesh: Mesh, topology: Topology, conditions: FlowConditions, settings: FlowSettings, order: int):
        self.mesh, self.topology, self.conditions, self.settings, self.order = (
            mesh,
            topology,
            conditions,
            settings,
            order,
        )
        self.dtype = settings.dtype
        self.gamma = self.dtype(conditions.gamma)
        self.wall_area = np.asarray(mesh.wall_area, dtype=np.float64)
        self.wetted = float(np.linalg.norm(self.wall_area, axis=1).sum()) or 1.0
        extent = (
            np.ptp(mesh.wall_center, axis=0).max() if len(mesh.wall_center) else np.ptp(mesh.cell_center, axis=0).max()
        )
        self.smallness = self.dtype((settings.limiter_constant / extent) ** 3)
        self.low, self.high = (self.dtype(value) for value in FLUXES[settings.flux])
        self.limiter = LIMITERS[settings.limiter]
        self.allocate(np.arange(len(conditions)))
        self.anderson = Anderson(mesh.cells, self.free, settings.anderson_depth if order == 2 else 0)

    def allocate(self, active: np.ndarray) -> None:
        """Make arrays for the conditions `active`, state at the free stream."""
        lanes = padded(len(active))
        self.lanes = np.concatenate([active, np.full(lanes - len(active), active[-1], dtype=active.dtype)])
        self.count = len(active)
        cells, dtype = self.mesh.cells, self.dtype
        self.free = np.ascontiguousarray(free_stream(self.conditions)[:, self.lanes], dtype=dtype)
        self.state = np.empty((cells, 5, lanes), dtype)
        self.state[:] = self.free
        self.far = np.ascontiguousarray(np.broadcast_to(self.free, (max(len(self.mesh.far_cell), 1), 5, lanes)))
        self.residual = np.zeros((cells, 5, lanes), dtype)
        self.change = np.zeros((cells, 5, lanes), dtype)
        self.gradient = np.zeros((cells, 15, lanes), dtype) if self.order == 2 else np.zeros((1, 15, lanes), dtype)
        self.sensor = np.zeros((cells, lanes), dtype)
        self.hold = np.zeros(lanes, dtype)
        mach = self.conditions.mach[self.lanes]
        self.per_pressure = (2.0 / mach**2).astype(dtype)
        self.ceiling = (HIGHEST_ENTHALPY * (1.0 / (self.conditions.gamma - 1.0) + 0.5 * mach**2)).astype(dtype)
        self.inverse = np.zeros((cells, 25, lanes), dtype)

    def keep(self, lanes: np.ndarray) -> None:
        """Drop all lanes but these (indices into the current ones)."""
        state, sensor, hold = self.state, self.sensor, self.hold
        self.allocate(self.lanes[lanes])
        source = np.concatenate([lanes, np.full(len(self.lanes) - len(lanes), lanes[-1])])
        np.take(state, source, axis=2, out=self.state)
        np.take(sensor, source, axis=1, out=self.sensor)
        self.hold = hold[source]
        self.anderson.keep(source)

    def evaluate(self) -> np.ndarray:
        """Compute the residual of the present state; its norm [lane], fp64."""
        self.reconstruct()
        self.balance()
        sums = np.zeros((len(self.topology.chunk_cells) - 1, self.state.shape[2]))
        implicit.squared_norms(self.topology, self.residual, sums)
        return np.sqrt(sums.sum(axis=0))

    def reconstruct(self) -> None:
        """Fill gradients and sensor."""
        if self.order == 1:
            self.sensor[:] = self.low
            return
        gradients(
            self.topology,
            self.state,
            self.gradient,
            self.sensor,
            self.limiter,
            self.low,
            self.high,
            self.smallness,
            self.gamma,
            self.per_pressure,
            self.dtype(self.settings.wake_calming),
            self.hold,
        )

    def balance(self) -> None:
        """Fill the residual from state, gradients and sensor."""
        low_mach = self.dtype(self.settings.low_mach if self.order == 2 else 1.0)
        fluxes(
            self.topology,
            self.state,
            self.slopes(),
            self.sensor,
            self.far,
            self.residual,
            self.gamma,
            low_mach,
            self.stiffness(),
            self.order,
        )

    def slopes(self) -> np.ndarray:
        """Gradients; on first-order levels zeros, of which the kernels read only those of wall cells, times zero."""
        if len(self.gradient) != self.mesh.cells:
            self.gradient = np.zeros((self.mesh.cells, 15, self.state.shape[2]), self.dtype)
        return self.gradient

    def stiffness(self) -> float:
        """Acoustic share in the wall pressure: full on first-order levels, which start impulsively."""
        return self.dtype(1.0 if self.order == 1 else self.settings.wall_stiffness)

    def correct(self, cfl: np.ndarray) -> None:
        """Fill `change` with the implicit increment at the CFL numbers [lane]."""
        self.factorise(cfl)
        self.relax()

    def factorise(self, cfl: np.ndarray) -> None:
        """Fill the inverse diagonal blocks at the CFL numbers [lane]."""
        implicit.diagonals(
            self.topology,
            self.state,
            self.sensor,
            self.far,
            cfl.astype(self.dtype),
            self.gamma,
            self.stiffness(),
            self.inverse,
        )

    def relax(self) -> None:
        """Solve for `change` by symmetric Gauss-Seidel sweeps from zero."""
        self.change[:] = 0
        for forward in (True, False) * self.settings.sweeps:
            implicit.sweep(
                self.topology, self.state, self.sensor, self.residual, self.inverse, self.change, self.gamma, forward
            )
        self.mirror(self.change)

    def load(self, state: np.ndarray) -> None:
        """Start from `state` [cell, 5, condition], in the kernels' order of cells."""
        count = state.shape[2]
        self.state[:, :, :count] = state
        self.state[:, :, count:] = state[:, :, -1:]
        # Only changes are made symmetric later, so that an uneven start would stay.
        self.mirror(self.state)

    def mirror(self, field: np.ndarray) -> None:
        """Make a field [cell, 5, lane] symmetric in the lanes without sideslip, on meshes that mirror themselves."""
        share = np.where(self.conditions.beta[self.lanes] == 0.0, 0.5, 0.0).astype(self.dtype)
        if len(self.topology.mirror) and share.any():
            symmetrise(self.topology.mirror, field, share)

    def apply(self, largest: float, calm: np.ndarray) -> np.ndarray:
        """Add the accelerated change to the state; [lane] share of cells that were scaled back.

        Args:
            largest: most that density and pressure of a cell may fall, of themselves.
            calm: [lane] whether the acceleration may be used.
        """
        t = self.topology
        weights = self.anderson.weights(t, self.change, calm)
        limited = np.zeros((len(t.chunk_cells) - 1, self.state.shape[2]), self.dtype)
        apply_step(
            t,
            self.state,
            self.change,
            self.anderson.last_change,
            self.anderson.last_step,
            self.anderson.combined,
            weights,
            self.anderson.used,
            self.dtype(largest),
            self.gamma,
            self.ceiling,
            limited,
        )
        return limited.sum(axis=0, dtype=np.float64) / self.mesh.cells

    def undo(self, lanes: np.ndarray) -> None:
        """Take back the last step of the lanes marked true."""
        for lane in np.flatnonzero(lanes):
            self.state[:, :, lane] -= self.anderson.last_step[:, :, lane]
            self.anderson.last_step[:, :, lane] = 0

    def wall_pressure(self) -> np.ndarray:
        """[wall, lane] pressure on the walls, from the state and gradients of the last `evaluate`."""
        out = np.zeros((len(self.wall_area), self.state.shape[2]), self.dtype)
        pressures_on_wall(self.topology, self.state, self.slopes(), self.gamma, self.stiffness(), self.order, out)
        return out

    def forces(self) -> np.ndarray:
        """[lane, 3] pressure force over q A_wetted."""
        gauge = self.wall_pressure().astype(np.float64) - 1.0 / float(self.gamma)
        mach = self.conditions.mach[self.lanes]
        return (gauge.T @ self.wall_area) / (0.5 * mach**2 * self.wetted)[:, None]
