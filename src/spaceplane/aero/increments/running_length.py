"""How far the boundary layer has run along the wall: a transport equation on the wall faces.

The plain running length s grows by the way along the surface streamlines, t . grad s = 1 with the unit vector t of the
surface flow, from zero where streamlines begin: at the nose, at leading edges. Where streamlines spread the boundary
layer thins. With small cross-flow it grows as on a body of revolution whose radius is the spacing h of the streamlines
(Cooke, ARC R&M 3200, 1961), and a skin-friction law c_f ~ Re_x^-m then holds for the flat plate's length

    x = (integral of h^(1/(1-m)) ds) / h^(1/(1-m)),

which for laminar flow on a cone is Mangler's third of s (Mangler 1948). Since div t = d ln h / ds, this is

    t . grad x = 1 - x div t / (1 - m),

solved here by upwinding between neighbouring faces: exact in parallel flow on a plane and for x ~ s on cones, first
order elsewhere. An attachment line, where flow leaves both ways, so has its finite length although its own streamline
comes from far upstream. Streamlines that converge lengthen x to at most twice s: beyond, the surface separates and
strips along streamlines mean nothing.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix, eye

from spaceplane.mesh.mesh import Mesh

CONVERGENCE_BOUND = 0.5
"""Most that converging streamlines lengthen x, as the share of 1/s that x div t may take: bounds x by 2 s."""
WEAK = 0.25
"""Sum of squared cosines below which upstream neighbours lie too far aside to be all of what is upstream."""
FADING = 1000.0
"""Body lengths after which a streamline forgets: what keeps closed streamlines in dead water from having no start."""


def neighbours(mesh: Mesh) -> np.ndarray:
    """[pair, 2] wall faces whose cells are the same or share a face, each pair in both orders."""
    walls, cells = len(mesh.wall_cell), mesh.cells
    holds = csc_matrix((np.ones(walls), (mesh.wall_cell, np.arange(walls))), shape=(cells, walls))
    first, second = mesh.face_cells.astype(np.int64).T
    joined = coo_matrix((np.ones(len(first)), (first, second)), shape=(cells, cells))
    near = (holds.T @ (joined + joined.T + eye(cells)) @ holds).tocoo()
    apart = near.row != near.col
    return np.stack([near.row[apart], near.col[apart]], axis=1)


def running_length(mesh: Mesh, pairs: np.ndarray, direction: np.ndarray, exponent: float) -> np.ndarray:
    """[wall] length x of the flat plate with the same boundary layer, m.

    Args:
        mesh: its wall faces.
        pairs: what `neighbours` found.
        direction: [wall, xyz] unit vectors of the surface flow, zero where there is none.
        exponent: m of the friction law, a number from 0 to below 1.
    """
    from scipy.sparse.linalg import spsolve  # slow to import, and needed with friction only

    here, there = pairs.T
    step = mesh.wall_center[here] - mesh.wall_center[there]
    distance = np.maximum(np.linalg.norm(step, axis=1), 1e-300)
    mean = direction[here] + direction[there]
    mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-12)
    way = (mean * step).sum(axis=1)
    weight = np.maximum(way / distance, 0.0) ** 2
    count = len(mesh.wall_cell)
    total = np.bincount(here, weight, minlength=count)
    scale = np.maximum(total, WEAK)
    share = weight / scale[here]
    half = 0.5 * np.sqrt(np.linalg.norm(mesh.wall_area, axis=1))
    advance = np.bincount(here, share * way, minlength=count) + (1.0 - total / scale) * half
    advance = np.maximum(advance, 1e-9 * half.max())
    length = FADING * float(np.ptp(mesh.wall_center, axis=0).max())
    upstream = coo_matrix((share, (here, there)), shape=(count, count)).tocsc()

    def solved(loss: np.ndarray) -> np.ndarray:
        """x of t . grad x = 1 - x loss."""
        system = eye(count, format="csc") - upstream
        system.setdiag(system.diagonal() + advance * loss)
        return spsolve(system, advance)

    plain = solved(np.full(count, 1.0 / length))
    spread = _divergence(mesh, pairs, direction) / (1.0 - exponent)
    return solved(np.maximum(spread, -CONVERGENCE_BOUND / plain) + 1.0 / length)


def _divergence(mesh: Mesh, pairs: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """[wall] surface divergence of the unit vectors, 1/m, by weighted least squares over the neighbours."""
    here, there = pairs.T
    normal = mesh.wall_area / np.maximum(np.linalg.norm(mesh.wall_area, axis=1, keepdims=True), 1e-300)
    step = mesh.wall_center[there] - mesh.wall_center[here]
    weight = 1.0 / np.maximum((step**2).sum(axis=1), 1e-300)
    step = step - (step * normal[here]).sum(axis=1, keepdims=True) * normal[here]
    change = direction[there] - direction[here]
    count = len(mesh.wall_cell)
    matrix, mixed = np.zeros((count, 3, 3)), np.zeros((count, 3, 3))
    for a in range(3):
        for b in range(3):
            matrix[:, a, b] = np.bincount(here, weight * step[:, a] * step[:, b], minlength=count)
            mixed[:, a, b] = np.bincount(here, weight * step[:, a] * change[:, b], minlength=count)
    size = np.trace(matrix, axis1=1, axis2=2)
    matrix += np.maximum(size, 1e-300)[:, None, None] * normal[:, :, None] * normal[:, None, :]
    # faces with neighbours on one line only know nothing across it
    gradient = np.linalg.pinv(matrix, rcond=1e-2, hermitian=True) @ mixed
    return np.trace(gradient, axis1=1, axis2=2)
