"""Geometry and connectivity of a polyhedral mesh; it knows nothing of flow."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Mesh:
    """A polyhedral finite-volume mesh, ours or an imported one.

    All vectors in geometry axes (x aft, y right, z up), m, m2 and m3, float64.

    Attributes:
        cell_volume: [cell] volume.
        cell_center: [cell, xyz] centroid.
        cell_size: [cell] edge length of the octree cube (cube root of the volume elsewhere).
        face_cells: [face, 2] int32 the two cells of an interior face.
        face_area: [face, xyz] area vector pointing from `face_cells[:, 0]` to `face_cells[:, 1]`.
        face_center: [face, xyz] centroid of the face.
        wall_cell: [wall] int32 cell of a wall face. At most one wall face per cell on cut-cell meshes.
        wall_area: [wall, xyz] area vector pointing out of the fluid, into the body.
        wall_center: [wall, xyz] centroid of the wall face.
        far_cell, far_area, far_center: the same for the far-field boundary.
        piece_wall: [piece] int32 wall face that a piece of surface belongs to. Pieces split a wall face by part and
            by whether it faces upstream, so that forces by part sum to the force on the wall exactly.
        piece_area: [piece, xyz] area vector pointing into the body.
        piece_center: [piece, xyz] centroid of the piece.
        piece_part: [piece] int32 index into `part_names`.
        part_names: names of the parts of the surface.
        record: what the generator has to say: counts, merged and split cells, warnings, seconds.
        cell_cube_center: [cell, xyz] centre of the octree cube of edge `cell_size` that the cell lies in (a merged
            cell: the cube of its largest member); None on imported meshes.
        merged_cubes: [cube, (cell, x, y, z, edge)] centre and edge, m, of octree cubes that merging added to a cell;
            None on imported meshes.
        wall_wetted: [wall] area of the surface that a wall face stands for, m2: more than the size of its area vector
            where the surface turns; None on imported meshes.
        wall_symmetry: [wall] whether the wall face lies in a plane of symmetry: a slip wall to the flow, no part of the
            body (it has no pieces and bears no force); None where no wall face does.
    """

    cell_volume: np.ndarray
    cell_center: np.ndarray
    cell_size: np.ndarray
    face_cells: np.ndarray
    face_area: np.ndarray
    face_center: np.ndarray
    wall_cell: np.ndarray
    wall_area: np.ndarray
    wall_center: np.ndarray
    far_cell: np.ndarray
    far_area: np.ndarray
    far_center: np.ndarray
    piece_wall: np.ndarray
    piece_area: np.ndarray
    piece_center: np.ndarray
    piece_part: np.ndarray
    part_names: tuple[str, ...]
    record: dict = field(default_factory=dict)
    cell_cube_center: np.ndarray | None = None
    merged_cubes: np.ndarray | None = None
    wall_wetted: np.ndarray | None = None
    wall_symmetry: np.ndarray | None = None

    @property
    def cells(self) -> int:
        """Number of cells."""
        return len(self.cell_volume)

    @property
    def body_wall(self) -> np.ndarray:
        """[wall] whether the wall face belongs to the body; those in planes of symmetry do not."""
        return np.ones(len(self.wall_cell), bool) if self.wall_symmetry is None else ~self.wall_symmetry

    def closure(self) -> np.ndarray:
        """[cell, xyz] sum of outward area vectors of each cell, m2: zero to round-off on a closed mesh."""
        outward = (
            (self.face_cells[:, 0], self.face_area),
            (self.face_cells[:, 1], -self.face_area),
            (self.wall_cell, self.wall_area),
            (self.far_cell, self.far_area),
        )
        total = np.zeros((self.cells, 3))
        for cell, area in outward:
            for axis in range(3):
                total[:, axis] += np.bincount(cell, area[:, axis], minlength=self.cells)
        return total
