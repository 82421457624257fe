"""The gate every surface passes: closed, oriented, one piece, no handles, positive volume."""

from __future__ import annotations

import numpy as np

from spaceplane.errors import InputError
from spaceplane.vehicle.surface import Surface


class GeometryError(InputError):
    """A combination of parameters that gives no valid body; the message says which check failed."""


def edge_faults(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges that keep a triangulation from being a closed, consistently oriented surface.

    Args:
        triangles: [triangle, 3] vertex indices.

    Returns:
        unpaired: [edge, 2] directed edges without their opposite (holes, or neighbours turned the other way).
        repeated: [edge, 2] directed edges used more than once (fins, or neighbours turned the other way).
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    size = int(triangles.max()) + 1 if len(triangles) else 1
    key, back = edges[:, 0] * size + edges[:, 1], edges[:, 1] * size + edges[:, 0]
    ordered = np.sort(key)
    if np.array_equal(ordered, np.sort(back)) and not (ordered[1:] == ordered[:-1]).any():
        return edges[:0], edges[:0]
    unique, index, count = np.unique(key, return_index=True, return_counts=True)
    unpaired = edges[index[~np.isin(unique, back, kind="sort")]]
    return unpaired, edges[index[count > 1]]


def component_count(surface: Surface) -> int:
    """Number of separate pieces."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    t, n = surface.triangles, len(surface.points)
    rows, columns = np.concatenate([t[:, 0], t[:, 1]]), np.concatenate([t[:, 1], t[:, 2]])
    labels = connected_components(coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(n, n)), directed=False)[1]
    return len(np.unique(labels[t[:, 0]]))


def genus(surface: Surface) -> int:
    """Number of handles of a closed one-piece surface, from Euler's formula V - E + F = 2 - 2 g."""
    vertices = int(np.count_nonzero(np.bincount(surface.triangles.ravel())))
    faces = len(surface.triangles)
    return 1 - (vertices - faces // 2) // 2


def check(surface: Surface, what: str) -> None:
    """Refuse a surface that is not one closed body of genus 0 with its normals outwards.

    Raises:
        GeometryError: naming the failed check and `what` was built.
    """
    unpaired, repeated = edge_faults(surface.triangles)
    if len(unpaired) or len(repeated):
        raise GeometryError(f"{what}: surface not closed ({len(unpaired)} open and {len(repeated)} repeated edges)")
    if not np.isfinite(surface.points).all():
        raise GeometryError(f"{what}: surface has points that are not finite")
    pieces = component_count(surface)
    if pieces != 1:
        raise GeometryError(f"{what}: surface falls into {pieces} pieces")
    if genus(surface) != 0:
        raise GeometryError(f"{what}: surface has {genus(surface)} handles, must have none")
    if surface.volume <= 0:
        raise GeometryError(f"{what}: enclosed volume {surface.volume:g} m3, must be positive")
