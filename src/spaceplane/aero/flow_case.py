"""Any body in any list of free streams: coefficients as plain records."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from spaceplane.aero.free_streams import FreeStreams, require_along_symmetry
from spaceplane.aero.increments.add import integrate_with
from spaceplane.aero.integrate import Reference
from spaceplane.aero.records import records, total_seconds
from spaceplane.aero.uncertainty.accuracy import Accuracy, Refined, Trial, at_wall_cell, refine, relative
from spaceplane.aero.uncertainty.companion import RATIO, Companion, coarser
from spaceplane.aero.uncertainty.errors import of_coefficients
from spaceplane.aero.uncertainty.settings import ITERATION, MESH
from spaceplane.flow.adapt import adapt_mesh, follower, solve_last
from spaceplane.flow.compilation import begin
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions, Solution
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.resolution import require_resolved
from spaceplane.mesh.settings import MeshSettings, check_passes
from spaceplane.mesh.sizing import sizes_of
from spaceplane.plain import finite
from spaceplane.progress import Progress, silent
from spaceplane.vehicle.surface import Surface

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class FlowCase:
    """What `run_flow` found.

    Attributes:
        records: one JSON-ready dict per condition, see `records`.
        coefficients: the same by part, see `integrate_with`.
        mesh: the mesh.
        solution: the flow.
        companion: the same on a coarser mesh, for the errors of the mesh; None where there is none.
    """

    records: list[dict]
    coefficients: xr.Dataset
    mesh: Mesh
    solution: Solution
    companion: Companion | None = None


def run_flow(
    body: Surface,
    streams: FreeStreams,
    reference: Reference,
    mesh_settings: MeshSettings,
    flow_settings: FlowSettings,
    progress: Progress | None = None,
    uncertainty: str = ITERATION,
    adapt: int = 0,
) -> FlowCase:
    """Mesh a body and solve all free streams in one ensemble.

    Args:
        body: watertight surface.
        streams: what comes towards it.
        reference: area, chord, span and moment centre, SI.
        mesh_settings: how to mesh.
        flow_settings: how to solve.
        progress: passed on to the solver.
        uncertainty: "mesh" solves everything again on a coarser companion mesh, and `coefficient_errors` of the records
            hold the uncertainty by the mesh; "iteration" leaves that out.
        adapt: passes that adapt the mesh to the flow, see `adapt_mesh`; the companion then has cells twice as large
            as those of the last mesh everywhere.

    Raises:
        InputError: as `FreeStreams.conditions`, a bad body, adaptation without a number of cells, or a mesh so coarse
            that forces mean nothing, see `require_resolved`.
    """
    conditions = streams.conditions(reference, body.points)
    solution = _solved(body, mesh_settings, conditions, flow_settings, adapt, progress)
    case = _told(solution, reference, streams)
    if uncertainty != MESH:
        return case

    def say(phase: str, done: int, total: int, text: str) -> None:
        (progress or silent)(f"companion: {phase}", done, total, text)

    wall_cell = float(case.mesh.record["wall_cell_m"])
    own = follower(mesh_settings, wall_cell) if adapt else mesh_settings
    twice = sizes_of(case.mesh, RATIO) if adapt else None
    coarse = generate(body, coarser(own, wall_cell), say, twice)
    return _compared(case, _told(solve(coarse, conditions, flow_settings, say), reference, streams), RATIO)


def _solved(
    body: Surface,
    settings: MeshSettings,
    conditions: FlowConditions,
    flow_settings: FlowSettings,
    adapt: int,
    progress: Progress | None,
) -> Solution:
    """The flow on the mesh of the settings, or on one that `adapt` passes made follow it; not on one too coarse."""
    begin(flow_settings, conditions)
    if check_passes("adapt", adapt):
        adapted = adapt_mesh(body, settings, conditions, flow_settings, adapt, progress)
        require_resolved(body, settings, adapted.mesh, adapted=True)
        return solve_last(adapted, conditions, flow_settings, progress)
    (progress or silent)("mesh", 0, 1, "")
    mesh = generate(body, settings, progress)
    require_resolved(body, settings, mesh)
    return solve(mesh, conditions, flow_settings, progress)


def run_to_accuracy(
    body: Surface,
    streams: FreeStreams,
    reference: Reference,
    mesh_settings: MeshSettings,
    flow_settings: FlowSettings,
    accuracy: Accuracy,
    progress: Progress | None = None,
    tell: Callable[[Trial], None] | None = None,
) -> tuple[FlowCase, Refined]:
    """As `run_flow`, on meshes made finer until the coefficients are as certain as asked; the last mesh's flow.

    Args:
        body, streams, reference, flow_settings, progress: as for `run_flow`.
        mesh_settings: how to mesh; the wall cell is chosen here.
        accuracy: what is asked, and the most cells; see `refine`.
        tell: called with each mesh once it is solved.

    Returns:
        The case, whose records hold `coefficient_errors` and `accuracy` ("target", "reached", "met" of the condition),
        and the way there.

    Raises:
        InputError: as `run_flow`, or fewer cells allowed than two meshes of this body have.
    """
    conditions = streams.conditions(reference, body.points)
    last: FlowCase | None = None
    number = 1
    begin(flow_settings, conditions)

    def say(phase: str, done: int, total: int, text: str) -> None:
        (progress or silent)(f"mesh {number}: {phase}", done, total, text)

    def make(cell: float | None) -> Mesh:
        return generate(body, at_wall_cell(mesh_settings, cell), say)

    def solved(mesh: Mesh) -> xr.Dataset:
        nonlocal last, number
        last = None  # its state is as large as the next one's
        last = _told(solve(mesh, conditions, flow_settings, say), reference, streams)
        number += 1
        return last.coefficients

    found = refine(make, solved, accuracy, tell)
    case = last
    rows = records(case.solution, found.coefficients)
    for row, reached in zip(rows, relative(found.coefficients), strict=True):
        met = bool(reached <= accuracy.target)
        row["accuracy"] = {"target": accuracy.target, "reached": finite(reached), "met": met}
    return replace(case, records=rows, coefficients=found.coefficients), found


def run_on_mesh(
    mesh: Mesh,
    streams: FreeStreams,
    reference: Reference,
    flow_settings: FlowSettings,
    progress: Progress | None = None,
) -> FlowCase:
    """Solve all free streams on a mesh that is there already.

    Args:
        mesh: ours or an imported one; coefficients of half a body, cut at a plane of symmetry, are those of that half.
        streams, reference, flow_settings, progress: as for `run_flow`.

    Raises:
        InputError: as `FreeStreams.conditions`, or a free stream that goes through a plane of symmetry, or rates beside
            one.
    """
    conditions = streams.conditions(reference, mesh.wall_center[mesh.body_wall])
    require_along_symmetry(mesh, conditions)
    return _told(solve(mesh, conditions, flow_settings, progress), reference, streams)


def _told(solution: Solution, reference: Reference, streams: FreeStreams) -> FlowCase:
    """The case of this flow, with errors of the iteration alone."""
    found = integrate_with(solution, reference, streams.increments, streams.air())
    coefficients = of_coefficients(found, None, RATIO)
    return FlowCase(records(solution, coefficients), coefficients, solution.mesh, solution)


def _compared(case: FlowCase, coarse: FlowCase, ratio: float) -> FlowCase:
    """The case with the errors that a coarser mesh, of cells `ratio` times as large, shows."""
    coefficients = of_coefficients(case.coefficients, coarse.coefficients, ratio)
    companion = Companion(
        coarse.coefficients,
        coarse.solution.records,
        ratio,
        float(coarse.mesh.record["wall_cell_m"]),
        coarse.mesh.cells,
        {"flow": total_seconds(coarse.solution)},
    )
    return replace(case, records=records(case.solution, coefficients), coefficients=coefficients, companion=companion)
