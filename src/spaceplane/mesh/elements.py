"""A body-fitted mesh as its file has it: points, elements by kind, named patches of boundary."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

FACES: dict[str, tuple[tuple[int, ...], ...]] = {
    "tetra": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)),
    "hexahedron": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    "wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "pyramid": ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
}
"""Kind of element -> the corners of its faces, counter-clockwise seen from outside, in the numbering of VTK (but the
opposite hand of its wedge, as Gmsh has it; `imported.build` accepts both hands of every kind)."""

CORNERS = {"tetra": 4, "hexahedron": 8, "wedge": 6, "pyramid": 5, "triangle": 3, "quad": 4}
"""Kind of element or boundary face -> number of its corners."""


@dataclass(frozen=True)
class Elements:
    """Points, elements and boundary faces of a file, not checked.

    Attributes:
        points: [point, xyz] m, in geometry axes (x aft, y right, z up).
        cells: kind (a key of `FACES`) -> [element, corner] int64 indices of points. Cells of the `Mesh` are numbered
            through these arrays in their order.
        boundary: marker -> [face, 4] int64 corners of its faces; -1 stands last for triangles.
    """

    points: np.ndarray
    cells: dict[str, np.ndarray]
    boundary: dict[str, np.ndarray]

    @property
    def count(self) -> int:
        """Number of elements."""
        return sum(len(corners) for corners in self.cells.values())
