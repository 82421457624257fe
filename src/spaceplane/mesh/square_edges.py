"""Cells at the square edges of thin walls: the blunt leading and trailing edges and the tips of a plate.

In front of a square edge the flow stands still and round it expands, over lengths of the order of its height. Cells of
that size or larger see a plate without thickness, and its lift comes out too large.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial import cKDTree

from spaceplane.mesh.sizing import Sizing
from spaceplane.mesh.thickness import Thickness
from spaceplane.vehicle.surface import Surface

SHARP = math.radians(50.0)
"""Turn of the wall from which on an edge counts, as for `MeshSettings.fine_edges`."""
NEAR = 1.5
"""Spacings of the grid lines, beyond its thickness, within which a wall belongs to an edge: lines along the rim miss
it by up to one spacing in each direction."""
BESIDE = 0.5
"""How far round an edge, in each direction, in cells wanted there, cells are asked for."""
CORNERS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


def cells_at_square_edges(surface: Surface, walls: Thickness, cells: float, smallest: float, largest: float) -> Sizing:
    """Cells of which the body is at least `cells` thick, along the convex edges of thin walls and all around them.

    Args:
        surface: the body.
        walls: its thickness where it is thin.
        cells: across the thickness.
        smallest: no smaller cells are asked for, m.
        largest: nothing is asked for where larger cells will do, m.
    """
    thin = walls.thickness < cells * largest
    points = _along_edges(surface, 0.5 * smallest)
    if not thin.any() or not len(points):
        return Sizing(np.zeros((0, 3)), np.zeros(0))
    middle, thickness = walls.point[thin].copy(), walls.thickness[thin]
    middle[np.arange(len(middle)), walls.axis[thin]] += 0.5 * thickness
    distance, nearest = cKDTree(middle).query(points)
    wanted = np.maximum(thickness[nearest] / cells, smallest)
    kept = (distance < NEAR * walls.spacing + thickness[nearest]) & (wanted < largest)
    # Air beside an edge that lies close to a plane of the grid is in the next cell.
    reach = BESIDE * wanted[kept, None]
    around = points[kept] + reach * CORNERS[:, None]
    return Sizing(around.reshape(-1, 3), np.tile(wanted[kept], len(CORNERS)))


def _along_edges(surface: Surface, step: float) -> np.ndarray:
    """[point, xyz] points no further apart than `step`, m, along the sharp convex edges of a surface."""
    start, end = surface.points[_sharp_edges(surface)].swapaxes(0, 1)
    pieces = np.maximum(np.ceil(np.linalg.norm(end - start, axis=1) / step).astype(int), 1)
    edge = np.repeat(np.arange(len(pieces)), pieces + 1)
    first = np.cumsum(pieces + 1) - (pieces + 1)
    share = (np.arange(len(edge)) - first[edge]) / pieces[edge]
    return start[edge] + share[:, None] * (end - start)[edge]


def _sharp_edges(surface: Surface) -> np.ndarray:
    """[edge, 2] vertices of the edges, shared by two triangles, round which the wall turns outwards by `SHARP`."""
    triangles = surface.triangles
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    face, apex = np.repeat(np.arange(len(triangles)), 3), triangles[:, [2, 0, 1]].ravel()
    edges, which, shared = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    pair = np.argsort(which.ravel(), kind="stable")
    pair = pair[(shared == 2)[which.ravel()[pair]]].reshape(-1, 2)
    normal = surface.area_vectors / np.maximum(np.linalg.norm(surface.area_vectors, axis=1), 1e-300)[:, None]
    one, other = normal[face[pair]].swapaxes(0, 1)
    turn = np.arccos(np.clip((one * other).sum(axis=1), -1.0, 1.0))
    across = surface.points[apex[pair[:, 1]]] - surface.points[apex[pair[:, 0]]]
    return edges[shared == 2][(turn > SHARP) & ((across * one).sum(axis=1) < 0.0)]
