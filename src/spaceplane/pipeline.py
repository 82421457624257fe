"""The composition: from a vehicle to its flying qualities, every stage in turn."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from spaceplane import __version__
from spaceplane.aero.bodies import ControlRun, is_symmetric
from spaceplane.aero.conditions import ConditionPlan
from spaceplane.aero.conditions import plan as plan_conditions
from spaceplane.aero.database import SolvedCases, assemble
from spaceplane.analysis.aerodynamics import solve_aerodynamics
from spaceplane.analysis.flight import fly
from spaceplane.analysis.found import Analysis, remarks
from spaceplane.analysis.settings import AnalyseSettings
from spaceplane.dynamics.linearise import check_form
from spaceplane.files import writable_folder
from spaceplane.flow.settings import check
from spaceplane.progress import Progress, silent
from spaceplane.report.output import write
from spaceplane.vehicle.controls import CONTROLS, ControlDeflections
from spaceplane.vehicle.presets import Vehicle

if TYPE_CHECKING:
    import xarray as xr


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
    check_form(settings.form, vehicle.mass)
    say = progress or silent
    points = settings.flight_points()
    symmetric = is_symmetric(settings.deflections)
    plan = plan_conditions(list(points), settings.steps, symmetric, reference=vehicle.reference, gas=settings.gas)
    check(plan.conditions)
    aero = solve_aerodynamics(vehicle, settings, plan, points, say)
    base = aero.coefficients.isel(condition=[p.base for p in plan.points])
    say("flight dynamics", 0, 1, "")
    length = float(np.ptp(aero.body.surface.bounds[:, 0]))
    found = tuple(fly(p, i, vehicle, settings, base, aero.derivatives, length) for i, p in enumerate(points))
    cases = _cases(settings, plan, aero.coefficients, aero.control_runs)
    return Analysis(
        vehicle=vehicle,
        settings=settings,
        plan=plan,
        aerodynamics=aero,
        points=found,
        database=assemble(cases, aero.derivatives, [p.name for p in points], __version__),
        warnings=remarks(vehicle, plan, aero, found),
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
