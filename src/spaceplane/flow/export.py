"""Flow fields for ParaView and pyvista: the cells as VTU, the coloured surface as VTP."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from spaceplane.errors import InputError
from spaceplane.flow.equilibrium import speed_of_sound
from spaceplane.flow.solution import FlowConditions, Solution
from spaceplane.mesh.elements import Elements
from spaceplane.mesh.mesh import Mesh
from spaceplane.vehicle.surface import Surface

_NEIGHBOURS = (12, 96)
_OTHER_PART = 0.05
# Corners of a hexahedron in VTK's order, in half edges from the centre.
_CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], dtype=float
)
_VTK_NAME = {"tetra": "TETRA", "hexahedron": "HEXAHEDRON", "wedge": "WEDGE", "pyramid": "PYRAMID"}


def condition_labels(conditions: FlowConditions) -> tuple[str, ...]:
    """Short names of conditions such as M2.5_a16.6_b0, angles in degrees."""
    angles = np.degrees([conditions.alpha, conditions.beta])
    return tuple(
        f"M{m:.6g}_a{round(float(a), 6):g}_b{round(float(b), 6):g}"
        for m, a, b in zip(conditions.mach, *angles, strict=True)
    )


def write_vtu(
    solution: Solution, path: Path | str, labels: Sequence[str] | None = None, elements: Elements | None = None
) -> None:
    """Write the cells of a mesh with the flow of each condition.

    Cell data per condition: `Mach_<label>`, `Cp_<label>`, `density_<label>` (on the free stream's), `velocity_<label>`
    (on the free-stream speed of sound, geometry axes); and `fluid_fraction`, the part of an octree's cube outside the
    body. A cell of an octree at the body is drawn as its whole cube.

    Args:
        solution: flow on an octree mesh or an imported one.
        path: ends in .vtu.
        labels: [condition] names; `condition_labels` by default.
        elements: of an imported mesh.

    Raises:
        InputError: another ending, a mesh without cubes or elements, or a file that cannot be written.
    """
    path = _target(path, ".vtu")
    import pyvista

    mesh, conditions = solution.mesh, solution.conditions
    if elements is None:
        points, cells = _cubes(mesh)
        grid = pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: cells}, points)
        grid.cell_data["fluid_fraction"] = (mesh.cell_volume / mesh.cell_size**3).astype(np.float32)
    else:
        kinds = {pyvista.CellType[_VTK_NAME[kind]]: corners for kind, corners in elements.cells.items()}
        grid = pyvista.UnstructuredGrid(kinds, elements.points)
    for i, label in enumerate(labels or condition_labels(conditions)):
        density, velocity, pressure = solution.state[:, 0, i], solution.state[:, 1:4, i], solution.state[:, 4, i]
        sound = speed_of_sound(conditions, i, density, pressure)
        grid.cell_data[f"Mach_{label}"] = (np.linalg.norm(velocity, axis=1) / sound).astype(np.float32)
        cp = (pressure - 1.0 / conditions.gamma) / (0.5 * conditions.mach[i] ** 2)
        grid.cell_data[f"Cp_{label}"] = cp.astype(np.float32)
        grid.cell_data[f"density_{label}"] = density.astype(np.float32)
        grid.cell_data[f"velocity_{label}"] = np.ascontiguousarray(velocity, dtype=np.float32)
    _note(grid, solution)
    _save(grid, path)


def write_vtp(surface: Surface, solution: Solution, path: Path | str, fields: Mapping[str, int] | None = None) -> None:
    """Write the surface with its part tags and the Cp of chosen conditions.

    Cell data: `part` (index into the field data `part_names`) and `Cp_<name>` per entry of `fields`.

    Args:
        surface: the body that was meshed.
        solution: flow around it.
        path: ends in .vtp.
        fields: name to index of the condition; all by `condition_labels` by default.

    Raises:
        InputError: another ending, or a file that cannot be written.
    """
    path = _target(path, ".vtp")
    import pyvista

    if fields is None:
        fields = {label: i for i, label in enumerate(condition_labels(solution.conditions))}
    cp = surface_cp(surface, solution, list(fields.values()))
    faces = np.column_stack([np.full(len(surface.triangles), 3), surface.triangles])
    body = pyvista.PolyData(np.asarray(surface.points, dtype=float), faces.ravel())
    body.cell_data["part"] = np.asarray(surface.part, dtype=np.int32)
    for column, name in enumerate(fields):
        body.cell_data[f"Cp_{name}"] = cp[:, column].astype(np.float32)
    body.add_field_data(np.array(surface.part_names, dtype=str), "part_names")
    _note(body, solution)
    _save(body, path)


def surface_cp(surface: Surface, solution: Solution, conditions: Sequence[int] | None = None) -> np.ndarray:
    """[triangle, condition] pressure coefficient at the triangles' centroids, of all conditions or of those chosen.

    A weighted mean over the wall pieces around: pieces that face another way do not count (so that both sides of a thin
    wing keep apart), those of other parts count little, near ones most.
    """
    from scipy.spatial import cKDTree

    mesh = solution.mesh
    chosen = slice(None) if conditions is None else list(conditions)
    cp = solution.wall_cp()[:, chosen].astype(float)[mesh.piece_wall]
    if len(cp) == 0:
        raise InputError("mesh: it has no wall, so there is no surface pressure")
    tree = cKDTree(mesh.piece_center)
    result = np.empty((len(surface.triangles), cp.shape[1]))
    left = np.arange(len(surface.triangles))
    for count in _NEIGHBOURS:
        distance, near = tree.query(surface.centroids[left], k=min(count, len(cp)))
        distance, near = distance.reshape(len(left), -1), near.reshape(len(left), -1)
        weight = _weights(surface, mesh, left, distance, near)
        total = weight.sum(axis=1)
        found = total > 0.0
        mean = np.einsum("tk,tkc->tc", weight[found] / total[found, None], cp[near[found]])
        result[left[found]] = mean
        left, nearest = left[~found], near[~found, 0]
        if len(left) == 0:
            return result
    result[left] = cp[nearest]  # no wall near that faces this way, as on a sliver: the nearest there is
    return result


def _weights(surface: Surface, mesh: Mesh, chosen: np.ndarray, distance: np.ndarray, near: np.ndarray) -> np.ndarray:
    """[triangle, neighbour] weights of wall pieces for the chosen triangles."""
    size = np.linalg.norm(mesh.piece_area, axis=1)
    outward = -mesh.piece_area / np.maximum(size, 1e-300)[:, None]
    normal = surface.area_vectors[chosen]
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    facing = np.clip(np.einsum("tx,tkx->tk", normal, outward[near]), 0.0, 1.0) ** 4
    known = {name: index for index, name in enumerate(mesh.part_names)}
    part = np.array([known.get(name, -1) for name in surface.part_names])[surface.part[chosen]]
    same = np.where(mesh.piece_part[near] == part[:, None], 1.0, _OTHER_PART)
    cell = mesh.cell_size[mesh.wall_cell[mesh.piece_wall[near]]]
    return facing * same * size[near] / (distance**2 + (0.3 * cell) ** 2) ** 2


def _cubes(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Shared nodes [node, xyz] and hexahedra [cell, 8] of the octree's cubes."""
    center = cube_centers(mesh)
    finest = mesh.cell_size.min()
    corners = center[:, None, :] + 0.5 * mesh.cell_size[:, None, None] * _CORNERS
    lattice = np.rint((corners - corners.min(axis=(0, 1))) / finest).astype(np.int64).reshape(-1, 3)
    extent = lattice.max(axis=0) + 1
    key = (lattice[:, 0] * extent[1] + lattice[:, 1]) * extent[2] + lattice[:, 2]
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    return corners.reshape(-1, 3)[first], inverse.reshape(-1, 8)


def cube_centers(mesh: Mesh) -> np.ndarray:
    """[cell, xyz] centre, m, of the octree cube that holds the centroid of each cell.

    Whole cells have it as their centroid. Cut cells lie in the cube of their size on the lattice whose corner is
    that of the far field.

    Raises:
        InputError: the mesh is not an octree.
    """
    size = mesh.cell_size[:, None]
    corner = (mesh.cell_center - 0.5 * size).min(axis=0)
    center = corner + (np.floor((mesh.cell_center - corner) / size) + 0.5) * size
    whole = np.abs(mesh.cell_volume / mesh.cell_size**3 - 1.0) < 1e-9
    if not whole.any() or np.abs((center - mesh.cell_center)[whole] / size[whole]).max() > 1e-6:
        raise InputError("mesh: its cells are not the cubes of an octree, so they cannot be written as VTU")
    return center


def _note(data, solution: Solution) -> None:
    """Attach what each field means as field data."""
    conditions = solution.conditions
    data.add_field_data(np.asarray(conditions.mach, dtype=float), "condition_mach")
    data.add_field_data(np.degrees(conditions.alpha), "condition_alpha_deg")
    data.add_field_data(np.degrees(conditions.beta), "condition_beta_deg")
    data.add_field_data(np.array([r.verdict for r in solution.records], dtype=str), "condition_verdict")


def _target(path: Path | str, ending: str) -> Path:
    path = Path(path)
    if path.suffix.lower() != ending:
        raise InputError(f"{path}: the name must end in {ending}")
    if not path.parent.is_dir():
        raise InputError(f"{path}: folder {path.parent} does not exist")
    return path


def _save(data, path: Path) -> None:
    try:
        with path.open("ab"):
            pass
        data.save(path, binary=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror or error})") from error
