"""What one condition did on one level: residuals, forces, and what they say about its convergence."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

LEAST_FORCE = 2e-3
"""Dynamic pressure on this share of the wetted area is the least force that a wandering one is measured by. A slender
vehicle's drag is five times as large; a sphere's at Mach 0.5, all of it error, a fifth."""


@dataclass
class History:
    """What one condition did on one level.

    Attributes:
        residual: after each iteration, the first before any; force: [3] likewise.
        impulsive: residual of the free stream on this level, which no start worth the name exceeds: one from a coarse
            level that went astray would otherwise pass for decades gained.
        failure: why the condition broke; done: whether it left because it was at its end.
    """

    impulsive: float = float("inf")
    residual: list[float] = field(default_factory=list)
    force: list[np.ndarray] = field(default_factory=list)
    failure: str = ""
    done: bool = False

    @property
    def age(self) -> int:
        """Iterations done."""
        return max(len(self.residual) - 1, 0)

    @property
    def first(self) -> float:
        """The residual by which its fall is measured."""
        return max(min(self.residual[0], self.impulsive), 1e-300)

    def drop(self) -> float:
        """Decades that the residual has fallen since the first iteration."""
        if not self.residual:
            return 0.0
        return float(np.log10(self.first / max(self.residual[-1], 1e-300)))

    def best_drop(self) -> float:
        """Decades that the best residual lies below the first."""
        return float(np.log10(self.first / max(min(self.residual), 1e-300))) if self.residual else 0.0

    def gain(self, window: int) -> float:
        """Decades by which the best residual of the last `window` iterations is below the best one before them;
        infinite where there is none before."""
        if len(self.residual) <= window:
            return float("inf")
        before, since = min(self.residual[:-window]), min(self.residual[-window:])
        return float(np.log10(max(before, 1e-300) / max(since, 1e-300)))

    def spread(self, window: int) -> float:
        """Half peak-to-peak of the force over the last `window` iterations, on the mean force's size.

        Never by less than `LEAST_FORCE`, so that a flow with next to none can stand still too.
        """
        force = np.array(self.force[-window:])
        scale = max(float(np.linalg.norm(force.mean(axis=0))), LEAST_FORCE)
        return float(0.5 * np.ptp(force, axis=0).max() / scale)
