"""Joining cells: small control volumes into a neighbour, and faces that come to connect the same two cells."""

from __future__ import annotations

import numpy as np

from spaceplane.mesh.compiled import kernel


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


@kernel
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


@kernel
def combine_faces(faces, area, center, cells):
    """Turn faces to point from the lower to the higher cell, order them by cells and add up duplicates.

    Faces inside one cell, and those with a cell number below 0, are dropped. Centroids are weighted by area.

    Args:
        faces: [face, 2] cells; area: [face, xyz] from the first to the second; center: [face, xyz].
        cells: number of cells.

    Returns:
        faces [face, 2] int32, area and center of the combined faces.
    """
    start = np.zeros(cells + 1, np.int64)
    for f in range(len(faces)):
        if faces[f, 0] >= 0 and faces[f, 1] >= 0 and faces[f, 0] != faces[f, 1]:
            start[min(faces[f, 0], faces[f, 1]) + 1] += 1
    for c in range(cells):
        start[c + 1] += start[c]
    fill = start[:-1].copy()
    listed = np.empty(start[cells], np.int64)
    for f in range(len(faces)):
        if faces[f, 0] >= 0 and faces[f, 1] >= 0 and faces[f, 0] != faces[f, 1]:
            low = min(faces[f, 0], faces[f, 1])
            high = max(faces[f, 0], faces[f, 1])
            # insertion sort by the higher cell: a cell has few faces
            at = fill[low]
            while at > start[low] and max(faces[listed[at - 1], 0], faces[listed[at - 1], 1]) > high:
                listed[at] = listed[at - 1]
                at -= 1
            listed[at] = f
            fill[low] += 1
    pairs = np.empty((len(listed), 2), np.int32)
    vectors = np.zeros((len(listed), 3))
    middle = np.zeros((len(listed), 3))
    n = 0
    for c in range(cells):
        at = start[c]
        while at < start[c + 1]:
            f = listed[at]
            high = max(faces[f, 0], faces[f, 1])
            pairs[n, 0] = c
            pairs[n, 1] = high
            total = 0.0
            begin = at
            while at < start[c + 1] and max(faces[listed[at], 0], faces[listed[at], 1]) == high:
                g = listed[at]
                sign = 1.0 if faces[g, 0] == c else -1.0
                size = abs(area[g, 0]) + abs(area[g, 1]) + abs(area[g, 2]) + 1e-300
                total += size
                for d in range(3):
                    vectors[n, d] += sign * area[g, d]
                    middle[n, d] += size * center[g, d]
                at += 1
            for d in range(3):
                middle[n, d] = center[f, d] if at == begin + 1 else middle[n, d] / total
            n += 1
    return pairs[:n].copy(), vectors[:n].copy(), middle[:n].copy()


@kernel
def outward_sums(cells, faces, area, far_cell, far_area):
    """[cell, xyz] sum of the outward area vectors of each cell's interior and far-field faces.

    Args:
        cells: number of cells.
        faces: [face, 2] cells, the area vector pointing from the first to the second.
        area: [face, xyz].
        far_cell, far_area: [far face] cell and outward area vector.
    """
    total = np.zeros((cells, 3))
    for f in range(len(faces)):
        for d in range(3):
            total[faces[f, 0], d] += area[f, d]
            total[faces[f, 1], d] -= area[f, d]
    for f in range(len(far_cell)):
        for d in range(3):
            total[far_cell[f], d] += far_area[f, d]
    return total


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
