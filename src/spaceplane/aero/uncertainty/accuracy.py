"""Meshes made finer until lift, drag and pitching moment are as certain as asked, or until the cells run out."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.integrate import TOTAL
from spaceplane.aero.uncertainty.companion import RATIO
from spaceplane.aero.uncertainty.errors import of_coefficients
from spaceplane.aero.uncertainty.grid import ORDER
from spaceplane.aero.uncertainty.settings import FIRST_CELLS, LOOSEST, TIGHTEST
from spaceplane.errors import InputError
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings
from spaceplane.plain import degrees

if TYPE_CHECKING:
    import xarray as xr

JUDGED = ("CL", "CD", "Cm")
MOST_CELLS = 2_000_000
BYTES_PER_CELL = 12_000
"""Memory that the solver takes for each cell with sixteen conditions at once, fp32."""
SMALLEST_STEP = 1.25
"""Least ratio of the cells of two meshes from which an uncertainty is taken."""
MARGIN = 0.9
"""Share of the uncertainty asked for that the next mesh is aimed at."""


@dataclass(frozen=True)
class Accuracy:
    """How certain coefficients shall be, and how many cells that may take.

    Attributes:
        target: largest uncertainty of C_L, C_D and C_m, 95 %, as a fraction of the size of the force coefficient; for
            C_m that is the centre of pressure as a fraction of the reference length.
        max_cells: most cells of a mesh.
    """

    target: float
    max_cells: int

    def __post_init__(self) -> None:
        if not (math.isfinite(self.target) and TIGHTEST <= self.target <= LOOSEST):
            raise InputError(f"accuracy: {100 * self.target:g} %, allowed {100 * TIGHTEST:g} % to {100 * LOOSEST:g} %")
        if self.max_cells < FIRST_CELLS:
            raise InputError(f"max_cells: {self.max_cells}, at least {FIRST_CELLS} with an accuracy to reach")


@dataclass(frozen=True)
class Trial:
    """One mesh on the way.

    Attributes:
        cells: of the mesh.
        wall_cell: m.
        reached: worst uncertainty on the force's size; None for the first mesh, which has none to compare with.
        worst: where: coefficient, Mach number and angles.
    """

    cells: int
    wall_cell: float
    reached: float | None
    worst: str


@dataclass(frozen=True)
class Refined:
    """What came of making meshes finer.

    Attributes:
        trials: every mesh, coarse to fine.
        met: whether the last one is as certain as asked.
        coefficients: on the last mesh, with their errors.
        needed: cells that would be needed, by the assumed order; None when met.
    """

    trials: tuple[Trial, ...]
    met: bool
    coefficients: xr.Dataset
    needed: int | None

    @property
    def reached(self) -> float:
        """Worst uncertainty on the last mesh, as a fraction of the force's size."""
        return self.trials[-1].reached


def cells_in_memory() -> int:
    """Most cells that the machine's free memory holds while they are solved, and never above MOST_CELLS."""
    try:
        free = os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (ValueError, OSError):  # not told on this system
        return MOST_CELLS
    return max(FIRST_CELLS, min(MOST_CELLS, int(0.8 * free / BYTES_PER_CELL)))


def at_wall_cell(settings: MeshSettings, cell: float | None) -> MeshSettings:
    """Mesh settings with the wall cell, m, or for a first mesh of about FIRST_CELLS cells."""
    if cell is None:
        return replace(settings, target_cells=FIRST_CELLS)
    return replace(settings, wall_cell=cell, target_cells=None)


def relative(coefficients: xr.Dataset) -> np.ndarray:
    """[condition] largest of the uncertainties of JUDGED as a fraction of the force coefficient's size."""
    return _relative(coefficients).max(axis=0)


def refine(
    make: Callable[[float | None], Mesh],
    solve: Callable[[Mesh], xr.Dataset],
    accuracy: Accuracy,
    tell: Callable[[Trial], None] | None = None,
    companion: Callable[[float], xr.Dataset] | None = None,
) -> Refined:
    """Solve on finer and finer meshes until the estimated uncertainty is as small as asked or the next is too large.

    Each mesh is compared with the earlier one whose cells are nearest to twice as large, or with a companion of its
    own. The next wall cell is what the assumed order asks for, half the present one at least.

    Args:
        make: mesh of a wall cell, m; a first one of about FIRST_CELLS cells for None.
        solve: coefficients of every condition on a mesh, as `integrate` gives.
        accuracy: what is asked, and the most cells.
        tell: called with each mesh once it is solved.
        companion: coefficients on the companion of a mesh with this wall cell, m, RATIO times as coarse; None compares
            with earlier meshes.

    Raises:
        InputError: the cells allowed are too few for two meshes of this body.
    """
    mesh = make(None)
    runs = [(_wall_cell(mesh), mesh.cells, solve(mesh))]
    trials = [Trial(mesh.cells, runs[0][0], None, "")]
    if tell:
        tell(trials[0])
    finer = _within(make, runs, runs[0][0] / RATIO, accuracy.max_cells)
    if finer is None:
        raise InputError(f"max_cells: {accuracy.max_cells}, too few for two meshes of this body to compare")
    while True:
        runs.append((_wall_cell(finer), finer.cells, solve(finer)))
        found = _compared(runs, companion)
        share = _relative(found)
        reached = float(share.max()) if np.isfinite(share).all() else math.inf
        trials.append(Trial(finer.cells, runs[-1][0], reached, _where(found, share)))
        if tell:
            tell(trials[-1])
        met = reached <= accuracy.target
        wish = (MARGIN * accuracy.target / reached) ** (1.0 / ORDER) if reached else 1.0
        cell = runs[-1][0] * min(max(wish, 1.0 / RATIO), 1.0 / SMALLEST_STEP)
        finer = None if met else _within(make, runs, cell, accuracy.max_cells)
        if finer is None:
            return _stopped(runs, trials, accuracy, found, met)


Run = tuple[float, int, "xr.Dataset"]
"""Wall cell in m, cells and coefficients."""


def _within(make: Callable[[float | None], Mesh], runs: Sequence[Run], cell: float, most: int) -> Mesh | None:
    """The mesh of a wall cell, or the finest that has no more than `most` cells; None where that is hardly finer."""
    power = _power(runs)
    last, count = runs[-1][:2]
    cell = max(cell, last * (count / (0.97 * most)) ** (1.0 / power))
    for _ in range(5):
        if last / cell < 0.999 * SMALLEST_STEP:
            return None
        mesh = make(cell)
        if mesh.cells <= most:
            return mesh
        cell *= (mesh.cells / (0.95 * most)) ** (1.0 / power)
    return None


def _power(runs: Sequence[Run]) -> float:
    """How the cells grow with the inverse of the wall cell: seen on the last two meshes, or between surface and box."""
    if len(runs) < 2:
        return 1.7
    (large, few, _), (small, many, _) = runs[-2:]
    return min(max(math.log(many / few) / math.log(large / small), 1.0), 3.0)


def _compared(runs: Sequence[Run], companion: Callable[[float], xr.Dataset] | None) -> xr.Dataset:
    """Coefficients of the last run with errors, from its companion or from the earlier run nearest to one."""
    cell, _, coefficients = runs[-1]
    if companion is not None:
        return of_coefficients(coefficients, companion(cell), RATIO)
    other = min(runs[:-1], key=lambda run: abs(math.log(run[0] / cell / RATIO)))
    return of_coefficients(coefficients, other[2], other[0] / cell)


def _stopped(runs: Sequence[Run], trials: Sequence[Trial], accuracy: Accuracy, found: xr.Dataset, met: bool) -> Refined:
    needed = None
    if not met and math.isfinite(trials[-1].reached):
        needed = cells_needed(trials[-1].cells, trials[-1].reached, accuracy.target, _power(runs))
    return Refined(tuple(trials), met, found, needed)


def cells_needed(cells: int, reached: float, target: float, power: float = 2.0) -> int:
    """About the cells of the mesh on which the target would be reached.

    Args:
        cells: of a mesh.
        reached: uncertainty on it, as a fraction.
        target: uncertainty asked for, as a fraction.
        power: with which cells grow with the inverse of the wall cell; by default as surfaces do.
    """
    return round(cells * (reached / target) ** (power / ORDER))


def _relative(coefficients: xr.Dataset) -> np.ndarray:
    """[of JUDGED, condition] uncertainty as a fraction of the force coefficient's size."""
    totals = coefficients.sel(part=TOTAL)
    force = np.sqrt(sum(totals[name].values ** 2 for name in ("CL", "CD", "CY")))
    return np.stack([totals[f"{name}_error"].values for name in JUDGED]) / force


def _where(coefficients: xr.Dataset, share: np.ndarray) -> str:
    row, at = np.unravel_index(np.nan_to_num(share, nan=np.inf).argmax(), share.shape)
    one = coefficients.isel(condition=at)
    beta = f", beta {degrees(float(one.beta)):g} deg" if float(one.beta) else ""
    return f"{JUDGED[row]} at Mach {float(one.mach):g}, alpha {degrees(float(one.alpha)):g} deg{beta}"


def _wall_cell(mesh: Mesh) -> float:
    return float(mesh.record["wall_cell_m"])
