"""Left-right symmetry: without sideslip the flow round a symmetric body is kept exactly symmetric.

Gauss-Seidel orders are not symmetric, so that an iteration in progress is not either; projecting its change on the
symmetric part costs one pass and leaves the converged flow as it is.
"""

from __future__ import annotations

import numpy as np
from numba import prange
from scipy.spatial import cKDTree

from spaceplane.flow.compiled import LANES, kernel


def mirror_cells(center: np.ndarray, volume: np.ndarray) -> np.ndarray:
    """[cell] mirror image in y = 0 of each cell with this centroid and volume; empty unless all cells have one."""
    none = np.zeros(0, dtype=np.int32)
    size = np.cbrt(volume)
    if abs(center[:, 1] @ volume) > 1e-6 * volume.sum() * size.max():
        return none
    distance, image = cKDTree(center).query(center * [1.0, -1.0, 1.0], distance_upper_bound=1e-6 * size.max())
    if not np.isfinite(distance).all() or (distance > 1e-6 * size).any():
        return none
    paired = np.array_equal(image[image], np.arange(len(image)))
    return image.astype(np.int32) if paired and np.allclose(volume[image], volume, rtol=1e-6) else none


@kernel
def symmetrise(mirror, change, share):
    """Replace `change` [cell, 5, lane] by (1 - share) itself + share its mirror image; share [lane] is 0.5 or 0."""
    for i in prange(change.shape[0]):
        j = mirror[i]
        if i <= j:
            for k in range(5):
                real = type(share[0])
                sign = real(-1) if k == 2 else real(1)
                for n in range(LANES):
                    s = share[n]
                    a = change[i, k, n]
                    b = sign * change[j, k, n]
                    d = s * (b - a)
                    change[i, k, n] = a + d
                    change[j, k, n] = sign * (b - d)
