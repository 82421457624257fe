"""Wall faces on known surfaces with a known surface flow: solutions that no solver had to find."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial import cKDTree

from spaceplane.flow.solution import ConvergenceRecord, FlowConditions, Solution
from spaceplane.mesh.mesh import Mesh

GAMMA = 1.4


def wall_mesh(center: np.ndarray, area: np.ndarray, links: np.ndarray, part: np.ndarray | None = None) -> Mesh:
    """A mesh of one cell to a wall face; `links` [face, 2] are the cells that share a face. `area` points inward."""
    count = len(center)
    none, flat = np.zeros((0, 3)), np.zeros(0, dtype=np.int32)
    own = np.arange(count, dtype=np.int32)
    part = np.zeros(count, dtype=np.int32) if part is None else part.astype(np.int32)
    return Mesh(
        cell_volume=np.ones(count),
        cell_center=center.copy(),
        cell_size=np.ones(count),
        face_cells=links.astype(np.int32),
        face_area=np.zeros((len(links), 3)),
        face_center=np.zeros((len(links), 3)),
        wall_cell=own,
        wall_area=area,
        wall_center=center,
        far_cell=flat,
        far_area=none,
        far_center=none,
        piece_wall=own,
        piece_area=area.copy(),
        piece_center=center.copy(),
        piece_part=part,
        part_names=tuple(f"part_{n}" for n in range(part.max() + 1)),
    )


def patch(place: Callable[[np.ndarray, np.ndarray], np.ndarray], shape: tuple[int, int], wraps: bool = False) -> Mesh:
    """Quadrilaterals between `place(u, v)` [..., xyz] at u, v in 0 to 1; the normal r_u x r_v points into the air.

    Args:
        place: the surface.
        shape: faces along u and v.
        wraps: the last row in v touches the first.
    """
    u, v = (np.linspace(0.0, 1.0, n + 1) for n in shape)
    corner = place(*np.meshgrid(u, v, indexing="ij"))
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    area = -0.5 * np.cross(c - a, d - b).reshape(-1, 3)
    index = np.arange(shape[0] * shape[1]).reshape(shape)
    links = [(index[:-1].ravel(), index[1:].ravel()), (index[:, :-1].ravel(), index[:, 1:].ravel())]
    if wraps:
        links.append((index[:, -1], index[:, 0]))
    links = np.concatenate([np.stack(pair, axis=1) for pair in links])
    return wall_mesh((0.25 * (a + b + c + d)).reshape(-1, 3), area, links)


def plate(length: float = 1.0, shape: tuple[int, int] = (100, 4), turn: float = 0.0) -> Mesh:
    """A plate in the plane z = 0 with air above, leading edge x = 0 and square faces.

    A grid turned by `turn`, rad, is as wide as long and has a ragged leading edge.
    """
    size = length / shape[0]
    if turn == 0.0:
        return patch(lambda u, v: np.stack([length * u, size * shape[1] * v, 0.0 * u], axis=-1), shape)
    wide = np.arange(-4 * shape[0], 4 * shape[0]) + 0.5
    x, y = (g.ravel() * size for g in np.meshgrid(wide, wide, indexing="ij"))
    c, s = np.cos(turn), np.sin(turn)
    x, y = c * x - s * y, s * x + c * y
    inside = (x > 0.0) & (x < length) & (np.abs(y) < 0.5 * length)
    center = np.stack([x, y, 0.0 * x], axis=1)[inside]
    links = np.array(sorted(cKDTree(center).query_pairs(1.01 * size)))
    return wall_mesh(center, np.tile([0.0, 0.0, -(size**2)], (len(center), 1)), links)


def cone(half_angle: float, shape: tuple[int, int] = (60, 48)) -> Mesh:
    """A cone of slant length 1 m about the x axis from its apex at the origin, without base."""

    def place(u, v):
        slant = 1e-6 + u
        phi = 2.0 * np.pi * v
        radius = slant * np.sin(half_angle)
        return np.stack([slant * np.cos(half_angle), -radius * np.cos(phi), radius * np.sin(phi)], axis=-1)

    return patch(place, shape, wraps=True)


def flow_on(
    mesh: Mesh,
    velocity: np.ndarray,
    mach: float,
    pressure: np.ndarray | float = 1.0,
    alpha: float = 0.0,
    beta: float = 0.0,
) -> Solution:
    """A solution of one condition with a wall pressure (on the free stream's) and the free stream's entropy.

    Args:
        mesh: the wall.
        velocity: [wall, xyz]; only its direction is used by what is tested.
        mach: of the free stream.
        pressure: [wall] or one number.
        alpha, beta: of the free stream, rad.
    """
    ratio = np.broadcast_to(np.asarray(pressure, dtype=float), (mesh.cells,))
    state = np.empty((mesh.cells, 5, 1))
    state[:, 0, 0] = ratio ** (1.0 / GAMMA)
    state[:, 1:4, 0] = velocity
    state[:, 4, 0] = ratio / GAMMA
    record = ConvergenceRecord("converged", 3.0, 10, np.zeros(10), np.zeros((10, 3)), np.zeros(3), np.zeros(3))
    conditions = FlowConditions(np.array([mach]), np.array([alpha]), np.array([beta]), GAMMA)
    return Solution(mesh, conditions, state, ratio[:, None] / GAMMA, (record,))
