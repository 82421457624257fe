"""Joining cells: small control volumes into a neighbour, and faces that come to connect the same two cells."""

from __future__ import annotations

import numpy as np
from numba import njit


def merge_small(volume: np.ndarray, limit: np.ndarray, faces: np.ndarray, area: np.ndarray) -> np.ndarray:
    """Join cells smaller than their limit across their largest face, the smallest first.

    Args:
        volume: [cell].
        limit: [cell] smallest volume allowed.
        faces: [face, 2] cells.
        area: [face] fluid area.

    Returns:
        [cell] the cell that stands for the cluster (itself when untouched).
    """
    small = volume < limit
    near = np.flatnonzero(small[faces[:, 0]] | small[faces[:, 1]])
    ends = faces[near]
    weight = area[near]
    origin = np.concatenate([ends[:, 0], ends[:, 1]])
    target = np.concatenate([ends[:, 1], ends[:, 0]])
    size = np.concatenate([weight, weight])
    order = np.argsort(origin, kind="stable")
    start = np.zeros(len(volume) + 1, np.int64)
    np.cumsum(np.bincount(origin, minlength=len(volume)), out=start[1:])
    first = np.flatnonzero(small)
    first = first[np.argsort(volume[first], kind="stable")]
    return _merge(volume.copy(), limit.copy(), first, start, target[order], size[order])


@njit(cache=True)
def _merge(volume, limit, first, start, target, size):
    """Greedy merging; `first` lists the small cells by rising volume."""
    count = len(volume)
    root = np.arange(count)
    following = np.full(count, -1)  # linked list of a cluster's members
    last = np.arange(count)
    total = np.zeros(count)
    touched = np.empty(count, np.int64)
    for seed in first:
        while True:
            r = root[seed]
            if volume[r] >= limit[r]:
                break
            seen = 0
            member = r
            while member >= 0:
                for n in range(start[member], start[member + 1]):
                    other = root[target[n]]
                    if other != r:
                        if total[other] == 0.0:
                            touched[seen] = other
                            seen += 1
                        total[other] += size[n] + 1e-300
                member = following[member]
            best = -1
            for n in range(seen):
                if best < 0 or total[touched[n]] > total[best]:
                    best = touched[n]
            for n in range(seen):
                total[touched[n]] = 0.0
            if best < 0:
                break
            # the larger of the two stands for the cluster
            keep, gone = (best, r) if volume[best] >= volume[r] else (r, best)
            member = gone
            while member >= 0:
                root[member] = keep
                member = following[member]
            following[last[keep]] = gone
            last[keep] = last[gone]
            volume[keep] += volume[gone]
            limit[keep] = max(limit[keep], limit[gone])
    return root


def combine_faces(faces: np.ndarray, area: np.ndarray, center: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Turn faces to point from the lower to the higher cell, order them by cells and add up duplicates.

    Faces inside one cell are dropped. Centroids are weighted by area.

    Args:
        faces: [face, 2] cells; area: [face, xyz] from the first to the second; center: [face, xyz].

    Returns:
        faces [face, 2] int32, area and center of the combined faces.
    """
    kept = np.flatnonzero(faces[:, 0] != faces[:, 1])
    faces = faces[kept].astype(np.int64)
    flip = faces[:, 0] > faces[:, 1]
    key = np.where(flip, (faces[:, 1] << 32) + faces[:, 0], (faces[:, 0] << 32) + faces[:, 1])
    order = np.argsort(key, kind="stable")
    key = key[order]
    kept = kept[order]
    first = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1]]))
    vectors = np.where(flip[order, None], -area[kept], area[kept])
    middle = center[kept]
    if len(first) < len(key):
        weight = np.linalg.norm(vectors, axis=1) + 1e-300
        combined = np.add.reduceat(middle * weight[:, None], first) / np.add.reduceat(weight, first)[:, None]
        alone = np.diff(np.concatenate([first, [len(key)]])) == 1
        combined[alone] = middle[first[alone]]
        vectors, middle = np.add.reduceat(vectors, first), combined
    key = key[first]
    return np.stack([key >> 32, key & 0xFFFFFFFF], axis=1).astype(np.int32), vectors, middle


def morton_order(place: np.ndarray) -> np.ndarray:
    """Order that visits integer places [cell, ijk] along a Morton curve."""
    code = np.zeros(len(place), np.uint64)
    for axis in range(3):
        bits = place[:, axis].astype(np.uint64) & np.uint64(0x1FFFFF)
        for shift, mask in (
            (32, 0x1F00000000FFFF),
            (16, 0x1F0000FF0000FF),
            (8, 0x100F00F00F00F00F),
            (4, 0x10C30C30C30C30C3),
            (2, 0x1249249249249249),
        ):
            bits = (bits | (bits << np.uint64(shift))) & np.uint64(mask)
        code |= bits << np.uint64(2 - axis)
    return np.argsort(code, kind="stable")
