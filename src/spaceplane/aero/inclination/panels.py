"""Flat panels of a surface: its triangles, long ones cut, and which of them are blunt."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spaceplane.vehicle.surface import Surface

SHARPEST_FOLD = np.radians(60.0)
"""A greater angle between neighbouring triangles is an edge of the shape, not a facet of a curve."""
LEAST_HEIGHT = 1e-2
"""Triangles thinner than this fraction of their edge are slivers, whose normals say nothing."""


@dataclass(frozen=True)
class Panels:
    """Flat panels that carry one pressure each.

    Attributes:
        normal: [panel, xyz] outward unit normal; 0 for a triangle without area.
        area: [panel] m2.
        center: [panel, xyz] centroid, m.
        triangle: [panel] triangle of the surface that it is cut from; panels of one part follow each other.
        surface: the surface.
    """

    normal: np.ndarray
    area: np.ndarray
    center: np.ndarray
    triangle: np.ndarray
    surface: Surface

    @property
    def part(self) -> np.ndarray:
        """[panel] index into the surface's part names."""
        return self.surface.part[self.triangle]

    def __len__(self) -> int:
        return len(self.area)


def panels_of(surface: Surface, longest: float) -> Panels:
    """Cut a surface into panels.

    A triangle with an edge longer than `longest` is halved across its longest edge, again and again. Without hidden
    panels that changes no load, since a triangle has one inclination; with them it is the resolution of the shadow's
    edge.

    Args:
        surface: closed surface.
        longest: longest edge of a panel, m.
    """
    pieces, source, share = _cut(surface.corners, longest)
    order = np.argsort(surface.part[source], kind="stable")
    source = source[order]
    # Normals are those of the whole triangles and areas their equal shares, so that no digit is lost by cutting.
    vector = surface.area_vectors
    size = np.linalg.norm(vector, axis=1)
    normal = vector / np.maximum(size, 1e-300)[:, None]
    return Panels(normal[source], size[source] * share[order], pieces.mean(axis=1)[order], source, surface)


def _cut(corners: np.ndarray, longest: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """[piece, corner, xyz] corners, triangle that the piece is of, and its share of the triangle's area."""
    source, share = np.arange(len(corners)), np.ones(len(corners))
    done = []
    while True:
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        length = np.stack([((b - a) ** 2).sum(axis=1), ((c - b) ** 2).sum(axis=1), ((a - c) ** 2).sum(axis=1)])
        long = length.max(axis=0) > longest**2
        short = ~long
        done.append((corners[short], source[short], share[short]))
        if not long.any():
            break
        rows, k = np.flatnonzero(long), length[:, long].argmax(axis=0)
        a, b, c = (corners[rows, (k + shift) % 3] for shift in range(3))
        middle = 0.5 * (a + b)
        corners = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
        source, share = np.tile(source[rows], 2), 0.5 * np.tile(share[rows], 2)
    return tuple(np.concatenate(column) for column in zip(*done, strict=True))


def blunt_triangles(surface: Surface, radius: float) -> np.ndarray:
    """[triangle] whether the wall there is convex with a radius of curvature below `radius`, m, in some direction.

    The curvature along an edge is the change of the vertices' normals over its length, which is exact on spheres and
    cylinders. Vertices on a fold above SHARPEST_FOLD lie on a sharp edge of the shape, and do not count.
    """
    triangles, points = surface.triangles, surface.points
    start, end = triangles, np.roll(triangles, -1, axis=1)
    size = np.linalg.norm(surface.area_vectors, axis=1)
    normal = surface.area_vectors / np.maximum(size, 1e-300)[:, None]
    smooth = ~_sharp_vertices(surface, normal, size)
    mean = _vertex_normals(surface, normal)
    along, change = points[end] - points[start], mean[end] - mean[start]
    length2 = np.maximum(np.einsum("tkx,tkx->tk", along, along), 1e-300)
    curvature = np.einsum("tkx,tkx->tk", along, change) / length2
    return (smooth[start] & smooth[end] & (curvature * radius > 1.0)).any(axis=1)


def _vertex_normals(surface: Surface, normal: np.ndarray) -> np.ndarray:
    """[vertex, xyz] unit normals: those of the triangles weighted by their angles."""
    corners = surface.corners
    ahead = np.roll(corners, -1, axis=1) - corners
    ahead /= np.maximum(np.linalg.norm(ahead, axis=2), 1e-300)[..., None]
    angle = np.arccos(np.clip(-np.einsum("tkx,tkx->tk", ahead, np.roll(ahead, 1, axis=1)), -1.0, 1.0))
    count = len(surface.points)
    weighted = (angle[..., None] * normal[:, None, :]).reshape(-1, 3)
    mean = np.stack([np.bincount(surface.triangles.ravel(), weighted[:, x], count) for x in range(3)], axis=1)
    return mean / np.maximum(np.linalg.norm(mean, axis=1), 1e-300)[:, None]


def _sharp_vertices(surface: Surface, normal: np.ndarray, size: np.ndarray) -> np.ndarray:
    """[vertex] whether it lies on a fold sharper than SHARPEST_FOLD between two triangles that are no slivers."""
    triangles = surface.triangles
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    key = np.minimum(start, end) * len(surface.points) + np.maximum(start, end)
    order = np.argsort(key)
    same = np.flatnonzero(key[order[:-1]] == key[order[1:]])
    edge, other = order[same], order[same + 1]
    i, j = edge // 3, other // 3
    length = np.linalg.norm(surface.points[start[edge]] - surface.points[end[edge]], axis=1)
    solid = 2.0 * np.minimum(size[i], size[j]) > LEAST_HEIGHT * length**2
    sharp = solid & (np.einsum("ex,ex->e", normal[i], normal[j]) < np.cos(SHARPEST_FOLD))
    result = np.zeros(len(surface.points), dtype=bool)
    result[start[edge[sharp]]] = True
    result[end[edge[sharp]]] = True
    return result
