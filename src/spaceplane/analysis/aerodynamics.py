"""Coefficients and derivatives of a vehicle on one mesh, and with the error that a coarser mesh shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.bodies import ControlRun, SolvedBody, control_runs, is_symmetric, slopes_of, solve_vehicle
from spaceplane.aero.conditions import ConditionPlan
from spaceplane.aero.derivatives import differentiate
from spaceplane.aero.increments.add import integrate_with
from spaceplane.aero.increments.settings import Air
from spaceplane.aero.uncertainty.accuracy import Accuracy, Refined, at_wall_cell, cells_in_memory, refine
from spaceplane.aero.uncertainty.arms import arms_of
from spaceplane.aero.uncertainty.companion import RATIO, Companion, coarser
from spaceplane.aero.uncertainty.errors import of_coefficients, of_derivatives
from spaceplane.aero.uncertainty.settings import MESH, TIGHTEST
from spaceplane.analysis.settings import AnalyseSettings
from spaceplane.dynamics.flightpoint import FlightPoint
from spaceplane.flow.adapt import Adapted, adapt_mesh
from spaceplane.flow.compilation import begin
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings
from spaceplane.mesh.sizing import Sizing, sizes_of
from spaceplane.progress import Progress
from spaceplane.vehicle.build import build
from spaceplane.vehicle.presets import Vehicle

if TYPE_CHECKING:
    import xarray as xr

STRICTER = 0.95
"""Share of what is asked that the mesh is chosen by: the choice knows the base conditions alone, the result their
neighbours too, with which the estimate may come out a little larger."""


@dataclass(frozen=True)
class Aerodynamics:
    """Everything that the flow about one vehicle gave.

    Attributes:
        body: the base body, its mesh and flow.
        coefficients: of the base ensemble, by part.
        control_runs: one per moved surface and step.
        derivatives: dims (point, part).
        companion: the coarser run that the errors of the mesh come from; None without one.
        refined: the way to the accuracy asked for; None where none was.
        adapted: the way to a mesh that follows the base conditions; None where the mesh is that of the settings.
    """

    body: SolvedBody
    coefficients: xr.Dataset
    control_runs: tuple[ControlRun, ...]
    derivatives: xr.Dataset
    companion: Companion | None = None
    refined: Refined | None = None
    adapted: Adapted | None = None


def solve_aerodynamics(
    vehicle: Vehicle,
    settings: AnalyseSettings,
    plan: ConditionPlan,
    points: Sequence[FlightPoint],
    progress: Progress,
) -> Aerodynamics:
    """Coefficients and derivatives at all flight points, with their errors.

    Args:
        vehicle: shape and reference lengths.
        settings: which deflections, steps, mesh and flow, and whether there is a companion mesh.
        plan: conditions of the base ensemble.
        points: flight points, whose air the friction needs.
        progress: called with (phase, done, total, text).
    """
    refined = None
    if settings.accuracy is not None:
        refined = _refine(vehicle, settings, settings.accuracy, plan, points, progress)
        mesh = at_wall_cell(settings.mesh, refined.trials[-1].wall_cell)
        found = solve_aerodynamics(vehicle, replace(settings, mesh=mesh, accuracy=None), plan, points, progress)
        return replace(found, refined=refined)
    adapted = _adapt(vehicle, settings, plan, progress) if settings.adapt else None
    mesh = settings.mesh if adapted is None else adapted.settings
    fine = _on_mesh(vehicle, settings, plan, points, mesh, progress, adapted and sizes_of(adapted.mesh), resolved=True)
    if settings.uncertainty != MESH:
        return replace(_with_errors(fine, None, plan), adapted=adapted)
    wall_cell = float(fine.body.solution.mesh.record["wall_cell_m"])

    def say(phase: str, done: int, total: int, text: str) -> None:
        progress(f"companion of {phase}", done, total, text)

    twice = adapted and sizes_of(adapted.mesh, RATIO)
    coarse = _on_mesh(vehicle, settings, plan, points, coarser(mesh, wall_cell), say, twice)
    return replace(_with_errors(fine, coarse, plan), adapted=adapted)


def _adapt(vehicle: Vehicle, settings: AnalyseSettings, plan: ConditionPlan, progress: Progress) -> Adapted:
    """A mesh that follows the base conditions; their neighbours and moved control surfaces get cells of its sizes."""

    def say(phase: str, done: int, total: int, text: str) -> None:
        progress(f"adaptation: {phase}", done, total, text)

    surface = build(vehicle.shape, settings.deflections)
    conditions = plan.conditions.take(np.array([p.base for p in plan.points]))
    begin(settings.flow, conditions)
    return adapt_mesh(surface, settings.mesh, conditions, settings.flow, settings.adapt, say)


def _refine(
    vehicle: Vehicle,
    settings: AnalyseSettings,
    target: float,
    plan: ConditionPlan,
    points: Sequence[FlightPoint],
    progress: Progress,
) -> Refined:
    """Finer and finer meshes with the base conditions alone."""
    surface = build(vehicle.shape, settings.deflections)
    conditions = plan.conditions.take(np.array([p.base for p in plan.points]))
    air = Air.of([p.ambient for p in points])
    begin(settings.flow, conditions)

    def say(phase: str, done: int, total: int, text: str) -> None:
        progress(f"accuracy: {phase}", done, total, text)

    def make(cell: float | None) -> Mesh:
        return generate(surface, at_wall_cell(settings.mesh, cell), say)

    def solved(mesh: Mesh) -> xr.Dataset:
        solution = solve(mesh, conditions, settings.flow, say)
        return integrate_with(solution, vehicle.reference, settings.increments, air)

    def companion(cell: float) -> xr.Dataset:
        return solved(generate(surface, coarser(settings.mesh, cell), say))

    asked = Accuracy(max(STRICTER * target, TIGHTEST), settings.mesh.target_cells or cells_in_memory())
    return refine(make, solved, asked, companion=companion)


def _on_mesh(
    vehicle: Vehicle,
    settings: AnalyseSettings,
    plan: ConditionPlan,
    points: Sequence[FlightPoint],
    mesh: MeshSettings,
    say: Progress,
    sizing: Sizing | None = None,
    resolved: bool = False,
) -> Aerodynamics:
    flow = settings.flow
    body = solve_vehicle(vehicle, settings.deflections, plan.conditions, mesh, flow, say, "base", sizing, resolved)
    say("coefficients", 0, 1, "")
    air = Air.of([points[i].ambient for i in plan.point])
    coefficients = integrate_with(body.solution, vehicle.reference, settings.increments, air)
    derivatives = differentiate(coefficients, plan)
    if not settings.controls:
        return Aerodynamics(body, coefficients, (), derivatives)
    rows = np.array([p.base for p in plan.points])
    runs = control_runs(
        vehicle,
        settings.deflections,
        settings.control_step,
        plan.conditions.take(rows),
        replace(mesh, wall_cell=float(body.solution.mesh.record["wall_cell_m"]), target_cells=None),
        settings.flow,
        settings.steps.two_step_sizes,
        say,
        settings.increments,
        Air.of([p.ambient for p in points]),
        sizing,
    )
    slopes = slopes_of(coefficients.isel(condition=rows), runs, is_symmetric(settings.deflections))
    import xarray as xr

    return Aerodynamics(body, coefficients, runs, xr.merge([derivatives, slopes], join="exact"))


def _with_errors(fine: Aerodynamics, coarse: Aerodynamics | None, plan: ConditionPlan) -> Aerodynamics:
    """The findings on the fine mesh with their errors; those of the mesh from the coarse one where there is one."""
    companion = None if coarse is None else _companion(coarse)
    others = [None] * len(fine.control_runs) if coarse is None else [run.coefficients for run in coarse.control_runs]
    runs = tuple(
        replace(run, coefficients=of_coefficients(run.coefficients, other, RATIO))
        for run, other in zip(fine.control_runs, others, strict=True)
    )
    mach = np.array([plan.conditions.mach[p.base] for p in plan.points])
    slopes = None if coarse is None else coarse.derivatives
    return Aerodynamics(
        fine.body,
        of_coefficients(fine.coefficients, companion and companion.coefficients, RATIO),
        runs,
        of_derivatives(fine.derivatives, slopes, mach, RATIO, arms_of(fine.coefficients)),
        companion,
    )


def _companion(coarse: Aerodynamics) -> Companion:
    """What is kept of the coarse run: neither mesh nor flow."""
    seconds = dict(coarse.body.seconds)
    for run in coarse.control_runs:
        seconds = {key: seconds[key] + run.seconds[key] for key in seconds}
    records = (*coarse.body.solution.records, *(one for run in coarse.control_runs for one in run.records))
    mesh = coarse.body.solution.mesh
    return Companion(coarse.coefficients, records, RATIO, float(mesh.record["wall_cell_m"]), mesh.cells, seconds)
