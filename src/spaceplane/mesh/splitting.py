"""Edges and polygons split at the planes of one axis of the grid, compiled.

Slabs are integers, given to every vertex once; nothing here decides on a coordinate. Coordinates are in wall cells.
"""

from __future__ import annotations

import numpy as np

from spaceplane.kernelcache import inner
from spaceplane.mesh.compiled import kernel


@inner
def _copy_row(target, n, source, m):
    """target[n] = source[m] for rows of three, far quicker to compile than the slice."""
    for d in range(3):
        target[n, d] = source[m, d]


@kernel
def first_parts(slab, ends):
    """[edge + 1] number of the first part of each edge after splitting.

    Args:
        slab: [vertex] integer slab along the axis.
        ends: [edge, 2] vertices.
    """
    first = np.empty(len(ends) + 1, np.int32)
    n = 0
    for e in range(len(ends)):
        first[e] = n
        n += 1 + abs(slab[ends[e, 1]] - slab[ends[e, 0]])
    first[len(ends)] = n
    return first


@kernel
def split_edges(axis, x, slab, ends, tag, place, edge_triangle, first):
    """Split every edge at the planes between its ends' slabs; note where cut edges cross grid lines.

    Args:
        axis: normal of the planes, 0 to 2.
        x: [vertex, xyz] in wall cells.
        slab, ends, first: as for and from `first_parts`.
        tag, place, edge_triangle: [edge] as in `subdivide.Subdivision`, and the triangle that a cut edge lies on.

    Returns:
        The same of the parts (x, ends, tag, place, edge_triangle), and of the crossings (vertex, axis of the line,
        sign, place, triangle).
    """
    edges = len(ends)
    parts = first[edges]
    vertices = len(x)
    x2 = np.empty((vertices + parts - edges, 3))
    for n in range(vertices):
        _copy_row(x2, n, x, n)
    ends2 = np.empty((parts, 2), np.int32)
    tag2 = np.empty(parts, np.int8)
    place2 = np.empty((parts, 3), np.int32)
    triangle2 = np.empty(parts, np.int32)
    crossings = 0
    for e in range(edges):
        if tag[e] >= 0:
            crossings += first[e + 1] - first[e] - 1
    vertex = np.empty(crossings, np.int32)
    line = np.empty(crossings, np.int8)
    sign = np.empty(crossings, np.int8)
    crossing_place = np.empty((crossings, 3), np.int32)
    crossing_triangle = np.empty(crossings, np.int32)
    v = vertices
    w = 0
    for e in range(edges):
        a = ends[e, 0]
        b = ends[e, 1]
        s = slab[a]
        count = first[e + 1] - first[e]
        step = 1 if slab[b] > s else -1
        previous = a
        for n in range(count):
            part = first[e] + n
            tag2[part] = tag[e]
            _copy_row(place2, part, place, e)
            place2[part, axis] = s
            triangle2[part] = edge_triangle[e]
            ends2[part, 0] = previous
            if n == count - 1:
                ends2[part, 1] = b
                break
            plane = s + 1 if step > 0 else s
            t = (plane - x[a, axis]) / (x[b, axis] - x[a, axis])
            for d in range(3):
                low = min(x[a, d], x[b, d])
                high = max(x[a, d], x[b, d])
                x2[v, d] = min(max(x[a, d] + t * (x[b, d] - x[a, d]), low), high)
            x2[v, axis] = plane
            ends2[part, 1] = v
            if tag[e] >= 0:
                vertex[w] = v
                line[w] = 3 - axis - tag[e]
                # left of a segment that runs up the plane's first axis lies up its second one
                sign[w] = step if axis == (tag[e] + 1) % 3 else -step
                _copy_row(crossing_place, w, place, e)
                crossing_place[w, axis] = plane
                crossing_triangle[w] = edge_triangle[e]
                w += 1
            previous = v
            v += 1
            s += step
    return x2, ends2, tag2, place2, triangle2, (vertex, line, sign, crossing_place, crossing_triangle)


@inner
def _slab_range(slab, ends, start, loop, p):
    """Lowest and highest slab of polygon `p`'s vertices."""
    low = slab[ends[loop[start[p]] >> 1, loop[start[p]] & 1]]
    high = low
    for n in range(start[p] + 1, start[p + 1]):
        s = slab[ends[loop[n] >> 1, loop[n] & 1]]
        low = min(low, s)
        high = max(high, s)
    return low, high


@inner
def _expand(slab, ends, first, start, loop, p, low, codes, slabs):
    """Write polygon `p`'s directed edge parts and their slabs, beginning where it comes down into slab `low`."""
    count = 0
    for n in range(start[p], start[p + 1]):
        e = loop[n] >> 1
        r = loop[n] & 1
        parts = first[e + 1] - first[e]
        s = slab[ends[e, r]]
        step = 1 if slab[ends[e, 1 - r]] > s else -1
        for m in range(parts):
            part = first[e] + (parts - 1 - m if r else m)
            codes[count] = 2 * part + r
            slabs[count] = s + step * m
            count += 1
    begin = 0
    for n in range(count):
        if slabs[n] == low and slabs[(n + count - 1) % count] != low:
            begin = n
            break
    if begin > 0:
        rotated = np.empty(count, np.int32)
        levels = np.empty(count, np.int32)
        for n in range(count):
            rotated[n] = codes[(n + begin) % count]
            levels[n] = slabs[(n + begin) % count]
        for n in range(count):
            codes[n] = rotated[n]
            slabs[n] = levels[n]
    return count


@kernel
def split_polygons(axis, slab, ends, first, ends2, start, loop, triangle, cell):
    """Split every polygon into its slab pieces; a new cut edge closes two pieces at each plane.

    Args:
        axis, slab, ends, first: as for `split_edges`; `ends2` is [part, 2] what it made of `ends`.
        start, loop, triangle, cell: the polygons, as in `subdivide.Subdivision`; none rises more than once.

    Returns:
        The same of the pieces (start, loop, triangle, cell), and of the cut edges (ends, place, triangle), which are
        numbered after the parts.
    """
    polygons = len(triangle)
    pieces = 0
    entries = 0
    cuts = 0
    longest = 0
    widest = 0
    for p in range(polygons):
        low, high = _slab_range(slab, ends, start, loop, p)
        size = 0
        for n in range(start[p], start[p + 1]):
            size += first[(loop[n] >> 1) + 1] - first[loop[n] >> 1]
        pieces += high - low + 1
        cuts += high - low
        entries += size + 2 * (high - low)
        longest = max(longest, size)
        widest = max(widest, high - low + 1)
    start2 = np.empty(pieces + 1, np.int32)
    loop2 = np.empty(entries, np.int32)
    triangle2 = np.empty(pieces, np.int32)
    cell2 = np.empty((pieces, 3), np.int32)
    cut_ends = np.empty((cuts, 2), np.int32)
    cut_place = np.empty((cuts, 3), np.int32)
    cut_triangle = np.empty(cuts, np.int32)
    codes = np.empty(longest, np.int32)
    slabs = np.empty(longest, np.int32)
    rise = np.empty(widest + 1, np.int32)
    fall = np.empty(widest + 1, np.int32)
    base = first[len(ends)]
    q = 0
    n = 0
    cut = 0
    for p in range(polygons):
        low, high = _slab_range(slab, ends, start, loop, p)
        count = _expand(slab, ends, first, start, loop, p, low, codes, slabs)
        # rise[k]..rise[k+1] is the rising run in slab low+k, fall[k]..fall[k-1] the falling one
        rise[0] = 0
        top = high - low
        for m in range(1, count):
            if slabs[m] > slabs[m - 1]:
                rise[slabs[m] - low] = m
            elif slabs[m] < slabs[m - 1]:
                fall[slabs[m] - low] = m
        fall[0] = count
        for k in range(top + 1):
            start2[q] = n
            triangle2[q] = triangle[p]
            _copy_row(cell2, q, cell, p)
            cell2[q, axis] = low + k
            stop = rise[k + 1] if k < top else (fall[k - 1] if k > 0 else count)
            for m in range(rise[k], stop):
                loop2[n] = codes[m]
                n += 1
            if k < top:
                begin = codes[rise[k + 1]]
                end = codes[fall[k] % count]
                cut_ends[cut + k, 0] = ends2[begin >> 1, begin & 1]
                cut_ends[cut + k, 1] = ends2[end >> 1, end & 1]
                _copy_row(cut_place, cut + k, cell, p)
                cut_place[cut + k, axis] = low + k + 1
                cut_triangle[cut + k] = triangle[p]
                loop2[n] = 2 * (base + cut + k)
                n += 1
                if k > 0:
                    for m in range(fall[k], fall[k - 1]):
                        loop2[n] = codes[m]
                        n += 1
            if k > 0:
                loop2[n] = 2 * (base + cut + k - 1) + 1
                n += 1
            q += 1
        cut += top
    start2[q] = n
    return start2, loop2, triangle2, cell2, cut_ends, cut_place, cut_triangle
