"""From cut cells and octree leaves to one mesh: a common numbering, mirror image, merging, pieces of wall."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from spaceplane.mesh.agglomerate import combine_faces, merge_small, morton_order, outward_sums
from spaceplane.mesh.cutcells import CutCells
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.octree import Leaves


@dataclass
class Assembly:
    """Cells, faces and surface polygons in wall cells, counted from the corner of the domain.

    Attributes:
        volume: [cell]; first the control volumes of cut cells, then leaves.
        center: [cell, xyz] centroid.
        size: [cell] edge of the cube.
        cube: [cell, xyz] centre of the cube.
        faces, face_area, face_center: interior faces, vectors from the first to the second cell.
        far_cell, far_area, far_center: far-field faces, vectors out of the domain.
        mirror_cell, mirror_area, mirror_center: faces on the plane of symmetry, vectors out of the right half.
        polygon_cell, polygon_part, polygon_upstream: cell, part and orientation of each piece of surface.
        polygon_area, polygon_size, polygon_center: area vector out of the fluid, area, centroid.
    """

    volume: np.ndarray
    center: np.ndarray
    size: np.ndarray
    cube: np.ndarray
    faces: np.ndarray
    face_area: np.ndarray
    face_center: np.ndarray
    far_cell: np.ndarray
    far_area: np.ndarray
    far_center: np.ndarray
    mirror_cell: np.ndarray
    mirror_area: np.ndarray
    mirror_center: np.ndarray
    polygon_cell: np.ndarray
    polygon_part: np.ndarray
    polygon_upstream: np.ndarray
    polygon_area: np.ndarray
    polygon_size: np.ndarray
    polygon_center: np.ndarray


def _vectors(axis: np.ndarray, size: np.ndarray) -> np.ndarray:
    """[face, xyz] vectors of the given size along the axes."""
    vectors = np.zeros((len(axis), 3))
    vectors[np.arange(len(axis)), axis] = size
    return vectors


def _leaf_faces(leaves: Leaves, leaf: np.ndarray, axis: np.ndarray, side: np.ndarray):
    """Area and centre of the given side of each leaf."""
    edge = (1 << leaves.level[leaf].astype(np.int64)).astype(np.float64)
    center = (leaves.place[leaf] + 0.5) * edge[:, None]
    center[np.arange(len(leaf)), axis] += (side - 0.5) * edge
    return edge**2, center


def assemble(
    cut: CutCells, leaves: Leaves, shift: np.ndarray, part: np.ndarray, upstream: np.ndarray, half: bool
) -> Assembly:
    """Number control volumes and leaves together and list all faces.

    Args:
        cut: cut cells in a window whose cell [0, 0, 0] is cell `shift` of the domain.
        leaves: uncut cells of the domain.
        part: [triangle] part of the surface; upstream: [triangle] whether its outward normal has n_x < 0.
        half: whether the domain's face y = 0 is a plane of symmetry.

    Raises:
        RuntimeError: a fluid face of a cut cell has no cell beyond it (never seen; window and octree would not fit).
    """
    first = len(cut.volume)
    edge = (1 << leaves.level.astype(np.int64)).astype(np.float64)
    cube = np.concatenate([cut.cell + shift + 0.5, (leaves.place + 0.5) * edge[:, None]])
    center = cube.copy()
    center[:first] = cut.center + shift

    sides = cut.face_sides.astype(np.int64)
    mirror = np.zeros(len(sides), bool)
    for side in range(2):
        open_side = np.flatnonzero(sides[:, side] < 0)
        place = cut.face_corner[open_side] + shift
        if side == 0:
            place[np.arange(len(open_side)), cut.face_axis[open_side]] -= 1
        outside = (place[:, 1] < 0) & half
        place = place[~outside]
        leaf = leaves.index[0].at(place)
        for level in range(1, len(leaves.index)):  # beside a coarse wall
            missing = leaf < 0
            if not missing.any():
                break
            leaf[missing] = leaves.index[level].at(place[missing] >> level)
        if len(leaf) and leaf.min() < 0:
            raise RuntimeError("a fluid face of a cut cell has no cell beyond it")
        sides[open_side[~outside], side] = first + leaf
        mirror[open_side[outside]] = True
    vectors = _vectors(cut.face_axis, cut.face_area)
    centers = cut.face_center + shift

    leaf_area, leaf_center = _leaf_faces(leaves, leaves.face_fine, leaves.face_axis, leaves.face_side)
    far_size, far_center = _leaf_faces(leaves, leaves.far_leaf, leaves.far_axis, leaves.far_side)
    far_area = _vectors(leaves.far_axis, far_size * (2 * leaves.far_side - 1))
    far = ~((leaves.far_axis == 1) & (leaves.far_side == 0) & half)
    return Assembly(
        volume=np.concatenate([cut.volume, edge**3]),
        center=center,
        size=np.concatenate([np.ones(first), edge]),
        cube=cube,
        faces=np.concatenate([sides[~mirror], leaves.face_leaves + first]),
        face_area=np.concatenate([vectors[~mirror], _vectors(leaves.face_axis, leaf_area)]),
        face_center=np.concatenate([centers[~mirror], leaf_center]),
        far_cell=leaves.far_leaf[far] + first,
        far_area=far_area[far],
        far_center=far_center[far],
        mirror_cell=np.concatenate([sides[mirror, 1], leaves.far_leaf[~far] + first]),
        mirror_area=np.concatenate([-vectors[mirror], far_area[~far]]),
        mirror_center=np.concatenate([centers[mirror], far_center[~far]]),
        polygon_cell=cut.polygon_volume.astype(np.int64),
        polygon_part=part[cut.polygon_triangle],
        polygon_upstream=upstream[cut.polygon_triangle],
        polygon_area=cut.polygon_area,
        polygon_size=cut.polygon_size,
        polygon_center=cut.polygon_center + shift,
    )


def joined(a: Assembly, root: np.ndarray) -> Assembly:
    """Each cluster as one cell, which is as large as the one that stands for it; faces inside clusters are left out.

    Args:
        root: [cell] the cell that stands for each cluster.
    """
    stands = root == np.arange(len(root))
    if stands.all():
        return a
    number = (np.cumsum(stands) - 1)[root]
    count = int(stands.sum())
    volume = np.bincount(number, a.volume, minlength=count)
    center = np.stack([np.bincount(number, a.volume * x, minlength=count) for x in a.center.T], axis=1)
    center = _means(center, volume, a.center[stands])
    faces = number[a.faces]
    between = faces[:, 0] != faces[:, 1]
    return replace(
        a,
        volume=volume,
        center=center,
        size=a.size[stands],
        cube=a.cube[stands],
        faces=faces[between],
        face_area=a.face_area[between],
        face_center=a.face_center[between],
        far_cell=number[a.far_cell],
        mirror_cell=number[a.mirror_cell],
        **_pieces(a, number[a.polygon_cell], np.ones(len(a.polygon_cell), bool)),
    )


def mirror(half: Assembly, partner: np.ndarray) -> Assembly:
    """Add the mirror image in y = 0, which makes mirror faces interior. `partner` [part] is the other side's."""
    flip = np.array([1.0, -1.0, 1.0])
    n = len(half.volume)

    def both(a: np.ndarray) -> np.ndarray:
        return np.concatenate([a, a])

    def image(a: np.ndarray) -> np.ndarray:
        return np.concatenate([a, a * flip])

    across = np.stack([half.mirror_cell + n, half.mirror_cell], axis=1)
    return Assembly(
        volume=both(half.volume),
        center=image(half.center),
        size=both(half.size),
        cube=image(half.cube),
        faces=np.concatenate([half.faces, half.faces + n, across]),
        face_area=np.concatenate([half.face_area, half.face_area * flip, -half.mirror_area]),
        face_center=np.concatenate([half.face_center, half.face_center * flip, half.mirror_center]),
        far_cell=np.concatenate([half.far_cell, half.far_cell + n]),
        far_area=image(half.far_area),
        far_center=image(half.far_center),
        mirror_cell=half.mirror_cell[:0],
        mirror_area=half.mirror_area[:0],
        mirror_center=half.mirror_center[:0],
        polygon_cell=np.concatenate([half.polygon_cell, half.polygon_cell + n]),
        polygon_part=np.concatenate([half.polygon_part, partner[half.polygon_part]]),
        polygon_upstream=both(half.polygon_upstream),
        polygon_area=image(half.polygon_area),
        polygon_size=both(half.polygon_size),
        polygon_center=image(half.polygon_center),
    )


def join_small(a: Assembly, fraction: float, root: np.ndarray | None = None) -> np.ndarray:
    """[cell] the cell that stands for each cluster once volumes below `fraction` of their cube are merged.

    Args:
        root: clusters to start from, from an earlier call.
    """
    if root is None:
        root = np.arange(len(a.volume))
    volume = np.bincount(root, a.volume, minlength=len(root))
    volume[root != np.arange(len(root))] = np.inf
    ends = root[a.faces]
    return merge_small(volume, fraction * a.size**3, ends, np.abs(a.face_area).sum(axis=1))[root]


def reachable(a: Assembly, root: np.ndarray) -> np.ndarray:
    """[cell] whether air can flow from the far field to the cell."""
    n = len(root)
    ends = root[a.faces]
    graph = coo_matrix((np.ones(len(ends), np.int8), (ends[:, 0], ends[:, 1])), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    outside = np.zeros(label.max() + 1, bool)
    outside[label[root[a.far_cell]]] = True
    return outside[label][root]


def finish(
    a: Assembly, root: np.ndarray, kept: np.ndarray, cell: float, corner: np.ndarray, part_names: tuple
) -> tuple[Mesh, np.ndarray]:
    """Build the Mesh in metres: clusters become cells, ordered along a Morton curve.

    Args:
        root: [cell] representative of each cluster; kept: [cell] cells that stay.
        cell: wall cell, m. corner: [xyz] of the grid's integer origin, m.

    Returns:
        The mesh, and for each cell given the cell of the mesh that it became part of (-1: left out).
    """
    stands = np.flatnonzero((root == np.arange(len(root))) & kept)
    place = 2.0 * a.cube[stands]
    order = stands[morton_order((place - place.min(axis=0)).astype(np.int64))]
    number = np.full(len(root), -1, np.int64)
    number[order] = np.arange(len(order))
    number = number[root]
    n = len(order)

    inside = number >= 0
    index = number[inside]
    added = inside & (a.cube != a.cube[root]).any(axis=1)
    merged = np.unique(np.column_stack([number[added], a.cube[added], a.size[added]]), axis=0)
    volume = np.bincount(index, a.volume[inside], minlength=n)
    center = np.stack([np.bincount(index, a.volume[inside] * x, minlength=n) for x in a.center[inside].T], axis=1)
    center /= volume[:, None]
    faces, area, face_center = combine_faces(number[a.faces], a.face_area, a.face_center, n)
    far_cell = number[a.far_cell]
    wall = number[a.polygon_cell] >= 0
    walls = _walls(a, number[a.polygon_cell], wall)
    wall_cell = walls[0]
    total = outward_sums(n, faces, area, far_cell, a.far_area)
    mesh = Mesh(
        cell_volume=volume * cell**3,
        cell_center=corner + center * cell,
        cell_size=a.size[order] * cell,
        face_cells=faces,
        face_area=area * cell**2,
        face_center=corner + face_center * cell,
        wall_cell=wall_cell,
        wall_area=-total[wall_cell] * cell**2,
        wall_center=corner + walls[1] * cell,
        far_cell=far_cell.astype(np.int32),
        far_area=a.far_area * cell**2,
        far_center=corner + a.far_center * cell,
        piece_wall=walls[2],
        piece_area=walls[3] * cell**2,
        piece_center=corner + walls[4] * cell,
        piece_part=walls[5],
        part_names=part_names,
        cell_cube_center=corner + a.cube[order] * cell,
        wall_wetted=walls[6] * cell**2,
        merged_cubes=merged * np.repeat([1.0, cell], [1, 4]) + np.concatenate([[0.0], corner, [0.0]]),
    )
    return mesh, number


def _walls(a: Assembly, cell: np.ndarray, kept: np.ndarray):
    """Wall faces and their pieces from the surface polygons `kept` [polygon], which lie in these cells.

    Returns:
        wall cell, wall centre, piece wall, piece area vector, piece centre, piece part, wetted area of the wall.
    """
    pieces = _pieces(a, cell, kept)
    piece_cell, size, center = (pieces[f"polygon_{name}"] for name in ("cell", "size", "center"))
    new = _starts(piece_cell)
    wetted = np.add.reduceat(size, new)
    wall_center = _means(np.add.reduceat(center * size[:, None], new), wetted, center[new])
    piece_wall = np.repeat(np.arange(len(new)), np.diff(np.concatenate([new, [len(piece_cell)]])))
    return (
        piece_cell[new].astype(np.int32),
        wall_center,
        piece_wall.astype(np.int32),
        pieces["polygon_area"],
        center,
        pieces["polygon_part"].astype(np.int32),
        wetted,
    )


def _pieces(a: Assembly, cell: np.ndarray, kept: np.ndarray) -> dict[str, np.ndarray]:
    """Polygons `kept` [polygon] of one part and orientation in the same `cell` [polygon] as one, by field."""
    parts = int(a.polygon_part.max(initial=0)) + 1
    key = (cell[kept] * parts + a.polygon_part[kept]) * 2 + a.polygon_upstream[kept]
    order = np.argsort(key, kind="stable")
    key = key[order]
    first = _starts(key)
    size, center = a.polygon_size[kept][order], a.polygon_center[kept][order]
    total = np.add.reduceat(size, first)
    return {
        "polygon_cell": key[first] // (2 * parts),
        "polygon_part": (key[first] // 2) % parts,
        "polygon_upstream": key[first] % 2 == 1,
        "polygon_area": np.add.reduceat(a.polygon_area[kept][order], first),
        "polygon_size": total,
        "polygon_center": _means(np.add.reduceat(center * size[:, None], first), total, center[first]),
    }


def _starts(key: np.ndarray) -> np.ndarray:
    """Where runs of equal values begin."""
    return np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1]])) if len(key) else np.zeros(0, np.int64)


def _means(sums: np.ndarray, size: np.ndarray, instead: np.ndarray) -> np.ndarray:
    """[n, xyz] `sums` over `size` [n]; `instead` where there is no size."""
    sized = size > 1e-30
    return np.where(sized[:, None], sums / np.where(sized, size, 1.0)[:, None], instead)
