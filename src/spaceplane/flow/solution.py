"""What the flow stage is asked and what it answers."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from spaceplane.mesh.mesh import Mesh


@dataclass(frozen=True)
class FlowConditions:
    """Free streams to solve together as one ensemble.

    Attributes:
        mach: [condition] free-stream Mach number.
        alpha: [condition] angle of attack, rad, nose up positive.
        beta: [condition] sideslip, rad, wind from the right positive.
        gamma: ratio of specific heats.
    """

    mach: np.ndarray
    alpha: np.ndarray
    beta: np.ndarray
    gamma: float = 1.4

    def __len__(self) -> int:
        return len(self.mach)


@dataclass(frozen=True)
class ConvergenceRecord:
    """How one condition converged.

    Attributes:
        verdict: "converged", "oscillating" (forces wander about a stated mean) or "failed".
        residual_drop: decades (log10) that the density residual fell on the fine mesh.
        iterations: fine-mesh iterations.
        residual_history: [iteration] log10 of the residual relative to the first.
        force_history: [iteration, 3] force coefficients along x, y, z on the body's frontal scale q A_wetted.
        window_mean: [3] mean of `force_history` over the final window.
        window_spread: [3] half the peak-to-peak over the final window.
        reason: why it is not "converged"; empty when it is.
    """

    verdict: str
    residual_drop: float
    iterations: int
    residual_history: np.ndarray
    force_history: np.ndarray
    window_mean: np.ndarray
    window_spread: np.ndarray
    reason: str = ""

    @property
    def good(self) -> bool:
        """Whether forces of this condition may be reported as a converged result."""
        return self.verdict == "converged"


@dataclass(frozen=True)
class Solution:
    """Steady flow of every condition on one mesh.

    Scaled units: density on the free stream's, velocity on the free-stream speed of sound, pressure on
    rho_inf a_inf^2 (so p_inf = 1/gamma and q_inf = Mach^2/2).

    Attributes:
        state: [cell, (rho, u, v, w, p), condition].
        wall_pressure: [wall, condition] pressure at the wall face's centroid.
        records: one ConvergenceRecord per condition.
        statistics: cells, seconds (by phase), iterations, precision, warnings.
    """

    mesh: Mesh
    conditions: FlowConditions
    state: np.ndarray
    wall_pressure: np.ndarray
    records: tuple[ConvergenceRecord, ...]
    statistics: dict = field(default_factory=dict)

    def wall_cp(self) -> np.ndarray:
        """[wall, condition] pressure coefficient on the wall."""
        gamma = self.conditions.gamma
        return (self.wall_pressure - 1.0 / gamma) / (0.5 * self.conditions.mach**2)
