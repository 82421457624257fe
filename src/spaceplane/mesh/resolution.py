"""Meshes too coarse for their body, on which forces mean nothing.

Measured on HORUS-2B at Mach 0.8 and 2.5 (10 and 30 deg), a sphere and a cone at Mach 2.5 and thin wings at Mach 2, each
on 700 to 30 000 cells, against fine meshes. A third of the force is lost
- where a sixth of the wall, counted by its projections, lies in cells that hold its opposite side as well: HORUS-2B
  loses 35, 32, 22 and 9 % of its normal force at 0.21, 0.18, 0.16 and 0.07, with finer edges 35 and 3 % at 0.24, 0.05;
- where the body is less than three wall cells across: the sphere loses 93, 63, 33 to 42 and 4 to 9 % of its axial force
  on 1, 2, 2.9 and 4 cells, a diamond wing 70 and 14 % of its normal force on 1.6 and 4.2.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spaceplane.errors import InputError
from spaceplane.mesh.generate import generate
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.surface import Surface

FEWEST_ACROSS = 3.0
"""Wall cells across the body, see `checks.coarseness`, below which forces mean nothing."""
MOST_DOUBLED = 1.0 / 6.0
"""Share of the wall in cells that hold its opposite side too above which they mean nothing."""
FINER, TRIES = 0.8, 12
"""Steps, and how many, in which a wall cell that would do is looked for."""


def is_resolved(mesh: Mesh) -> bool:
    """Whether the cells of a mesh of `generate` are small enough for forces to mean something."""
    return mesh.record["cells_across"] >= FEWEST_ACROSS and mesh.record["doubled_share"] <= MOST_DOUBLED


def require_resolved(surface: Surface, settings: MeshSettings, mesh: Mesh, adapted: bool = False) -> None:
    """Refuse a mesh on which forces mean nothing.

    Args:
        surface, settings: that the mesh is of.
        mesh: of `generate`.
        adapted: whether it followed the flow; then no wall cell that would do is looked for.

    Raises:
        InputError: naming the setting, its value and a wall cell that would do.
    """
    if is_resolved(mesh):
        return
    record, cell, target = mesh.record, mesh.record["wall_cell_m"], settings.target_cells
    across, percent = record["cells_across"], 100 * record["doubled_share"]
    found = f"wall_cell: {cell:.4g} m"
    if target is not None:
        found = f"target_cells: {target} gives wall cells of {cell:.3g} m,"
    found += (
        f" too coarse for this body ({across:.2g} cells across, {percent:.0f} % of its wall in cells that hold both of "
        "its sides): its forces would mean nothing"
    )
    helps = None if adapted else _coarsest(surface, settings, cell)
    raise InputError(
        found + ("; use smaller cells" if helps is None else "; {:g} m ({} cells) would do".format(*helps))
    )


def _coarsest(surface: Surface, settings: MeshSettings, cell: float) -> tuple[float, int] | None:
    """About the largest wall cell, m, that would do, and its number of cells; None where it is far smaller."""
    low, high = surface.bounds
    cell = min(cell, float(np.median(high - low)))
    for _ in range(TRIES):
        cell = float(f"{FINER * cell:.2g}")
        try:
            mesh = generate(surface, replace(settings, wall_cell=cell, target_cells=None))
        except InputError:  # more cells than are allowed
            return None
        if is_resolved(mesh):
            return cell, mesh.cells
    return None
