"""The octree outside the cut cells: levels, leaves, and the faces between them.

Level 0 is the wall-cell size, level l is 2^l times larger. Places are integers in units of the level's own cells,
counted from the corner of the domain. A window is a dense array over part of a level with the place of its first entry.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spaceplane.mesh.compiled import kernel


@dataclass(frozen=True)
class Window:
    """A dense array over part of one octree level.

    Attributes:
        origin: (i, j, k) place of entry [0, 0, 0].
        array: [i, j, k].
    """

    origin: np.ndarray
    array: np.ndarray

    def at(self, place: np.ndarray) -> np.ndarray:
        """Entries at places [n, ijk], -1 outside the window."""
        local = place - self.origin
        inside = ((local >= 0) & (local < self.array.shape)).all(axis=1)
        found = np.full(len(place), -1, self.array.dtype)
        found[inside] = self.array[tuple(local[inside].T)]
        return found


@dataclass(frozen=True)
class Leaves:
    """Uncut fluid cells of the octree and the faces between them.

    Attributes:
        level: [leaf] int8.
        place: [leaf, ijk] int32 in cells of its level.
        face_leaves: [face, 2] leaf below and above.
        face_axis: [face] axis of the normal.
        face_fine: [face] the finer of the two leaves (the first when equal).
        face_side: [face] side of the finer leaf that the face lies on, 0 below, 1 above.
        far_leaf, far_axis, far_side: the same for faces on the boundary of the domain.
        index: windows of levels 0 and 1 with the leaf of each cell, -1 where none.
    """

    level: np.ndarray
    place: np.ndarray
    face_leaves: np.ndarray
    face_axis: np.ndarray
    face_fine: np.ndarray
    face_side: np.ndarray
    far_leaf: np.ndarray
    far_axis: np.ndarray
    far_side: np.ndarray
    index: tuple[Window, Window]


def refined_levels(
    cut: Window, fine: Window, size: np.ndarray, levels: int, wall_layers: int, growth_layers: int, boxes: list
) -> tuple[list, Window]:
    """Which cells of each level are refined.

    Args:
        cut: cut cells on level 0.
        fine: those of them that shall stay cells of level 0, in an equal window.
        size: [3] domain in cells of the top level.
        levels: number of the top level.
        wall_layers: layers of level-0 cells around the cut cells.
        growth_layers: layers of each coarser level.
        boxes: (level, lower, upper) in level-0 cells: no cell there is coarser than `level`.

    Returns:
        [level] Window of cells that are refined into the level below; entry 0 is the cut cells, the last covers
        the domain. And the cells of level 1 that are refined only because they are cut: to be joined again.
    """
    refined = [cut]
    for level in range(1, levels + 1):
        extent = size * 2 ** (levels - level)
        grown = _dilate(fine if level == 1 else refined[-1], wall_layers if level == 1 else growth_layers, extent * 2)
        window = _parents(grown)
        for at_level, lower, upper in boxes:
            if at_level < level:
                low = np.clip(np.floor(np.asarray(lower) / 2**level).astype(np.int64), 0, extent - 1)
                high = np.clip(np.ceil(np.asarray(upper) / 2**level).astype(np.int64), low + 1, extent)
                window = _mark(window, low, high)
        if level == 1:
            cut_parents = _parents(cut)
            here = _slices(cut_parents, window.origin)
            joined = Window(cut_parents.origin, cut_parents.array & ~window.array[here])
            window.array[here] |= cut_parents.array
        refined.append(window)
    top = np.zeros(size, bool)
    last = refined[-1]
    top[_slices(last, np.zeros(3, np.int64))] = last.array
    refined[-1] = Window(np.zeros(3, np.int64), top)
    return refined, joined


def _slices(window: Window, origin: np.ndarray) -> tuple:
    """Where `window` lies in an array that begins at `origin`."""
    return tuple(slice(s, s + n) for s, n in zip(window.origin - origin, window.array.shape, strict=True))


def _dilate(window: Window, layers: int, extent: np.ndarray) -> Window:
    """Grow the marked cells by `layers` in all 26 directions, within the domain."""
    low = np.maximum(window.origin - layers, 0)
    high = np.minimum(window.origin + window.array.shape + layers, extent)
    grown = np.zeros(high - low, bool)
    grown[_slices(window, low)] = window.array
    for axis in range(3):
        done = 0
        while done < layers:
            step = min(layers - done, max(done, 1))
            before = grown.copy()
            lower = tuple(slice(None, -step) if d == axis else slice(None) for d in range(3))
            upper = tuple(slice(step, None) if d == axis else slice(None) for d in range(3))
            grown[lower] |= before[upper]
            grown[upper] |= before[lower]
            done += step
    return Window(low, grown)


def _parents(window: Window) -> Window:
    """Cells of the next level with a marked child."""
    low = window.origin // 2
    high = -((-(window.origin + window.array.shape)) // 2)
    shape = high - low
    padded = np.zeros(2 * shape, bool)
    padded[_slices(window, 2 * low)] = window.array
    return Window(low, padded.reshape(shape[0], 2, shape[1], 2, shape[2], 2).any(axis=(1, 3, 5)))


def _mark(window: Window, low: np.ndarray, high: np.ndarray) -> Window:
    """Mark the box [low, high), enlarging the window where needed."""
    origin = np.minimum(window.origin, low)
    end = np.maximum(window.origin + window.array.shape, high)
    array = np.zeros(end - origin, bool)
    array[_slices(window, origin)] = window.array
    array[tuple(slice(a, b) for a, b in zip(low - origin, high - origin, strict=True))] = True
    return Window(origin, array)


def _children(window: Window) -> Window:
    """Cells of the level below that exist because their parent is refined."""
    array = window.array.repeat(2, axis=0).repeat(2, axis=1).repeat(2, axis=2)
    return Window(2 * window.origin, array)


def count_leaves(refined: list) -> int:
    """Number of cells before those inside the body are taken out."""
    total = 0
    for level in range(len(refined)):
        exists = 8 * int(refined[level + 1].array.sum()) if level + 1 < len(refined) else refined[-1].array.size
        total += exists - (int(refined[level].array.sum()) if level else 0)
    return total


def build_leaves(refined: list, fluid: Window) -> Leaves:
    """Number the uncut fluid leaves of all levels and connect them.

    Args:
        refined: from `refined_levels`.
        fluid: nodes of level 0 that lie in the fluid; outside the window all do.
    """
    indices, exists, levels, places = [], [], [], []
    count = 0
    for level, window in enumerate(refined):
        top = level + 1 == len(refined)
        there = Window(np.zeros(3, np.int64), np.ones_like(window.array)) if top else _children(refined[level + 1])
        index = np.full(there.array.shape, -1, np.int32)
        found = _number(
            there.array, there.origin, window.array, window.origin, fluid.array, fluid.origin, level, index, count
        )
        places.append(found)
        levels.append(np.full(len(found), level, np.int8))
        count += len(found)
        indices.append(Window(there.origin, index))
        exists.append(there)
    parts, far_parts = [], []
    for level in range(len(refined)):
        coarse = min(level + 1, len(refined) - 1)
        first = sum(len(p) for p in places[:level])
        extent = np.array(refined[-1].array.shape, np.int64) * 2 ** (len(refined) - 1 - level)
        faces, far = _connect(
            places[level],
            first,
            extent,
            exists[level].array,
            indices[level].array,
            exists[level].origin,
            indices[coarse].array,
            indices[coarse].origin,
        )
        parts.append(faces)
        far_parts.append(far)
    faces = np.concatenate(parts)
    far = np.concatenate(far_parts)
    return Leaves(
        level=np.concatenate(levels),
        place=np.concatenate(places),
        face_leaves=faces[:, :2].copy(),
        face_axis=faces[:, 2].copy(),
        face_fine=faces[:, 3].copy(),
        face_side=faces[:, 4].copy(),
        far_leaf=far[:, 0].copy(),
        far_axis=far[:, 1].copy(),
        far_side=far[:, 2].copy(),
        index=(indices[0], indices[1]),
    )


@kernel
def _number(there, origin, refined, refined_origin, fluid, fluid_origin, level, index, first):
    """Number the leaves of one level: cells that exist, are not refined and whose lower node lies in the fluid."""
    scale = 2**level
    capacity = 0
    for value in there.ravel():
        capacity += value
    found = np.empty((capacity, 3), np.int32)
    count = 0
    for i in range(there.shape[0]):
        for j in range(there.shape[1]):
            for k in range(there.shape[2]):
                if not there[i, j, k]:
                    continue
                x, y, z = i + origin[0], j + origin[1], k + origin[2]
                a, b, c = x - refined_origin[0], y - refined_origin[1], z - refined_origin[2]
                inside = 0 <= a < refined.shape[0] and 0 <= b < refined.shape[1] and 0 <= c < refined.shape[2]
                if inside and refined[a, b, c]:
                    continue
                a, b, c = x * scale - fluid_origin[0], y * scale - fluid_origin[1], z * scale - fluid_origin[2]
                inside = 0 <= a < fluid.shape[0] and 0 <= b < fluid.shape[1] and 0 <= c < fluid.shape[2]
                if inside and not fluid[a, b, c]:
                    continue
                found[count, 0] = x
                found[count, 1] = y
                found[count, 2] = z
                index[i, j, k] = first + count
                count += 1
    return found[:count].copy()


@kernel
def _connect(places, first, extent, exists, index, origin, coarse_index, coarse_origin):
    """Faces of one level's leaves with leaves of the same level (seen from below) and of the next coarser one."""
    count = len(places)
    faces = np.empty((6 * count, 5), np.int32)
    far = np.empty((6 * count, 3), np.int32)
    n = 0
    m = 0
    at = np.empty(3, np.int64)
    for leaf in range(count):
        for axis in range(3):
            for side in range(2):
                for d in range(3):
                    at[d] = places[leaf, d]
                at[axis] += 2 * side - 1
                if at[axis] < 0 or at[axis] >= extent[axis]:
                    far[m, 0] = first + leaf
                    far[m, 1] = axis
                    far[m, 2] = side
                    m += 1
                    continue
                a, b, c = at[0] - origin[0], at[1] - origin[1], at[2] - origin[2]
                inside = 0 <= a < exists.shape[0] and 0 <= b < exists.shape[1] and 0 <= c < exists.shape[2]
                if inside and exists[a, b, c]:
                    if side == 0 or index[a, b, c] < 0:
                        continue
                    other = index[a, b, c]
                else:
                    a, b, c = (
                        at[0] // 2 - coarse_origin[0],
                        at[1] // 2 - coarse_origin[1],
                        at[2] // 2 - coarse_origin[2],
                    )
                    other = coarse_index[a, b, c]
                    if other < 0:
                        continue
                faces[n, 0] = first + leaf if side == 1 else other
                faces[n, 1] = other if side == 1 else first + leaf
                faces[n, 2] = axis
                faces[n, 3] = first + leaf
                faces[n, 4] = side
                n += 1
    return faces[:n].copy(), far[:m].copy()
