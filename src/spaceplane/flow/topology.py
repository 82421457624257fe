"""A mesh as the kernels want it: cells along a space-filling curve, faces by thread chunk, coefficients of
gradients."""

from __future__ import annotations

from typing import NamedTuple, TypeVar

import numpy as np
from scipy import sparse

from spaceplane.flow.symmetry import mirror_cells
from spaceplane.mesh.mesh import Mesh

CELLS_PER_CHUNK = 16384
CELLS_PER_BLOCK = 2048
LEAST_SHARE = 0.25


class Topology(NamedTuple):
    """Arrays of the kernels; real arrays in the working precision, indices int32.

    Cells are renumbered along a Morton curve: `order[new] = old`. Every cell has a list of entries, one per interior
    face, `start[cell]:start[cell + 1]`: the neighbour `other`, unit normal `normal` out of the cell, area `area`;
    those before `split[cell]` lead to cells that a forward sweep visits earlier.
    `stencil_*` is the list of the gradient's neighbours with the coefficients of the least-squares gradient.
    Faces of a chunk (a run of cells owned by one thread) are `chunk_faces[chunk_start[k]:chunk_start[k + 1]]`; a face
    between two
    chunks stands in both lists and each chunk adds its own side, so that threads never write to the same cell.
    `face_swirl`, `boundary_swirl` are the moments of a face's area about the origin on its area: what a rotation sees.
    `boundary` rows are walls first (`walls` of them), then far field; `edge_start` lists them by cell.
    Blocks of cells are coloured so that blocks of one colour do not touch: `color_start`, `color_blocks`.
    `mirror` is the mirror image of each cell in y = 0; empty when the mesh does not mirror itself.
    """

    order: np.ndarray
    volume: np.ndarray
    size: np.ndarray
    start: np.ndarray
    split: np.ndarray
    other: np.ndarray
    normal: np.ndarray
    area: np.ndarray
    reach: np.ndarray
    stencil_start: np.ndarray
    stencil_other: np.ndarray
    stencil_weight: np.ndarray
    face_cells: np.ndarray
    face_normal: np.ndarray
    face_area: np.ndarray
    face_reach: np.ndarray
    face_swirl: np.ndarray
    chunk_cells: np.ndarray
    chunk_start: np.ndarray
    chunk_faces: np.ndarray
    walls: int
    edge_start: np.ndarray
    edge_row: np.ndarray
    boundary_cell: np.ndarray
    boundary_normal: np.ndarray
    boundary_area: np.ndarray
    boundary_reach: np.ndarray
    boundary_swirl: np.ndarray
    block_cells: np.ndarray
    color_start: np.ndarray
    color_blocks: np.ndarray
    mirror: np.ndarray

    def part(self, kind: type[Part]) -> Part:
        """What a kernel needs, see `Chunks` and the others."""
        return kind(*(getattr(self, name) for name in kind._fields))


# Every array that a kernel is given costs a tenth of a second when it is compiled: each gets its own only.


class Chunks(NamedTuple):
    """Of `Topology`, for work that looks at no neighbours."""

    chunk_cells: np.ndarray
    volume: np.ndarray


class Stencils(NamedTuple):
    """Of `Topology`, for the gradients."""

    chunk_cells: np.ndarray
    size: np.ndarray
    start: np.ndarray
    reach: np.ndarray
    stencil_start: np.ndarray
    stencil_other: np.ndarray
    stencil_weight: np.ndarray


class Faces(NamedTuple):
    """Of `Topology`, for the fluxes."""

    volume: np.ndarray
    face_cells: np.ndarray
    face_normal: np.ndarray
    face_area: np.ndarray
    face_reach: np.ndarray
    face_swirl: np.ndarray
    chunk_cells: np.ndarray
    chunk_start: np.ndarray
    chunk_faces: np.ndarray
    walls: int
    edge_start: np.ndarray
    edge_row: np.ndarray
    boundary_normal: np.ndarray
    boundary_area: np.ndarray
    boundary_reach: np.ndarray
    boundary_swirl: np.ndarray


class Walls(NamedTuple):
    """Of `Topology`, for the pressure on walls."""

    walls: int
    boundary_cell: np.ndarray
    boundary_normal: np.ndarray
    boundary_reach: np.ndarray


class Blocks(NamedTuple):
    """Of `Topology`, for the diagonal blocks."""

    chunk_cells: np.ndarray
    start: np.ndarray
    other: np.ndarray
    normal: np.ndarray
    area: np.ndarray
    walls: int
    edge_start: np.ndarray
    edge_row: np.ndarray
    boundary_normal: np.ndarray
    boundary_area: np.ndarray


class Sweeps(NamedTuple):
    """Of `Topology`, for the Gauss-Seidel sweeps."""

    start: np.ndarray
    split: np.ndarray
    other: np.ndarray
    normal: np.ndarray
    area: np.ndarray
    block_cells: np.ndarray
    color_start: np.ndarray
    color_blocks: np.ndarray


Part = TypeVar("Part", Chunks, Stencils, Faces, Walls, Blocks, Sweeps)


def morton_order(points: np.ndarray, spacing: float) -> np.ndarray:
    """[cell] order of the cells along a Morton curve with cubes of edge `spacing` (m)."""
    low = points.min(axis=0)
    cube = np.minimum((points - low) / spacing, 2**20 - 1).astype(np.uint64)
    key = np.zeros(len(points), dtype=np.uint64)
    for axis in range(3):
        x = cube[:, axis]
        for shift, mask in (
            (32, 0x1F00000000FFFF),
            (16, 0x1F0000FF0000FF),
            (8, 0x100F00F00F00F00F),
            (4, 0x10C30C30C30C30C3),
            (2, 0x1249249249249249),
        ):
            x = (x | (x << np.uint64(shift))) & np.uint64(mask)
        key |= x << np.uint64(2 - axis)
    return np.argsort(key, kind="stable")


def starts(keys: np.ndarray, groups: int) -> np.ndarray:
    """[groups + 1] where each group begins, of rows sorted by key."""
    return np.concatenate([[0], np.cumsum(np.bincount(keys, minlength=groups))])


def group(keys: np.ndarray, groups: int) -> tuple[np.ndarray, np.ndarray]:
    """(start [groups + 1], rows): rows sorted by key, stable."""
    return starts(keys, groups), np.argsort(keys, kind="stable")


def least_squares(
    center: np.ndarray, own: np.ndarray, start: np.ndarray, other: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients [entry, xyz] of the gradients in the cells `own` [row] and the reciprocal condition number [row] of
    their matrices.

    Weights 1/distance^2 in the normal equations. Directions that the neighbours do not span get no gradient.
    """
    rows = len(own)
    row = np.repeat(np.arange(rows), np.diff(start))
    d = center[other] - center[own][row]
    weight = 1.0 / np.einsum("ij,ij->i", d, d)
    matrix = np.empty((rows, 3, 3))
    for a in range(3):
        for b in range(a, 3):
            matrix[:, a, b] = matrix[:, b, a] = np.bincount(row, d[:, a] * d[:, b] * weight, rows)
    values, vectors = np.linalg.eigh(matrix)
    largest = np.maximum(values[:, 2], 1e-300)
    quality = np.maximum(values[:, 0], 0.0) / largest
    kept = values > 0.02 * largest[:, None]
    inverse = np.where(kept, 1.0 / np.where(kept, values, 1.0), 0.0)
    pseudo = np.einsum("cik,ck,cjk->cij", vectors, inverse, vectors)
    return np.einsum("eij,ej->ei", pseudo[row], d * weight[:, None]), quality


def gradient_stencil(
    center: np.ndarray, start: np.ndarray, other: np.ndarray, few: np.ndarray
) -> tuple[np.ndarray, ...]:
    """(start, other, coefficients): face neighbours; where they are `few` [cell] or span space badly, theirs too."""
    weight, quality = least_squares(center, np.arange(len(center)), start, other)
    poor = np.flatnonzero((quality < 0.1) | few)
    if not len(poor):
        return start, other, weight
    cells = len(center)
    graph = sparse.csr_matrix((np.ones(len(other), dtype=np.int8), other, start), shape=(cells, cells))
    wide = (graph[poor] @ graph + graph[poor]).tocoo()
    keep = wide.col != poor[wide.row]
    own, far = wide.row[keep], wide.col[keep]  # by row, as `wide` was compressed by row
    far_weight, _ = least_squares(center, poor, starts(own, len(poor)), far)
    row = np.repeat(np.arange(cells), np.diff(start))
    plain = ~np.isin(row, poor)
    rows = np.concatenate([row[plain], poor[own]])
    cols = np.concatenate([other[plain], far])
    order = np.lexsort((cols, rows))
    return starts(rows, cells), cols[order], np.concatenate([weight[plain], far_weight])[order]


def few_faces(mesh: Mesh) -> np.ndarray:
    """[cell] whether an imported element has fewer than six faces, on meshes with more than `LEAST_SHARE` of these.

    None on octrees, whose cut cells do well with few, nor on hexahedra of which some are collapsed at an apex: wide
    stencils of those alone keep the flow from coming to rest.

    Slopes from the neighbours of tetrahedra, prisms and pyramids alone never come to rest: F. Haider, J.-P. Croisille,
    B. Courbet, "Stability analysis of the cell centered finite-volume MUSCL method on unstructured grids", Numer. Math.
    113 (2009) 555-600, ask for a wider stencil.
    """
    if mesh.cell_cube_center is not None:
        return np.zeros(mesh.cells, dtype=bool)
    ends = np.concatenate([mesh.face_cells.ravel(), mesh.wall_cell, mesh.far_cell])
    few = np.bincount(ends, minlength=mesh.cells) < 6
    return few & (few.mean() > LEAST_SHARE)


def color_blocks(cells: int, face_cells: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Blocks of consecutive cells, coloured greedily so that neighbours differ: (block_cells, color_start, blocks)."""
    count = max(1, round(cells / CELLS_PER_BLOCK))
    bounds = np.linspace(0, cells, count + 1).astype(np.int64)
    block = np.repeat(np.arange(count), np.diff(bounds))
    a, b = block[face_cells[:, 0]], block[face_cells[:, 1]]
    across = a != b
    a, b = a[across], b[across]
    graph = sparse.csr_matrix((np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])), shape=(count, count))
    color = np.full(count, -1)
    for k in range(count):
        taken = set(color[graph.indices[graph.indptr[k] : graph.indptr[k + 1]]].tolist())
        color[k] = next(c for c in range(count + 1) if c not in taken)
    start, blocks = group(color, int(color.max()) + 1)
    return bounds, start, blocks


def _unit(area: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    size = np.linalg.norm(area, axis=1)
    normal = np.where(size[:, None] > 0, area / np.where(size, size, 1.0)[:, None], [1.0, 0.0, 0.0])
    return normal, size


def wall_swirl(mesh: Mesh) -> np.ndarray:
    """[wall, xyz] moment of the area of each wall face about the origin: of its pieces, as a wall face need not be
    plane."""
    moment = np.cross(mesh.piece_center, mesh.piece_area)
    walls = len(mesh.wall_cell)
    swirl = np.stack([np.bincount(mesh.piece_wall, moment[:, k], walls) for k in range(3)], axis=1)
    bare = np.bincount(mesh.piece_wall, minlength=walls) == 0
    swirl[bare] = np.cross(mesh.wall_center[bare], mesh.wall_area[bare])
    return swirl


def prepare(mesh: Mesh, dtype: type) -> Topology:
    """Build the kernels' view of `mesh` in precision `dtype`."""
    cells = mesh.cells
    order = morton_order(mesh.cell_center, float(mesh.cell_size.min()))
    place = np.empty(cells, dtype=np.int64)
    place[order] = np.arange(cells)
    center = mesh.cell_center[order]

    pair = place[mesh.face_cells]
    flip = pair[:, 0] > pair[:, 1]
    sign = np.where(flip, -1.0, 1.0)
    pair = np.sort(pair, axis=1)
    rank = np.lexsort((pair[:, 1], pair[:, 0]))
    pair = pair[rank]
    normal, area = _unit((mesh.face_area * sign[:, None])[rank])
    face_center = mesh.face_center[rank]
    reach = np.concatenate([face_center - center[pair[:, 0]], face_center - center[pair[:, 1]]], axis=1)

    faces = len(pair)
    block_cells, color_start, blocks = color_blocks(cells, pair)
    visited = np.empty(cells, dtype=np.int64)
    visited[np.concatenate([np.arange(block_cells[b], block_cells[b + 1]) for b in blocks])] = np.arange(cells)
    own, opposite = np.r_[pair[:, 0], pair[:, 1]], np.r_[pair[:, 1], pair[:, 0]]
    later = visited[opposite] > visited[own]
    start, rows = group(2 * own + later, 2 * cells)
    start, split = start[::2], start[1::2]
    other = opposite[rows]
    entry_normal = np.concatenate([normal, -normal])[rows]
    entry_area = np.r_[area, area][rows]
    entry_reach = np.concatenate([reach[:, :3], reach[:, 3:]])[rows]
    stencil_start, stencil_other, weight = gradient_stencil(center, start, other, few_faces(mesh)[order])

    chunks = max(1, round(cells / CELLS_PER_CHUNK))
    chunk_cells = np.linspace(0, cells, chunks + 1).astype(np.int64)
    chunk = np.repeat(np.arange(chunks), np.diff(chunk_cells))
    first, second = chunk[pair[:, 0]], chunk[pair[:, 1]]
    cross = np.flatnonzero(first != second)
    listed = np.r_[np.arange(faces), cross]
    chunk_start, listed_rows = group(np.r_[first, second[cross]], chunks)

    edge_cell = place[np.r_[mesh.wall_cell, mesh.far_cell].astype(np.int64)]
    edge_normal, edge_area = _unit(np.concatenate([mesh.wall_area, mesh.far_area]))
    edge_reach = np.concatenate([mesh.wall_center, mesh.far_center]) - center[edge_cell]
    edge_swirl = np.concatenate([wall_swirl(mesh), np.cross(mesh.far_center, mesh.far_area)])
    edge_start, edge_row = group(edge_cell, cells)

    def real(x: np.ndarray) -> np.ndarray:
        return np.ascontiguousarray(x, dtype=dtype)

    def index(x: np.ndarray) -> np.ndarray:
        return np.ascontiguousarray(x, dtype=np.int32)

    return Topology(
        order=index(order),
        volume=real(mesh.cell_volume[order]),
        size=real(np.cbrt(mesh.cell_volume[order])),
        start=index(start),
        split=index(split),
        other=index(other),
        normal=real(entry_normal),
        area=real(entry_area),
        reach=real(entry_reach),
        stencil_start=index(stencil_start),
        stencil_other=index(stencil_other),
        stencil_weight=real(weight),
        face_cells=index(pair),
        face_normal=real(normal),
        face_area=real(area),
        face_reach=real(reach),
        face_swirl=real(np.cross(face_center, normal)),
        chunk_cells=index(chunk_cells),
        chunk_start=index(chunk_start),
        chunk_faces=index(listed[listed_rows]),
        walls=len(mesh.wall_cell),
        edge_start=index(edge_start),
        edge_row=index(edge_row),
        boundary_cell=index(edge_cell),
        boundary_normal=real(edge_normal),
        boundary_area=real(edge_area),
        boundary_reach=real(edge_reach),
        boundary_swirl=real(edge_swirl / np.where(edge_area > 0.0, edge_area, 1.0)[:, None]),
        block_cells=index(block_cells),
        color_start=index(color_start),
        color_blocks=index(blocks),
        mirror=index(mirror_cells(mesh.cell_center[order], mesh.cell_volume[order])),
    )
