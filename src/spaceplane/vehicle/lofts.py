"""From grids of section points to closed triangulated solids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

CAMBER = 1e-4
"""m, by which flat and straight skins are cambered.

A union merges the triangles of faces that are flat to round-off and leaves slivers as long as the vehicle; a tenth of a
millimetre of camber keeps the triangles that were asked for.
"""


@dataclass(frozen=True)
class Shell:
    """A closed triangulated shell with outward normals.

    Attributes:
        points: [vertex, xyz], m.
        triangles: [triangle, 3] vertex indices.
    """

    points: np.ndarray
    triangles: np.ndarray


def oriented(points: np.ndarray, triangles: np.ndarray) -> Shell:
    """Shell of points [vertex, xyz], m, with triangles [triangle, 3] turned so that the enclosed volume is positive."""
    c = points[triangles] - points.mean(axis=0)
    volume = np.einsum("ij,ij->", c[:, 0], np.cross(c[:, 1], c[:, 2]))
    return Shell(points, triangles if volume > 0 else triangles[:, ::-1])


def tube(grid: np.ndarray) -> np.ndarray:
    """Triangles of the side of a loft; each quadrilateral is split along its shorter diagonal.

    Args:
        grid: [station, point, xyz], closed in the second index.
    """
    stations, count = grid.shape[:2]
    i, j = np.meshgrid(np.arange(stations - 1), np.arange(count), indexing="ij")
    k = (j + 1) % count
    a, b, c, d = i * count + j, i * count + k, (i + 1) * count + k, (i + 1) * count + j
    flat = grid.reshape(-1, 3)
    first = np.linalg.norm(flat[a] - flat[c], axis=-1) <= np.linalg.norm(flat[b] - flat[d], axis=-1)
    one = np.where(first[..., None], np.stack([a, b, c], -1), np.stack([a, b, d], -1))
    two = np.where(first[..., None], np.stack([a, c, d], -1), np.stack([b, c, d], -1))
    return np.concatenate([one.reshape(-1, 3), two.reshape(-1, 3)])


def profile_loft(grid: np.ndarray) -> Shell:
    """Closed solid from sections that run along one side and back along the other.

    Args:
        grid: [station, point, xyz]; point i of one side faces point count - 1 - i of the other, so that the
            end caps are strips between the two sides and need no fans.
    """
    stations, count = grid.shape[:2]
    i = np.arange((count - 1) // 2)
    a, b, c, d = i, i + 1, count - 2 - i, count - 1 - i
    cap = np.concatenate([np.stack([a, d, c], -1), np.stack([a, c, b], -1)])
    cap = cap[(cap[:, 0] != cap[:, 1]) & (cap[:, 1] != cap[:, 2]) & (cap[:, 0] != cap[:, 2])]
    end = cap[:, ::-1] + (stations - 1) * count
    return oriented(grid.reshape(-1, 3), np.concatenate([tube(grid), cap, end]))


def capped_loft(grid: np.ndarray, start: np.ndarray, end: np.ndarray) -> Shell:
    """Closed solid from convex-looking sections with a centre point at each end.

    Args:
        grid: [station, point, xyz], closed in the second index.
        start, end: [xyz] centres of the two caps.
    """
    stations, count = grid.shape[:2]
    j = np.arange(count)
    k = (j + 1) % count
    n = stations * count
    front = np.stack([np.full(count, n), k, j], -1)
    back = np.stack([np.full(count, n + 1), n - count + j, n - count + k], -1)
    points = np.concatenate([grid.reshape(-1, 3), [start], [end]])
    return oriented(points, np.concatenate([tube(grid), front, back]))


def box(corners: np.ndarray) -> Shell:
    """Solid with eight corners, [2, 2, 2, xyz], a distorted cube."""
    p = corners.reshape(8, 3)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    return oriented(p, triangles)
