"""Body-fitted meshes from files: elements become control volumes with shared faces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from spaceplane.errors import InputError
from spaceplane.mesh.elements import FACES, Elements
from spaceplane.mesh.gmsh import read_gmsh
from spaceplane.mesh.markers import SYMMETRY, WALL, assign
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.polygons import fans, keys, pieces, ways_round, without_repeats
from spaceplane.mesh.su2 import read_su2
from spaceplane.vehicle.surface import Surface

READERS = {".su2": read_su2, ".msh": read_gmsh}
"""Ending of the file's name -> its reader."""
DEGENERATE = 1e-13
"""Volume, on the 3/2 power of its surface's area, below which an element counts as flat: round-off."""


@dataclass(frozen=True)
class Imported:
    """A mesh from a file.

    Attributes:
        mesh: what the solver needs.
        elements: as the file has them; cells are numbered alike.
        roles: marker -> "wall", "far" or "symmetry".
        surface: the walls as triangles, a part for each marker; open at a plane of symmetry.
    """

    mesh: Mesh
    elements: Elements
    roles: dict[str, str]
    surface: Surface


def read_mesh(path: str | Path, chosen: dict[str, Sequence[str] | None] | None = None) -> Imported:
    """Read a body-fitted mesh, metres, in axes x aft, y right, z up.

    Args:
        path: a .su2 or .msh file.
        chosen: role -> markers, see `markers.assign`.

    Raises:
        InputError: another ending, an unreadable file, wrong markers, or a mesh that is not one, see `build`.
    """
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: the name of a mesh must end in {' or '.join(READERS)}")
    elements = reader(path)
    roles = assign(list(elements.boundary), chosen or {})
    mesh, surface = build(elements, roles)
    return Imported(mesh, elements, roles, surface)


def build(elements: Elements, roles: dict[str, str]) -> tuple[Mesh, Surface]:
    """Control volumes and walls of a mesh of elements.

    Quadrilateral faces may be warped: they are fans of triangles about the mean of their corners, the same ones for the
    elements on both sides, so that every element is closed to round-off; volumes and centroids are those of the
    polyhedra with such faces, by the divergence theorem. Corners of an element may coincide (a hexahedron collapsed to
    a prism). Elements numbered with the other hand are turned.

    Args:
        elements: points, elements and boundary faces.
        roles: marker -> "wall", "far" or "symmetry", all markers.

    Returns:
        The mesh, without cubes, its parts the wall markers and its planes of symmetry wall faces without pieces; and
        the walls as triangles.

    Raises:
        InputError: no elements, coordinates that are not finite, corners that do not exist, elements that are flat,
            inverted or overlap, faces with three elements, boundary faces without, with two or with a wrong marker.
    """
    points = elements.points
    _require_numbers(elements)
    owner, corners = _half_faces(elements)
    inside = np.concatenate([_means(points, c) for c in elements.cells.values()])
    collapsed = np.bincount(owner, minlength=elements.count) < 4
    _refuse(collapsed, "elements are degenerate, fewer than 4 faces", lambda k: inside[k])
    key = keys(corners, len(points))
    first, second, alone = _paired(key, points, corners)
    turn, opposite = ways_round(corners)
    _refuse(
        opposite[first] != opposite[second],
        "faces have corners that their two elements join in different orders",
        lambda k: _middle(points, corners[first[k]]),
    )
    unique = np.concatenate([first, alone])
    reverse = np.where(turn[first] == turn[second], 1.0, -1.0)
    sums = _integrals(points, corners[unique], owner[unique], owner[second], reverse, inside)
    flat = np.abs(sums.volume) <= DEGENERATE * sums.surface**1.5
    _refuse(flat, "elements are degenerate, without volume", lambda k: inside[k])
    hand = np.where(sums.volume > 0.0, 1.0, -1.0)
    _refuse(
        hand[owner[first]] == reverse * hand[owner[second]],
        "faces have both their elements on one side: inverted or overlapping elements",
        lambda k: _middle(points, corners[first[k]]),
    )
    sign = hand[owner[unique]]
    area = sums.area * sign[:, None]
    mark, names = _marked(elements, key[alone], points, corners[alone])
    role = np.array([roles[name] for name in names])[mark]
    body, mirror = np.flatnonzero(role == WALL), np.flatnonzero(role == SYMMETRY)
    wall = np.concatenate([body, mirror])
    far = np.setdiff1d(np.arange(len(alone)), wall)
    edge_cell, edge_area, edge_center = owner[alone].astype(np.int32), area[len(first) :], sums.center[len(first) :]
    parts = tuple(name for name in names if roles[name] == WALL)
    part = np.array([parts.index(name) if name in parts else -1 for name in names])[mark]
    volume = np.abs(sums.volume)
    mesh = Mesh(
        cell_volume=volume,
        cell_center=inside + sums.first * (hand / volume)[:, None],
        cell_size=np.cbrt(volume),
        face_cells=np.stack([owner[first], owner[second]], axis=1).astype(np.int32),
        face_area=area[: len(first)],
        face_center=sums.center[: len(first)],
        wall_cell=edge_cell[wall],
        wall_area=edge_area[wall],
        wall_center=edge_center[wall],
        far_cell=edge_cell[far],
        far_area=edge_area[far],
        far_center=edge_center[far],
        piece_wall=np.arange(len(body), dtype=np.int32),
        piece_area=edge_area[body],
        piece_center=edge_center[body],
        piece_part=part[body].astype(np.int32),
        part_names=parts,
        wall_symmetry=np.arange(len(wall)) >= len(body),
    )
    outward = _outward(corners[alone[body]], sign[len(first) + body])
    mesh.record.update(_record(mesh, elements, roles, mark, names, edge_area))
    return mesh, _surface(points, outward, part[body], parts)


def _require_numbers(elements: Elements) -> None:
    """Refuse what cannot be computed with."""
    if not elements.count:
        raise InputError("mesh: 0 elements; at least one is needed")
    bad = ~np.isfinite(elements.points).all(axis=1)
    if bad.any():
        raise InputError(f"mesh: {bad.sum()} points have coordinates that are not finite numbers")
    count = len(elements.points)
    for name, corners in (*elements.cells.items(), *elements.boundary.items()):
        least = -1 if name in elements.boundary else 0  # -1 is the fourth corner of a triangle
        wrong = ((corners < least) | (corners >= count)).any(axis=1)
        if wrong.any():
            raise InputError(
                f"mesh: {wrong.sum()} of '{name}' have corners that do not exist (there are {count} points)"
            )


def _half_faces(elements: Elements) -> tuple[np.ndarray, np.ndarray]:
    """Every face of every element: its element, and its corners [., 4] with -1 last for triangles."""
    count = sum(len(FACES[kind]) * len(corners) for kind, corners in elements.cells.items())
    owner, faces = np.empty(count, dtype=np.int32), np.full((count, 4), -1, dtype=np.int32)
    before, begin = 0, 0
    for kind, corners in elements.cells.items():
        for local in FACES[kind]:
            own = slice(begin, begin + len(corners))
            owner[own] = before + np.arange(len(corners))
            for k, corner in enumerate(local):
                faces[own, k] = corners[:, corner]
            begin = own.stop
        before += len(corners)
    faces = without_repeats(faces)
    whole = faces[:, 2] >= 0  # a face collapsed to an edge or a point is none
    return (owner, faces) if whole.all() else (owner[whole], faces[whole])


def _paired(key: np.ndarray, points: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Half faces that make a face: (one side, the other side, those with no other side)."""
    order, new = _groups(key)
    times = np.diff(np.append(np.flatnonzero(new), len(order)))
    start = np.flatnonzero(new)
    crowd = order[start[times > 2]]
    if len(crowd):
        where = _place(_middle(points, corners[crowd[0]]))
        raise InputError(f"mesh: {len(crowd)} faces are shared by more than two elements, {where}")
    twice = start[times == 2]
    return order[twice], order[twice + 1], np.sort(order[start[times == 1]])


def _groups(key: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Order of rows [., 2] by which equal ones follow each other, and where in it a new one begins."""
    order = np.lexsort((key[:, 1], key[:, 0]))
    placed = key[order]
    return order, np.concatenate([[True], (placed[1:] != placed[:-1]).any(axis=1)])


def _means(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """[element, xyz] mean of the corners [element, corner]."""
    result = np.empty((len(corners), 3))
    for piece in pieces(len(corners)):
        result[piece] = points[corners[piece]].mean(axis=1)
    return result


class _Sums(NamedTuple):
    """Integrals of faces and elements; those of elements numbered with the other hand are negative.

    Attributes:
        area, center: [face, xyz] area vector, m2, and centroid, m.
        volume: [element] m3.
        first: [element, xyz] first moment of the volume about `inside`, m4.
        surface: [element] area of its faces, m2.
    """

    area: np.ndarray
    center: np.ndarray
    volume: np.ndarray
    first: np.ndarray
    surface: np.ndarray


def _integrals(
    points: np.ndarray,
    corners: np.ndarray,
    owner: np.ndarray,
    neighbour: np.ndarray,
    reverse: np.ndarray,
    inside: np.ndarray,
) -> _Sums:
    """Areas of faces and, from the cones over them, volumes and first moments of elements.

    A cone from `inside` [element, xyz] to the triangle t of a fan has the volume a . A_t / 3, a the way to the fan's
    middle, which lies in the planes of all its triangles, and its centroid at 3/4 of the way to the triangle's.

    Args:
        owner: [face] element whose numbering the `corners` [face, 4] have.
        neighbour: element on the other side, of the first faces; `reverse` is -1 where it has them the other way round.
    """
    count = len(inside)
    volume, surface, first = np.zeros(count), np.zeros(count), np.zeros((3, count))
    area, center = np.empty((len(corners), 3)), np.empty((len(corners), 3))
    for piece in pieces(len(corners)):
        fan = fans(points, corners[piece])
        area[piece], center[piece] = fan.area, fan.center
        size = np.linalg.norm(fan.area, axis=1)
        for cell, sign in ((owner[piece], 1.0), (neighbour[piece], reverse[piece])):
            n = len(cell)
            arm = fan.middle[:n] - inside[cell]
            cone = sign * np.einsum("ij,ij->i", arm, fan.area[:n]) / 3.0
            part = 0.75 * cone[:, None] * arm
            part += 0.25 * np.einsum("ij,ijk->ik", arm, fan.moment[:n]) * np.reshape(sign, (-1, 1))
            np.add.at(volume, cell, cone)
            np.add.at(surface, cell, size[:n])
            for k in range(3):
                np.add.at(first[k], cell, part[:, k])
    return _Sums(area, center, volume, np.ascontiguousarray(first.T), surface)


def _marked(
    elements: Elements, edge: np.ndarray, points: np.ndarray, corners: np.ndarray
) -> tuple[np.ndarray, list[str]]:
    """[boundary face] index of its marker, and the markers' names."""
    names = list(elements.boundary)
    faces = np.concatenate([np.zeros((0, 4), np.int64), *elements.boundary.values()])
    marker = np.repeat(np.arange(len(names)), [len(elements.boundary[name]) for name in names])
    key = keys(without_repeats(faces), len(points))
    order, new = _groups(np.concatenate([edge, key]))
    group = np.empty(len(order), dtype=np.int64)
    group[order] = np.cumsum(new) - 1
    at = np.full(int(new.sum()), -1)
    at[group[: len(edge)]] = np.arange(len(edge))
    place = at[group[len(edge) :]]
    if (place < 0).any():
        lost = place < 0
        where = ", ".join(sorted({names[m] for m in marker[lost]}))
        raise InputError(f"mesh: {lost.sum()} faces of {where} are not on the boundary of the elements")
    times = np.bincount(place, minlength=len(edge))
    if (times > 1).any():
        raise InputError(f"mesh: {(times > 1).sum()} boundary faces have two markers or stand twice in one")
    bare = times == 0
    if bare.any():
        twins = _twins(points)
        hint = f"; {twins} points coincide with another, merge them" if twins else ""
        raise InputError(
            f"mesh: {bare.sum()} of {len(edge)} boundary faces have no marker, "
            f"{_place(_middle(points, corners[bare][0]))}{hint}"
        )
    mark = np.empty(len(edge), dtype=np.int64)
    mark[place] = marker
    return mark, names


def _twins(points: np.ndarray) -> int:
    """How many points coincide with an earlier one."""
    scale = float(np.ptp(points, axis=0).max()) or 1.0
    return len(points) - len(np.unique(np.round(points / scale * 1e9), axis=0))


def _outward(corners: np.ndarray, sign: np.ndarray) -> np.ndarray:
    """[triangle, 4] triangles of wall faces, numbered counter-clockwise seen from the fluid, and the face of each."""
    # `corners` run counter-clockwise seen from outside the element, that is from inside the body.
    a, b, c, d = corners.T
    face = np.arange(len(corners))
    quad = d >= 0
    triangles = np.concatenate([np.stack([a, b, c, face], 1), np.stack([a, c, d, face], 1)[quad]])
    swap = sign[triangles[:, 3]] > 0.0
    triangles[swap, 1:3] = triangles[swap, 2:0:-1]
    return triangles


def _surface(points: np.ndarray, triangles: np.ndarray, part: np.ndarray, names: tuple[str, ...]) -> Surface:
    used, compact = np.unique(triangles[:, :3], return_inverse=True)
    return Surface(points[used], compact.reshape(-1, 3), part[triangles[:, 3]].astype(np.int32), names)


def _record(mesh: Mesh, elements: Elements, roles: dict[str, str], mark, names: list[str], area: np.ndarray) -> dict:
    size = np.linalg.norm(area, axis=1)
    outside = _wrong_sides(mesh)
    warnings = [f"{outside} faces have the centroid of an element on the wrong side"] if outside else []
    return {
        "cells": mesh.cells,
        "points": len(elements.points),
        "elements": {kind: len(corners) for kind, corners in elements.cells.items()},
        "faces": len(mesh.face_cells),
        "wall_faces": int(mesh.body_wall.sum()),
        "symmetry_faces": int((~mesh.body_wall).sum()),
        "far_faces": len(mesh.far_cell),
        "markers": {
            name: {"role": roles[name], "faces": int((mark == k).sum()), "area_m2": float(size[mark == k].sum())}
            for k, name in enumerate(names)
        },
        "closure": float(np.abs(mesh.closure()).max()),
        "warnings": warnings,
    }


def _wrong_sides(mesh: Mesh) -> int:
    """How many faces look back at the centroid of one of their elements."""
    count = 0
    for piece in pieces(len(mesh.face_cells)):
        ends = mesh.cell_center[mesh.face_cells[piece]]
        along = np.einsum("fex,fx->fe", mesh.face_center[piece][:, None] - ends, mesh.face_area[piece])
        count += int(((along[:, 0] <= 0.0) | (along[:, 1] >= 0.0)).sum())
    return count


def _refuse(bad: np.ndarray, what: str, where: Callable[[int], np.ndarray]) -> None:
    """Raise when any is bad, with their number and the place of the first."""
    if bad.any():
        raise InputError(f"mesh: {bad.sum()} of {len(bad)} {what}, {_place(where(int(np.flatnonzero(bad)[0])))}")


def _middle(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Mean of the corners [4] of a face."""
    return points[corners[corners >= 0]].mean(axis=0)


def _place(where: np.ndarray) -> str:
    x, y, z = where
    return f"the first near x = {x:.4g}, y = {y:.4g}, z = {z:.4g} m"
