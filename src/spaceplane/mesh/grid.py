"""Where the octree lies in space."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spaceplane.mesh.settings import MeshSettings
from spaceplane.mesh.symmetry import is_symmetric
from spaceplane.vehicle.surface import Surface


@dataclass(frozen=True)
class Grid:
    """Where the octree lies.

    Attributes:
        cell: wall cell, m.
        corner: [xyz] of integer place (0, 0, 0), m.
        size: [xyz] domain in cells of the top level.
        levels: number of the top level.
        half: whether y = 0 is the lower face of the domain and a plane of symmetry.
    """

    cell: float
    corner: np.ndarray
    size: np.ndarray
    levels: int
    half: bool

    @property
    def lower(self) -> np.ndarray:
        """Lower corner of the whole domain, mirror image included, m."""
        lower = self.corner.copy()
        if self.half:
            lower[1] = -self.size[1] * self.cell * 2**self.levels
        return lower

    @property
    def upper(self) -> np.ndarray:
        """Upper corner of the domain, m."""
        return self.corner + self.size * self.cell * 2**self.levels


def place_grid(surface: Surface, settings: MeshSettings, half: bool) -> Grid:
    """Lay the grid: y = 0 is a cell face of every level, the body keeps its place within a wall cell in x and z."""
    cell = settings.wall_cell
    low, high = surface.bounds
    length = float((high - low).max())
    levels = max(1, round(math.log2(max(length / cell, 2.0))))
    top = cell * 2**levels
    reach = settings.far_field * length
    size = np.zeros(3, np.int64)
    corner = np.zeros(3)
    level_faced = half and is_symmetric(surface, 2)
    for axis in range(3):
        if axis == 1 or (axis == 2 and level_faced):
            widest = max(abs(low[axis]), abs(high[axis]))
            size[axis] = 2 * math.ceil((widest + reach) / top)
            corner[axis] = -0.5 * size[axis] * top
        else:
            offset = settings.offset[0 if axis == 0 else 1] % 1.0
            size[axis] = math.ceil((high[axis] - low[axis] + 2.0 * reach) / top)
            before = math.floor((size[axis] * top - (high[axis] - low[axis])) / (2.0 * cell))
            corner[axis] = low[axis] - (before + offset) * cell
    if half:
        size[1] //= 2
        corner[1] = 0.0
    return Grid(cell, corner, size, levels, half)


def boxes_in_cells(settings: MeshSettings, grid: Grid) -> list:
    """Refinement boxes as (level, lower, upper) in wall cells of the domain."""
    found = []
    for box in settings.boxes:
        level = max(0, math.floor(math.log2(box.cell / grid.cell) + 1e-9))
        low, high = np.array(box.lower, float), np.array(box.upper, float)
        if grid.half:
            low[1], high[1] = 0.0, max(abs(low[1]), abs(high[1]))
        found.append((level, (low - grid.corner) / grid.cell, (high - grid.corner) / grid.cell))
    return found
