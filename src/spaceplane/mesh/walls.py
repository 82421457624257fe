"""Finer cells at chosen parts and at edges; at the other walls octree levels are joined again.

The whole surface is cut at the finest level. Where the wall may be coarser, the pieces of a larger cube that air
connects become one control volume, so that the coarser wall is as exact as the finer one.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from spaceplane.errors import InputError
from spaceplane.mesh.assembly import Assembly
from spaceplane.mesh.cutcells import CutCells
from spaceplane.mesh.octree import Window
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.surface import Surface

# Length of the summed area vectors over the summed areas of the wall in a cube: cos(50 deg / 2).
STRAIGHT = 0.906


def fine_parts(names: tuple[str, ...], settings: MeshSettings) -> np.ndarray:
    """[part] whether the part's wall gets the finer cells.

    Raises:
        InputError: a name of `settings.fine_parts` that no part has.
    """
    fine = np.zeros(len(names), bool)
    for wanted in settings.fine_parts:
        found = [n for n, name in enumerate(names) if name == wanted or name.startswith(wanted + "_")]
        if not found:
            raise InputError(f"fine_parts: unknown part {wanted!r}, the body has {', '.join(names)}")
        fine[found] = True
    return fine


def fine_walls(
    window: Window, level: int, cut: CutCells, shift: np.ndarray, surface: Surface, settings: MeshSettings
) -> Window:
    """The cells of `window`, those of `level` with walls in them, that keep this size; all where walls are not graded.

    Args:
        shift: [xyz] cell of the domain that the window of `cut` begins with.
    """
    if not settings.graded_wall:
        return window
    place = (cut.cell[cut.polygon_volume] + shift) >> (level + 1)
    shape = (window.origin + window.array.shape - window.origin // 2 * 2) // 2 + 1
    cube = np.ravel_multi_index(tuple((place - window.origin // 2).T), shape)
    count = int(np.prod(shape))
    chosen = np.zeros(count, bool)
    chosen[cube[fine_parts(surface.part_names, settings)[surface.part[cut.polygon_triangle]]]] = True
    if settings.fine_edges:
        total = np.bincount(cube, cut.polygon_size, minlength=count)
        net = np.stack([np.bincount(cube, a, minlength=count) for a in cut.polygon_area.T], axis=1)
        chosen |= np.linalg.norm(net, axis=1) < STRAIGHT * total
    chosen = chosen.reshape(shape).repeat(2, axis=0).repeat(2, axis=1).repeat(2, axis=2)
    start = window.origin - window.origin // 2 * 2
    inside = tuple(slice(s, s + n) for s, n in zip(start, window.array.shape, strict=True))
    return Window(window.origin, window.array & chosen[inside])


def join_coarse_walls(a: Assembly, blocks: list[Window]) -> np.ndarray:
    """Join what air connects within each of the given cubes; their cells get that cube and its size.

    Args:
        a: cells and faces; `size` and `cube` are changed in place.
        blocks: [level] disjoint cubes of that level.

    Returns:
        [cell] the cell that stands for each joined group.
    """
    n = len(a.volume)
    group = np.full(n, -1, np.int64)
    first = 0
    for level, cubes in enumerate(blocks):
        if level == 0 or not cubes.array.any():
            continue
        edge = 2**level
        place = np.floor(a.cube / edge).astype(np.int64) - cubes.origin
        inside = (a.size < edge) & (group < 0) & (place >= 0).all(axis=1) & (place < cubes.array.shape).all(axis=1)
        inside[inside] = cubes.array[tuple(place[inside].T)]
        group[inside] = first + np.ravel_multi_index(tuple(place[inside].T), cubes.array.shape)
        first += cubes.array.size
        a.size[inside] = edge
        a.cube[inside] = edge * (place[inside] + cubes.origin + 0.5)
    if first == 0:
        return np.arange(n)
    same = (group[a.faces[:, 0]] >= 0) & (group[a.faces[:, 0]] == group[a.faces[:, 1]])
    ends = a.faces[same]
    graph = coo_matrix((np.ones(len(ends), np.int8), (ends[:, 0], ends[:, 1])), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    _, root = np.unique(label, return_index=True)
    return root[label]


def wall_sizes(places: np.ndarray, blocks: list[Window]) -> np.ndarray:
    """[n] edge, in finest cells, of the cubes of wall that hold the finest cells `places` [n, ijk]."""
    size = np.ones(len(places), np.int64)
    for level, cubes in enumerate(blocks):
        if level:
            size[cubes.at(places >> level) > 0] = 2**level
    return size
