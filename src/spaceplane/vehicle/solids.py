"""Boolean solids (manifold3d) and the triangles that come out of them."""

from __future__ import annotations

import numpy as np

from spaceplane.vehicle.validity import GeometryError


def solid_of(points: np.ndarray, triangles: np.ndarray, what: str, tags: np.ndarray | None = None):
    """manifold3d solid of a closed triangulation.

    Args:
        points: [vertex, xyz] m.
        triangles: [triangle, 3] vertices, counter-clockwise seen from outside.
        what: its name in an error.
        tags: [triangle] numbers that the triangles keep through unions, as `face_id`.

    Raises:
        GeometryError: the triangles are not a closed oriented surface.
    """
    import manifold3d

    faces = {} if tags is None else {"face_id": tags.astype(np.uint64)}
    mesh = manifold3d.Mesh64(np.ascontiguousarray(points), np.ascontiguousarray(triangles.astype(np.uint64)), **faces)
    solid = manifold3d.Manifold(mesh)
    if solid.status() != manifold3d.Error.NoError or solid.volume() <= 0:
        raise GeometryError(f"{what}: these parameters give no closed solid ({solid.status().name})")
    return solid


def welded(mesh) -> tuple[np.ndarray, np.ndarray]:
    """Points [vertex, xyz] and triangles [triangle, 3] of a manifold3d Mesh64, vertices that it doubles joined."""
    points = np.array(mesh.vert_properties[:, :3])
    triangles = mesh.tri_verts.astype(np.int64)
    if len(mesh.merge_from_vert):
        target = np.arange(len(points))
        target[mesh.merge_from_vert] = mesh.merge_to_vert
        triangles = target[triangles]
    return points, triangles
