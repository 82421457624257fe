"""The composition: from a vehicle to its flying qualities, every stage in turn."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from spaceplane import __version__
from spaceplane.aero.bodies import ControlRun, SolvedBody, control_runs, is_symmetric, slopes_of, solve_vehicle
from spaceplane.aero.conditions import ConditionPlan, DerivativeSteps
from spaceplane.aero.conditions import plan as plan_conditions
from spaceplane.aero.database import AeroDatabase, SolvedCases, assemble
from spaceplane.aero.derivatives import CONVERGED, differentiate
from spaceplane.aero.integrate import TOTAL, integrate
from spaceplane.dynamics.derivatives import COEFFICIENTS, STATIC, Derivatives
from spaceplane.dynamics.flightpoint import AngularRates, FlightPoint, equilibrium_rates, taem_point
from spaceplane.dynamics.linearise import FORMS, linearise
from spaceplane.dynamics.modes import Mode, identify
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.environment.constants import STANDARD_GRAVITY
from spaceplane.environment.validity import Validity, assess_validity
from spaceplane.errors import InputError, unknown_name
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.mesh.settings import MeshSettings, RefinementBox
from spaceplane.qualities import limits
from spaceplane.qualities.assess import Verdict, assess, load_factor_slope
from spaceplane.report import record
from spaceplane.report.output import check_output, write
from spaceplane.vehicle.controls import CONTROLS, ControlDeflections
from spaceplane.vehicle.presets import Vehicle

Progress = Callable[[str, int, int, str], None]
"""Called with (phase, done, total, text); calls of the solver have the name of the body before the phase."""

DEFLECTIONS_TAEM = ControlDeflections.from_degrees(elevon_left=-17.5, elevon_right=-17.5, body_flap=-20.0)
"""Deflections of the thesis's flight points (its section 7.1)."""


@dataclass(frozen=True)
class AnalyseSettings:
    """What is analysed and how; every field has a default.

    Attributes:
        mach: Mach number of each flight point.
        alpha_deg: angle of attack of each, deg; None takes the documented schedule.
        altitude_m: altitude of each, m; None takes the descent of thesis Table 4.1.
        gamma_deg: flight-path angle of each, deg; None takes the thesis's.
        bank_deg: bank angle of each, deg; None takes the thesis's.
        deflections: control surfaces of the base body, rad.
        controls: whether control derivatives are computed (one more body and mesh per surface).
        control_step: deflection step of control derivatives, rad.
        steps: steps of the stability derivatives.
        mesh: how to mesh; the default, a wall cell of 0.2 m, is meant to answer in about two minutes on two cores.
        flow: how to solve.
        form: form of the linear model.
        vehicle_class: class of MIL-F-8785C.
        category: flight phase category of MIL-F-8785C.
    """

    mach: tuple[float, ...] = (0.8, 1.5, 2.5)
    alpha_deg: tuple[float, ...] | None = None
    altitude_m: tuple[float, ...] | None = None
    gamma_deg: tuple[float, ...] | None = None
    bank_deg: tuple[float, ...] | None = None
    deflections: ControlDeflections = DEFLECTIONS_TAEM
    controls: bool = True
    control_step: float = math.radians(10.0)
    steps: DerivativeSteps = field(default_factory=DerivativeSteps)
    mesh: MeshSettings = field(default_factory=lambda: MeshSettings(wall_cell=0.25))
    flow: FlowSettings = field(default_factory=FlowSettings)
    form: str = "rigid-body"
    vehicle_class: str = "III"
    category: str = "B"

    def __post_init__(self) -> None:
        if not self.mach:
            raise InputError("mach: at least one Mach number is needed")
        for mach in self.mach:
            if not (math.isfinite(mach) and mach > 0.0):
                raise InputError(f"mach = {mach}: a positive number is needed")
        for name in ("alpha_deg", "altitude_m", "gamma_deg", "bank_deg"):
            values = getattr(self, name)
            if values is not None and len(values) != len(self.mach):
                raise InputError(f"{name}: {len(values)} values for {len(self.mach)} Mach numbers; give one for each")
        if not 0.0 < self.control_step <= math.radians(20.0):
            raise InputError(f"control_step = {math.degrees(self.control_step):g} deg: above 0 and at most 20 deg")
        for name, value, allowed in (
            ("form", self.form, FORMS),
            ("vehicle_class", self.vehicle_class, limits.CLASSES),
            ("category", self.category, limits.CATEGORIES),
        ):
            if value not in allowed:
                raise InputError(f"{name} = {value!r}: allowed are {', '.join(allowed)}")

    @classmethod
    def from_mapping(cls, values: Mapping) -> AnalyseSettings:
        """Settings from nested plain values, such as a YAML file's: {"mach": [2.5], "mesh": {"wall_cell": 0.2}}.

        A field kept in rad may be given in degrees with `_deg` at the end of its name; deflections are given in degrees
        by name of the surface. What is not named keeps its default.

        Raises:
            InputError: unknown name (with the nearest valid one) or a value that is not allowed.
        """
        values = dict(values)
        deflections = values.pop("deflections", None)
        mesh = values.get("mesh")
        if isinstance(mesh, Mapping) and "wall_cell" in mesh:
            values["mesh"] = {
                "target_cells": None,
                **mesh,
            }  # a wall cell that is asked for is not for the target to move
        settings = _override(cls(), values, "")
        if deflections is None:
            return settings
        if not isinstance(deflections, Mapping):
            raise InputError(f"deflections = {deflections!r}: degrees by name of the surface are needed")
        merged = DEFLECTIONS_TAEM.to_degrees() | dict(deflections)
        return replace(settings, deflections=ControlDeflections.from_degrees(merged))

    def as_dict(self) -> dict:
        """Resolved settings as plain values that `from_mapping` takes back; deflections in degrees."""
        return record.plain(self) | {"deflections": self.deflections.to_degrees()}

    def flight_points(self) -> tuple[FlightPoint, ...]:
        """The flight points, with names of their own.

        Raises:
            InputError: a Mach number outside the tables without altitude or angle of attack given.
        """
        points = []
        for i, mach in enumerate(self.mach):
            given = {
                name: getattr(self, name)[i]
                for name in ("alpha_deg", "altitude_m", "gamma_deg", "bank_deg")
                if getattr(self, name) is not None
            }
            point = taem_point(mach, **given)
            if self.mach.count(mach) > 1:
                point = replace(point, name=f"{point.name}, alpha {math.degrees(point.alpha):g} deg")
            if point.name in (p.name for p in points):
                raise InputError(f"mach: {point.name} is asked twice")
            points.append(point)
        return tuple(points)


def _override(settings: Any, values: Mapping, where: str) -> Any:
    """A copy of a settings record with plain values written over its fields."""
    types = {f.name: str(f.type) for f in fields(settings)}
    names = tuple(types)
    changes = {}
    for key, value in values.items():
        name, angle = str(key), False
        if name not in names and name.endswith("_deg"):
            name, angle = name.removesuffix("_deg"), True
        if name not in names:
            raise InputError(unknown_name("setting", f"{where}{key}", tuple(f"{where}{n}" for n in names)))
        old = getattr(settings, name)
        if is_dataclass(old):
            if not isinstance(value, Mapping):
                raise InputError(f"{where}{name} = {value!r}: fields by name are needed")
            changes[name] = _override(old, value, f"{where}{name}.")
        else:
            value = None if value is None and "None" in types[name] else _checked(f"{where}{key}", value, old)
            changes[name] = math.radians(value) if angle else value
    return replace(settings, **changes)


def _checked(name: str, value: Any, default: Any) -> Any:
    """A plain value of the kind that the default has."""
    if name == "mesh.boxes":
        return tuple(RefinementBox(tuple(b["lower"]), tuple(b["upper"]), b["cell"]) for b in value)
    if name == "mesh.fine_parts":
        if not isinstance(value, list | tuple) or not all(isinstance(v, str) for v in value):
            raise InputError(f"{name} = {value!r}: a list of parts' names is needed")
        return tuple(value)
    if isinstance(value, list | tuple):
        bad = [v for v in value if isinstance(v, bool) or not isinstance(v, int | float)]
        if bad:
            raise InputError(f"{name}: {bad[0]!r} is not a number")
        return tuple(value)
    if isinstance(default, bool | str):
        fits = isinstance(value, type(default))
    elif default is None:
        fits = isinstance(value, int | float)
    else:
        fits = isinstance(value, int | float) and not isinstance(value, bool) and not isinstance(default, tuple)
    if not fits:
        raise InputError(f"{name} = {value!r}: not allowed; the default is {default!r}")
    return value


@dataclass(frozen=True)
class PointAnalysis:
    """What was found at one flight point.

    Attributes:
        point: flight point, with CL and CD where its base condition was solved.
        validity: whether continuum and ideal gas hold.
        rates: equilibrium body rates; None without CL.
        system: linear model; None where a derivative is missing.
        modes: its modes.
        verdicts: MIL-F-8785C.
        reason: why there is no linear model; empty where there is.
    """

    point: FlightPoint
    validity: Validity
    rates: AngularRates | None
    system: StateSpace | None
    modes: tuple[Mode, ...]
    verdicts: tuple[Verdict, ...]
    reason: str = ""


@dataclass(frozen=True)
class Analysis:
    """Everything an analysis found.

    Attributes:
        vehicle: what was analysed.
        settings: how.
        body: the base body, its mesh and flow.
        plan: which condition of the ensemble is for what.
        coefficients: of the base ensemble, by part.
        control_runs: one per moved surface and step.
        derivatives: dims (point, part).
        points: one per flight point.
        database: every case and derivative.
        warnings: what a reader must know, one line each.
    """

    vehicle: Vehicle
    settings: AnalyseSettings
    body: SolvedBody
    plan: ConditionPlan
    coefficients: xr.Dataset
    control_runs: tuple[ControlRun, ...]
    derivatives: xr.Dataset
    points: tuple[PointAnalysis, ...]
    database: AeroDatabase
    warnings: tuple[str, ...]

    def seconds(self) -> dict[str, float]:
        """Wall time, s, by phase."""
        total = dict(self.body.seconds)
        for key in ("geometry", "mesh", "flow"):
            if self.control_runs:
                total[f"{key} (controls)"] = sum(run.seconds[key] for run in self.control_runs)
        return total


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
    say = progress or (lambda phase, done, total, text: None)
    points = settings.flight_points()
    plan = plan_conditions(list(points), settings.steps, is_symmetric(settings.deflections))
    body = solve_vehicle(vehicle, settings.deflections, plan.conditions, settings.mesh, settings.flow, say, "base")
    say("coefficients", 0, 1, "")
    coefficients = integrate(body.solution, vehicle.reference)
    base = coefficients.isel(condition=[p.base for p in plan.points])
    derivatives = differentiate(coefficients, plan)
    runs: tuple[ControlRun, ...] = ()
    if settings.controls:
        wall_cell = float(body.solution.mesh.record["wall_cell_m"])
        runs = _control_runs(vehicle, settings, plan, wall_cell, say)
        slopes = slopes_of(base, runs, is_symmetric(settings.deflections))
        derivatives = xr.merge([derivatives, slopes], join="exact")
    say("flight dynamics", 0, 1, "")
    length = float(np.ptp(body.surface.bounds[:, 0]))
    found = tuple(_fly(p, i, vehicle, settings, base, derivatives, length) for i, p in enumerate(points))
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
        warnings=_warnings(vehicle, body, plan, runs, found, derivatives),
    )


def _control_runs(
    vehicle: Vehicle, settings: AnalyseSettings, plan: ConditionPlan, wall_cell: float, say: Progress
) -> tuple[ControlRun, ...]:
    """The base conditions on bodies with one surface moved, on the wall cell, m, of the base mesh."""
    rows = np.array([p.base for p in plan.points])
    c = plan.conditions
    return control_runs(
        vehicle,
        settings.deflections,
        settings.control_step,
        FlowConditions(c.mach[rows], c.alpha[rows], c.beta[rows], c.gamma),
        replace(settings.mesh, wall_cell=wall_cell, target_cells=None),
        settings.flow,
        settings.steps.two_step_sizes,
        say,
    )


def _fly(
    point: FlightPoint,
    index: int,
    vehicle: Vehicle,
    settings: AnalyseSettings,
    base: xr.Dataset,
    derivatives: xr.Dataset,
    length: float,
) -> PointAnalysis:
    """Flight dynamics and flying qualities at one flight point of a body of some length, m."""
    validity = assess_validity(point.mach, point.ambient, length)
    lift, drag = (float(base[name].sel(part=TOTAL)[index]) for name in ("CL", "CD"))
    if not (math.isfinite(lift) and math.isfinite(drag)):
        return PointAnalysis(point, validity, None, None, (), (), "the flow of the base condition failed")
    point = point.with_coefficients(lift, drag)
    rates = equilibrium_rates(point, vehicle.mass.mass, vehicle.reference.area)
    values = {
        str(name): float(derivatives[name].sel(part=TOTAL)[index])
        for name in derivatives.data_vars
        if f"{name}_status" in derivatives
    }
    missing = [name for name in STATIC if not math.isfinite(values[name])]
    if missing:
        reason = f"no linear model: {', '.join(missing)} rest on a condition that failed"
        return PointAnalysis(point, validity, rates, None, (), (), reason)
    static = {name: values[name] for name in STATIC}
    controls = {n: v for n, v in values.items() if n not in STATIC and n.split("_")[0] in COEFFICIENTS}
    known = {n: v for n, v in controls.items() if math.isfinite(v)}
    system = linearise(point, vehicle.mass, vehicle.reference, Derivatives(**static, controls=known), settings.form)
    modes = identify(system)
    weight = vehicle.mass.mass * STANDARD_GRAVITY
    n_alpha = load_factor_slope(static["CL_alpha"], point.dynamic_pressure, vehicle.reference.area, weight)
    verdicts = assess(modes, settings.vehicle_class, settings.category, n_alpha)
    return PointAnalysis(point, validity, rates, system, tuple(modes), tuple(verdicts))


def _cases(
    settings: AnalyseSettings, plan: ConditionPlan, coefficients: xr.Dataset, runs: tuple[ControlRun, ...]
) -> list[SolvedCases]:
    def of(deflections: ControlDeflections) -> dict[str, float]:
        return {name: getattr(deflections, name) for name in CONTROLS}

    cases = [SolvedCases(coefficients, plan.labels, plan.point, of(settings.deflections))]
    for run in runs:
        count = len(run.records)
        cases.append(SolvedCases(run.coefficients, [run.label] * count, range(count), of(run.deflections)))
    return cases


def _warnings(
    vehicle: Vehicle,
    body: SolvedBody,
    plan: ConditionPlan,
    runs: tuple[ControlRun, ...],
    found: tuple[PointAnalysis, ...],
    derivatives: xr.Dataset,
) -> tuple[str, ...]:
    lines = [
        f"{name} = {getattr(vehicle.shape, name):g} lies outside its limits" for name in vehicle.shape.outside_limits()
    ]
    lines += [str(line) for line in body.solution.mesh.record.get("warnings", ())]
    judged = [(found[plan.point[i]].point.name, plan.labels[i], one) for i, one in enumerate(body.solution.records)]
    judged += [(at.point.name, run.label, one) for run in runs for at, one in zip(found, run.records, strict=True)]
    lines += [f"{name}, condition {label}: {one.verdict}: {one.reason}" for name, label, one in judged if not one.good]
    for index, point in enumerate(found):
        name = point.point.name
        lines += [f"{name}: {note}" for note in point.validity.notes]
        shaky = [n for n in STATIC if str(derivatives[f"{n}_status"].values[index]) != CONVERGED]
        if point.reason:
            lines.append(f"{name}: {point.reason}")
        elif shaky:
            lines.append(f"{name}: modes and levels rest on {', '.join(shaky)}, of conditions that did not converge")
    return tuple(lines)


def run(vehicle: Vehicle, settings: AnalyseSettings, out_dir: Path | str, progress: Progress | None = None) -> Analysis:
    """Analyse and write, the folder being checked before anything is computed."""
    folder = check_output(out_dir)
    analysis = analyse(vehicle, settings, progress)
    if progress:
        progress("report", 0, 1, str(folder))
    write(analysis, folder)
    return analysis
