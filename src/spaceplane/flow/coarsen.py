"""Coarse levels by joining cells of a fine mesh: octree siblings where there are any, else cells in common cubes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from spaceplane.mesh import coarsen as octree
from spaceplane.mesh.mesh import Mesh

_BODY = 6
"""Side of wall faces of the body; those of planes of symmetry have the direction that they face."""


@dataclass(frozen=True)
class Sequence:
    """Meshes from fine to coarse with the maps between them.

    Attributes:
        meshes: finest first.
        parents: `parents[k]` [cell of meshes[k]] is the cell of `meshes[k + 1]` that holds it.
    """

    meshes: tuple[Mesh, ...]
    parents: tuple[np.ndarray, ...]


def _sum(rows: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    if values.ndim == 1:
        return np.bincount(rows, values, count)
    return np.stack([np.bincount(rows, v, count) for v in values.T], axis=1)


def _facing(area: np.ndarray) -> np.ndarray:
    """[face] which of the six directions along the axes an area vector [face, xyz] faces most, 0 to 5."""
    axis = np.abs(area).argmax(axis=1)
    return 2 * axis + (area[np.arange(len(area)), axis] > 0)


def _join_boundary(cell: np.ndarray, area: np.ndarray, center: np.ndarray, sides: np.ndarray) -> tuple[np.ndarray, ...]:
    """One boundary face per (coarse cell, side): (cell, area, center, side)."""
    if not len(cell):
        return cell.astype(np.int32), area, center, sides
    _, first, inverse = np.unique(cell.astype(np.int64) * 8 + sides, return_index=True, return_inverse=True)
    count = len(first)
    size = np.linalg.norm(area, axis=1)
    middle = (
        _sum(inverse, center * size[:, None], count) / np.maximum(np.bincount(inverse, size, count), 1e-300)[:, None]
    )
    return cell[first].astype(np.int32), _sum(inverse, area, count), middle, sides[first]


def join_in_cubes(mesh: Mesh, edge: float) -> tuple[Mesh, np.ndarray]:
    """Join all connected cells smaller than `edge` (m) that lie in one cube of that edge: (coarse mesh, parent [cell]).

    Cells on two sides of a thin body stay apart, for they share no face.
    """
    low = mesh.far_center.min(axis=0) if len(mesh.far_center) else mesh.cell_center.min(axis=0)
    cube = np.floor((mesh.cell_center - low) / edge + 1e-9).astype(np.int64)
    cube -= cube.min(axis=0)
    small = mesh.cell_size < 0.75 * edge
    key = (cube[:, 0] * (cube[:, 1].max() + 1) + cube[:, 1]) * (cube[:, 2].max() + 1) + cube[:, 2]
    key = np.where(small, key, -1 - np.arange(mesh.cells))
    a, b = mesh.face_cells.astype(np.int64).T
    same = key[a] == key[b]
    graph = sparse.coo_matrix((np.ones(same.sum(), dtype=np.int8), (a[same], b[same])), shape=(mesh.cells, mesh.cells))
    count, parent = connected_components(graph, directed=False)
    parent = parent.astype(np.int64)

    volume = np.bincount(parent, mesh.cell_volume, count)
    center = _sum(parent, mesh.cell_center * mesh.cell_volume[:, None], count) / volume[:, None]
    pa, pb = parent[a], parent[b]
    across = pa != pb
    flip = (pa > pb)[across]
    pair = np.sort(np.stack([pa, pb], axis=1)[across], axis=1)
    area = np.where(flip[:, None], -1.0, 1.0) * mesh.face_area[across]
    _, first, inverse = np.unique(pair[:, 0] * count + pair[:, 1], return_index=True, return_inverse=True)
    size = np.linalg.norm(area, axis=1)
    face_center = _sum(inverse, mesh.face_center[across] * size[:, None], len(first))
    face_center /= np.maximum(np.bincount(inverse, size, len(first)), 1e-300)[:, None]
    side = np.where(mesh.body_wall, _BODY, _facing(mesh.wall_area))
    wall = _join_boundary(parent[mesh.wall_cell], mesh.wall_area, mesh.wall_center, side)
    far = _join_boundary(parent[mesh.far_cell], mesh.far_area, mesh.far_center, _facing(mesh.far_area))
    empty = np.zeros((0, 3))
    coarse = Mesh(
        cell_volume=volume,
        cell_center=center,
        cell_size=np.maximum(np.cbrt(volume), edge * 0.75),
        face_cells=pair[first].astype(np.int32),
        face_area=_sum(inverse, area, len(first)),
        face_center=face_center,
        wall_cell=wall[0],
        wall_area=wall[1],
        wall_center=wall[2],
        far_cell=far[0],
        far_area=far[1],
        far_center=far[2],
        piece_wall=np.zeros(0, np.int32),
        piece_area=empty,
        piece_center=empty,
        piece_part=np.zeros(0, np.int32),
        part_names=mesh.part_names,
        wall_symmetry=wall[3] != _BODY,
    )
    return coarse, parent


def sequence(mesh: Mesh, levels: int, fewest: int = 500) -> Sequence:
    """The mesh and up to `levels` coarser ones, none below `fewest` cells."""
    meshes, parents = [mesh], []
    edge = 2.0 * float(np.quantile(mesh.cell_size, 0.02))
    while len(parents) < levels and meshes[-1].cells > fewest:
        if mesh.cell_cube_center is not None:
            coarse, parent = octree.coarsen(meshes[-1])
        else:
            coarse, parent = join_in_cubes(meshes[-1], edge)
            edge *= 2.0
        if coarse.cells < fewest or edge > 8.0 * float(mesh.cell_size.max()):
            break
        if coarse.cells < 0.8 * meshes[-1].cells:
            meshes.append(coarse)
            parents.append(parent)
        elif mesh.cell_cube_center is not None:
            break
    return Sequence(tuple(meshes), tuple(parents))
