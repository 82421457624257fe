"""Control volumes of cut cells: union-find over face regions and surface polygons, sizes by the divergence theorem."""

from __future__ import annotations

import numpy as np

from spaceplane.mesh.compiled import kernel
from spaceplane.mesh.unionfind import find, unite


@kernel
def connect_volumes(
    edge_tag, polygon_start, loop, polygon_cell, cell_faces, slot_start, slot_region, segment_region, regions
):
    """Union-find forest over region sides (2 * region + side) and polygons (2 * regions + polygon).

    Side 0 of a region is the cell below its face, side 1 the cell above.

    Args:
        edge_tag, polygon_start, loop: as in `subdivide.Subdivision`.
        polygon_cell: [polygon] cut cell.
        cell_faces: [cell, 2 * axis + side], see `regions.list_faces`.
        slot_start, slot_region, segment_region: from `regions.face_regions`.
        regions: number of regions.
    """
    polygons = len(polygon_cell)
    parent = np.arange(2 * regions + polygons).astype(np.int32)
    first_polygon = np.full(len(edge_tag), -1, np.int32)
    for p in range(polygons):
        if polygon_cell[p] < 0:
            continue
        for n in range(polygon_start[p], polygon_start[p + 1]):
            e = loop[n] >> 1
            if edge_tag[e] >= 0:
                if segment_region[e] >= 0:
                    unite(parent, 2 * regions + p, 2 * segment_region[e] + (loop[n] & 1))
            elif first_polygon[e] < 0:
                first_polygon[e] = p
            else:
                unite(parent, 2 * regions + p, 2 * regions + first_polygon[e])
    for cell in range(len(cell_faces)):
        for along in range(3):
            b = (along + 1) % 3
            c = (along + 2) % 3
            for side_b in range(2):
                for side_c in range(2):
                    n = 4 * cell_faces[cell, 2 * b + side_b] + (1 if side_c else 3)
                    m = 4 * cell_faces[cell, 2 * c + side_c] + (2 if side_b else 0)
                    for k in range(slot_start[n + 1] - slot_start[n]):
                        r = slot_region[slot_start[n] + k]
                        s = slot_region[slot_start[m] + k]
                        unite(parent, 2 * r + 1 - side_b, 2 * s + 1 - side_c)
    return parent


@kernel
def polygon_moments(points, polygon_start, loop, edge_ends, polygon_cell, cells):
    """Area vectors, centroids and divergence-theorem moments of the surface polygons, seen from the fluid.

    Args:
        points: [vertex, xyz] in grid coordinates.
        polygon_start, loop, edge_ends: as in `subdivide.Subdivision`.
        polygon_cell: [polygon] cut cell.
        cells: [cell, ijk].

    Returns:
        area [polygon, xyz] out of the fluid, weight [polygon] sum of triangle areas, center [polygon, xyz] in grid
        coordinates, first [polygon, xyz] integral of x_d n_d and second [polygon, xyz] of x_d^2 n_d / 2 over the
        polygon, both about the middle of its cell.
    """
    polygons = len(polygon_cell)
    area = np.zeros((polygons, 3))
    weight = np.zeros(polygons)
    center = np.zeros((polygons, 3))
    first = np.zeros((polygons, 3))
    second = np.zeros((polygons, 3))
    middle = np.empty(3)
    corner = np.empty((3, 3))
    t = np.empty(3)
    for p in range(polygons):
        if polygon_cell[p] < 0:
            continue
        s = polygon_start[p]
        for d in range(3):
            middle[d] = cells[polygon_cell[p], d] + 0.5
        apex = edge_ends[loop[s] >> 1, loop[s] & 1]
        for d in range(3):
            corner[0, d] = points[apex, d] - middle[d]
        for n in range(s + 1, polygon_start[p + 1] - 1):
            e = loop[n] >> 1
            r = loop[n] & 1
            for d in range(3):
                corner[1, d] = points[edge_ends[e, r], d] - middle[d]
                corner[2, d] = points[edge_ends[e, 1 - r], d] - middle[d]
            for d in range(3):
                a = (d + 1) % 3
                b = (d + 2) % 3
                # minus the outward normal of the body
                t[d] = -0.5 * (
                    (corner[1, a] - corner[0, a]) * (corner[2, b] - corner[0, b])
                    - (corner[1, b] - corner[0, b]) * (corner[2, a] - corner[0, a])
                )
            size = np.sqrt(t[0] ** 2 + t[1] ** 2 + t[2] ** 2)
            weight[p] += size
            for d in range(3):
                x, y, z = corner[0, d], corner[1, d], corner[2, d]
                area[p, d] += t[d]
                center[p, d] += size * (x + y + z) / 3.0
                first[p, d] += t[d] * (x + y + z) / 3.0
                second[p, d] += t[d] * (x * x + y * y + z * z + x * y + y * z + z * x) / 12.0
        for d in range(3):
            mean = center[p, d] / weight[p] if weight[p] > 0.0 else corner[0, d]
            center[p, d] = mean + middle[d]
    return area, weight, center, first, second


@kernel
def measure_volumes(parent, axes, beside, region_face, region_area, polygon_cell, first, second):
    """Number the control volumes of the cut cells and measure them.

    Args:
        parent: forest from `connect_volumes`.
        axes, beside: [face] axis and [face, 2] cut cell below and above.
        region_face, region_area: [region] from `regions.face_regions`.
        polygon_cell: [polygon] cut cell.
        first, second: [polygon, xyz] from `polygon_moments`.

    Returns:
        side_volume [region, 2] (-1: not a cut cell), polygon_volume [polygon], cell [volume],
        moment [volume, xyz] volume from the integral of x_d n_d for each axis d,
        first_moment [volume, xyz] integral of position about the middle of the cell, has_region [volume].
    """
    regions = len(region_face)
    polygons = len(polygon_cell)
    number = np.full(len(parent), -1, np.int32)
    side_volume = np.full((regions, 2), -1, np.int32)
    polygon_volume = np.full(polygons, -1, np.int32)
    cell = np.empty(len(parent), np.int32)
    count = 0
    for r in range(regions):
        for side in range(2):
            c = beside[region_face[r], side]
            if c < 0:
                continue
            root = find(parent, 2 * r + side)
            if number[root] < 0:
                number[root] = count
                cell[count] = c
                count += 1
            side_volume[r, side] = number[root]
    with_region = count
    for p in range(polygons):
        if polygon_cell[p] < 0:
            continue
        root = find(parent, 2 * regions + p)
        if number[root] < 0:
            number[root] = count
            cell[count] = polygon_cell[p]
            count += 1
        polygon_volume[p] = number[root]
    moment = np.zeros((count, 3))
    first_moment = np.zeros((count, 3))
    for r in range(regions):
        d = axes[region_face[r]]
        for side in range(2):
            v = side_volume[r, side]
            if v >= 0:
                moment[v, d] += 0.5 * region_area[r]
                first_moment[v, d] += (0.125 if side == 0 else -0.125) * region_area[r]
    for p in range(polygons):
        v = polygon_volume[p]
        if v >= 0:
            for d in range(3):
                moment[v, d] += first[p, d]
                first_moment[v, d] += second[p, d]
    return side_volume, polygon_volume, cell[:count].copy(), moment, first_moment, with_region
