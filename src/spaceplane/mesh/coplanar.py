"""Triangles that lie in a plane of the grid, moved to the side of the air that they bound.

A piece of wall belongs to the cell that it lies in. One in the plane between two cells would bound a control volume of
nothing in the cell inside the body; merged with a neighbour, such volumes join the air on both sides of an edge.
"""

from __future__ import annotations

import numpy as np

CLOSE = 8.0
"""Distance of a vertex that still counts as in the plane, in units of the largest coordinate's round-off."""


def beside_planes(points: np.ndarray, triangles: np.ndarray, mirror: float | None = None) -> np.ndarray:
    """Vertices with those of triangles in grid planes moved, by round-off only, into the slabs of the air.

    A vertex in a plane counts to the slab above it (see `subdivide`). Where the air lies above, its triangles are put
    into the plane, where it lies below, just under it. Vertices on which two triangles disagree stay.

    Args:
        points: [vertex, xyz] in wall cells; grid planes lie at integers.
        triangles: [triangle, 3] vertex indices, counter-clockwise seen from the air.
        mirror: y of a plane of symmetry (in wall cells, a number), in which everything stays.
    """
    close = CLOSE * np.spacing(np.abs(points).max(initial=1.0))
    nearest = np.round(points)
    near = np.abs(points - nearest) <= close
    if mirror is not None:
        near[:, 1] &= nearest[:, 1] != mirror
    moved = points.copy()
    for axis in range(3):
        plane = nearest[triangles, axis]
        flat = near[triangles, axis].all(axis=1) & (plane == plane[:, :1]).all(axis=1)
        if not flat.any():
            continue
        corner = points[triangles[flat]]
        up = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])[:, axis]
        above, below = (np.zeros(len(points), bool) for _ in range(2))
        above[triangles[flat][up > 0.0]] = True
        below[triangles[flat][up < 0.0]] = True
        moved[above & ~below, axis] = nearest[above & ~below, axis]
        moved[below & ~above, axis] = nearest[below & ~above, axis] - close
    return moved
