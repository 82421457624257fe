"""Whether a surface is its own mirror image, and which part mirrors which."""

from __future__ import annotations

import numpy as np

from spaceplane.vehicle.surface import Surface

# Relative to the surface's own integrals; above round-off of a boolean union, below any shape change that matters.
TOLERANCE = 1e-8


def mirrored_parts(names: tuple[str, ...]) -> np.ndarray:
    """[part] the part on the other side: `left` and `right` change places in its name; others mirror themselves."""
    swapped = [n.replace("left", "\0").replace("right", "left").replace("\0", "right") for n in names]
    return np.array([names.index(s) if s in names else k for k, s in enumerate(swapped)], dtype=np.int32)


def is_symmetric(surface: Surface, axis: int) -> bool:
    """Whether the surface mirrors itself in the plane through the origin normal to `axis`.

    Compares exact integrals of area, area vector, first and second moments of area, by part: they do not depend on how
    flat patches are triangulated. Parts must mirror by name in y, and onto themselves in other directions.
    """
    partner = mirrored_parts(surface.part_names) if axis == 1 else np.arange(len(surface.part_names))
    corners = surface.corners
    vectors = surface.area_vectors
    area = np.linalg.norm(vectors, axis=1)
    center = surface.centroids
    second = (np.einsum("tci,tcj->tij", corners, corners) + 9.0 * np.einsum("ti,tj->tij", center, center)) / 12.0
    length = np.abs(surface.points).max()
    flip = np.ones(3)
    flip[axis] = -1.0
    fields = (
        (area[:, None], np.ones(1), 1.0),
        (vectors, flip, 1.0),
        (area[:, None] * center, flip, length),
        ((area[:, None, None] * second).reshape(-1, 9), np.outer(flip, flip).ravel(), length**2),
    )
    parts = len(surface.part_names)
    scale = area.sum()
    for values, signs, unit in fields:
        totals = np.stack([np.bincount(surface.part, v, minlength=parts) for v in values.T], axis=1)
        if np.abs(totals[partner] * signs - totals).max() > TOLERANCE * scale * unit:
            return False
    return True
