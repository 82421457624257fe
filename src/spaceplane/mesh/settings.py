"""What a user may ask of the mesh."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Real
from typing import Any

from spaceplane.errors import InputError
from spaceplane.mesh.frustum import RefinementFrustum

MOST_PASSES = 3
"""Times that a mesh may be adapted to the flow; each halves some cells."""


def check_passes(field: str, passes: int) -> int:
    """The number of passes that adapt a mesh, when it is allowed.

    Raises:
        InputError: naming `field`.
    """
    if isinstance(passes, bool) or not isinstance(passes, int) or not 0 <= passes <= MOST_PASSES:
        raise InputError(f"{field}: {passes}, a whole number from 0 to {MOST_PASSES} is allowed")
    return passes


MOST_EDGE_LEVELS = 4
"""Times that cells at edges may be halved."""

MOST_EDGE_CELLS = 16.0
"""Cells that may be asked for across the thickness of a thin wall."""


def _finite(value: Any) -> bool:
    """Whether a value is a finite number."""
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


def _three(value: Any) -> bool:
    """Whether a value is three finite numbers."""
    try:
        return len(value) == 3 and all(_finite(x) for x in value)
    except TypeError:
        return False


@dataclass(frozen=True)
class RefinementBox:
    """An axis-aligned box in which cells are no larger than `cell`.

    Attributes:
        lower: (x, y, z) lower corner, m.
        upper: (x, y, z) upper corner, m.
        cell: largest cell edge inside the box, m.
    """

    lower: tuple[float, float, float]
    upper: tuple[float, float, float]
    cell: float


@dataclass(frozen=True)
class MeshSettings:
    """Size and grading of the octree. Lengths in m.

    Attributes:
        wall_cell: edge of the cells cut by the body, m.
        target_cells: choose the wall cell so that about this many cells result (within 15 %); overrides `wall_cell`.
        far_field: distance from the body's bounding box to the far field, in body lengths (its largest extent).
        domain: (lower corner, upper corner) of the air to mesh, m, widened to whole cells of the coarsest size; None
            uses `far_field`.
        wall_layers: layers of wall-sized cells beside the cut cells; at least 1.
        growth_layers: layers of cells of each coarser size before the next; at least 1.
        merge_fraction: control volumes below this fraction of their cube are merged with a neighbour.
        fine_parts: names of parts whose walls get cells of half `wall_cell`; `elevon` stands for `elevon_left` and
            `elevon_right`.
        fine_edges: half-sized cells also where the wall turns by more than about 50 degrees within a wall cell: leading
            and trailing edges, tips, plates thinner than a cell.
        edge_levels: how many times cells are halved where air connects the two sides of a thin wall round its edge
            within a cell (the wall turns by more than 120 degrees there), so that one pressure acts on both sides, and
            where the body is thinner than 0.45 of the cell, as towards a sharp edge.
        edge_cells: least cells across the thickness of a thin wall at its square edges, such as those of a plate, as
            far as `edge_levels` halvings give them; 0 asks for none.
        boxes: refinement boxes, for air and walls; mirrored on a body meshed as half and mirror image.
        frustums: refinement in truncated cones, as in the air between a slender body and its shock, for air and walls;
            mirrored likewise.
        symmetric: mirror the mesh of the right half; None finds out whether the surface is symmetric about y = 0, False
            meshes both sides even then.
        offset: (x, z) position of the body's lower corner within a wall cell, as a fraction of the cell.
        max_cells: refuse to build more cells than this (about 1.5 kB of memory each while meshing).
    """

    wall_cell: float = 0.125
    target_cells: int | None = None
    far_field: float = 6.0
    domain: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
    wall_layers: int = 2
    growth_layers: int = 3
    merge_fraction: float = 0.3
    fine_parts: tuple[str, ...] = ()
    fine_edges: bool = False
    edge_levels: int = 0
    edge_cells: float = 0.0
    boxes: tuple[RefinementBox, ...] = ()
    frustums: tuple[RefinementFrustum, ...] = ()
    symmetric: bool | None = None
    offset: tuple[float, float] = (0.38196601125, 0.2360679775)
    max_cells: int = 6_000_000

    @property
    def graded_wall(self) -> bool:
        """Whether some walls get cells of half the size of others."""
        return bool(self.fine_parts) or self.fine_edges

    def __post_init__(self) -> None:
        """Refuse values that no mesh can have.

        Raises:
            InputError: naming the field, its value and what is allowed.
        """
        for name in ("wall_cell", "far_field", "wall_layers", "growth_layers", "edge_levels", "edge_cells"):
            if not _finite(getattr(self, name)):
                raise InputError(f"{name}: {getattr(self, name)!r}, must be a finite number")
        if not self.wall_cell > 0.0:
            raise InputError(f"wall_cell: {self.wall_cell} m, must be a finite length above 0")
        target = self.target_cells
        if target is not None and not (_finite(target) and 1000 <= target <= self.max_cells):
            raise InputError(f"target_cells: {target!r}, allowed 1000 to {self.max_cells}")
        if not self.far_field >= 0.25:
            raise InputError(f"far_field: {self.far_field} body lengths, must be a finite number of at least 0.25")
        for name in ("wall_layers", "growth_layers"):
            if getattr(self, name) < 1:
                raise InputError(f"{name}: {getattr(self, name)}, must be at least 1")
        if not 0 <= self.edge_levels <= MOST_EDGE_LEVELS:
            raise InputError(f"edge_levels: {self.edge_levels}, allowed 0 to {MOST_EDGE_LEVELS}")
        if not 0.0 <= self.edge_cells <= MOST_EDGE_CELLS:
            raise InputError(f"edge_cells: {self.edge_cells}, allowed 0 to {MOST_EDGE_CELLS:g}")
        if self.edge_cells and not self.edge_levels:
            raise InputError(f"edge_cells: {self.edge_cells:g}, goes with edge_levels of at least 1, which reach them")
        if not (_finite(self.merge_fraction) and 0.0 <= self.merge_fraction <= 0.9):
            raise InputError(f"merge_fraction: {self.merge_fraction!r}, allowed 0 to 0.9")
        self._check_regions()

    def _check_regions(self) -> None:
        """Refuse a domain, parts, boxes and frustums that are none."""
        if self.domain is not None and not (
            isinstance(self.domain, tuple | list) and len(self.domain) == 2 and all(_three(c) for c in self.domain)
        ):
            raise InputError(f"domain: {self.domain!r}, lower and upper corner, three numbers each, are needed")
        if self.domain is not None and not all(low < high for low, high in zip(*self.domain, strict=True)):
            raise InputError(f"domain: {self.domain} m, the upper corner must lie above the lower one")
        for name, kind in (("fine_parts", str), ("boxes", RefinementBox), ("frustums", RefinementFrustum)):
            value = getattr(self, name)
            if not (isinstance(value, tuple | list) and all(isinstance(one, kind) for one in value)):
                raise InputError(f"{name}: {value!r}, a tuple of {kind.__name__} is needed")
        for box in self.boxes:
            if not (_finite(box.cell) and box.cell > 0.0):
                raise InputError(f"boxes: cell {box.cell!r} m, must be a finite length above 0")
            if not (_three(box.lower) and _three(box.upper)):
                raise InputError(
                    f"boxes: lower {box.lower!r}, upper {box.upper!r}; three finite numbers each are needed"
                )
            if any(u <= low for low, u in zip(box.lower, box.upper, strict=True)):
                raise InputError(f"boxes: lower {box.lower}, upper {box.upper}; upper must lie above lower")
