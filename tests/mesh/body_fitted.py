"""Body-fitted meshes of elements for tests, and writers of them in the formats that the program reads."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from flow.structured import cone_block
from spaceplane.mesh.elements import FACES, Elements

CUBE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
VTK = {"tetra": 10, "hexahedron": 12, "wedge": 13, "pyramid": 14}
SIX_TETRAHEDRA = [(0, a, b, 6) for a, b in ((1, 2), (2, 3), (3, 7), (7, 4), (4, 5), (5, 1))]
TWO_WEDGES = [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)]


def hexahedra(block: np.ndarray) -> np.ndarray:
    """[element, 8] corners of a block of point numbers [i, j, k]."""
    last = [n - 1 for n in block.shape]
    corners = [block[a : a + last[0], b : b + last[1], c : c + last[2]] for a, b, c in CUBE]
    return np.stack(corners, axis=-1).reshape(-1, 8)


def grid(counts: tuple[int, int, int], warp: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Points [point, xyz] of the unit box, inner ones moved by `warp` of a cell, and their numbers [i, j, k]."""
    points = np.stack(np.meshgrid(*[np.linspace(0, 1, n + 1) for n in counts], indexing="ij"), axis=-1)
    shift = np.random.default_rng(2).uniform(-warp, warp, points.shape) / np.array(counts)
    points[1:-1, 1:-1, 1:-1] += shift[1:-1, 1:-1, 1:-1]
    return points.reshape(-1, 3), np.arange(points[..., 0].size).reshape(points.shape[:3])


def boundary(cells: dict[str, np.ndarray]) -> np.ndarray:
    """[face, 4] corners of the faces that only one element has, -1 last for triangles, elements in order."""
    seen: dict[frozenset, list[int] | None] = {}
    for kind, corners in cells.items():
        for local in FACES[kind]:
            for face in corners[:, local].tolist():
                face = list(dict.fromkeys(face))
                if len(face) > 2:
                    key = frozenset(face)
                    seen[key] = None if key in seen else face
    return np.array([[*face, -1][:4] for face in seen.values() if face is not None])


def marked(points: np.ndarray, cells: dict[str, np.ndarray], name: Callable[[np.ndarray], str]) -> Elements:
    """Elements with the boundary faces under the markers that `name` gives for their middles [xyz]."""
    faces: dict[str, list] = {}
    for face in boundary(cells):
        faces.setdefault(name(points[face[face >= 0]].mean(axis=0)), []).append(face)
    return Elements(points, cells, {marker: np.array(rows) for marker, rows in faces.items()})


def box_side(middle: np.ndarray) -> str:
    """Markers of the unit box: the floor is a wall."""
    return "floor" if middle[2] < 1e-9 else "farfield"


def box(kind: str, n: int = 4, warp: float = 0.2, name: Callable[[np.ndarray], str] = box_side) -> Elements:
    """Unit box of elements of one kind, `n` cells a side."""
    points, number = grid((n, n, n), warp)
    cubes = hexahedra(number)
    if kind == "pyramid":
        return marked(*pyramids(points, cubes), name)
    split = {"hexahedron": [tuple(range(8))], "tetra": SIX_TETRAHEDRA, "wedge": TWO_WEDGES}[kind]
    return marked(points, {kind: np.concatenate([cubes[:, part] for part in split])}, name)


def pyramids(points: np.ndarray, cubes: np.ndarray) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Points with the middles of cubes added, and the six pyramids that have them as their tops."""
    top = len(points) + np.arange(len(cubes))
    inward = [face[::-1] for face in FACES["hexahedron"]]
    parts = np.concatenate([np.column_stack([cubes[:, face], top]) for face in inward])
    return np.concatenate([points, points[cubes].mean(axis=1)]), {"pyramid": parts}


def mixed(warp: float = 0.2) -> Elements:
    """Unit box of all four kinds: hexahedra, pyramids and (for those on the side y = 0) tetrahedra, wedges."""
    points, number = grid((6, 3, 3), warp)
    cubes = hexahedra(number[:3])
    points, cells = pyramids(points, hexahedra(number[2:5]))
    pyramid = cells["pyramid"]
    outer = (points[pyramid[:, :4], 1] < 1e-9).all(axis=1)
    cut = pyramid[outer]
    tetra = np.concatenate([cut[:, [0, 1, 2, 4]], cut[:, [0, 2, 3, 4]]])
    wedge = np.concatenate([hexahedra(number[4:])[:, part] for part in TWO_WEDGES])
    kinds = {"hexahedron": cubes, "pyramid": pyramid[~outer], "tetra": tetra, "wedge": wedge}
    return marked(points, kinds, box_side)


def cone(along: int, across: int, around: int, half_angle: float, outer_angle: float) -> tuple[Elements, np.ndarray]:
    """Quarter of a unit-length cone about the x axis as in the structured tests (angles in rad), and its block of
    points.

    Hexahedra at the apex are collapsed. Markers: cone, sym_y, sym_z, farfield.
    """
    block = cone_block(along, across, around, half_angle, outer_angle)
    number = np.arange(block[..., 0].size).reshape(block.shape[:3])
    number[0] = 0  # all of them the apex
    used, compact = np.unique(number, return_inverse=True)
    points = block.reshape(-1, 3)[used]
    slope = np.tan(half_angle) * (1 + 1e-6)

    def name(middle: np.ndarray) -> str:
        if abs(middle[1]) < 1e-9 or abs(middle[2]) < 1e-9:
            return "sym_y" if abs(middle[1]) < 1e-9 else "sym_z"
        inner = np.hypot(middle[1], middle[2]) < middle[0] * slope and middle[0] < 1 - 1e-9
        return "cone" if inner else "farfield"

    return marked(points, {"hexahedron": hexahedra(compact.reshape(number.shape))}, name), block


def write_su2(elements: Elements, path: Path) -> Path:
    """Write the native format of SU2, with comments, numbered lines and elements of different kinds mixed."""
    lines = [(VTK[kind], *row) for kind, corners in elements.cells.items() for row in corners.tolist()]
    text = ["% a comment", "NDIME= 3", f"NELEM= {len(lines)}"]
    text += [" ".join(map(str, (*line, k))) for k, line in enumerate(lines)]
    text += [f"NPOIN= {len(elements.points)}  % points"]
    text += [" ".join(map(repr, (*row, k))) for k, row in enumerate(elements.points.tolist())]
    text += ["", f"NMARK= {len(elements.boundary)}"]
    for name, faces in elements.boundary.items():
        text += [f"MARKER_TAG= {name}", f"MARKER_ELEMS= {len(faces)}"]
        text += [" ".join(map(str, (9, *f) if f[3] >= 0 else (5, *f[:3]))) for f in faces.tolist()]
    path.write_text("\n".join(text) + "\n")
    return path


def write_msh(elements: Elements, path: Path, version: str = "2.2") -> Path:
    """Write Gmsh's format, markers as physical surfaces: by meshio ("2.2", "2.2 binary") or here ("4.1")."""
    blocks = [(kind, corners, "air") for kind, corners in elements.cells.items()]
    for name, faces in elements.boundary.items():
        parts = (("triangle", faces[faces[:, 3] < 0, :3], name), ("quad", faces[faces[:, 3] >= 0], name))
        blocks += [part for part in parts if len(part[1])]
    tags = {name: k + 1 for k, name in enumerate([*elements.boundary, "air"])}
    if version == "4.1":
        path.write_text(_msh_41(elements.points, blocks, tags))
        return path
    import meshio

    data = [np.full(len(corners), tags[name]) for _, corners, name in blocks]
    mesh = meshio.Mesh(
        elements.points,
        [(kind, corners) for kind, corners, _ in blocks],
        cell_data={"gmsh:physical": data, "gmsh:geometrical": data},
        field_data={name: np.array([tag, 3 if name == "air" else 2]) for name, tag in tags.items()},
    )
    meshio.write(path, mesh, file_format="gmsh22", binary="binary" in version)
    return path


def _msh_41(points: np.ndarray, blocks: list[tuple[str, np.ndarray, str]], tags: dict[str, int]) -> str:
    kinds = {"triangle": 2, "quad": 3, "tetra": 4, "hexahedron": 5, "wedge": 6, "pyramid": 7}
    box, count = "0 0 0 1 1 1", sum(len(corners) for _, corners, _ in blocks)
    dimension = {name: 3 if name == "air" else 2 for name in tags}
    text = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", len(tags)]
    text += [f'{dimension[name]} {tag} "{name}"' for name, tag in tags.items()]
    text += ["$EndPhysicalNames", "$Entities", f"0 0 {len(tags) - 1} 1"]
    text += [f"{tag} {box} 1 {tag} 0" for tag in tags.values()]
    text += ["$EndEntities", "$Nodes", f"1 {len(points)} 1 {len(points)}", f"3 {tags['air']} 0 {len(points)}"]
    text += [*range(1, len(points) + 1), *(" ".join(map(repr, row)) for row in points.tolist())]
    text += ["$EndNodes", "$Elements", f"{len(blocks)} {count} 1 {count}"]
    number = 0
    for kind, corners, name in blocks:
        text.append(f"{dimension[name]} {tags[name]} {kinds[kind]} {len(corners)}")
        for row in (corners + 1).tolist():
            number += 1
            text.append(" ".join(map(str, (number, *row))))
    return "\n".join(map(str, [*text, "$EndElements", ""]))
