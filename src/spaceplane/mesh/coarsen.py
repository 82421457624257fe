"""Coarser companions of a mesh: octree siblings joined, nested in the finer mesh."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from spaceplane.errors import InputError
from spaceplane.mesh.assembly import Assembly, finish, join_small
from spaceplane.mesh.mesh import Mesh

_STRIDE = 1 << 20


def _key(place: np.ndarray) -> np.ndarray:
    """One integer for each integer place, negative ones allowed."""
    place = place + (_STRIDE >> 1)
    return (place[:, 0] * _STRIDE + place[:, 1]) * _STRIDE + place[:, 2]


def coarsen(mesh: Mesh, merge_fraction: float = 0.3) -> tuple[Mesh, np.ndarray]:
    """Join the cells of every octree cube whose children are all leaves into one cell (one for each side of a wall).

    Wall area, volume and closure are those of the finer mesh exactly; sums over fine cells are sums over coarse ones.

    Args:
        mesh: from `generate` or from an earlier call.
        merge_fraction: coarse volumes below this fraction of their cube are merged with a neighbour.

    Returns:
        The coarser mesh and, for each fine cell, the coarse cell that holds it.

    Raises:
        InputError: the mesh is not an octree (imported).
    """
    if mesh.cell_cube_center is None or "grid_corner" not in mesh.record:
        raise InputError("mesh: only octree meshes can be coarsened, this one was imported")
    unit = mesh.record["grid_cell_m"]
    corner = np.array(mesh.record["grid_corner"])
    cube = (mesh.cell_cube_center - corner) / unit
    level = np.round(np.log2(mesh.cell_size / unit)).astype(np.int64)
    size = (1 << level).astype(np.float64)
    place = np.floor(cube / size[:, None]).astype(np.int64)
    group, joined = _siblings(place, level, int(mesh.record["levels"]) - 1)

    n = mesh.cells
    same = group[mesh.face_cells[:, 0]] == group[mesh.face_cells[:, 1]]
    ends = mesh.face_cells[same]
    graph = coo_matrix((np.ones(len(ends), np.int8), (ends[:, 0], ends[:, 1])), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    _, first = np.unique(label, return_index=True)
    size = np.where(joined, 2.0 * size, size)
    parent = np.where(joined[:, None], (place // 2 + 0.5) * size[:, None], cube)
    a = _as_assembly(mesh, corner, unit, size, parent)
    root = _join_small_sides(a, first[label], merge_fraction)
    coarse, number = finish(a, root, np.ones(n, bool), unit, corner, mesh.part_names)
    kept = ("wall_cell", "wall_cell_m", "grid_cell_m", "levels", "symmetric", "grid_corner", "domain", "volume")
    coarse.record.update({name: mesh.record[name] for name in kept})
    coarse.record.update(
        cells=coarse.cells, faces=len(coarse.face_cells), closure=float(np.abs(coarse.closure()).max()), warnings=[]
    )
    return coarse, number.astype(np.int32)


def _siblings(place: np.ndarray, level: np.ndarray, top: int) -> tuple[np.ndarray, np.ndarray]:
    """[cell] number of the group that each cell is joined with, and [cell] whether it is joined at all."""
    group = np.arange(len(level), dtype=np.int64)
    joined = np.zeros(len(level), bool)
    finer = np.zeros((0, 3), np.int64)  # cubes of the current level that are refined
    for at in range(top):
        here = np.flatnonzero(level == at)
        parents = place[here] // 2
        blocked = np.unique(_key(finer // 2))
        free = here[~np.isin(_key(parents), blocked)]
        _, inverse = np.unique(_key(place[free] // 2), return_inverse=True)
        group[free] = (at + 1) * (1 << 40) + inverse
        joined[free] = True
        finer = np.unique(np.concatenate([parents, finer // 2]), axis=0)
    return group, joined


def _as_assembly(mesh: Mesh, corner: np.ndarray, unit: float, size: np.ndarray, cube: np.ndarray) -> Assembly:
    """The mesh in wall cells, with its pieces of wall for surface polygons."""
    nothing = np.zeros((0, 3))
    return Assembly(
        volume=mesh.cell_volume / unit**3,
        center=(mesh.cell_center - corner) / unit,
        size=size,
        cube=cube,
        faces=mesh.face_cells.astype(np.int64),
        face_area=mesh.face_area / unit**2,
        face_center=(mesh.face_center - corner) / unit,
        far_cell=mesh.far_cell.astype(np.int64),
        far_area=mesh.far_area / unit**2,
        far_center=(mesh.far_center - corner) / unit,
        mirror_cell=np.zeros(0, np.int64),
        mirror_area=nothing,
        mirror_center=nothing,
        polygon_cell=mesh.wall_cell[mesh.piece_wall].astype(np.int64),
        polygon_part=mesh.piece_part.astype(np.int64),
        polygon_upstream=mesh.piece_area[:, 0] > 0.0,
        polygon_area=mesh.piece_area / unit**2,
        polygon_size=np.linalg.norm(mesh.piece_area, axis=1) / unit**2,
        polygon_center=(mesh.piece_center - corner) / unit,
    )


def _join_small_sides(a: Assembly, root: np.ndarray, fraction: float) -> np.ndarray:
    """Merge small coarse volumes, but not across y = 0, so that symmetric meshes stay so."""
    across = (np.abs(a.face_area[:, 1]) > 0.0) & (np.abs(a.face_center[:, 1]) < 1e-9)
    sides = Assembly(**{**vars(a), "faces": a.faces[~across], "face_area": a.face_area[~across]})
    return join_small(sides, fraction, root)
