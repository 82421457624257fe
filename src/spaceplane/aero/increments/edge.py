"""The state at the edge of the boundary layer, from the computed inviscid flow at the wall.

Pressure is that on the wall, and total enthalpy the free stream's. The one thing left to choose is the entropy, which
decides how the rest is shared between temperature and speed. It is the entropy of the wall cell. The alternative,
the entropy behind a normal shock everywhere, holds for the one streamline that wets the whole of a blunt body; a
boundary layer on a slender vehicle soon swallows that thin layer and has the air of weaker shocks at its edge, and a
swept wing or winglet that the nose's streamline never reaches does from the start. The wall cell averages over its own
depth and so sees the entropy that the flow has there. Entropy that the scheme makes at corners and in dead water
slows the edge, which errs towards less friction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spaceplane.flow.solution import Solution


@dataclass(frozen=True)
class Edge:
    """Edge of the boundary layer at each wall face in one condition; the solver's scales.

    Attributes:
        pressure: [wall] on rho_inf a_inf^2.
        temperature: [wall] on the free stream's.
        speed: [wall] on the free stream's speed of sound.
        velocity: [wall, xyz] velocity of the wall cell, not yet in the wall's plane: only its direction is used.
        gamma: ratio of specific heats.
    """

    pressure: np.ndarray
    temperature: np.ndarray
    speed: np.ndarray
    velocity: np.ndarray
    gamma: float

    @property
    def density(self) -> np.ndarray:
        """[wall] on the free stream's."""
        return self.gamma * self.pressure / self.temperature


def edge_of(solution: Solution, condition: int) -> Edge:
    """Edge state of every wall face in one condition of a solution."""
    gamma = solution.conditions.gamma
    mach = float(solution.conditions.mach[condition])
    density, *velocity, cell_pressure = solution.state[solution.mesh.wall_cell, :, condition].astype(float).T
    pressure = np.maximum(solution.wall_pressure[:, condition].astype(float), 1e-9)
    # p / rho^gamma on the free stream's; entropy never falls below the free stream's.
    entropy = np.maximum(gamma * cell_pressure / density**gamma, 1.0)
    total = 1.0 + 0.5 * (gamma - 1.0) * mach**2
    temperature = entropy ** (1.0 / gamma) * (gamma * pressure) ** ((gamma - 1.0) / gamma)
    temperature = np.minimum(temperature, total)
    speed = np.sqrt(2.0 / (gamma - 1.0) * (total - temperature))
    return Edge(pressure, temperature, speed, np.stack(velocity, axis=1), gamma)


def along_wall(velocity: np.ndarray, area: np.ndarray) -> np.ndarray:
    """Unit vectors of velocities projected on planes; zero where nothing is left of the velocity or of the plane.

    Args:
        velocity: [face, xyz].
        area: [face, xyz] area vectors of the planes.
    """
    size = np.linalg.norm(area, axis=1, keepdims=True)
    normal = area / np.maximum(size, 1e-300)
    tangent = velocity - (velocity * normal).sum(axis=1, keepdims=True) * normal
    length = np.linalg.norm(tangent, axis=1, keepdims=True)
    lost = (length <= 1e-9 * np.linalg.norm(velocity, axis=1, keepdims=True)) | (length == 0.0) | (size == 0.0)
    return np.where(lost, 0.0, tangent / np.where(lost, 1.0, length))
