"""Flight dynamics and flying qualities at one flight point, from its coefficients and derivatives."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from spaceplane.aero.integrate import TOTAL
from spaceplane.aero.model.derivatives import COEFFICIENTS, DAMPING, STATIC, Derivatives
from spaceplane.aero.uncertainty.settings import MESH
from spaceplane.analysis.controllability import Controllability, controllability
from spaceplane.analysis.settings import AnalyseSettings
from spaceplane.dynamics.flightpoint import AngularRates, FlightPoint, equilibrium_rates
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import Mode, identify
from spaceplane.dynamics.sensitivity import AT_POINT, PARAMETERS, ModeSensitivity, of_model
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.environment.constants import STANDARD_GRAVITY
from spaceplane.environment.validity import Validity, assess_validity
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.assess import Verdict, assess, load_factor_slope
from spaceplane.qualities.assess_airframe import assess_airframe
from spaceplane.qualities.probability import Outlook, Uncertainty, mirror_correlation, outlooks
from spaceplane.vehicle.presets import Vehicle

if TYPE_CHECKING:
    import xarray as xr

SAMPLES = 1000
"""Draws of the derivatives at each flight point: probabilities within 0.03."""


@dataclass(frozen=True)
class PointAnalysis:
    """What was found at one flight point.

    Attributes:
        point: flight point, with CL and CD where its base condition was solved.
        validity: whether continuum and ideal gas hold.
        rates: equilibrium body rates; None without CL.
        system: linear model; None where a derivative is missing.
        modes: its modes.
        verdicts: MIL-F-8785C on the modes.
        reason: why there is no linear model; empty where there is.
        airframe_verdicts: MIL-F-8785C on the airframe and its controls, and departure criteria.
        uncertainty: of the derivatives, from their stated errors; None without any.
        outlooks: the verdicts' probabilities; empty without uncertainty.
        sensitivities: of the modes, in their order.
        control: what the controls can do, from the deflections that were solved; None without a linear model.
    """

    point: FlightPoint
    validity: Validity
    rates: AngularRates | None
    system: StateSpace | None
    modes: tuple[Mode, ...]
    verdicts: tuple[Verdict, ...]
    reason: str = ""
    airframe_verdicts: tuple[Verdict, ...] = ()
    uncertainty: Uncertainty | None = None
    outlooks: tuple[Outlook, ...] = ()
    sensitivities: tuple[ModeSensitivity, ...] = ()
    control: Controllability | None = None


def fly(
    point: FlightPoint,
    index: int,
    vehicle: Vehicle,
    settings: AnalyseSettings,
    base: xr.Dataset,
    derivatives: xr.Dataset,
    length: float,
) -> PointAnalysis:
    """Equilibrium, linear model, modes and verdicts at one flight point; a reason where flow or derivatives failed.

    Args:
        point: flight point, without coefficients.
        index: its number in `base` and `derivatives`.
        vehicle: mass and reference lengths.
        settings: form of the linear model, class and category.
        base: coefficients of the base conditions, dims (condition, part), one condition per flight point.
        derivatives: dims (point, part), per rad or per unit Mach number, see `aero.derivatives.differentiate`.
        length: of the body, m, for the Knudsen number.
    """
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
    all_known = _derivatives(values)
    system = linearise(point, vehicle.mass, vehicle.reference, all_known, settings.form)
    modes = identify(system)
    weight = vehicle.mass.mass * STANDARD_GRAVITY
    n_alpha = load_factor_slope(values["CL_alpha"], point.dynamic_pressure, vehicle.reference.area, weight)
    verdicts = assess(modes, settings.vehicle_class, settings.category, n_alpha)
    model = (point, vehicle.mass, vehicle.reference, all_known)
    airframe = Airframe(*model, *_trim(base, index, settings))
    # Errors of iteration and step alone would make levels look far more certain than they are.
    stated = settings.uncertainty == MESH
    uncertainty = _uncertainty(base, derivatives, index, all_known) if stated else None
    judged = (settings.vehicle_class, settings.category)
    return PointAnalysis(
        point,
        validity,
        rates,
        system,
        tuple(modes),
        tuple(verdicts),
        airframe_verdicts=assess_airframe(airframe, *judged, system),
        uncertainty=uncertainty,
        outlooks=outlooks(airframe, uncertainty, *judged, samples=SAMPLES, form=settings.form) if uncertainty else (),
        sensitivities=of_model(*model, system.A, modes, settings.form),
        control=controllability(airframe, system, asdict(settings.deflections), settings.feedback, *judged),
    )


def _derivatives(values: Mapping[str, float]) -> Derivatives:
    """Those that are known; the static ones all are."""
    static = {name: values[name] for name in STATIC}
    known = {n: v for n, v in values.items() if n not in STATIC and math.isfinite(v)}
    damping = {n: v for n, v in known.items() if n in DAMPING}
    controls = {n: v for n, v in known.items() if n not in DAMPING and n.split("_")[0] in COEFFICIENTS}
    return Derivatives(**static, **damping, controls=controls)


def _trim(base: xr.Dataset, index: int, settings: AnalyseSettings) -> tuple[float | None, float]:
    """(C_m of the base condition or None, elevator of the body that was solved, rad)."""
    moment = float(base.Cm.sel(part=TOTAL)[index])
    deflections = settings.deflections
    return moment if math.isfinite(moment) else None, 0.5 * (deflections.elevon_left + deflections.elevon_right)


def _uncertainty(base: xr.Dataset, derivatives: xr.Dataset, index: int, known: Derivatives) -> Uncertainty | None:
    """Stated errors of the derivatives, C_L and C_D as half widths of 95 % intervals.

    None where none is above 0, or where that of a value is missing, which is not to pass for certain.
    """
    half_width = {}
    for name in (*PARAMETERS, *known.controls):
        source, label = (base if name in AT_POINT else derivatives), f"{name}_error"
        if name not in source or label not in source:
            continue
        if not math.isfinite(float(source[name].sel(part=TOTAL)[index])):
            continue  # it is not in the linear model
        error = float(source[label][index])
        if not math.isfinite(error):
            return None
        if error > 0.0:
            half_width[name] = error
    return Uncertainty(half_width, mirror_correlation(known, half_width)) if half_width else None
