"""Where the octree lies in space."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from spaceplane.errors import InputError
from spaceplane.mesh.settings import MeshSettings
from spaceplane.mesh.symmetry import is_symmetric
from spaceplane.vehicle.surface import Surface


@dataclass(frozen=True)
class Grid:
    """Where the octree lies.

    Attributes:
        cell: smallest cell, m: level 0.
        wall_cell: cells at most walls, m: `cell`, or twice that where some walls are finer.
        corner: [xyz] of integer place (0, 0, 0), m.
        size: [xyz] domain in cells of the top level.
        levels: number of the top level.
        half: whether y = 0 is the lower face of the domain and a plane of symmetry.
    """

    cell: float
    wall_cell: float
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
    """Lay the grid: y = 0 is a cell face of every level, the body keeps its place within a wall cell in x and z.

    Args:
        surface: the body, m.
        settings: cell size, far field and offset.
        half: whether the grid ends at y = 0.

    Raises:
        InputError: a domain that does not hold the body and four cells round it.
    """
    cell = settings.wall_cell / (2.0 if settings.graded_wall else 1.0)
    low, high = surface.bounds
    length = float((high - low).max())
    levels = max(1, round(math.log2(max(length / cell, 2.0))))
    top = cell * 2**levels
    # a body of a few cells still needs air around it
    reach = max(settings.far_field * length, 8.0 * cell)
    lower, upper = low - reach, high + reach
    if settings.domain is not None:
        lower, upper = np.array(settings.domain, dtype=float)
        if (low - lower < 4.0 * cell).any() or (upper - high < 4.0 * cell).any():
            raise InputError(
                f"domain: {settings.domain} m, the body ({low.round(3).tolist()} to {high.round(3).tolist()} m) is "
                "larger than the domain or within four cells of its boundary"
            )
    size = np.zeros(3, np.int64)
    corner = np.zeros(3)
    level_faced = half and is_symmetric(surface, 2)
    for axis in range(3):
        if axis == 1 or (axis == 2 and level_faced):
            size[axis] = 2 * math.ceil(max(abs(lower[axis]), abs(upper[axis])) / top)
            corner[axis] = -0.5 * size[axis] * top
        else:
            offset = settings.offset[0 if axis == 0 else 1] % 1.0
            size[axis] = math.ceil((upper[axis] - lower[axis]) / top)
            spare = size[axis] * top - (upper[axis] - lower[axis])
            before = math.floor((low[axis] - lower[axis] + 0.5 * spare) / cell)
            corner[axis] = low[axis] - (before + offset) * cell
    if half:
        size[1] //= 2
        corner[1] = 0.0
    return Grid(cell, settings.wall_cell, corner, size, levels, half)


def refined(grid: Grid, finer: int) -> Grid:
    """The same grid with `finer` more levels below the finest; every cell of `grid` is one of its cells."""
    return replace(grid, cell=grid.cell / 2**finer, levels=grid.levels + finer)


def boxes_in_cells(settings: MeshSettings, grid: Grid) -> list:
    """Refinement boxes as (level, lower, upper) in wall cells of the domain.

    Raises:
        InputError: a box outside the domain, or with more cells than are allowed altogether.
    """
    found = []
    for box in settings.boxes:
        level = max(0, math.floor(math.log2(box.cell / grid.cell) + 1e-9))
        low, high = np.array(box.lower, float), np.array(box.upper, float)
        if grid.half:
            low[1], high[1] = 0.0, max(abs(low[1]), abs(high[1]))
        low, high = (low - grid.corner) / grid.cell, (high - grid.corner) / grid.cell
        inside = np.minimum(high, grid.size * 2**grid.levels) - np.maximum(low, 0.0)
        if (inside <= 0.0).any():
            raise InputError(f"boxes: {box.lower} to {box.upper} m lies outside the air that is meshed")
        cells = float(np.prod(inside / 2**level))
        if cells > settings.max_cells:
            raise InputError(
                f"boxes: cells of {box.cell:g} m from {box.lower} to {box.upper} m are {cells:.3g}, "
                f"at most {settings.max_cells} allowed"
            )
        found.append((level, low, high))
    return found
