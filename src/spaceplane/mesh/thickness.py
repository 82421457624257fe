"""Where the body is thin against its cells, and the cells wanted there.

Towards a sharp edge a wing becomes thinner than any cell, and its pressure changes over lengths of the order of its
thickness: the shock at a leading edge, the expansion behind a bevel. The thickness along grid lines says so wherever
the edge lies in the grid, in a plane of it as well, where no cell holds both sides of the wing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spaceplane.mesh.cutcells import CutCells
from spaceplane.mesh.grid import Grid
from spaceplane.mesh.sizing import Sizing

THIN = 0.45
"""Thickness of the body, in cells, below which cells are halved at the edges of thin walls."""
ASIDE = 0.01
"""How far beside a grid line, in finest cells, the points lie that stand for the four cells around it."""


@dataclass(frozen=True)
class Thickness:
    """Thickness of the body along grid lines nearly normal to it.

    Attributes:
        point: [place, xyz] where the line enters the body from below, m.
        axis: [place] of the line.
        thickness: [place] way to where it leaves the body, m.
        spacing: between grid lines, m.
    """

    point: np.ndarray
    axis: np.ndarray
    thickness: np.ndarray
    spacing: float


def thickness_of(cut: CutCells, shift: np.ndarray, grid: Grid) -> Thickness:
    """Thickness at the thin walls of `cut`, whose window begins with cell `shift` [xyz] of the domain."""
    point = grid.corner + (cut.thin[:, :3] + shift) * grid.cell
    return Thickness(point, cut.thin[:, 5].astype(np.int64), cut.thin[:, 3] * grid.cell, grid.cell)


def cells_on_thin_walls(walls: Thickness, smallest: float, largest: float) -> Sizing:
    """Cells of which the body is at least `THIN` thick, on both of its sides and all around each grid line.

    Args:
        walls: thickness of the body.
        smallest: no smaller cells are asked for, m.
        largest: nothing is asked for where larger cells will do, m.
    """
    wanted = np.maximum(walls.thickness / THIN, smallest)
    few = np.flatnonzero(wanted < largest)
    rows, axis, wanted = np.arange(len(few)), walls.axis[few], wanted[few]
    entry = walls.point[few]
    leaving = entry.copy()
    leaving[rows, axis] += walls.thickness[few]
    points = []
    for end in (entry, leaving):
        for first in (-ASIDE, ASIDE):
            for second in (-ASIDE, ASIDE):
                beside = end.copy()
                beside[rows, (axis + 1) % 3] += first * walls.spacing
                beside[rows, (axis + 2) % 3] += second * walls.spacing
                points.append(beside)
    return Sizing(np.concatenate(points), np.tile(wanted, len(points)))
