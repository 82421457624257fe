"""Flight dynamics and flying qualities at one flight point, from its coefficients and derivatives."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from spaceplane.aero.integrate import TOTAL
from spaceplane.analysis.settings import AnalyseSettings
from spaceplane.dynamics.derivatives import COEFFICIENTS, DAMPING, STATIC, Derivatives
from spaceplane.dynamics.flightpoint import AngularRates, FlightPoint, equilibrium_rates
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import Mode, identify
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.environment.constants import STANDARD_GRAVITY
from spaceplane.environment.validity import Validity, assess_validity
from spaceplane.qualities.assess import Verdict, assess, load_factor_slope
from spaceplane.vehicle.presets import Vehicle

if TYPE_CHECKING:
    import xarray as xr


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
    static = {name: values[name] for name in STATIC}
    known = {n: v for n, v in values.items() if n not in STATIC and math.isfinite(v)}
    damping = {n: v for n, v in known.items() if n in DAMPING}
    controls = {n: v for n, v in known.items() if n not in DAMPING and n.split("_")[0] in COEFFICIENTS}
    all_known = Derivatives(**static, **damping, controls=controls)
    system = linearise(point, vehicle.mass, vehicle.reference, all_known, settings.form)
    modes = identify(system)
    weight = vehicle.mass.mass * STANDARD_GRAVITY
    n_alpha = load_factor_slope(static["CL_alpha"], point.dynamic_pressure, vehicle.reference.area, weight)
    verdicts = assess(modes, settings.vehicle_class, settings.category, n_alpha)
    return PointAnalysis(point, validity, rates, system, tuple(modes), tuple(verdicts))
