"""Cells wanted smaller than the distance from the wall makes them, place by place."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spaceplane.errors import InputError
from spaceplane.mesh.grid import Grid
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.octree import Window, window_of

MOST_FINER = 5
"""Levels that a sizing may add below the wall cell of the settings."""


@dataclass(frozen=True)
class Sizing:
    """Largest cell wanted at given points; between them the octree is graded.

    Attributes:
        point: [point, xyz] m.
        cell: [point] no cell that holds the point is larger, m.
    """

    point: np.ndarray
    cell: np.ndarray

    def __post_init__(self) -> None:
        """Refuse what is no sizing.

        Raises:
            InputError: naming the field.
        """
        if np.ndim(self.point) != 2 or np.shape(self.point)[1] != 3 or len(self.point) != len(self.cell):
            raise InputError(f"sizing: {np.shape(self.point)} points for {np.shape(self.cell)} cells do not fit")
        if not (np.isfinite(self.point).all() and np.isfinite(self.cell).all() and (np.asarray(self.cell) > 0).all()):
            raise InputError("sizing: points and cells must be finite, cells above 0")


def split(mesh: Mesh, marked: np.ndarray) -> Sizing:
    """Cells as small as those of `mesh`, and half as small where marked.

    Args:
        mesh: of `generate`; built again with the same settings and this sizing, only marked cells are split, and what
            grading needs besides.
        marked: [cell] bool.
    """
    wanted = np.where(marked, 0.5, 1.0) * mesh.cell_size
    quarter = 0.25 * mesh.cell_size[marked, None, None]
    corners = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(1, 8, 3)
    children = (mesh.cell_cube_center[marked][:, None] + quarter * corners).reshape(-1, 3)
    # a cell may be larger than its cube: small cut cells were merged with it, and its wall lies in theirs
    cell = mesh.wall_cell[mesh.piece_wall]
    wall = marked[cell]
    return Sizing(
        np.concatenate([mesh.cell_cube_center[~marked], children, mesh.piece_center[wall]]),
        np.concatenate([wanted[~marked], np.repeat(wanted[marked], 8), wanted[cell[wall]]]),
    )


def finer_levels(sizing: Sizing | None, cell: float) -> int:
    """How many levels below cells of `cell`, m, a sizing needs.

    Raises:
        InputError: more than `MOST_FINER`.
    """
    if sizing is None or not len(sizing.cell):
        return 0
    finer = max(0, math.ceil(math.log2(cell / float(np.min(sizing.cell))) - 1e-6))
    if finer > MOST_FINER:
        raise InputError(
            f"sizing: {np.min(sizing.cell):.3g} m lies {finer} levels below the cell of {cell:.3g} m, "
            f"at most {MOST_FINER} allowed"
        )
    return finer


def split_cells(sizing: Sizing | None, grid: Grid) -> dict[int, Window]:
    """By level, the cells that must be refined so that no cell is larger than wanted."""
    if sizing is None or not len(sizing.cell):
        return {}
    place = (np.asarray(sizing.point, float) - grid.corner) / grid.cell
    if grid.half:
        place[:, 1] = np.abs(place[:, 1])
    # the level below which a cell that holds the point must lie
    level = np.floor(np.log2(np.asarray(sizing.cell, float) / grid.cell) + 1e-6).astype(np.int64) + 1
    found = {}
    for above in range(1, grid.levels + 1):
        here = level == above
        if here.any():
            places = np.unique(np.floor(place[here] / 2**above).astype(np.int64), axis=0)
            found[above] = window_of(places, grid.size * 2 ** (grid.levels - above))
    return found
