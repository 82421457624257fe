"""One conforming subdivision of a closed triangulated surface by the planes of an integer grid.

Everything is decided on integers: a vertex is given its slab along an axis once (a vertex on a plane belongs to the
slab above), an edge is split once at every plane between its ends' slabs, and the two polygons beside it share the new
vertices. Places of edges and polygons are inherited from then on. No tolerance is needed, whatever the quality of the
triangles.

Coordinates are in wall cells, so that grid planes lie at integers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spaceplane.errors import InputError
from spaceplane.kernelcache import inner
from spaceplane.mesh.compiled import kernel
from spaceplane.mesh.splitting import first_parts, split_edges, split_polygons


@dataclass(frozen=True)
class Subdivision:
    """A surface cut into polygons that each lie in one cell.

    Attributes:
        points: [vertex, xyz] in wall cells.
        edge_ends: [edge, 2] vertices. A cut edge (tag >= 0) has fluid on its left in the plane, seen against the axis.
        edge_tag: [edge] axis of the grid plane that the edge lies on, or -1.
        edge_place: [edge, xyz] slab along each axis; the plane's index along the tag axis.
        polygon_start: [polygon + 1] offsets into `loop`.
        loop: directed edges, 2 * edge + reversed, counter-clockwise seen from the air.
        polygon_triangle: [polygon] triangle of the surface that the polygon comes from.
        polygon_place: [polygon, xyz] cell.
        crossing_vertex: [crossing] vertex where the surface crosses a grid line.
        crossing_axis: [crossing] axis along which the line runs.
        crossing_sign: [crossing] +1 where the line enters the fluid going up, -1 where it leaves it.
        crossing_place: [crossing, xyz] plane indices, and the slab along the line.
        crossing_triangle: [crossing] a triangle at the crossing.
    """

    points: np.ndarray
    edge_ends: np.ndarray
    edge_tag: np.ndarray
    edge_place: np.ndarray
    polygon_start: np.ndarray
    loop: np.ndarray
    polygon_triangle: np.ndarray
    polygon_place: np.ndarray
    crossing_vertex: np.ndarray
    crossing_axis: np.ndarray
    crossing_sign: np.ndarray
    crossing_place: np.ndarray
    crossing_triangle: np.ndarray


def pair_edges(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Give every pair of opposite half-edges one edge.

    Args:
        triangles: [triangle, 3] vertex indices.

    Returns:
        kept triangles (those with three different vertices), edge ends [edge, 2], loops [kept, 3] as
        2 * edge + reversed.

    Raises:
        InputError: the surface is not closed.
    """
    a, b, c = triangles.T
    kept = np.flatnonzero((a != b) & (b != c) & (c != a))
    origin = triangles[kept].ravel()
    target = triangles[kept][:, [1, 2, 0]].ravel()
    count = int(triangles.max()) + 1
    key = np.minimum(origin, target).astype(np.int64) * count + np.maximum(origin, target)
    forward = np.flatnonzero(origin < target)
    backward = np.flatnonzero(origin > target)
    forward = forward[np.argsort(key[forward], kind="stable")]
    backward = backward[np.argsort(key[backward], kind="stable")]
    if len(forward) != len(backward) or np.any(key[forward] != key[backward]):
        raise InputError("surface: not watertight (an edge has no opposite triangle), a closed surface is needed")
    loop = np.empty(len(origin), np.int32)
    numbers = np.arange(len(forward), dtype=np.int32)
    loop[forward] = 2 * numbers
    loop[backward] = 2 * numbers + 1
    ends = np.stack([origin[forward], target[forward]], axis=1).astype(np.int32)
    return kept, ends, loop.reshape(-1, 3)


def subdivide(points: np.ndarray, triangles: np.ndarray, right_of: float | None = None) -> Subdivision:
    """Cut a closed surface by all grid planes.

    Args:
        points: [vertex, xyz] in wall cells.
        triangles: [triangle, 3] vertex indices, counter-clockwise seen from the air.
        right_of: leave out triangles that have no vertex with y at or above this plane (in wall cells, a number).

    Raises:
        InputError: the surface is not closed.
    """
    kept, ends, loops = pair_edges(triangles)
    if right_of is not None:
        needed = (points[triangles[kept], 1] >= right_of).any(axis=1)
        kept, loops = kept[needed], loops[needed]
        used = np.zeros(len(ends), bool)
        used[loops >> 1] = True
        number = (np.cumsum(used) - 1).astype(np.int32)
        ends = ends[used]
        loops = 2 * number[loops >> 1] + (loops & 1)
    x = np.ascontiguousarray(points, dtype=np.float64)
    tag = np.full(len(ends), -1, np.int8)
    place = np.zeros((len(ends), 3), np.int32)
    edge_triangle = np.full(len(ends), -1, np.int32)
    start = np.arange(0, 3 * len(loops) + 1, 3, dtype=np.int32)
    loop = loops.astype(np.int32).ravel()
    triangle = kept.astype(np.int32)
    cell = np.zeros((len(kept), 3), np.int32)
    crossings = []
    for axis in range(3):
        slab = np.floor(x[:, axis]).astype(np.int32)
        state = _fan(slab, ends, tag, place, edge_triangle, start, loop, triangle, cell)
        ends, tag, place, edge_triangle, start, loop, triangle, cell = state
        first = first_parts(slab, ends)
        x, ends2, tag2, place2, edge_triangle2, found = split_edges(
            axis, x, slab, ends, tag, place, edge_triangle, first
        )
        crossings.append(found)
        state = split_polygons(axis, slab, ends, first, ends2, start, loop, triangle, cell)
        start, loop, triangle, cell, cut_ends, cut_place, cut_triangle = state
        ends = np.concatenate([ends2, cut_ends])
        tag = np.concatenate([tag2, np.full(len(cut_ends), axis, np.int8)])
        place = np.concatenate([place2, cut_place])
        edge_triangle = np.concatenate([edge_triangle2, cut_triangle])
    vertex, line, sign, crossing_place, crossing_triangle = (
        np.concatenate([found[n] for found in crossings]) for n in range(5)
    )
    along_z = line == 2
    crossing_place[along_z, 2] = np.floor(x[vertex[along_z], 2]).astype(np.int32)
    return Subdivision(
        x, ends, tag, place, start, loop, triangle, cell, vertex, line, sign, crossing_place, crossing_triangle
    )


@inner
def _turns(slab, ends, start, loop, p):
    """Number of changes between rising and falling around polygon `p`: 0 or 2 when it is unimodal."""
    first = 0
    last = 0
    turns = 0
    for n in range(start[p], start[p + 1]):
        e = loop[n] >> 1
        r = loop[n] & 1
        step = slab[ends[e, 1 - r]] - slab[ends[e, r]]
        if step == 0:
            continue
        way = 1 if step > 0 else -1
        if last == 0:
            first = way
        elif way != last:
            turns += 1
        last = way
    if last != first:
        turns += 1
    return turns


@kernel
def _folded(slab, ends, start, loop):
    """[polygon] whether the polygon rises more than once along the axis."""
    bad = np.zeros(len(start) - 1, np.bool_)
    for p in range(len(start) - 1):
        bad[p] = start[p + 1] - start[p] > 3 and _turns(slab, ends, start, loop, p) > 2
    return bad


def _fan(slab, ends, tag, place, edge_triangle, start, loop, triangle, cell):
    """Replace polygons that rise more than once along the axis by fans of triangles: round-off makes a few of them."""
    bad = _folded(slab, ends, start, loop)
    if not bad.any():
        return ends, tag, place, edge_triangle, start, loop, triangle, cell
    new_ends, new_place, new_loops, new_polygons = [], [], [], []
    for p in np.flatnonzero(bad):
        ring = [int(code) for code in loop[start[p] : start[p + 1]]]
        apex = ends[ring[0] >> 1, ring[0] & 1]
        entry = ring[0]
        for code in ring[1:-2]:
            edge = len(ends) + len(new_ends)
            new_ends.append((ends[code >> 1, 1 - (code & 1)], apex))
            new_place.append(cell[p])
            new_loops.append((entry, code, 2 * edge))
            new_polygons.append(p)
            entry = 2 * edge + 1
        new_loops.append((entry, ring[-2], ring[-1]))
        new_polygons.append(p)
    count = np.diff(start)
    sizes = np.concatenate([count[~bad], np.full(len(new_loops), 3)])
    return (
        np.concatenate([ends, np.array(new_ends, np.int32)]),
        np.concatenate([tag, np.full(len(new_ends), -1, np.int8)]),
        np.concatenate([place, np.array(new_place, np.int32)]),
        np.concatenate([edge_triangle, np.full(len(new_ends), -1, np.int32)]),
        np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32),
        np.concatenate([loop[np.repeat(~bad, count)], np.array(new_loops, np.int32).ravel()]),
        np.concatenate([triangle[~bad], triangle[new_polygons]]),
        np.concatenate([cell[~bad], cell[new_polygons]]),
    )
