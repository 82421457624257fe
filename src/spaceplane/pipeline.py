"""The composition: from a vehicle to its flying qualities, every stage in turn."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from spaceplane import __version__
from spaceplane.aero.bodies import ControlRun, control_runs, is_symmetric, slopes_of, solve_vehicle
from spaceplane.aero.conditions import ConditionPlan
from spaceplane.aero.conditions import plan as plan_conditions
from spaceplane.aero.database import SolvedCases, assemble
from spaceplane.aero.derivatives import differentiate
from spaceplane.aero.increments.add import integrate_with
from spaceplane.aero.increments.settings import Air
from spaceplane.analysis.flight import fly
from spaceplane.analysis.found import Analysis, remarks
from spaceplane.analysis.settings import AnalyseSettings
from spaceplane.files import writable_folder
from spaceplane.flow.settings import check
from spaceplane.progress import Progress, silent
from spaceplane.report.output import write
from spaceplane.vehicle.controls import CONTROLS, ControlDeflections
from spaceplane.vehicle.presets import Vehicle


def analyse(vehicle: Vehicle, settings: AnalyseSettings | None = None, progress: Progress | None = None) -> Analysis:
    """From a vehicle to its flying qualities: shape, mesh, flow, coefficients, derivatives, modes, verdicts.

    All conditions of all flight points are one ensemble on one mesh; each moved control surface is one body, mesh and
    ensemble more. A condition that fails is reported as failed, and nothing is computed from it.

    Args:
        vehicle: shape, mass and reference lengths.
        settings: defaults when None.
        progress: called with (phase, done, total, text).

    Raises:
        InputError: something in the vehicle or the settings is not allowed.
    """
    settings = settings or AnalyseSettings()
    say = progress or silent
    points = settings.flight_points()
    symmetric = is_symmetric(settings.deflections)
    plan = plan_conditions(list(points), settings.steps, symmetric, reference=vehicle.reference, gas=settings.gas)
    check(plan.conditions)
    body = solve_vehicle(vehicle, settings.deflections, plan.conditions, settings.mesh, settings.flow, say, "base")
    say("coefficients", 0, 1, "")
    air = Air.of([points[i].ambient for i in plan.point])
    coefficients = integrate_with(body.solution, vehicle.reference, settings.increments, air)
    base = coefficients.isel(condition=[p.base for p in plan.points])
    derivatives = differentiate(coefficients, plan)
    runs: tuple[ControlRun, ...] = ()
    if settings.controls:
        wall_cell = float(body.solution.mesh.record["wall_cell_m"])
        runs = _control_runs(vehicle, settings, plan, wall_cell, Air.of([p.ambient for p in points]), say)
        slopes = slopes_of(base, runs, symmetric)
        derivatives = xr.merge([derivatives, slopes], join="exact")
    say("flight dynamics", 0, 1, "")
    length = float(np.ptp(body.surface.bounds[:, 0]))
    found = tuple(fly(p, i, vehicle, settings, base, derivatives, length) for i, p in enumerate(points))
    return Analysis(
        vehicle=vehicle,
        settings=settings,
        body=body,
        plan=plan,
        coefficients=coefficients,
        control_runs=runs,
        derivatives=derivatives,
        points=found,
        database=assemble(
            _cases(settings, plan, coefficients, runs), derivatives, [p.name for p in points], __version__
        ),
        warnings=remarks(vehicle, body, plan, runs, found, derivatives),
    )


def _control_runs(
    vehicle: Vehicle, settings: AnalyseSettings, plan: ConditionPlan, wall_cell: float, air: Air, say: Progress
) -> tuple[ControlRun, ...]:
    """The base conditions on bodies with one surface moved, on the wall cell, m, of the base mesh and in its air."""
    rows = np.array([p.base for p in plan.points])
    return control_runs(
        vehicle,
        settings.deflections,
        settings.control_step,
        plan.conditions.take(rows),
        replace(settings.mesh, wall_cell=wall_cell, target_cells=None),
        settings.flow,
        settings.steps.two_step_sizes,
        say,
        settings.increments,
        air,
    )


def _cases(
    settings: AnalyseSettings, plan: ConditionPlan, coefficients: xr.Dataset, runs: tuple[ControlRun, ...]
) -> list[SolvedCases]:
    """The base ensemble and those of the moved surfaces, as the database takes them."""

    def of(deflections: ControlDeflections) -> dict[str, float]:
        return {name: getattr(deflections, name) for name in CONTROLS}

    cases = [SolvedCases(coefficients, plan.labels, plan.point, of(settings.deflections))]
    for run in runs:
        count = len(run.records)
        cases.append(SolvedCases(run.coefficients, [run.label] * count, range(count), of(run.deflections)))
    return cases


def run(vehicle: Vehicle, settings: AnalyseSettings, out_dir: Path | str, progress: Progress | None = None) -> Analysis:
    """Analyse and write into `out_dir`, the folder being checked before anything is computed.

    Args:
        vehicle, settings, progress: as for `analyse`.
        out_dir: folder of the files, made if need be; see `report.output.write`.

    Raises:
        InputError: as `analyse`, or the folder cannot be written.
    """
    folder = writable_folder(out_dir)
    analysis = analyse(vehicle, settings, progress)
    (progress or silent)("report", 0, 1, str(folder))
    write(analysis, folder)
    return analysis
