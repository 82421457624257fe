"""What the flow stage is asked and what it answers."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from spaceplane.mesh.mesh import Mesh

PERFECT, EQUILIBRIUM = GASES = ("perfect", "equilibrium")
"""Constant specific heats, or air in chemical equilibrium."""


@dataclass(frozen=True)
class FlowConditions:
    """Free streams to solve together as one ensemble.

    Attributes:
        mach: [condition] free-stream Mach number.
        alpha: [condition] angle of attack, rad, nose up positive.
        beta: [condition] sideslip, rad, wind from the right positive.
        gamma: ratio of specific heats.
        rates: [condition, (p, q, r)] steady roll, pitch and yaw rate of the body about `center` on the free-stream
            speed of sound, 1/m; None for no rotation.
        center: (x, y, z) point of the body that moves with the free stream's speed, m, geometry axes.
        gas: name in `GASES`.
        density, pressure: [condition] of the free stream, kg/m3 and Pa; the perfect gas needs none.
    """

    mach: np.ndarray
    alpha: np.ndarray
    beta: np.ndarray
    gamma: float = 1.4
    rates: np.ndarray | None = None
    center: tuple[float, float, float] = (0.0, 0.0, 0.0)
    gas: str = PERFECT
    density: np.ndarray | None = None
    pressure: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.mach)

    def take(self, which: np.ndarray) -> FlowConditions:
        """The conditions of these indices."""
        names = ("mach", "alpha", "beta", "rates", "density", "pressure")
        values = {name: getattr(self, name) for name in names}
        return replace(self, **{name: value if value is None else value[which] for name, value in values.items()})

    def angular_velocity(self) -> np.ndarray:
        """[condition, xyz] angular velocity of the body in geometry axes, 1/m (x and z of body axes are reversed)."""
        if self.rates is None:
            return np.zeros((len(self), 3))
        return np.asarray(self.rates, dtype=float) * [-1.0, 1.0, -1.0]

    def symmetric(self) -> np.ndarray:
        """[condition] whether the stream is the same left and right: no sideslip, no roll, no yaw rate."""
        straight = np.asarray(self.beta) == 0.0
        return straight if self.rates is None else straight & ~np.asarray(self.rates)[:, [0, 2]].any(axis=1)


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
    rho_inf a_inf^2 (so p_inf = 1/gamma and q_inf = Mach^2/2); a_inf is that of cold air in equilibrium air too.

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
