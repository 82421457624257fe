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
        """Entries at places [n, ijk]; outside the window -1, or False where entries are bool."""
        local = place - self.origin
        inside = ((local >= 0) & (local < self.array.shape)).all(axis=1)
        found = np.full(len(place), False if self.array.dtype == bool else -1, self.array.dtype)
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
        index: [level] windows with the leaf of each cell, -1 where none.
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
    index: tuple[Window, ...]


def refined_levels(
    cut: Window,
    fine: Window,
    wall_level: int,
    size: np.ndarray,
    levels: int,
    wall_layers: int,
    growth_layers: int,
    boxes: list,
    wanted: dict[int, Window],
) -> tuple[list, list]:
    """Which cells of each level are refined.

    Args:
        cut: cut cells on level 0.
        fine: those cells of `wall_level` with cut cells in them that distance from the wall alone keeps that size.
        wall_level: level of the finest walls that the settings ask for; only `wanted` makes cells below it.
        size: [3] domain in cells of the top level.
        levels: number of the top level.
        wall_layers: layers of cells of `wall_level` around the cut ones.
        growth_layers: layers of each coarser level.
        boxes: (level, lower, upper) in level-0 cells: no cell there is coarser than `level`.
        wanted: by level, cells that shall be refined whatever their distance from the wall.

    Returns:
        [level] Window of cells that are refined into the level below; entry 0 is the cut cells, the last covers
        the domain. And [level] the largest cubes that are refined only because the surface is cut on level 0: what air
        connects in one of them is to be joined again.
    """
    walls = [cut]
    for _ in range(levels):
        walls.append(parents(walls[-1]))
    targets: list[Window] = [Window(cut.origin, np.zeros_like(cut.array))]
    chain, layers = fine, wall_layers
    for level in range(1, levels + 1):
        extent = size * 2 ** (levels - level)
        near = Window(walls[level].origin, np.zeros_like(walls[level].array))
        if level > wall_level:
            near = parents(_dilate(chain, layers, extent * 2))
        for at_level, lower, upper in boxes:
            if at_level < level:
                low = np.clip(np.floor(np.asarray(lower) / 2**level).astype(np.int64), 0, extent - 1)
                high = np.clip(np.ceil(np.asarray(upper) / 2**level).astype(np.int64), low + 1, extent)
                near = _mark(near, low, high)
        if level > wall_level:
            chain = union(near, walls[level]) if level == wall_level + 1 else near
            layers = growth_layers
        target = union(near, wanted[level]) if level in wanted else near
        if (wanted or level <= wall_level + 1) and targets[-1].array.any():
            # neighbours of split cells exist on their level: 2:1
            target = union(target, parents(_dilate(targets[-1], 1, extent * 2)))
        targets.append(target)
    refined = [cut] + [union(target, wall) for target, wall in zip(targets[1:], walls[1:], strict=True)]
    blocks = [
        Window(wall.origin, wall.array & ~_within(target, wall) & _parents_in(targets, level, wall))
        for level, (target, wall) in enumerate(zip(targets, walls, strict=True))
    ]
    top = np.zeros(size, bool)
    last = refined[-1]
    top[_slices(last, np.zeros(3, np.int64))] = last.array
    refined[-1] = Window(np.zeros(3, np.int64), top)
    return refined, blocks


def ancestors(cut: Window, level: int) -> Window:
    """Cells of `level` with a marked cell of level 0 in them."""
    for _ in range(level):
        cut = parents(cut)
    return cut


def window_of(places: np.ndarray, extent: np.ndarray) -> Window:
    """Window that marks the given places [n, ijk]; those outside `extent` are dropped."""
    places = places[((places >= 0) & (places < extent)).all(axis=1)]
    low = places.min(axis=0) if len(places) else np.zeros(3, np.int64)
    high = places.max(axis=0) + 1 if len(places) else np.ones(3, np.int64)
    array = np.zeros(high - low, bool)
    array[tuple((places - low).T)] = True
    return Window(low, array)


def union(a: Window, b: Window) -> Window:
    """What either window marks."""
    origin = np.minimum(a.origin, b.origin)
    array = np.zeros(np.maximum(a.origin + a.array.shape, b.origin + b.array.shape) - origin, bool)
    for window in (a, b):
        array[_slices(window, origin)] |= window.array
    return Window(origin, array)


def _within(window: Window, frame: Window) -> np.ndarray:
    """What `window` marks of the cells that `frame` covers."""
    found = np.zeros(frame.array.shape, bool)
    low = np.maximum(window.origin, frame.origin)
    high = np.minimum(window.origin + window.array.shape, frame.origin + frame.array.shape)
    if (low < high).all():
        here, there = (
            tuple(slice(a, b) for a, b in zip(low - w.origin, high - w.origin, strict=True)) for w in (frame, window)
        )
        found[here] = window.array[there]
    return found


def _parents_in(targets: list, level: int, frame: Window) -> np.ndarray:
    """Whether the parents of the cells of `level` in `frame` are among the targets; the top level's all are."""
    if level + 1 == len(targets):
        return np.ones(frame.array.shape, bool)
    return _within(_children(targets[level + 1]), frame)


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


def parents(window: Window) -> Window:
    """Cells of the next level with a marked child."""
    low = window.origin // 2
    high = -((-(window.origin + window.array.shape)) // 2)
    shape = high - low
    padded = np.zeros(2 * shape, bool)
    padded[_slices(window, 2 * low)] = window.array
    padded = padded[0::2] | padded[1::2]
    padded = padded[:, 0::2] | padded[:, 1::2]
    return Window(low, padded[:, :, 0::2] | padded[:, :, 1::2])


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
        faces, far, open_sides = _connect(
            places[level],
            first,
            extent,
            exists[level].array,
            indices[level].array,
            exists[level].origin,
            indices[coarse].array,
            indices[coarse].origin,
        )
        parts += [faces, _across_levels(open_sides, places[level], first, level, indices)]
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
        index=tuple(indices),
    )


def _across_levels(open_sides: np.ndarray, places: np.ndarray, first: int, level: int, indices: list) -> np.ndarray:
    """Faces [face, 5] of leaves with leaves two or more levels coarser, as they occur in cubes of coarse wall.

    Args:
        open_sides: [n, (leaf, axis, side)] where neither this level nor the next has a leaf; most lie in the body.
    """
    leaf, axis, side = open_sides.T
    at = places[leaf - first].astype(np.int64)
    at[np.arange(len(leaf)), axis] += 2 * side - 1
    other = np.full(len(leaf), -1, np.int64)
    for up in range(level + 2, len(indices)):
        found = indices[up].at(at >> (up - level))
        other = np.where(other >= 0, other, found)
    met = other >= 0
    leaf, axis, side, other = leaf[met], axis[met], side[met], other[met]
    below, above = np.where(side == 1, leaf, other), np.where(side == 1, other, leaf)
    return np.stack([below, above, axis, leaf, side], axis=1).astype(np.int32)


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
    """Faces of one level's leaves with leaves of the same level (seen from below) and of the next coarser one.

    Also the faces on the boundary of the domain, and the sides where neither level has a leaf.
    """
    count = len(places)
    faces = np.empty((6 * count, 5), np.int32)
    far = np.empty((6 * count, 3), np.int32)
    open_sides = np.empty((6 * count, 3), np.int32)
    n = 0
    m = 0
    open_count = 0
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
                    inside = 0 <= a < coarse_index.shape[0] and 0 <= b < coarse_index.shape[1]
                    inside = inside and 0 <= c < coarse_index.shape[2]
                    other = coarse_index[a, b, c] if inside else -1
                    if other < 0:
                        open_sides[open_count, 0] = first + leaf
                        open_sides[open_count, 1] = axis
                        open_sides[open_count, 2] = side
                        open_count += 1
                        continue
                faces[n, 0] = first + leaf if side == 1 else other
                faces[n, 1] = other if side == 1 else first + leaf
                faces[n, 2] = axis
                faces[n, 3] = first + leaf
                faces[n, 4] = side
                n += 1
    return faces[:n].copy(), far[:m].copy(), open_sides[:open_count].copy()
