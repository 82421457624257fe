"""The coarser companion of a mesh, on which the same conditions are solved again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from spaceplane.flow.solution import ConvergenceRecord
from spaceplane.mesh.settings import MeshSettings

if TYPE_CHECKING:
    import xarray as xr

RATIO = 2.0
"""Wall cell of the companion on that of the mesh."""
GROWTH_LAYERS = 2
"""Most growth layers of the companion: one less than the default, which leaves out a third of its cells."""


@dataclass(frozen=True)
class Companion:
    """What is kept of a companion run.

    Attributes:
        coefficients: as those of the main run, on the coarser mesh.
        records: [condition] how it converged.
        ratio: its wall cell over that of the mesh.
        wall_cell: m.
        cells: of its mesh.
        seconds: wall time, s, by phase.
    """

    coefficients: xr.Dataset
    records: tuple[ConvergenceRecord, ...]
    ratio: float
    wall_cell: float
    cells: int
    seconds: Mapping[str, float]


def coarser(settings: MeshSettings, wall_cell: float, ratio: float = RATIO) -> MeshSettings:
    """Settings of the companion of a mesh: every cell that the settings name is `ratio` times as large.

    Args:
        settings: of the mesh.
        wall_cell: that the mesh was made with, m (a target number of cells leaves it open in the settings).
        ratio: of the cells' edges.
    """
    return replace(
        settings,
        wall_cell=ratio * wall_cell,
        target_cells=None,
        growth_layers=min(settings.growth_layers, GROWTH_LAYERS),
        boxes=tuple(replace(box, cell=ratio * box.cell) for box in settings.boxes),
        frustums=tuple(replace(frustum, cell=ratio * frustum.cell) for frustum in settings.frustums),
    )
