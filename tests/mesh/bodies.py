"""Simple closed bodies for the mesh tests."""

from __future__ import annotations

import numpy as np
import trimesh

from spaceplane.vehicle.surface import Surface


def from_trimesh(*bodies: trimesh.Trimesh, names: tuple[str, ...] | None = None) -> Surface:
    """Surface with one part for each body."""
    points, triangles, part = [], [], []
    first = 0
    for n, body in enumerate(bodies):
        points.append(np.asarray(body.vertices, float))
        triangles.append(np.asarray(body.faces, np.int64) + first)
        part.append(np.full(len(body.faces), n, np.int32))
        first += len(body.vertices)
    return Surface(
        np.concatenate(points),
        np.concatenate(triangles),
        np.concatenate(part),
        names or tuple(f"part{n}" for n in range(len(bodies))),
    )


def sphere(radius: float = 1.0, subdivisions: int = 3) -> Surface:
    """Icosphere; symmetric about all coordinate planes."""
    return from_trimesh(trimesh.creation.icosphere(subdivisions, radius))


def box(*edges: float, at: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> trimesh.Trimesh:
    """Box of the given edges about a point."""
    body = trimesh.creation.box(edges)
    body.apply_translation(at)
    return body


def cone(radius: float = 1.0, length: float = 3.0) -> Surface:
    """Cone along x with its tip at the origin."""
    body = trimesh.creation.cone(radius, length, sections=48)
    body.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, (0, 1, 0)))
    body.apply_translation((length, 0, 0))
    return from_trimesh(body)


def diamond_wing(chord: float = 5.0, span: float = 6.0, thickness: float = 0.4) -> Surface:
    """Wing of diamond section with its leading edge on x = 0."""
    return wing([(0.0, 0.0), (chord / 2, -thickness / 2), (chord, 0.0), (chord / 2, thickness / 2)], span)


def flat_plate(chord: float = 5.0, span: float = 6.0, thickness: float = 0.4, bevel: float = 1.0) -> Surface:
    """Plate with edges sharpened over a length of `bevel` and its leading edge on x = 0."""
    x, z = (bevel, chord - bevel), thickness / 2
    return wing([(0.0, 0.0), (x[0], -z), (x[1], -z), (chord, 0.0), (x[1], z), (x[0], z)], span)


def wing(section: list[tuple[float, float]], span: float) -> Surface:
    """Straight wing of a convex section [(x, z), ...]."""
    n = len(section)
    points = np.array([(x, y, z) for y in (-span / 2, span / 2) for x, z in section])
    after = [(k + 1) % n for k in range(n)]
    sides = [t for k in range(n) for t in ((k, n + k, n + after[k]), (k, n + after[k], after[k]))]
    ends = [t for k in range(1, n - 1) for t in ((0, k, k + 1), (n, n + k + 1, n + k))]
    body = trimesh.Trimesh(points, sides + ends, process=False)
    body.fix_normals()
    return from_trimesh(body)


def rotated(surface: Surface, seed: int) -> Surface:
    """The surface turned by an odd angle about an odd axis."""
    matrix = trimesh.transformations.random_rotation_matrix(np.random.default_rng(seed).random(3))[:3, :3]
    return Surface(surface.points @ matrix.T, surface.triangles, surface.part, surface.part_names)
