"""Cut cells of a triangulated surface: control volumes, the fluid faces between them and the wall inside them."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

from spaceplane.errors import InputError
from spaceplane.mesh import regions as rg
from spaceplane.mesh import volumes as vol
from spaceplane.mesh.coplanar import beside_planes
from spaceplane.mesh.subdivide import Subdivision, subdivide
from spaceplane.mesh.unionfind import bucket


@dataclass(frozen=True)
class CutCells:
    """Control volumes of the cells cut by a surface, in wall cells (lengths) and grid indices of a window.

    Attributes:
        cell: [volume, ijk] cell that the volume lies in.
        volume: [volume] size; 1 is a whole cell.
        center: [volume, xyz] centroid.
        face_sides: [face, 2] volume below and above the face, -1 where that cell is not cut.
        face_axis: [face] axis of the face's normal.
        face_corner: [face, ijk] lower corner; the cell above the face.
        face_area: [face] fluid area.
        face_center: [face, xyz] centroid.
        polygon_volume: [polygon] volume that the piece of surface bounds.
        polygon_triangle: [polygon] triangle of the surface.
        polygon_area: [polygon, xyz] area vector out of the fluid.
        polygon_size: [polygon] area.
        polygon_center: [polygon, xyz] centroid.
        cut: [i, j, k] bool, cells that are cut.
        fluid: [i, j, k] bool, nodes in the fluid.
        split_cells: cells with more than one control volume.
        folded_edges: cell edges along which the surface lies inside itself.
        gauss_error: largest difference between a volume's sizes from the three coordinate directions.
        thin: [n, (x, y, z, thickness, triangle, axis)] places where a grid line along the axis enters the body to leave
            it within `thin_below` cells.
        lines: [n] triangle of every crossing examined for thickness.
        seconds: by phase.
    """

    cell: np.ndarray
    volume: np.ndarray
    center: np.ndarray
    face_sides: np.ndarray
    face_axis: np.ndarray
    face_corner: np.ndarray
    face_area: np.ndarray
    face_center: np.ndarray
    polygon_volume: np.ndarray
    polygon_triangle: np.ndarray
    polygon_area: np.ndarray
    polygon_size: np.ndarray
    polygon_center: np.ndarray
    cut: np.ndarray
    fluid: np.ndarray
    split_cells: int
    folded_edges: int
    gauss_error: float
    thin: np.ndarray
    lines: np.ndarray
    seconds: dict


def cut_cells(
    points: np.ndarray, triangles: np.ndarray, shape: tuple, right_of: int | None = None, thin_below: float = 4.0
) -> CutCells:
    """Cut the unit cells of a window with a closed surface.

    Args:
        points: [vertex, xyz] in wall cells; all within the window by at least one cell below and two above.
        triangles: [triangle, 3].
        shape: cells of the window along x, y, z.
        right_of: keep only cells with j at or above this index (half of a symmetric body).
        thin_below: thickness, in cells, below which walls are listed as thin.

    Raises:
        InputError: the surface is not closed, or so folded that inside and outside cannot be told apart.
    """
    clock = [time.perf_counter()]
    mirror = None if right_of is None else float(right_of)
    surface = subdivide(beside_planes(points, triangles, mirror), triangles, mirror)
    clock.append(time.perf_counter())
    if right_of is not None:
        surface = _right_crossings(surface, right_of)
    place = surface.polygon_place
    kept = np.ones(len(place), bool) if right_of is None else place[:, 1] >= right_of
    cut = np.zeros(shape, bool)
    cut[tuple(place[kept].T)] = True
    cells = np.ascontiguousarray(np.argwhere(cut), dtype=np.int32)
    cell_index = np.full(shape, -1, np.int32)
    cell_index[tuple(cells.T)] = np.arange(len(cells), dtype=np.int32)
    states = rg.node_states(shape, surface.crossing_place, surface.crossing_axis, surface.crossing_sign)

    intervals, folded = _intervals(surface, cells, cell_index, states)
    if folded > max(20, 0.002 * len(cells)):
        raise InputError(f"surface: folds over itself at {folded} places, a surface without overlaps is needed")
    axes, corner, beside, cell_faces = rg.list_faces(cells, cell_index)
    segments = _segments(surface, cells, cell_index, 0 if right_of is None else right_of)
    region_face, region_area, region_moment, segment_region, slot_start, slot_region = rg.face_regions(
        axes, corner, cell_index, states, surface.points, segments, intervals
    )
    clock.append(time.perf_counter())

    polygon_cell = np.full(len(place), -1, np.int32)
    polygon_cell[kept] = cell_index[tuple(place[kept].T)]
    loops = (surface.polygon_start, surface.loop)
    slots = (cell_faces, slot_start, slot_region)
    parent = vol.connect_volumes(surface.edge_tag, *loops, polygon_cell, *slots, segment_region, len(region_face))
    area, size, center, first, second = vol.polygon_moments(
        surface.points, *loops, surface.edge_ends, polygon_cell, cells
    )
    sides, polygon_volume, cell, moment, first_moment, bounded = vol.measure_volumes(
        parent, axes, beside, region_face, region_area, polygon_cell, first, second
    )
    sides, polygon_volume, cell, moment, first_moment = _join_islands(
        sides, polygon_volume, cell, moment, first_moment, bounded
    )
    volume = moment.mean(axis=1)
    per_cell = np.bincount(cell, minlength=len(cells))
    middle = np.clip(first_moment / np.maximum(volume, 1e-12)[:, None], -0.5, 0.5)
    thin, lines = _thin_walls(surface, points, triangles, thin_below)
    used = np.flatnonzero(polygon_volume >= 0)
    clock.append(time.perf_counter())
    names = ("surface subdivision", "face regions", "control volumes")
    return CutCells(
        cell=cells[cell],
        volume=volume,
        center=cells[cell] + 0.5 + middle,
        face_sides=sides,
        face_axis=axes[region_face],
        face_corner=corner[region_face],
        face_area=region_area,
        face_center=_face_centers(axes[region_face], corner[region_face], region_area, region_moment),
        polygon_volume=polygon_volume[used],
        polygon_triangle=surface.polygon_triangle[used],
        polygon_area=area[used],
        polygon_size=size[used],
        polygon_center=center[used],
        cut=cut,
        fluid=states > 0,
        split_cells=int((per_cell > 1).sum()),
        folded_edges=int(folded),
        gauss_error=float(np.abs(moment - volume[:, None]).max(initial=0.0)),
        thin=thin,
        lines=lines,
        seconds={name: clock[n + 1] - clock[n] for n, name in enumerate(names)},
    )


def _right_crossings(surface: Subdivision, right_of: int) -> Subdivision:
    """Leave out the crossings of grid lines left of the plane of symmetry."""
    on = surface.crossing_place[:, 1] >= right_of
    return replace(
        surface,
        crossing_vertex=surface.crossing_vertex[on],
        crossing_axis=surface.crossing_axis[on],
        crossing_sign=surface.crossing_sign[on],
        crossing_place=surface.crossing_place[on],
        crossing_triangle=surface.crossing_triangle[on],
    )


def _intervals(surface: Subdivision, cells: np.ndarray, cell_index: np.ndarray, states: np.ndarray):
    """Fluid intervals of the cut cells' lower edges, and the number of folded edges."""
    owner = cell_index[tuple(surface.crossing_place.T)]
    key = np.where(owner >= 0, 3 * owner + surface.crossing_axis, -1).astype(np.int32)
    start, items = bucket(key, 3 * len(cells))
    *intervals, folded = rg.edge_intervals(
        cells, states, surface.points, start, items, surface.crossing_vertex, surface.crossing_sign
    )
    return tuple(intervals), folded


def _segments(surface: Subdivision, cells: np.ndarray, cell_index: np.ndarray, right_of: int):
    """Cut edges listed by the face they lie in (3 * cell above + axis), and the edges' ends."""
    key = np.full(len(surface.edge_tag), -1, np.int32)
    tagged = np.flatnonzero((surface.edge_tag >= 0) & (surface.edge_place[:, 1] >= right_of))
    owner = cell_index[tuple(surface.edge_place[tagged].T)]
    key[tagged] = np.where(owner >= 0, 3 * owner + surface.edge_tag[tagged], -1)
    return (*bucket(key, 3 * len(cells)), surface.edge_ends)


def _join_islands(sides, polygon_volume, cell, moment, first_moment, bounded):
    """Give closed pieces of body that lie wholly inside a cell to the air around them.

    A closed piece of surface without a face region has negative volume when it bounds body; a positive one bounds a
    cavity and stays a volume of its own.
    """
    count = len(cell)
    islands = np.arange(bounded, count)
    if len(islands) == 0:
        return sides, polygon_volume, cell, moment, first_moment
    order = np.lexsort((-moment[:bounded, 0], cell[:bounded]))
    hosts = cell[:bounded][order]
    target = np.arange(count)
    at = np.searchsorted(hosts, cell[islands])
    found = at < len(hosts)
    found[found] = hosts[at[found]] == cell[islands[found]]
    found &= moment[islands].mean(axis=1) <= 1e-12
    target[islands[found]] = order[at[found]]
    keep = target == np.arange(count)
    number = np.cumsum(keep) - 1
    target = number[target]
    moment2 = np.zeros((keep.sum(), 3))
    first2 = np.zeros((keep.sum(), 3))
    np.add.at(moment2, target, moment)
    np.add.at(first2, target, first_moment)
    sides = np.where(sides >= 0, target[sides], -1)
    polygon_volume = np.where(polygon_volume >= 0, target[polygon_volume], -1)
    return sides, polygon_volume, cell[keep], moment2, first2


def _face_centers(axis, corner, area, moment):
    """[face, xyz] centroids of the fluid regions."""
    within = np.full((len(area), 2), 0.5)
    sized = area > 1e-9
    within[sized] = np.clip(moment[sized] / area[sized, None], 0.0, 1.0)
    center = corner.astype(np.float64)
    rows = np.arange(len(area))
    center[rows, (axis + 1) % 3] += within[:, 0]
    center[rows, (axis + 2) % 3] += within[:, 1]
    return center


def _thin_walls(surface: Subdivision, points: np.ndarray, triangles: np.ndarray, below: float):
    """Thickness of the body along grid lines nearly normal to it, where it is `below` so many cells."""
    corners = points[triangles]
    normal = np.abs(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    steepest = normal.argmax(axis=1)
    thin, lines = [], []
    for axis in range(3):
        on = surface.crossing_axis == axis
        place = surface.crossing_place[on]
        at = surface.points[surface.crossing_vertex[on]]
        sign = surface.crossing_sign[on]
        triangle = surface.crossing_triangle[on]
        a, b = (axis + 1) % 3, (axis + 2) % 3
        order = np.lexsort((at[:, axis], place[:, b], place[:, a]))
        place, at, sign, triangle = place[order], at[order], sign[order], triangle[order]
        pair = (np.diff(place[:, a]) == 0) & (np.diff(place[:, b]) == 0) & (sign[:-1] < 0) & (sign[1:] > 0)
        entry = np.flatnonzero(pair & (steepest[triangle[:-1]] == axis))
        thickness = at[entry + 1, axis] - at[entry, axis]
        lines.append(triangle[entry])
        few = entry[thickness < below]
        along = np.full(len(few), axis)
        thin.append(np.column_stack([at[few], thickness[thickness < below], triangle[few], along]))
    return np.concatenate(thin), np.concatenate(lines)
