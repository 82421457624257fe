"""The working arrays of an ensemble on one level, and one implicit iteration on them."""

from __future__ import annotations

import numpy as np

from spaceplane.flow import implicit
from spaceplane.flow.acceleration import Anderson, apply_step, depth_for
from spaceplane.flow.bounds import cells_at_bound, least_values
from spaceplane.flow.compiled import LANES, ROW
from spaceplane.flow.equilibrium import Heating
from spaceplane.flow.fluxes import FLUXES
from spaceplane.flow.freestream import velocity
from spaceplane.flow.gas import PerfectGas
from spaceplane.flow.limiters import LIMITERS
from spaceplane.flow.reconstruction import gradients
from spaceplane.flow.residual import fluxes, pressures_on_wall
from spaceplane.flow.rotation import frame_of
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import EQUILIBRIUM, FlowConditions
from spaceplane.flow.symmetry import symmetrise
from spaceplane.flow.topology import Blocks, Chunks, Faces, Stencils, Sweeps, Topology, Walls
from spaceplane.mesh.mesh import Mesh

HIGHEST_ENTHALPY = 1.2
"""Total enthalpy that a transient may reach in a cell, on the free stream's."""


def free_stream(conditions: FlowConditions) -> np.ndarray:
    """[5, condition] rho, u, v, w, p in the scaled units of `Solution`."""
    count = len(conditions)
    speed = velocity(conditions.mach, conditions.alpha, conditions.beta)
    return np.concatenate([np.ones((1, count)), speed.T, np.full((1, count), 1.0 / conditions.gamma)])


class Ensemble:
    """State and scratch arrays [cell, variable, lane] of some conditions on one mesh, always `LANES` lanes wide.

    The first conditions are seated at once, others by `seat` when lanes become free. Lanes for which there is no
    condition repeat the last one; nothing is read from them.

    Attributes:
        lanes: [lane] condition of each lane; `count` lanes were given a condition of their own at the start.
        state, residual, change: [cell, 5, lane]; passed: products that a sweep leaves to the next.
        gradient: [cell, axis, 5 x lane]; sensor: [cell, lane]; inverse: [cell, 25 x lane] inverse diagonal blocks.
        pace: [cell, lane] share of the lane's CFL number that a cell marches with.
        kept: cells of a lane that stay as they are, by lane.
        gas: for the kernels; `heating` keeps it up to date, None for the perfect gas.
    """

    def __init__(self, mesh: Mesh, topology: Topology, conditions: FlowConditions, settings: FlowSettings, order: int):
        self.mesh, self.topology, self.conditions = mesh, topology, conditions
        self.settings, self.order = settings, order
        self.dtype = dtype = settings.dtype
        self.gamma = dtype(conditions.gamma)
        self.heating = Heating(mesh.cells, dtype) if conditions.gas == EQUILIBRIUM else None
        self.gas = PerfectGas(self.gamma) if self.heating is None else self.heating.gas
        self.wall_area = np.asarray(mesh.wall_area, dtype=np.float64) * mesh.body_wall[:, None]
        self.wetted = float(np.linalg.norm(self.wall_area, axis=1).sum()) or 1.0
        wall = mesh.wall_center[mesh.body_wall]
        extent = np.ptp(wall if len(wall) else mesh.cell_center, axis=0).max()
        self.smallness = dtype((settings.limiter_constant / extent) ** 3)
        self.low, self.high = (dtype(value) for value in FLUXES[settings.flux])
        self.limiter = LIMITERS[settings.limiter]
        cells = mesh.cells
        self.count = min(len(conditions), LANES)
        self.lanes = np.minimum(np.arange(LANES), self.count - 1)
        self.free = np.ascontiguousarray(free_stream(conditions)[:, self.lanes], dtype=dtype)
        self.state = np.empty((cells, 5, LANES), dtype)
        self.state[:] = self.free
        self.far = np.ascontiguousarray(np.broadcast_to(self.free, (max(len(mesh.far_cell), 1), 5, LANES)))
        self.residual, self.change, self.passed = (np.zeros((cells, 5, LANES), dtype) for _ in range(3))
        # First-order levels read the slopes of wall cells only, times zero.
        self.gradient = np.zeros((cells, 3, ROW), dtype)
        self.sensor = np.zeros((cells, LANES), dtype)
        self.hold = np.zeros(LANES, dtype)
        self.frozen = np.zeros(LANES, dtype)
        self.limits = np.zeros((cells, ROW), np.uint8)
        self.pace = np.ones((cells, LANES), dtype)
        self.kept: dict[int, np.ndarray] = {}
        self.inverse = np.zeros((cells, 25 * LANES), dtype)
        self.per_pressure, self.ceiling = np.empty((2, LANES), dtype)
        self.least = np.empty((2, LANES), dtype)
        self.scale(np.arange(LANES))
        depth = depth_for(np.asarray(conditions.mach), settings.anderson_depth) if order == 2 else 0
        self.anderson = Anderson(cells, self.free, depth)

    def seat(self, lane: int, condition: int, state: np.ndarray | None) -> None:
        """Give a lane to another condition, from `state` [cell, 5] in the kernels' order, or from the free stream."""
        self.lanes[lane] = condition
        self.free[:, lane] = free_stream(self.conditions)[:, condition]
        self.far[:, :, lane] = self.free[:, lane]
        self.state[:, :, lane] = self.free[:, lane] if state is None else state
        self.scale(np.array([lane]))
        self.hold[lane] = 0
        self.frozen[lane] = 0
        self.sensor[:, lane] = 0
        self.pace[:, lane] = 1
        self.kept.pop(lane, None)
        self.mirror(self.state, np.arange(LANES) == lane)
        self.anderson.forget(lane, self.free)

    def scale(self, lanes: np.ndarray) -> None:
        """Set dynamic pressure, rotation, heat, least values and ceiling of total enthalpy in these lanes, by their
        conditions."""
        self.frame = frame_of(self.conditions, self.lanes, self.dtype)
        if self.heating is not None:
            self.heating.scale(self.conditions.take(self.lanes), self.free)
        mach = self.conditions.mach[self.lanes[lanes]]
        self.per_pressure[lanes] = 2.0 / mach**2
        self.least[:, lanes] = least_values(mach, self.conditions.gamma)
        self.ceiling[lanes] = HIGHEST_ENTHALPY * (1.0 / (self.conditions.gamma - 1.0) + 0.5 * mach**2)

    def evaluate(self) -> np.ndarray:
        """Compute the residual of the present state; its norm [lane], fp64."""
        if self.heating is not None:
            self.heating.fill(self.state)
        self.reconstruct()
        self.balance()
        return self.norms()

    def norms(self) -> np.ndarray:
        """[lane] norm of the residual, fp64."""
        sums = np.empty((len(self.topology.chunk_cells) - 1, LANES))
        implicit.squared_norms(self.topology.part(Chunks), self.state, self.residual, self.least, sums)
        return np.sqrt(sums.sum(axis=0))

    def impulsive_norms(self) -> list[float]:
        """Norm of the residual of each condition's free stream: what it would blow through the walls; infinite without.

        At least a thousandth of what would flow through them head on, for streams along all walls.
        """
        conditions, mesh = self.conditions, self.mesh
        walls = np.zeros((mesh.cells, 3))
        np.add.at(walls, mesh.wall_cell, mesh.wall_area)
        outflow = walls @ velocity(conditions.mach, conditions.alpha, conditions.beta).T
        head_on = np.linalg.norm(walls, axis=1)[:, None] * conditions.mach
        squares = np.maximum(outflow**2, 1e-6 * head_on**2) / mesh.cell_volume[:, None]
        return np.sqrt(squares.sum(axis=0)).tolist() if len(mesh.wall_cell) else [np.inf] * len(conditions)

    def reconstruct(self) -> None:
        """Fill gradients and sensor."""
        if self.order == 1:
            self.sensor[:] = self.low
            return
        gradients(
            self.topology.part(Stencils),
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
            self.frozen,
            self.limits,
        )

    def balance(self) -> None:
        """Fill the residual from state, gradients and sensor."""
        low_mach = self.dtype(self.settings.low_mach if self.order == 2 else 1.0)
        fluxes(
            self.topology.part(Faces),
            self.state,
            self.gradient,
            self.sensor,
            self.far,
            self.frame,
            self.residual,
            self.gas,
            low_mach,
            self.stiffness(),
            self.order,
        )

    def stiffness(self) -> float:
        """Acoustic share in the wall pressure: full on first-order levels, which start impulsively."""
        return self.dtype(1.0 if self.order == 1 else self.settings.wall_stiffness)

    def correct(self, cfl: np.ndarray, again: np.ndarray | None = None) -> None:
        """Fill `change` with the implicit increment at the CFL numbers [lane].

        Args:
            again: [lane] whether to form the diagonal blocks; else those of an earlier call serve, CFL included. All
                by default.
        """
        again = np.ones(LANES, dtype=bool) if again is None else again
        if again.any():
            self.factorise(cfl, again)
        self.relax()

    def factorise(self, cfl: np.ndarray, again: np.ndarray) -> None:
        """Fill the inverse diagonal blocks of the lanes `again` at the CFL numbers [lane]."""
        implicit.diagonals(
            self.topology.part(Blocks),
            self.state,
            self.sensor,
            self.far,
            cfl.astype(self.dtype),
            self.pace,
            again.astype(self.dtype),
            self.gas,
            self.stiffness(),
            self.inverse,
        )

    def keep_bounded(self, lanes: np.ndarray) -> None:
        """From here on cells at their least density or pressure stay as they are, in the lanes marked true.

        Those that come to stand there later join them.
        """
        for lane in np.flatnonzero(lanes):
            cells = cells_at_bound(self.state[:, :, lane], self.least[:, lane])
            self.kept[lane] = np.union1d(self.kept[lane], cells) if lane in self.kept else cells

    def relax(self) -> None:
        """Solve for `change` by symmetric Gauss-Seidel sweeps from zero."""
        # Without a diagonal block a cell does not change, and its neighbours do not count on it.
        for lane, cells in self.kept.items():
            self.inverse[cells, lane::LANES] = 0
        self.passed[:] = 0
        for forward in (True, False) * self.settings.sweeps:
            implicit.sweep(
                self.topology.part(Sweeps),
                self.state,
                self.sensor,
                self.residual,
                self.inverse,
                self.change,
                self.passed,
                self.gas,
                self.least,
                forward,
            )
        self.mirror(self.change)

    def load(self, state: np.ndarray) -> None:
        """Start from `state` [cell, 5, condition], in the kernels' order of cells."""
        np.take(state, self.lanes, axis=2, out=self.state)
        # Only changes are made symmetric later, so that an uneven start would stay.
        self.mirror(self.state)

    def mirror(self, field: np.ndarray, which: np.ndarray | bool = True) -> None:
        """Make a field [cell, 5, lane] symmetric in the lanes (of `which`) with a symmetric stream, on meshes that
        mirror themselves."""
        share = np.where(self.conditions.symmetric()[self.lanes] & which, 0.5, 0.0).astype(self.dtype)
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
        before = {lane: self.state[cells, :, lane] for lane, cells in self.kept.items()}
        limited = np.empty((len(t.chunk_cells) - 1, LANES), self.dtype)
        apply_step(
            t.part(Chunks),
            self.state,
            self.change,
            self.anderson.last_change,
            self.anderson.last_step,
            self.anderson.combined,
            weights,
            self.anderson.used,
            self.dtype(largest),
            self.gas,
            self.least,
            self.ceiling,
            self.pace,
            limited,
        )
        step = self.anderson.last_step.reshape(self.state.shape)
        for lane, cells in self.kept.items():
            # Differences from before they were kept are still among those that are combined.
            self.state[cells, :, lane] = before[lane]
            step[cells, :, lane] = 0
        return limited.sum(axis=0, dtype=np.float64) / self.mesh.cells

    def undo(self, lanes: np.ndarray) -> None:
        """Take back the last step of the lanes marked true."""
        step = self.anderson.last_step.reshape(self.state.shape)
        for lane in np.flatnonzero(lanes):
            self.state[:, :, lane] -= step[:, :, lane]
            self.anderson.known[lane] = False

    def wall_pressure(self) -> np.ndarray:
        """[wall, lane] pressure on the walls, from the state and gradients of the last `evaluate`."""
        out = np.empty((len(self.wall_area), LANES), self.dtype)
        pressures_on_wall(
            self.topology.part(Walls), self.state, self.gradient, self.gas, self.stiffness(), self.order, out
        )
        return out

    def forces(self) -> np.ndarray:
        """[lane, 3] pressure force over q A_wetted."""
        gauge = self.wall_pressure().astype(np.float64) - 1.0 / float(self.gamma)
        mach = self.conditions.mach[self.lanes]
        return (gauge.T @ self.wall_area) / (0.5 * mach**2 * self.wetted)[:, None]
