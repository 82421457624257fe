"""The published record of an analysis: what `result.json` holds (schema in docs/formats.md)."""

from __future__ import annotations

from dataclasses import asdict
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import numpy as np

from spaceplane import __version__
from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.aero.conditions import ConditionPlan
from spaceplane.aero.increments.add import INVISCID, WITH_SOURCES
from spaceplane.aero.integrate import BY_SOURCE, COEFFICIENTS, PRESSURES, TOTAL, wetted_area
from spaceplane.aero.uncertainty.accuracy import cells_needed, relative
from spaceplane.aero.uncertainty.errors import OF_MESH, OF_STEP, error_record
from spaceplane.aero.uncertainty.grid import LEVEL, ORDER, SAFETY, SAFETY_SUPERSONIC
from spaceplane.aero.uncertainty.settings import ITERATION, MESH
from spaceplane.analysis.flight import PointAnalysis
from spaceplane.analysis.found import Analysis
from spaceplane.analysis.tracked import track
from spaceplane.flow.solution import ConvergenceRecord
from spaceplane.plain import degrees, plain
from spaceplane.qualities.outlook_record import mode_records, verdict_records
from spaceplane.report import branches
from spaceplane.report.control_record import control_record
from spaceplane.report.read import SCHEMA, SCHEMA_VERSION
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.presets import Vehicle
from spaceplane.vehicle.shape import PARAMETERS
from spaceplane.vehicle.surface import Surface

if TYPE_CHECKING:
    import xarray as xr


def result(analysis: Analysis) -> dict:
    """The whole record of an analysis, ready for JSON: no NaN, missing numbers None."""
    return plain(
        {
            "schema": SCHEMA,
            "schema_version": SCHEMA_VERSION,
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
            "version": __version__,
            "vehicle": vehicle(analysis.vehicle, analysis.settings.deflections, analysis.body.surface),
            "settings": analysis.settings.as_dict(),
            "mesh": mesh(analysis),
            "solver": solver(analysis),
            "uncertainty": uncertainty(analysis),
            "accuracy": accuracy(analysis),
            "flight_points": [flight_point(analysis, index) for index in range(len(analysis.points))],
            "mode_branches": mode_branches(analysis),
            "warnings": list(analysis.warnings),
        }
    )


def mode_branches(analysis: Analysis) -> dict:
    """Modes followed through the flight points along the Mach number."""
    points = [found.point for found in analysis.points]
    return branches.record(track(points, [found.system for found in analysis.points]), [p.name for p in points])


def vehicle(subject: Vehicle, deflections: ControlDeflections, surface: Surface) -> dict:
    """Shape, mass, reference lengths and geometry."""
    shape = subject.shape.as_dict()
    lower, upper = surface.bounds
    extent = upper - lower
    mass, reference = subject.mass, subject.reference
    return {
        "name": subject.name,
        "shape": {
            p.name: {"value": shape[p.name], "unit": p.unit, "default": p.default, "lower": p.lower, "upper": p.upper}
            for p in PARAMETERS
        },
        "deflections_deg": {name: round(value, 10) for name, value in deflections.to_degrees().items()},
        "mass": {
            "mass_kg": mass.mass,
            "Ixx_kgm2": mass.Ixx,
            "Iyy_kgm2": mass.Iyy,
            "Izz_kgm2": mass.Izz,
            "Ixz_kgm2": mass.Ixz,
        },
        "reference": {
            "area_m2": reference.area,
            "c_ref_m": reference.chord,
            "b_ref_m": reference.span,
            "moment_center_m": list(reference.moment_center),
        },
        "geometry": {
            "length_m": extent[0],
            "span_m": extent[1],
            "height_m": extent[2],
            "wetted_area_m2": surface.area,
            "volume_m3": surface.volume,
            "triangles": len(surface.triangles),
        },
    }


def flight_point(analysis: Analysis, index: int) -> dict:
    """One flight point with everything that was found there."""
    found = analysis.points[index]
    point, ambient = found.point, found.point.ambient
    totals = analysis.coefficients.isel(condition=analysis.plan.points[index].base).sel(part=TOTAL)
    coefficients = {name: float(totals[name]) for name in (*COEFFICIENTS, *PRESSURES)}
    coefficients["L_over_D"] = coefficients["CL"] / coefficients["CD"] if coefficients["CD"] else None
    record = {
        "name": point.name,
        "mach": point.mach,
        "altitude_m": point.altitude,
        "alpha_deg": degrees(point.alpha),
        "beta_deg": degrees(point.beta),
        "gamma_deg": degrees(point.gamma),
        "bank_deg": degrees(point.bank),
        "velocity_ms": point.velocity,
        "dynamic_pressure_Pa": point.dynamic_pressure,
        "pressure_Pa": ambient.pressure,
        "temperature_K": ambient.temperature,
        "density_kgm3": ambient.density,
        "alpha_source": point.alpha_source,
        "knudsen": found.validity.knudsen,
        "compressibility_factor": found.validity.compressibility_factor,
        "validity": {
            "continuum": found.validity.continuum,
            "ideal_gas": found.validity.ideal_gas,
            "notes": list(found.validity.notes),
        },
        "coefficients": coefficients,
        **error_record(totals),
        "coefficients_by_source": coefficients_by_source(totals),
        "coefficients_by_part": coefficients_by_part(analysis.coefficients, analysis.plan.points[index].base),
        "derivatives": derivatives(analysis.derivatives, index),
        "convergence": convergence(analysis, index),
    }
    return record | dynamics(found)


def coefficients_by_part(coefficients: xr.Dataset, condition: int) -> dict:
    """Part to coefficient to value at one condition."""
    at = coefficients.isel(condition=condition)
    return {
        str(part): {name: float(at[name].sel(part=part)) for name in FORCES_AND_MOMENTS}
        for part in at.part.values
        if part != TOTAL
    }


def coefficients_by_source(totals: xr.Dataset) -> dict:
    """Source ("inviscid", "friction", "base") to coefficient to value in total at one condition.

    Args:
        totals: coefficients of the whole vehicle at one condition; without increments all is inviscid.
    """
    if "source" not in totals.coords:
        return {INVISCID: {name: float(totals[name]) for name in WITH_SOURCES}}
    return {
        str(source): {name: float(totals[f"{name}{BY_SOURCE}"].sel(source=source)) for name in WITH_SOURCES}
        for source in totals.source.values
    }


def derivatives(data: xr.Dataset, point: int) -> dict:
    """Name to value, error, unit, step and status, in total and by part, at one flight point."""
    at = data.isel(point=point)
    names = [name for name in at.data_vars if f"{name}_status" in at.data_vars]
    return {
        name: {
            "value": float(at[name].sel(part=TOTAL)),
            "error": float(at[f"{name}_error"]),
            "error_by_source": derivative_error_by_source(at, name),
            "unit": at[name].attrs["units"],
            "step": float(at[f"{name}_step"]),
            "step_unit": at[f"{name}_step"].attrs["units"],
            "status": str(at[f"{name}_status"].values),
            "by_part": {str(part): float(at[name].sel(part=part)) for part in at.part.values if part != TOTAL},
        }
        for name in names
    }


def derivative_error_by_source(at: xr.Dataset, name: str) -> dict:
    """Source ("difference", "mesh") to error of a derivative at one flight point; "mesh" only where it is known."""
    if f"{name}{OF_MESH}" not in at:
        return {"difference": float(at[f"{name}_error"])}
    return {"difference": float(at[f"{name}{OF_STEP}"]), MESH: float(at[f"{name}{OF_MESH}"])}


def uncertainty(analysis: Analysis) -> dict:
    """What the stated errors hold, and the companion mesh that those of the mesh come from."""
    companion = analysis.aerodynamics.companion
    if companion is None:
        return {"sources": [ITERATION]}
    return {
        "sources": [ITERATION, MESH],
        "level": LEVEL,
        "ratio": companion.ratio,
        "order": ORDER,
        "safety": SAFETY,
        "safety_supersonic": SAFETY_SUPERSONIC,
        "wall_cell_m": companion.wall_cell,
        "cells": companion.cells,
        "conditions": len(companion.records),
        "unconverged": sum(not one.good for one in companion.records),
    }


def accuracy(analysis: Analysis) -> dict | None:
    """What accuracy was asked for and what was reached at the base conditions; None where none was asked for."""
    refined = analysis.aerodynamics.refined
    if refined is None:
        return None
    rows = [p.base for p in analysis.plan.points]
    reached = float(relative(analysis.coefficients.isel(condition=rows)).max())
    target = analysis.settings.accuracy
    cells = analysis.body.solution.mesh.cells
    return {
        "target": target,
        "reached": reached,
        "met": reached <= target,
        "needed_cells": cells_needed(cells, reached, target) if reached > target else None,
        "meshes": [asdict(trial) for trial in refined.trials],
    }


def convergence(analysis: Analysis, point: int) -> list[dict]:
    """How each condition of a flight point converged, those of the moved control surfaces included."""
    plan, solution = analysis.plan, analysis.body.solution
    scale = wetted_area(solution.mesh) / analysis.vehicle.reference.area
    rows = [
        convergence_row(solution.records[i], plan, i, plan.labels[i], scale)
        for i in np.flatnonzero(plan.point == point)
    ]
    base = plan.points[point].base
    for run in analysis.control_runs:
        rows.append(convergence_row(run.records[point], plan, base, run.label, run.force_scale))
    return rows


def convergence_row(one: ConvergenceRecord, plan: ConditionPlan, condition: int, label: str, scale: float) -> dict:
    """How one condition converged; `scale` is the factor that takes its forces to the reference area.

    Args:
        one: how it converged; forces on the wetted area.
        plan: of the ensemble that the condition's free stream is taken from.
        condition: its number there.
        label: what the condition is for.
        scale: wetted area over reference area.
    """
    spread = np.asarray(one.window_spread) * scale
    return {
        "label": label,
        "mach": plan.conditions.mach[condition],
        "alpha_deg": degrees(plan.conditions.alpha[condition]),
        "beta_deg": degrees(plan.conditions.beta[condition]),
        "verdict": one.verdict,
        "residual_drop": one.residual_drop,
        "iterations": one.iterations,
        "window_spread": dict(zip(("CA", "CY", "CN"), spread, strict=True)),
        "residual_history": np.asarray(one.residual_history),
        "force_history": np.asarray(one.force_history) * scale,
        "reason": one.reason,
    }


def dynamics(found: PointAnalysis) -> dict:
    """Equilibrium, linear model, modes and verdicts at one flight point; empty where there are none."""
    rates, system = found.rates, found.system
    on_modes, on_airframe = verdict_records((*found.verdicts, *found.airframe_verdicts), found.outlooks)
    return {
        "equilibrium": {
            "p_rads": rates.p if rates else None,
            "q_rads": rates.q if rates else None,
            "r_rads": rates.r if rates else None,
        },
        "A": system.A if system else None,
        "B": system.B if system else None,
        "states": system.states if system else [],
        "inputs": system.inputs if system else [],
        "form": system.form if system else None,
        "modes": mode_records(found.modes, found.sensitivities, found.uncertainty),
        "verdicts": on_modes,
        "airframe_verdicts": on_airframe,
        "reason": found.reason,
        "control": control_record(found.control),
    }


def mesh(analysis: Analysis) -> dict:
    """What the generator has to say of the base mesh, and its size against the surface."""
    made = analysis.body.solution.mesh
    kept = {key: value for key, value in made.record.items() if key not in ("settings", "errors_by_part")}
    adapted = analysis.aerodynamics.adapted
    steps = None if adapted is None else {"passes": len(adapted.cells) - 1, "cells": list(adapted.cells)}
    return {**kept, "cells": made.cells, "adaptation": steps, "seconds": analysis.body.seconds["mesh"]}


def solver(analysis: Analysis) -> dict:
    """Wall times, precision and number of conditions."""
    seconds, statistics = analysis.seconds(), analysis.body.solution.statistics
    return {
        "seconds": sum(value for name, value in seconds.items() if name.startswith("flow")),
        "seconds_by_phase": seconds,
        "precision": statistics.get("precision"),
        "conditions": sum(len(run.records) for run in analysis.control_runs) + len(analysis.plan.conditions),
        "base_ensemble": statistics,
    }
