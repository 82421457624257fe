"""Reader of Gmsh's mesh format (.msh, versions 2.2, 4.0 and 4.1, text or binary)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from spaceplane.errors import InputError
from spaceplane.mesh.elements import FACES, Elements
from spaceplane.mesh.su2 import padded

_SIDES = ("triangle", "quad")
_SKIPPED = ("vertex", "line")


def read_gmsh(path: str | Path) -> Elements:
    """Points, elements and physical surfaces of a three-dimensional Gmsh mesh.

    Coordinates are taken as metres in axes x aft, y right, z up. Physical surfaces are the markers; one without a name
    is called by its number. Faces in no physical surface have no marker.

    Args:
        path: the file.

    Raises:
        InputError: a file that is empty, damaged or two-dimensional, or has elements of other kinds than tetrahedra,
            hexahedra, prisms and pyramids of first order.

    Source: Gmsh reference manual, "Gmsh file formats"; read by meshio.
    """
    if not Path(path).read_bytes()[:64].strip():
        raise InputError(f"Gmsh file '{path}': is empty")
    import meshio

    try:
        mesh = meshio.gmsh.read(str(path))
    except Exception as err:  # of a damaged file meshio raises whatever it stumbles over
        reason = " ".join(str(err).split()) or type(err).__name__
        raise InputError(f"Gmsh file '{path}': cannot be read as a Gmsh mesh ({reason[:120]})") from err
    blocks = [(block.type, np.asarray(block.data, dtype=np.int64)) for block in mesh.cells]
    for kind, corners in blocks:
        if kind not in (*FACES, *_SIDES, *_SKIPPED):
            raise InputError(
                f"Gmsh file '{path}': {len(corners)} elements of kind {kind}, allowed are {', '.join(FACES)} of first "
                "order"
            )
    cells = {
        kind: np.concatenate([corners for other, corners in blocks if other == kind])
        for kind in FACES
        if any(other == kind for other, _ in blocks)
    }
    if not cells:
        raise InputError(f"Gmsh file '{path}': 0 elements with a volume, three dimensions are needed")
    return Elements(np.asarray(mesh.points, dtype=float), cells, _markers(mesh, blocks))


def _markers(mesh, blocks: list[tuple[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """Physical surface -> [face, 4] corners."""
    names = {int(tag): name for name, (tag, dimension) in mesh.field_data.items() if dimension == 2}
    tags = mesh.cell_data.get("gmsh:physical", [np.zeros(len(corners), int) for _, corners in blocks])
    faces: dict[str, list[np.ndarray]] = {}
    for (kind, corners), tag in zip(blocks, tags, strict=True):
        if kind not in _SIDES:
            continue
        for number in np.unique(tag[tag != 0]):
            faces.setdefault(names.get(int(number), str(number)), []).append(padded(corners[tag == number]))
    return {name: np.concatenate(parts) for name, parts in faces.items()}
