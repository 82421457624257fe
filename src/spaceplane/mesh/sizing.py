"""Cells wanted smaller than the distance from the wall makes them, place by place."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from spaceplane.errors import InputError
from spaceplane.mesh.frustum import RefinementFrustum
from spaceplane.mesh.grid import Grid
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.octree import Window, parents, union, window_of
from spaceplane.mesh.settings import RefinementBox

MOST_FINER = 5
"""Levels that a sizing may add below the wall cell of the settings."""
# Length of a wall's area vector on its wetted area: cos(120 deg / 2).
SHARP = 0.5
MOST_PLACES = 400_000_000
"""Places of the wanted cell in the box round a frustum, at most."""


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


def split(mesh: Mesh, marked: np.ndarray, coarse: np.ndarray | None = None) -> Sizing:
    """Cells as small as those of `mesh`, half as small where marked and twice as large where they may be coarse.

    Args:
        mesh: of `generate`; built again with the same settings and this sizing, only marked cells are split, and what
            grading needs besides. Eight cells become one where all of them may be coarse and the settings allow it.
        marked: [cell] bool.
        coarse: [cell] bool, none of them marked; None for no coarser cells.
    """
    owner, center, size = octree_cubes(mesh)
    wanted = np.where(marked[owner], np.minimum(size, 0.5 * mesh.cell_size[owner]), size)
    if coarse is not None:
        wanted = np.where(coarse[owner], 2.0 * size, wanted)
    halved = wanted < 0.75 * size
    corners = np.stack(np.meshgrid(*[[-0.25, 0.25]] * 3, indexing="ij"), axis=-1).reshape(1, 8, 3)
    children = (center[halved][:, None] + corners * size[halved, None, None]).reshape(-1, 3)
    return Sizing(
        np.concatenate([center[~halved], children]),
        np.concatenate([wanted[~halved], np.repeat(wanted[halved], 8)]),
    )


def sizes_of(mesh: Mesh, ratio: float = 1.0) -> Sizing:
    """Cells as small as those of `mesh`, or `ratio` times as large."""
    found = split(mesh, np.zeros(mesh.cells, bool))
    return Sizing(found.point, ratio * found.cell)


def both(one: Sizing, other: Sizing) -> Sizing:
    """Cells as small as either asks for."""
    return Sizing(np.concatenate([one.point, other.point]), np.concatenate([one.cell, other.cell]))


def round_edges(mesh: Mesh) -> np.ndarray:
    """[cell] whether air connects the two sides of a thin wall round its edge within the cell.

    The wall in such a cell turns by more than 120 degrees. Both sides of a wing have one pressure there: no lift.
    """
    found = np.zeros(mesh.cells, bool)
    found[mesh.wall_cell] = np.linalg.norm(mesh.wall_area, axis=1) < SHARP * mesh.wall_wetted
    return found


def octree_cubes(mesh: Mesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cell, centre [cube, xyz], m, and edge, m, of the octree cubes that the cells lie in.

    Raises:
        InputError: a mesh that is no octree's.
    """
    if mesh.cell_cube_center is None:
        raise InputError("mesh: an imported mesh has no octree to refine")
    cell, center, size = np.arange(mesh.cells), mesh.cell_cube_center, mesh.cell_size
    if mesh.merged_cubes is None:
        return cell, center, size
    more = mesh.merged_cubes
    return (
        np.concatenate([cell, more[:, 0].astype(np.int64)]),
        np.concatenate([center, more[:, 1:4]]),
        np.concatenate([size, more[:, 4]]),
    )


def finer_levels(sizing: Sizing | None, regions: Iterable[RefinementBox | RefinementFrustum], cell: float) -> int:
    """How many levels below cells of `cell`, m, a sizing, boxes and frustums need.

    Raises:
        InputError: more than `MOST_FINER`.
    """
    smallest = min([region.cell for region in regions], default=cell)
    if sizing is not None and len(sizing.cell):
        smallest = min(smallest, float(np.min(sizing.cell)))
    finer = max(0, math.ceil(math.log2(cell / smallest) - 1e-6))
    if finer > MOST_FINER:
        raise InputError(
            f"sizing: {smallest:.3g} m lies {finer} levels below the cell of {cell:.3g} m, at most {MOST_FINER} allowed"
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


def frustum_cells(frustums: Iterable[RefinementFrustum], grid: Grid) -> dict[int, Window]:
    """By level, the cells that must be refined so that no cell in a frustum is larger than it asks for.

    A grid that ends at y = 0 takes each frustum with its mirror image.

    Raises:
        InputError: a frustum with too many cells.
    """
    found: dict[int, Window] = {}
    for frustum in frustums:
        level = math.floor(math.log2(frustum.cell / grid.cell) + 1e-9)
        if level >= grid.levels:
            continue
        for one in (frustum, frustum.mirrored()) if grid.half else (frustum,):
            window = _inside(one, grid, level)
            if window is not None:
                split_here = parents(window)
                found[level + 1] = union(found[level + 1], split_here) if level + 1 in found else split_here
    return found


def _inside(frustum: RefinementFrustum, grid: Grid, level: int) -> Window | None:
    """The places of `level` with their centres in the frustum; None where it lies outside the domain."""
    edge = grid.cell * 2**level
    low, high = ((corner - grid.corner) / edge for corner in frustum.bounds())
    low = np.clip(np.floor(low).astype(np.int64), 0, None)
    high = np.minimum(np.ceil(high).astype(np.int64), grid.size * 2 ** (grid.levels - level))
    if (high <= low).any():
        return None
    places = float(np.prod((high - low).astype(float)))
    if places > MOST_PLACES:
        raise InputError(
            f"frustums: cell {frustum.cell:.6g} m spans the box round it with {places:.3g} cells, "
            f"at most {MOST_PLACES:.3g} allowed"
        )
    x, y, z = (grid.corner[d] + (np.arange(low[d], high[d]) + 0.5) * edge for d in range(3))
    section = np.stack(np.broadcast_arrays(0.0, y[:, None], z[None, :]), axis=-1)
    array = np.empty(high - low, bool)
    for i, station in enumerate(x):  # section by section, for memory
        section[..., 0] = station
        array[i] = frustum.contains(section)
    return Window(low, array)
