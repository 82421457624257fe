"""Body-fitted meshes for tests: structured blocks of hexahedra made into a Mesh."""

from __future__ import annotations

import numpy as np

from spaceplane.mesh.mesh import Mesh


def _quad(a, b, c, d):
    """Area vector and centroid of (possibly warped) quadrilaterals a b c d, right-handed."""
    area = 0.5 * np.cross(c - a, d - b)
    one, two = 0.5 * np.cross(b - a, c - a), 0.5 * np.cross(c - a, d - a)
    s1, s2 = np.linalg.norm(one, axis=-1, keepdims=True), np.linalg.norm(two, axis=-1, keepdims=True)
    total = np.where(s1 + s2 > 0, s1 + s2, 1.0)
    center = np.where(s1 + s2 > 0, ((a + b + c) / 3 * s1 + (a + c + d) / 3 * s2) / total, (a + b + c + d) / 4)
    return area, center


def from_grid(points: np.ndarray, kinds: dict[str, str], periodic: str = "", part: str = "body") -> Mesh:
    """Mesh of the hexahedra between points [i, j, k, xyz] (right-handed).

    Args:
        kinds: what each side is, "wall" or "far", for the keys i0 i1 j0 j1 k0 k1; sides not named are collapsed or
            periodic and get no face.
        periodic: axes ("k") whose last layer of cells touches the first.
    """
    p = points
    shape = tuple(n - 1 for n in p.shape[:3])
    number = np.arange(np.prod(shape)).reshape(shape)
    corner = {
        "i": (p[:, :-1, :-1], p[:, 1:, :-1], p[:, 1:, 1:], p[:, :-1, 1:]),
        "j": (p[:-1, :, :-1], p[:-1, :, 1:], p[1:, :, 1:], p[1:, :, :-1]),
        "k": (p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]),
    }
    cells, areas, centers = [], [], []
    edges = {"wall": ([], [], []), "far": ([], [], [])}
    volume, moment = np.zeros(number.size), np.zeros((number.size, 3))
    middle = (
        sum(
            p[a : p.shape[0] - 1 + a, b : p.shape[1] - 1 + b, c : p.shape[2] - 1 + c]
            for a in (0, 1)
            for b in (0, 1)
            for c in (0, 1)
        ).reshape(-1, 3)
        / 8
    )

    def add(cell, area, center):
        height = np.einsum("ij,ij->i", center - middle[cell], area) / 3
        np.add.at(volume, cell, height)
        np.add.at(moment, cell, height[:, None] * (0.75 * center + 0.25 * middle[cell]))

    for axis, name in enumerate("ijk"):
        area, center = _quad(*corner[name])
        take = lambda x, sl, axis=axis: x[tuple(sl if a == axis else slice(None) for a in range(3))].reshape(
            -1, *x.shape[3:]
        )
        low, high = take(number, slice(None, -1)), take(number, slice(1, None))
        inner, mid = take(area, slice(1, -1)), take(center, slice(1, -1))
        add(low, inner, mid)
        add(high, -inner, mid)
        pieces = [(low, high, inner, mid)]
        first, last = take(number, slice(0, 1)), take(number, slice(-1, None))
        if name in periodic:
            s, c = take(area, slice(0, 1)), take(center, slice(0, 1))
            add(last, s, c)
            add(first, -s, c)
            pieces.append((last, first, s, c))
        for cell, face, sign, side in ((first, slice(0, 1), -1, "0"), (last, slice(-1, None), 1, "1")):
            if name + side in kinds:
                s, c = sign * take(area, face), take(center, face)
                add(cell, s, c)
                for store, value in zip(edges[kinds[name + side]], (cell, s, c), strict=True):
                    store.append(value)
        for a, b, s, c in pieces:
            cells.append(np.stack([a, b], axis=1))
            areas.append(s)
            centers.append(c)
    join = lambda rows, width: np.concatenate(rows) if rows else np.zeros((0, width) if width else 0)
    wall, far = edges["wall"], edges["far"]
    wall_cell = join(wall[0], 0).astype(np.int32)
    cells = np.concatenate(cells).astype(np.int32)
    areas = np.concatenate(areas)
    keep = np.linalg.norm(areas, axis=1) > 1e-12 * np.cbrt(volume.max()) ** 2
    return Mesh(
        cell_volume=volume,
        cell_center=moment / volume[:, None],
        cell_size=np.cbrt(volume),
        face_cells=cells[keep],
        face_area=areas[keep],
        face_center=np.concatenate(centers)[keep],
        wall_cell=wall_cell,
        wall_area=join(wall[1], 3),
        wall_center=join(wall[2], 3),
        far_cell=join(far[0], 0).astype(np.int32),
        far_area=join(far[1], 3),
        far_center=join(far[2], 3),
        piece_wall=np.arange(len(wall_cell), dtype=np.int32),
        piece_area=join(wall[1], 3),
        piece_center=join(wall[2], 3),
        piece_part=np.zeros(len(wall_cell), dtype=np.int32),
        part_names=(part,),
    )


def box(n: int | tuple[int, int, int], perturb: float = 0.0, seed: int = 1) -> Mesh:
    """Unit box of hexahedra, far field all round, inner points moved at random by `perturb` of a cell."""
    counts = (n, n, n) if isinstance(n, int) else n
    grid = np.stack(np.meshgrid(*[np.linspace(0, 1, m + 1) for m in counts], indexing="ij"), axis=-1)
    shift = np.random.default_rng(seed).uniform(-perturb, perturb, grid.shape) / np.array(counts)
    grid[1:-1, 1:-1, 1:-1] += shift[1:-1, 1:-1, 1:-1]
    return from_grid(grid, dict.fromkeys(("i0", "i1", "j0", "j1", "k0", "k1"), "far"))


def sphere(radial: int, around: int, radius: float = 1.0, far: float = 8.0) -> Mesh:
    """Six cube-sphere patches would meet awkwardly; one polar block about the x axis does, with its two pole lines collapsed."""
    stretch = np.geomspace(radius, far, radial + 1)
    polar = np.linspace(0, np.pi, around + 1)
    turn = np.linspace(0, 2 * np.pi, 2 * around + 1)
    r, t, f = np.meshgrid(stretch, polar, turn, indexing="ij")
    grid = np.stack([-r * np.cos(t), r * np.sin(t) * np.cos(f), r * np.sin(t) * np.sin(f)], axis=-1)
    grid[:, :, -1] = grid[:, :, 0]
    grid[:, 0, :, 1:] = 0.0
    grid[:, -1, :, 1:] = 0.0
    flipped = grid[:, :, ::-1]
    return from_grid(flipped, {"i0": "wall", "i1": "far"}, periodic="k")
