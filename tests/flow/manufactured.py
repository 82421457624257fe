"""A smooth manufactured flow about the unit sphere at (1, 0, 0): tangential at its wall, with the sources that keep
it steady.

P. J. Roache, "Code verification by the method of manufactured solutions", J. Fluids Eng. 124 (2002) 4-10.
"""

from __future__ import annotations

import numpy as np

from spaceplane.flow.ensemble import Ensemble
from spaceplane.flow.march import Caution, march
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.topology import prepare
from spaceplane.mesh.mesh import Mesh

GAMMA, MACH = 1.4, 0.5


def exact(points: np.ndarray) -> np.ndarray:
    """[point, 5] density, velocity of the incompressible flow past the sphere, pressure.

    Density and pressure are wavy, yet too little to reach the bound that transients keep on total enthalpy.
    """
    offset = points - [1.0, 0.0, 0.0]
    r = np.linalg.norm(offset, axis=1)
    axial = offset[:, 0] / r
    speed = MACH * (np.array([[1.0, 0.0, 0.0]]) * (1.0 + 0.5 / r**3)[:, None])
    speed -= (1.5 * MACH * axial / r**4)[:, None] * offset
    x, y, z = points.T
    density = 1.0 + 0.05 * np.sin(0.7 * x + 0.5 * z) * np.cos(0.6 * y)
    pressure = (1.0 + 0.05 * np.cos(0.6 * x - 0.4 * z) * np.cos(0.5 * y)) / GAMMA
    return np.column_stack([density, speed, pressure])


def source(points: np.ndarray, step: float = 1e-4) -> np.ndarray:
    """[point, 5] divergence of the exact fluxes of mass, momentum and energy, by fourth-order differences."""
    total = np.zeros((len(points), 5))
    for axis in range(3):
        way = step * np.eye(3)[axis]
        for side, weight in ((1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)):
            total += weight / (12.0 * step) * _flux(exact(points + side * way), axis)
    return total


def _flux(state: np.ndarray, axis: int) -> np.ndarray:
    density, velocity, pressure = state[:, 0], state[:, 1:4], state[:, 4]
    mass = density * velocity[:, axis]
    momentum = mass[:, None] * velocity
    momentum[:, axis] += pressure
    enthalpy = GAMMA / (GAMMA - 1.0) * pressure / density + 0.5 * (velocity**2).sum(axis=1)
    return np.column_stack([mass, momentum, mass * enthalpy])


class Driven(Ensemble):
    """An ensemble whose residual has the sources taken off and whose far field is exact."""

    def __init__(self, mesh: Mesh, settings: FlowSettings):
        stream = FlowConditions(np.array([MACH]), np.zeros(1), np.zeros(1))
        super().__init__(mesh, prepare(mesh, settings.dtype), stream, settings, 2)
        order = self.topology.order
        self.expected = exact(mesh.cell_center)[order]
        self.driving = (source(mesh.cell_center) * mesh.cell_volume[:, None])[order]
        self.state[:] = self.expected[:, :, None]
        self.far[:] = exact(mesh.far_center)[:, :, None]

    def balance(self) -> None:
        super().balance()
        self.residual -= self.driving[:, :, None]


def errors(mesh: Mesh, settings: FlowSettings) -> dict[str, float]:
    """Volume mean of the error of each variable, and area mean of that of the wall pressure, once converged."""
    ensemble, final = Driven(mesh, settings), {}

    def keep(column, done, lane, history):
        final["state"] = done.state[:, :, lane].copy()
        final["wall"] = done.wall_pressure()[:, lane]

    histories = march(
        ensemble, 300, Caution(25.0, 100.0), lambda h: h.drop() > 3.5, keep, lambda *a: None, impulsive=False
    )
    assert histories[0].drop() > 3.5, histories[0].drop()
    weight = mesh.cell_volume[ensemble.topology.order]
    found = np.average(np.abs(final["state"] - ensemble.expected), axis=0, weights=weight)
    area = np.linalg.norm(mesh.wall_area, axis=1)
    wall = np.average(np.abs(final["wall"] - exact(mesh.wall_center)[:, 4]), weights=area)
    return dict(zip(("rho", "u", "v", "w", "p"), found, strict=True)) | {"wall p": float(wall)}
