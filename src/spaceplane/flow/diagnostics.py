"""What a solution says about its own quality: wall Cp extrema, entropy error, total-enthalpy error."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spaceplane.environment.equilibrium_air import GAS_CONSTANT, stagnation
from spaceplane.flow.equilibrium import enthalpy
from spaceplane.flow.solution import EQUILIBRIUM, FlowConditions, Solution


@dataclass(frozen=True)
class Diagnostics:
    """Quality measures of each condition; NaN where it failed.

    Attributes:
        cp_max, cp_min: [condition] extrema of the pressure coefficient over the wall faces.
        cp_stagnation: [condition] exact stagnation value (isentropic, behind a normal shock above Mach 1).
        entropy_error: [condition] share by which entropy p / rho^gamma falls below the free stream's at worst; in
            steady flow entropy never falls along a streamline, so any fall is an error. NaN in equilibrium air,
            of which it is no measure.
        enthalpy_error: [condition] root mean square over volume, within `near` of the wall cells' largest extent, of
            the
            total enthalpy's deviation from the free stream's, on the free stream's; zero in exact steady flow.
    """

    cp_max: np.ndarray
    cp_min: np.ndarray
    cp_stagnation: np.ndarray
    entropy_error: np.ndarray
    enthalpy_error: np.ndarray


def stagnation_cp(mach: np.ndarray, gamma: float = 1.4) -> np.ndarray:
    """Exact pressure coefficient at a blunt body's stagnation point.

    Isentropic compression below Mach 1 (NACA Report 1135, eq. 44), Rayleigh's pitot formula above (eq. 100).
    """
    m2 = np.asarray(mach, dtype=float) ** 2
    power = gamma / (gamma - 1.0)
    below = (1.0 + 0.5 * (gamma - 1.0) * m2) ** power
    shocked = np.maximum(m2, 1.0)
    above = (0.5 * (gamma + 1.0) * shocked) ** power * ((gamma + 1.0) / (2.0 * gamma * shocked - (gamma - 1.0))) ** (
        1.0 / (gamma - 1.0)
    )
    return (np.where(m2 < 1.0, below, above) - 1.0) / (0.5 * gamma * m2)


def stagnation_cp_equilibrium(conditions: FlowConditions) -> np.ndarray:
    """[condition] pressure coefficient of equilibrium air at a blunt body's stagnation point.

    Up to Mach 1.2 the perfect gas's: cold air gets no warmer there than to act as one.
    """
    cp = stagnation_cp(conditions.mach, conditions.gamma)
    for k in np.flatnonzero(conditions.mach > 1.2):
        p, r = conditions.pressure[k], conditions.density[k]
        speed2 = conditions.mach[k] ** 2 * conditions.gamma * p / r
        cp[k] = (stagnation(p, p / (r * GAS_CONSTANT), np.sqrt(speed2)).pressure - p) / (0.5 * r * speed2)
    return cp


def diagnose(solution: Solution, near: float = 0.5) -> Diagnostics:
    """Quality measures of every condition of a solution.

    Args:
        near: cells closer to the body's box than this share of its longest side count in `enthalpy_error`.
    """
    mesh, conditions = solution.mesh, solution.conditions
    gamma, mach = conditions.gamma, conditions.mach
    perfect = conditions.gas != EQUILIBRIUM
    nothing = np.full(len(conditions), np.nan)
    cp, wall = solution.wall_cp()[mesh.body_wall], mesh.wall_center[mesh.body_wall]
    low, high = wall.min(axis=0), wall.max(axis=0)
    margin = near * (high - low).max()
    close = ((mesh.cell_center > low - margin) & (mesh.cell_center < high + margin)).all(axis=1)
    volume = mesh.cell_volume[close]
    entropy, enthalpy_error = nothing.copy(), nothing.copy()
    for k in range(len(conditions)):
        r, u, v, w, p = solution.state[:, :, k].astype(np.float64).T
        if not np.isfinite(r).all():
            continue
        if perfect:
            entropy[k] = max(0.0, 1.0 - float((gamma * p / r**gamma).min()))
        total = enthalpy(conditions, k, r, p) + 0.5 * (u * u + v * v + w * w)
        free = float(enthalpy(conditions, k, 1.0, 1.0 / gamma)) + 0.5 * mach[k] ** 2
        enthalpy_error[k] = np.sqrt(volume @ (total[close] / free - 1.0) ** 2 / volume.sum())
    highest = stagnation_cp(mach, gamma) if perfect else stagnation_cp_equilibrium(conditions)
    return Diagnostics(cp.max(axis=0), cp.min(axis=0), highest, entropy, enthalpy_error)
