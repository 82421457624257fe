"""Pressure of blunt bases by correlation, in place of the one that an inviscid wake happens to have.

The base pressure is that of a turbulent wake behind a blunt body without jet or boat-tail. Its coefficient is

    -(0.12 + 0.13 M^2)                          below Mach 1,
    -0.25 / M                                   from Mach 1 on,
    2 / (gamma M^2) (p_b / p_inf - 1)           where this is the weaker suction, above about Mach 4, with
    p_b / p_inf = (2 / (gamma + 1))^gamma M^(-2 gamma) (2 gamma M^2 - (gamma - 1)) / (gamma + 1).

The first two are a fit to measured bodies of revolution after Hoerner (Fleeman, "Tactical Missile Design", 2nd ed.,
2006; Niskanen, "OpenRocket technical documentation", equation 3.94). It would pass beyond vacuum at Mach 5.7; the third
(Gabeaud, "Base pressures at supersonic velocities", J. Aeronautical Sciences 17 (8), 1950) tends to vacuum.
"""

from __future__ import annotations

import numpy as np

from spaceplane.flow.freestream import direction
from spaceplane.flow.solution import Solution
from spaceplane.mesh.mesh import Mesh

STEEPNESS = 0.5
"""Least n_x of a base: outward normals within 60 deg of aft, so a turn of 30 deg and more from axial flow."""


def base_cp(mach: np.ndarray, gamma: float = 1.4) -> np.ndarray:
    """Pressure coefficient of a blunt base at free-stream Mach numbers; see the module for the source."""
    mach = np.asarray(mach, dtype=float)
    supersonic = np.maximum(mach, 1.0)
    m2 = supersonic**2
    ratio = (2.0 / (gamma + 1.0)) ** gamma / m2**gamma * (2.0 * gamma * m2 - (gamma - 1.0)) / (gamma + 1.0)
    gabeaud = 2.0 / (gamma * m2) * (1.0 - ratio)
    return -np.where(mach < 1.0, 0.12 + 0.13 * mach**2, np.minimum(0.25 / supersonic, gabeaud))


def is_base(mesh: Mesh, alpha: float, beta: float) -> np.ndarray:
    """[piece] whether a piece of wall is base: outward n_x at least STEEPNESS, and turned away from the wind.

    Args:
        mesh: its pieces.
        alpha, beta: angle of attack and sideslip, rad.
    """
    outward = -mesh.piece_area / np.maximum(np.linalg.norm(mesh.piece_area, axis=1, keepdims=True), 1e-300)
    return (outward[:, 0] >= STEEPNESS) & (outward @ direction(alpha, beta) > 0.0)


def base_forces(solution: Solution, condition: int) -> np.ndarray:
    """[piece, xyz] change of the pressure force on each piece in one condition, on rho_inf a_inf^2 m2, geometry axes.

    Args:
        solution: flow.
        condition: number of the condition.
    """
    mesh, conditions = solution.mesh, solution.conditions
    mach = float(conditions.mach[condition])
    wanted = 1.0 / conditions.gamma + base_cp(mach, conditions.gamma) * 0.5 * mach**2
    change = wanted - solution.wall_pressure[mesh.piece_wall, condition].astype(float)
    base = is_base(mesh, float(conditions.alpha[condition]), float(conditions.beta[condition]))
    return np.where(base, change, 0.0)[:, None] * mesh.piece_area
