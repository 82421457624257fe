"""Fluid regions on the faces of cut cells, from the cut edges and the grid-line crossings of a subdivision.

A cut edge lies in one face and has fluid on a known side. Together with the fluid intervals of the face's four edges
the cut edges form closed loops; union-find over their shared vertices gives the regions, Green's theorem their areas.
"""

from __future__ import annotations

import numpy as np

from spaceplane.kernelcache import inner
from spaceplane.mesh.compiled import kernel
from spaceplane.mesh.unionfind import find, unite

# Overlap along a grid line, in cells, that is not round-off.
OVERLAP = 1e-7


@kernel
def node_states(shape, vertex_place, line_axis, sign):
    """[i, j, k] int8: 1 at grid nodes in the fluid, 0 in the body, summed from crossings up the z lines.

    Args:
        shape: (i, j, k) nodes of the window.
        vertex_place: [crossing, ijk] plane indices, and the slab along the line.
        line_axis: [crossing] axis along which the grid line runs.
        sign: [crossing] +1 where the line enters the fluid going up, -1 where it leaves it.
    """
    state = np.zeros(shape, np.int8)
    for n in range(len(sign)):
        if line_axis[n] == 2:
            state[vertex_place[n, 0], vertex_place[n, 1], vertex_place[n, 2] + 1] += sign[n]
    for i in range(shape[0]):
        for j in range(shape[1]):
            total = 1
            for k in range(shape[2]):
                total += state[i, j, k]
                state[i, j, k] = total
    return state


@kernel
def edge_intervals(cells, states, points, cross_start, cross_items, vertex, sign):
    """Fluid intervals of the three lower edges of every cut cell.

    An interval begins at a fluid node or an entering crossing and ends at a leaving crossing or a fluid node; sorted
    beginnings are paired with sorted ends, so that crossings misplaced by round-off change no connection.

    Args:
        cells: [cell, ijk] cut cells.
        states: [i, j, k] from `node_states`.
        points: [vertex, xyz] in grid coordinates.
        cross_start, cross_items: crossings of each edge, see `unionfind.bucket`.
        vertex, sign: [crossing] vertex, and +1 where the edge enters the fluid going up.

    Returns:
        start [3 * cell + axis + 1], begin [interval], end [interval]: vertices, -1 the lower node, -2 the upper node.
        The number of edges whose node state is neither 0 nor 1, or whose crossings do not alternate (folded surfaces).
    """
    count = len(cells)
    start = np.empty(3 * count + 1, np.int32)
    capacity = 6 * count + 2 * len(vertex) + 16
    begin = np.empty(capacity, np.int32)
    end = np.empty(capacity, np.int32)
    longest = 1
    for n in range(3 * count):
        longest = max(longest, cross_start[n + 1] - cross_start[n])
    enter = np.empty(longest + 300, np.int32)
    leave = np.empty(longest + 300, np.int32)
    total = 0
    folded = 0
    for c in range(count):
        for axis in range(3):
            n = 3 * c + axis
            start[n] = total
            i, j, k = cells[c, 0], cells[c, 1], cells[c, 2]
            below = states[i, j, k]
            above = states[i + (axis == 0), j + (axis == 1), k + (axis == 2)]
            if below < 0 or below > 1:
                folded += 1
            entering = 0
            leaving = 0
            for _ in range(max(below, 0)):
                enter[entering] = -1
                entering += 1
            for _ in range(max(-below, 0)):
                leave[leaving] = -1
                leaving += 1
            for m in range(cross_start[n], cross_start[n + 1]):
                w = cross_items[m]
                ends = enter if sign[w] > 0 else leave
                at = entering if sign[w] > 0 else leaving
                while at > 0 and ends[at - 1] >= 0 and points[ends[at - 1], axis] > points[vertex[w], axis]:
                    ends[at] = ends[at - 1]
                    at -= 1
                ends[at] = vertex[w]
                if sign[w] > 0:
                    entering += 1
                else:
                    leaving += 1
            for _ in range(max(above, 0)):
                leave[leaving] = -2
                leaving += 1
            for _ in range(max(-above, 0)):
                enter[entering] = -2
                entering += 1
            for m in range(min(entering, leaving)):
                # an interval that ends before it begins by more than round-off lies where the surface overlaps itself
                lower = 0.0 if enter[m] == -1 else (1.0 if enter[m] == -2 else points[enter[m], axis] - cells[c, axis])
                upper = 0.0 if leave[m] == -1 else (1.0 if leave[m] == -2 else points[leave[m], axis] - cells[c, axis])
                if upper < lower - OVERLAP and 0 <= below <= 1:
                    folded += 1
                if total < capacity:
                    begin[total] = enter[m]
                    end[total] = leave[m]
                    total += 1
    start[3 * count] = total
    return start, begin[:total], end[:total], folded


@kernel
def list_faces(cells, cell_index):
    """Faces of the cut cells.

    Returns:
        axis [face], lower corner [face, ijk], cut cell below and above (-1 where that cell is not cut) [face, 2],
        faces of each cut cell [cell, 2 * axis + side].
    """
    count = len(cells)
    axes = np.empty(6 * count, np.int8)
    corner = np.empty((6 * count, 3), np.int32)
    beside = np.empty((6 * count, 2), np.int32)
    cell_faces = np.empty((count, 6), np.int32)
    total = 0
    for c in range(count):
        for axis in range(3):
            i, j, k = cells[c, 0] - (axis == 0), cells[c, 1] - (axis == 1), cells[c, 2] - (axis == 2)
            below = cell_index[i, j, k]
            axes[total] = axis
            for d in range(3):
                corner[total, d] = cells[c, d]
            beside[total, 0] = below
            beside[total, 1] = c
            cell_faces[c, 2 * axis] = total
            if below >= 0:
                cell_faces[below, 2 * axis + 1] = total
            total += 1
            i, j, k = cells[c, 0] + (axis == 0), cells[c, 1] + (axis == 1), cells[c, 2] + (axis == 2)
            if cell_index[i, j, k] < 0:
                axes[total] = axis
                corner[total, 0] = i
                corner[total, 1] = j
                corner[total, 2] = k
                beside[total, 0] = c
                beside[total, 1] = -1
                cell_faces[c, 2 * axis + 1] = total
                total += 1
    return axes[:total].copy(), corner[:total].copy(), beside[:total].copy(), cell_faces


@inner
def _add_element(n, u0, v0, u1, v1, a, b, loops, ends):
    """Store the directed loop element (u0, v0) -> (u1, v1) between vertices a and b."""
    loops[n, 0] = u0
    loops[n, 1] = v0
    loops[n, 2] = u1
    loops[n, 3] = v1
    ends[n, 0] = a
    ends[n, 1] = b


@inner
def _gather(face, axes, corner, cell_index, states, points, segments, intervals, loops, ends, slot_count):
    """Collect the loop elements of a face: its cut edges first, then the fluid intervals of its four edges."""
    segment_start, segment_items, edge_ends = segments
    interval_start, begin, end = intervals
    axis = axes[face]
    b = (axis + 1) % 3
    c = (axis + 2) % 3
    at = corner[face]
    owner = cell_index[at[0], at[1], at[2]]
    n = 0
    if owner >= 0:
        for m in range(segment_start[3 * owner + axis], segment_start[3 * owner + axis + 1]):
            e = segment_items[m]
            p = edge_ends[e, 0]
            q = edge_ends[e, 1]
            _add_element(
                n,
                points[p, b] - at[b],
                points[p, c] - at[c],
                points[q, b] - at[b],
                points[q, c] - at[c],
                p,
                q,
                loops,
                ends,
            )
            n += 1
    for slot in range(4):
        # slots run round the face: along b below, along c right, along b above, along c left
        along = b if slot % 2 == 0 else c
        i, j, k = at[0], at[1], at[2]
        if slot == 1:
            i, j, k = i + (b == 0), j + (b == 1), k + (b == 2)
        elif slot == 2:
            i, j, k = i + (c == 0), j + (c == 1), k + (c == 2)
        cell = cell_index[i, j, k]
        state = states[i, j, k]
        low_corner = -3 - (0 if slot == 0 or slot == 3 else (1 if slot == 1 else 3))
        high_corner = -3 - (1 if slot == 0 else (3 if slot == 3 else 2))
        if cell >= 0:
            first = interval_start[3 * cell + along]
            count = interval_start[3 * cell + along + 1] - first
        else:
            first = -1
            count = abs(state)
        slot_count[slot] = count
        for m in range(count):
            p = begin[first + m] if cell >= 0 else (-1 if state > 0 else -2)
            q = end[first + m] if cell >= 0 else (-2 if state > 0 else -1)
            s = 0.0 if p == -1 else (1.0 if p == -2 else points[p, along] - at[along])
            t = 0.0 if q == -1 else (1.0 if q == -2 else points[q, along] - at[along])
            p = low_corner if p == -1 else (high_corner if p == -2 else p)
            q = low_corner if q == -1 else (high_corner if q == -2 else q)
            if slot == 0:
                _add_element(n, s, 0.0, t, 0.0, p, q, loops, ends)
            elif slot == 1:
                _add_element(n, 1.0, s, 1.0, t, p, q, loops, ends)
            elif slot == 2:
                _add_element(n, t, 1.0, s, 1.0, q, p, loops, ends)
            else:
                _add_element(n, 0.0, t, 0.0, s, q, p, loops, ends)
            n += 1
    return n


@inner
def _connect(n, ends, parent, vertex_element):
    """Union-find over elements that share a vertex. `vertex_element` is scratch of -1 and is left so."""
    corners = np.full(4, -1, np.int32)
    for m in range(n):
        parent[m] = m
    for m in range(n):
        for side in range(2):
            v = ends[m, side]
            if v < 0:
                if corners[-3 - v] < 0:
                    corners[-3 - v] = m
                else:
                    unite(parent, corners[-3 - v], m)
            elif vertex_element[v] < 0:
                vertex_element[v] = m
            else:
                unite(parent, vertex_element[v], m)
    for m in range(n):
        for side in range(2):
            if ends[m, side] >= 0:
                vertex_element[ends[m, side]] = -1


@inner
def _surrounding(hole, n, loops, parent):
    """Root of the loop that the ray from a hole along the first axis meets first, or -1."""
    u = 0.0
    v = 0.0
    for m in range(n):
        if find(parent, m) == hole:
            u = loops[m, 0]
            v = loops[m, 1]
            break
    best = -1
    nearest = 1e300
    for m in range(n):
        if (loops[m, 1] <= v) == (loops[m, 3] <= v) or find(parent, m) == hole:
            continue
        s = loops[m, 0] + (loops[m, 2] - loops[m, 0]) * (v - loops[m, 1]) / (loops[m, 3] - loops[m, 1])
        if u <= s < nearest:
            nearest = s
            best = find(parent, m)
    return best


@inner
def _join_holes(n, cut, loops, parent, area):
    """Join loops that wind round the body inside the face (no face edge, negative area) to the region around them."""
    for m in range(n):
        area[m] = 0.0
    others = 0
    other = -1
    for m in range(n):
        area[find(parent, m)] += 0.5 * (loops[m, 0] * loops[m, 3] - loops[m, 2] * loops[m, 1])
    touches = np.zeros(n, np.bool_)
    for m in range(cut, n):
        touches[find(parent, m)] = True
    for m in range(n):
        if parent[m] == m and (touches[m] or area[m] >= 0.0):
            others += 1
            if other < 0 or area[m] > area[other]:
                other = m
    if other < 0:
        return
    for m in range(n):
        if parent[m] == m and not touches[m] and area[m] < 0.0:
            around = other
            if others > 1:
                hit = _surrounding(m, n, loops, parent)
                around = hit if hit >= 0 else other
            # the larger of the two decides later holes, so keep its area at the root
            total = area[m] + area[find(parent, around)]
            unite(parent, m, around)
            root = find(parent, m)
            area[root] = total
            touches[root] = True


@kernel
def face_regions(axes, corner, cell_index, states, points, segments, intervals):
    """Fluid regions of all faces of cut cells.

    Args:
        axes, corner: [face] from `list_faces`.
        cell_index: [i, j, k] number of the cut cell, or -1.
        states, points: as for `edge_intervals`.
        segments: cut edges of the face 3 * (cell above) + axis, see `unionfind.bucket`, and [edge, 2] their vertices.
        intervals: what `edge_intervals` returned.

    Returns:
        region_face [region], region_area [region], region_moment [region, 2] (first moments along the face's two axes
        from its lower corner), segment_region [edge] (-1: not a cut edge), slot_start [face * 4 + slot + 1] and
        slot_region: region of each fluid interval of each face edge.
    """
    segment_start, _, edge_ends = segments
    interval_start = intervals[0]
    faces = len(axes)
    widest = 0
    for n in range(len(segment_start) - 1):
        widest = max(widest, segment_start[n + 1] - segment_start[n])
    deepest = 1
    for n in range(len(interval_start) - 1):
        deepest = max(deepest, interval_start[n + 1] - interval_start[n])
    size = widest + 4 * max(deepest, 128) + 8
    loops = np.empty((size, 4))
    ends = np.empty((size, 2), np.int32)
    parent = np.empty(size, np.int32)
    label = np.empty(size, np.int32)
    area = np.empty(size)
    slot_count = np.zeros(4, np.int32)
    vertex_element = np.full(len(points), -1, np.int32)
    capacity = faces + segment_start[-1] + len(intervals[1]) + 8
    region_face = np.empty(capacity, np.int32)
    region_area = np.zeros(capacity)
    region_moment = np.zeros((capacity, 2))
    segment_region = np.full(len(edge_ends), -1, np.int32)
    slot_start = np.empty(4 * faces + 1, np.int32)
    slot_region = np.empty(8 * faces + 8 * len(intervals[1]), np.int32)
    regions = 0
    slots = 0
    for face in range(faces):
        n = _gather(face, axes, corner, cell_index, states, points, segments, intervals, loops, ends, slot_count)
        _connect(n, ends, parent, vertex_element)
        cut = n - slot_count.sum()
        if cut > 0:
            _join_holes(n, cut, loops, parent, area)
        for m in range(n):
            label[m] = -1
        for m in range(n):
            root = find(parent, m)
            if label[root] < 0:
                label[root] = regions
                region_face[regions] = face
                regions += 1
            r = label[root]
            u0, v0, u1, v1 = loops[m, 0], loops[m, 1], loops[m, 2], loops[m, 3]
            cross = u0 * v1 - u1 * v0
            region_area[r] += 0.5 * cross
            region_moment[r, 0] += (u0 + u1) * cross / 6.0
            region_moment[r, 1] += (v0 + v1) * cross / 6.0
        if cut > 0:
            owner = cell_index[corner[face, 0], corner[face, 1], corner[face, 2]]
            base = segment_start[3 * owner + axes[face]]
            for m in range(cut):
                segment_region[segments[1][base + m]] = label[find(parent, m)]
        m = cut
        for slot in range(4):
            slot_start[4 * face + slot] = slots
            for _ in range(slot_count[slot]):
                slot_region[slots] = label[find(parent, m)]
                slots += 1
                m += 1
    slot_start[4 * faces] = slots
    return (
        region_face[:regions].copy(),
        region_area[:regions].copy(),
        region_moment[:regions].copy(),
        segment_region,
        slot_start,
        slot_region[:slots].copy(),
    )
