"""Carrying cell values from one mesh to another."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from spaceplane.mesh.mesh import Mesh


def nearest_cells(source: Mesh, target: Mesh) -> np.ndarray:
    """[target cell] int32 cell of `source` whose centroid lies nearest to the target cell's centroid.

    For meshes that are not nested; nested ones come with an exact map from `coarsen` or `sequence`.
    """
    _, index = cKDTree(source.cell_center).query(target.cell_center)
    return index.astype(np.int32)


def restrict(values: np.ndarray, fine: Mesh, coarse: Mesh, coarse_cell: np.ndarray) -> np.ndarray:
    """Volume-weighted means of fine cell values [cell, ...] over nested coarse cells.

    Args:
        coarse_cell: [fine cell] coarse cell that holds it.
    """
    flat = values.reshape(len(values), -1)
    total = np.stack(
        [np.bincount(coarse_cell, fine.cell_volume * column, minlength=coarse.cells) for column in flat.T], axis=1
    )
    return (total / coarse.cell_volume[:, None]).reshape(coarse.cells, *values.shape[1:])
