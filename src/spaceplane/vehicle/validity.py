"""The gate every surface passes: closed, oriented, one piece, no handles, positive volume, no overlap."""

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
    """Refuse a surface that is not one closed body of genus 0 with its normals outwards, free of overlaps.

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
    folded = overlaps(surface)
    if len(folded):
        x, y, z = folded[0]
        raise GeometryError(f"{what}: surface overlaps itself near x = {x:.2f}, y = {y:.2f}, z = {z:.2f} m")


def overlaps(surface: Surface, spacing: float = 0.2) -> np.ndarray:
    """Places where a closed surface overlaps itself, found by rays along the three axes.

    A ray through a sound body goes in, out, in, out; where it goes in twice, two parts overlap or a skin is folded.
    Rays that graze an edge (entries and exits not equal in number) are left out.

    Args:
        surface: closed, oriented.
        spacing: between rays, m.

    Returns:
        [place, xyz] second entries, m; empty if none.
    """
    found = [_overlaps_along(surface, axis, spacing) for axis in range(3)]
    return np.concatenate(found)


def _overlaps_along(surface: Surface, axis: int, spacing: float) -> np.ndarray:
    u, v = [k for k in range(3) if k != axis]
    origin = surface.bounds[0] - np.sqrt(2) * 0.01  # an offset no section line is likely to share
    corners = (surface.corners - origin) / spacing
    one, two, three = (corners[:, k][:, [u, v]] for k in range(3))
    low = np.ceil(np.minimum(np.minimum(one, two), three)).astype(np.int64)
    count = np.maximum(np.floor(np.maximum(np.maximum(one, two), three)).astype(np.int64) - low + 1, 0)
    total = count[:, 0] * count[:, 1]
    triangle = np.repeat(np.arange(len(total)), total)
    within = np.arange(len(triangle)) - np.repeat(np.cumsum(total) - total, total)
    i = low[triangle, 0] + within // count[triangle, 1]
    j = low[triangle, 1] + within % count[triangle, 1]
    a, b, c = (corners[triangle, k] for k in range(3))
    weights = np.stack(
        [(q[:, u] - i) * (r[:, v] - j) - (q[:, v] - j) * (r[:, u] - i) for q, r in ((b, c), (c, a), (a, b))]
    )
    sign = np.sign(weights.sum(axis=0))
    hit = (weights * sign > 0).all(axis=0)
    weights, sign, i, j = weights[:, hit], sign[hit], i[hit], j[hit]
    heights = np.stack([a[hit, axis], b[hit, axis], c[hit, axis]])
    height = (weights * heights).sum(axis=0) / weights.sum(axis=0)
    order = np.lexsort((height, j, i))
    ray = (i * (j.max(initial=0) + 1) + j)[order]
    # Which way the signed area points decides whether a ray that runs up the axis leaves or enters.
    enters = -sign[order] * (1 if axis != 1 else -1)
    start = np.flatnonzero(np.r_[True, ray[1:] != ray[:-1]]) if len(ray) else np.zeros(0, dtype=int)
    depth = np.cumsum(enters)
    before = np.repeat(depth[start] - enters[start], np.diff(np.r_[start, len(ray)]))
    depth = depth - before
    last = np.r_[start[1:], len(ray)] - 1
    balanced = np.repeat(depth[last] == 0, np.diff(np.r_[start, len(ray)])) if len(ray) else np.zeros(0, dtype=bool)
    bad = balanced & ((depth > 1) | (depth < 0))
    place = np.empty((int(bad.sum()), 3))
    place[:, axis], place[:, u], place[:, v] = height[order][bad], i[order][bad], j[order][bad]
    return place * spacing + origin
