"""An aerodynamic database of a vehicle from its own flow: every block stored as it is finished, then the tables."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from spaceplane.aero.model.model import AeroModel
from spaceplane.analysis.tables.assemble import Remark, model_of, remarks
from spaceplane.analysis.tables.settings import EULER, TableSettings
from spaceplane.analysis.tables.solve import Block, blocks, evaluate, inputs_of
from spaceplane.errors import InputError
from spaceplane.mesh.generate import generate
from spaceplane.study.execute import execute
from spaceplane.study.records import Case, Evaluate, Progress
from spaceplane.study.store import ResultStore
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.presets import Vehicle


@dataclass(frozen=True)
class Database:
    """What was found.

    Attributes:
        vehicle: whose flow it is.
        settings: what was asked, with the wall cell of the mesh.
        model: the tables.
        blocks: what was computed in one piece each.
        results: [block] of `analysis.tables.solve.solve_block`; None where it failed.
        remarks: conditions and blocks that did not converge.
        computed, reused: blocks computed now, and found in the store.
        seconds: wall-clock time, s.
    """

    vehicle: Vehicle
    settings: TableSettings
    model: AeroModel
    blocks: tuple[Block, ...]
    results: tuple[dict | None, ...]
    remarks: tuple[Remark, ...]
    computed: int
    reused: int
    seconds: float

    @property
    def conditions(self) -> int:
        """How many were solved, in all."""
        return sum(result["conditions"] for result in self.results if result is not None)


def run(
    vehicle: Vehicle,
    settings: TableSettings,
    store_path: Path | str,
    progress: Callable[[Progress], None] | None = None,
    workers: int = 1,
    evaluate: Evaluate = evaluate,
    before: Callable[[], object] | None = None,
) -> Database:
    """Compute what the store lacks of a database and put the tables together.

    Args:
        vehicle: shape, mass and reference lengths.
        settings: which tables, and how.
        store_path: the result store; a database that was cut short goes on from it.
        progress: called on every change of the count of finished blocks.
        workers: processes that compute at once.
        evaluate: from a block's inputs to its result.
        before: called once, when the input has been checked and before anything is computed.

    Raises:
        InputError: bad input, a damaged store, or no result at all of the undeflected vehicle.
        KeyboardInterrupt: as `execute.execute`; run again to go on.
    """
    ResultStore(store_path).close()  # a store that cannot be used is told before anything is meshed
    if before:
        before()
    settings = with_one_wall_cell(vehicle, settings)
    asked = blocks(settings)
    cases = [Case(block.label, inputs_of(vehicle, settings, block)) for block in asked]
    outcome = execute(cases, evaluate, store_path, progress, workers)
    why = {failure.label: failure.reason for failure in outcome.failures}
    reasons = [why.get(block.label, "") for block in asked]
    found = remarks(asked, outcome.results, reasons)
    try:
        model = model_of(vehicle, settings, asked, outcome.results)
    except InputError as error:
        raise InputError(f"{error}" + (f": {found[0].line}" if found else "")) from error
    return Database(
        vehicle, settings, model, asked, outcome.results, found, outcome.computed, outcome.reused, outcome.seconds
    )


def with_one_wall_cell(vehicle: Vehicle, settings: TableSettings) -> TableSettings:
    """The settings with the wall cell, m, that a number of cells gives the undeflected vehicle, for all its shapes.

    An increment is the difference of two shapes, and holds as little as may be of the difference of two meshes.

    Args:
        vehicle: shape.
        settings: of the database; those without a number of cells come back as they are.
    """
    if settings.tier != EULER or settings.mesh.target_cells is None:
        return settings
    mesh = generate(build(vehicle.shape, ControlDeflections()), settings.mesh)
    cell = float(mesh.record["wall_cell_m"])
    return replace(settings, mesh=replace(settings.mesh, wall_cell=cell, target_cells=None))
