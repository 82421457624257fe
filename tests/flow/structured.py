"""Body-fitted meshes for tests: structured blocks of hexahedra, joined where their points coincide, made into a
Mesh."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from spaceplane.mesh.mesh import Mesh

# Corners of a hexahedron (i, j, k bits) and its six faces, right-handed outwards.
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
FACES = np.array([[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]])


def quad(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Area vectors and centroids of (possibly warped) quadrilaterals [face, 4, xyz]; both diagonals count alike."""
    a, b, c, d = (corners[:, k] for k in range(4))
    area = 0.5 * np.cross(c - a, d - b)
    moment, total = np.zeros_like(a), np.zeros((len(a), 1))
    for one, two, three in ((a, b, c), (a, c, d), (a, b, d), (b, c, d)):
        weight = np.linalg.norm(np.cross(two - one, three - one), axis=1, keepdims=True)
        moment += weight * (one + two + three) / 3
        total += weight
    return area, np.where(total > 0, moment / np.where(total > 0, total, 1.0), (a + b + c + d) / 4)


def from_blocks(blocks: list[np.ndarray], is_wall: Callable[[np.ndarray], np.ndarray], part: str = "body") -> Mesh:
    """Mesh of all hexahedra of right-handed blocks of points [i, j, k, xyz].

    Faces with the same corner points are joined, faces without area dropped; of those left over, `is_wall` tells from
    the
    centres [face, xyz] which are walls; the others are far field.
    """
    points = np.concatenate([block.reshape(-1, 3) for block in blocks])
    scale = np.ptp(points, axis=0).max()
    _, unique = np.unique(np.round(points / scale * 1e9).astype(np.int64), axis=0, return_inverse=True)
    unique = unique.reshape(-1)
    hexes, offset = [], 0
    for block in blocks:
        number = offset + np.arange(block[..., 0].size).reshape(block.shape[:3])
        offset += block[..., 0].size
        ends = [n - 1 for n in block.shape[:3]]
        hexes.append(
            np.stack([number[a : a + ends[0], b : b + ends[1], c : c + ends[2]] for a, b, c in CORNERS], -1).reshape(
                -1, 8
            )
        )
    hexes = np.concatenate(hexes)
    count = len(hexes)
    corners = hexes[:, FACES].reshape(-1, 4)
    owner = np.repeat(np.arange(count), 6)
    area, center = quad(points[corners])
    middle = points[hexes].mean(axis=1)
    height = np.einsum("ij,ij->i", center - middle[owner], area) / 3
    volume = np.bincount(owner, height, count)
    part_center = 0.75 * center + 0.25 * middle[owner]
    moment = np.stack([np.bincount(owner, height * part_center[:, k], count) for k in range(3)], axis=1)

    solid = np.linalg.norm(area, axis=1) > 1e-13 * scale**2
    corners, owner, area, center = unique[corners[solid]], owner[solid], area[solid], center[solid]
    _, face, times = np.unique(np.sort(corners, axis=1), axis=0, return_inverse=True, return_counts=True)
    face = face.reshape(-1)
    order = np.argsort(face, kind="stable")
    first = order[np.concatenate([[0], np.cumsum(times)[:-1]])]
    second = order[np.cumsum(times) - 1]
    inner, outer = times == 2, times == 1
    assert (inner | outer).all()
    edge = first[outer]
    wall = is_wall(center[edge])
    w, f = edge[wall], edge[~wall]
    return Mesh(
        cell_volume=volume,
        cell_center=moment / volume[:, None],
        cell_size=np.cbrt(volume),
        face_cells=np.stack([owner[first[inner]], owner[second[inner]]], axis=1).astype(np.int32),
        face_area=0.5 * (area[first[inner]] - area[second[inner]]),
        face_center=center[first[inner]],
        wall_cell=owner[w].astype(np.int32),
        wall_area=area[w],
        wall_center=center[w],
        far_cell=owner[f].astype(np.int32),
        far_area=area[f],
        far_center=center[f],
        piece_wall=np.arange(len(w), dtype=np.int32),
        piece_area=area[w],
        piece_center=center[w],
        piece_part=np.zeros(len(w), dtype=np.int32),
        part_names=(part,),
    )


def nowhere(center: np.ndarray) -> np.ndarray:
    """No wall at all."""
    return np.zeros(len(center), dtype=bool)


def box(n: int | tuple[int, int, int], perturb: float = 0.0, seed: int = 1) -> Mesh:
    """Unit box of hexahedra, far field all round, inner points moved at random by `perturb` of a cell."""
    counts = (n, n, n) if isinstance(n, int) else n
    grid = np.stack(np.meshgrid(*[np.linspace(0, 1, m + 1) for m in counts], indexing="ij"), axis=-1)
    shift = np.random.default_rng(seed).uniform(-perturb, perturb, grid.shape) / np.array(counts)
    grid[1:-1, 1:-1, 1:-1] += shift[1:-1, 1:-1, 1:-1]
    return from_blocks([grid], nowhere)


def sphere(radial: int, side: int, radius: float = 1.0, far: float = 8.0) -> Mesh:
    """Sphere in a ball: six patches of a projected cube, `side` cells along each cube edge, `radial` layers, no
    pole."""
    r = np.geomspace(radius, far, radial + 1)
    return from_blocks(sphere_blocks(r, side), lambda c: np.linalg.norm(c, axis=1) < 0.5 * (r[0] + r[1]))


def sphere_blocks(r: np.ndarray, side: int) -> list[np.ndarray]:
    """Points [i, j, k, xyz] of the six patches of a projected cube at the radii `r` [k]."""
    angle = np.tan(np.linspace(-np.pi / 4, np.pi / 4, side + 1))
    blocks = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            a, b = np.meshgrid(angle, sign * angle, indexing="ij")
            direction = np.empty((side + 1, side + 1, 3))
            direction[..., axis], direction[..., (axis + 1) % 3], direction[..., (axis + 2) % 3] = sign, a, b
            direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
            blocks.append(direction[:, :, None, :] * r[None, None, :, None])
    return blocks


def cone(along: int, across: int, around: int, half_angle: float, outer_angle: float) -> Mesh:
    """Quarter of a unit-length cone about the x axis with its apex at the origin, out to a wider cone; angles in rad.

    The planes y = 0 and z = 0 are slip walls, as symmetry wants them.
    """
    points = cone_block(along, across, around, half_angle, outer_angle)
    gap = 1e-6

    def is_wall(c: np.ndarray) -> np.ndarray:
        radius = np.hypot(c[:, 1], c[:, 2])
        on_cone = radius < np.maximum(c[:, 0], 1e-9) * np.tan(half_angle) * (1 + gap)
        return (c[:, 1] < gap) | (c[:, 2] < gap) | (on_cone & (c[:, 0] < 1.0 - gap))

    return from_blocks([points], is_wall)


def cone_block(along: int, across: int, around: int, half_angle: float, outer_angle: float) -> np.ndarray:
    """Points [i, j, k, xyz] of a quarter of the air about a cone of unit length; angles in rad."""
    x = np.linspace(0.0, 1.0, along + 1)
    angle = np.linspace(half_angle, outer_angle, across + 1)
    turn = np.linspace(0.0, np.pi / 2, around + 1)
    xx, aa, tt = np.meshgrid(x, angle, turn, indexing="ij")
    r = xx * np.tan(aa)
    return np.stack([xx, r * np.cos(tt), r * np.sin(tt)], axis=-1)


def annulus(n: int, inner: float = 1.0, outer: float = 1.384) -> Mesh:
    """Quarter of a ring between two radii, n by 2 n cells and one cell thick; curved and flat sides are walls."""
    r, t, z = np.meshgrid(
        np.linspace(inner, outer, n + 1), np.linspace(0.0, np.pi / 2, 2 * n + 1), [0.0, outer / n / 4], indexing="ij"
    )
    points = np.stack([r * np.sin(t), r * np.cos(t), z], axis=-1)[:, ::-1]
    return from_blocks([points], lambda c: (c[:, 0] > 1e-6) & (c[:, 1] > 1e-6))
