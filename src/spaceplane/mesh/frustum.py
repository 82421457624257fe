"""Truncated cones in which a user asks for small cells."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spaceplane.errors import InputError


@dataclass(frozen=True)
class RefinementFrustum:
    """A truncated cone, any way up, in which cells are no larger than `cell`: a cell belongs to it with its centre.

    Attributes:
        start, end: (x, y, z) centres of the two plane ends, m.
        start_radius, end_radius: outer radii at the ends, m; one may be 0.
        cell: largest cell edge inside, m.
        start_hole, end_hole: radii at the ends of a hole along the axis that does not belong to it, m; 0 for none.
    """

    start: tuple[float, float, float]
    end: tuple[float, float, float]
    start_radius: float
    end_radius: float
    cell: float
    start_hole: float = 0.0
    end_hole: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what is no frustum.

        Raises:
            InputError: naming the field, its value and what is allowed.
        """
        if not (math.isfinite(self.cell) and self.cell > 0.0):
            raise InputError(f"frustums: cell {self.cell} m, must be a finite length above 0")
        for name in ("start", "end"):
            point = getattr(self, name)
            if len(point) != 3 or not all(math.isfinite(x) for x in point):
                raise InputError(f"frustums: {name} {point}, three finite coordinates in m are needed")
        if not math.dist(self.start, self.end) > 0.0:
            raise InputError(f"frustums: start {self.start} and end {self.end}, must be two points")
        for name in ("start", "end"):
            radius, hole = getattr(self, f"{name}_radius"), getattr(self, f"{name}_hole")
            if not (math.isfinite(radius) and radius >= 0.0):
                raise InputError(f"frustums: {name}_radius {radius} m, must be a finite length of at least 0")
            if not 0.0 <= hole <= radius:
                raise InputError(f"frustums: {name}_hole {hole} m, allowed 0 to {name}_radius {radius} m")
        if not max(self.start_radius - self.start_hole, self.end_radius - self.end_hole) > 0.0:
            raise InputError("frustums: radii equal the holes' at both ends, nothing is left between")

    def mirrored(self) -> RefinementFrustum:
        """Its mirror image in y = 0."""
        (a, b, c), (d, e, f) = self.start, self.end
        radii = (self.start_radius, self.end_radius, self.cell, self.start_hole, self.end_hole)
        return RefinementFrustum((a, -b, c), (d, -e, f), *radii)

    def contains(self, points: np.ndarray) -> np.ndarray:
        """[...] whether points [..., xyz], m, lie inside."""
        axis = np.subtract(self.end, self.start)
        length = float(np.linalg.norm(axis))
        away = points - np.asarray(self.start, float)
        along = away @ (axis / length)
        radius2 = (away**2).sum(axis=-1) - along**2
        share = along / length
        outer = self.start_radius + share * (self.end_radius - self.start_radius)
        inner = self.start_hole + share * (self.end_hole - self.start_hole)
        return (share >= 0.0) & (share <= 1.0) & (radius2 <= outer**2) & ((radius2 >= inner**2) | (inner <= 0.0))

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner of a box that holds it, m."""
        axis = np.subtract(self.end, self.start) / math.dist(self.start, self.end)
        reach = np.sqrt(np.maximum(1.0 - axis**2, 0.0))  # of a disc of radius 1 across the axis
        ends = np.array([self.start, self.end], float)
        reach = reach * np.array([[self.start_radius], [self.end_radius]])
        return (ends - reach).min(axis=0), (ends + reach).max(axis=0)
