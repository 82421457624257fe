"""The record of `spaceplane modes`: eigenvalues, modes and verdicts of a derivatives file, as plain JSON types.

Schema `spaceplane.modes`, version 1: `flight` and `vehicle` (resolved values, unit in the name), `derivatives` (per rad
and per unit Mach), `form`, `states`, `inputs`, `A`, `B`, `equilibrium` (rad/s), `eigenvalues` (every one, [re, im] in
1/s) with `names` and `eigenvectors` in the same order, `modes` (one for each real eigenvalue or conjugate pair; see
`spaceplane.dynamics.modes.to_record`; with `eigenvalue_error` and `drivers`), `n_alpha_g_per_rad`, `uncertainty` (95 %
half widths as given, per rad), `verdicts` on modes and `airframe_verdicts` (see `spaceplane.qualities.verdict.Verdict`;
with `probabilities`). Missing numbers are null.
"""

from __future__ import annotations

import math
from dataclasses import fields

import numpy as np

from spaceplane import __version__
from spaceplane.aero.model.derivatives import Derivatives
from spaceplane.dynamics.derivatives_file import ModesCase
from spaceplane.dynamics.flightpoint import equilibrium_rates
from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.modes import Mode, identify
from spaceplane.dynamics.sensitivity import of_model
from spaceplane.environment.constants import STANDARD_GRAVITY
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.assess import assess, load_factor_slope
from spaceplane.qualities.assess_airframe import assess_airframe
from spaceplane.qualities.outlook_record import mode_records, verdict_records
from spaceplane.qualities.probability import Uncertainty, outlooks


def analyse_modes(case: ModesCase) -> dict:
    """Everything `spaceplane modes` reports about a case.

    Raises:
        InputError: unknown class or category, or a flight point that the model cannot hold.
    """
    system = linearise(
        case.point, case.mass, case.reference, case.derivatives, case.form, case.density_gradient, case.gyroscopic
    )
    modes = identify(system)
    weight = case.mass.mass * STANDARD_GRAVITY
    n_alpha = load_factor_slope(case.derivatives.CL_alpha, case.point.dynamic_pressure, case.reference.area, weight)
    verdicts = assess(modes, case.vehicle_class, case.category, n_alpha)
    rates = equilibrium_rates(case.point, case.mass.mass, case.reference.area)
    model = (case.point, case.mass, case.reference, case.derivatives)
    how = (case.form, case.density_gradient, case.gyroscopic)
    airframe, judged = Airframe(*model, **case.airframe), (case.vehicle_class, case.category)
    verdicts += assess_airframe(airframe, *judged, system)
    uncertainty = Uncertainty(case.uncertainty, case.correlation) if case.uncertainty else None
    chances = ()
    if uncertainty:
        chances = outlooks(airframe, uncertainty, *judged, "sampling", case.samples, case.seed, *how)
    on_modes, on_airframe = verdict_records(verdicts, chances)
    return {
        "schema": "spaceplane.modes",
        "schema_version": 1,
        "version": __version__,
        "flight": _flight(case),
        "vehicle": {
            "mass_kg": case.mass.mass,
            "Ixx_kgm2": case.mass.Ixx,
            "Iyy_kgm2": case.mass.Iyy,
            "Izz_kgm2": case.mass.Izz,
            "Ixz_kgm2": case.mass.Ixz,
            "area_m2": case.reference.area,
            "c_ref_m": case.reference.chord,
            "b_ref_m": case.reference.span,
        },
        "derivatives": {"unit": "per_radian", **_derivatives(case.derivatives)},
        "form": system.form,
        "density_gradient": case.density_gradient and case.form == "rigid-body",
        "gyroscopic": case.gyroscopic and case.form == "rigid-body",
        "vehicle_class": case.vehicle_class,
        "category": case.category,
        "equilibrium": {"p_rads": rates.p, "q_rads": rates.q, "r_rads": rates.r},
        "states": list(system.states),
        "inputs": list(system.inputs),
        "A": system.A.tolist(),
        "B": system.B.tolist(),
        **_spectrum(modes),
        "modes": mode_records(modes, of_model(*model, system.A, modes, *how), uncertainty),
        "n_alpha_g_per_rad": n_alpha,
        "uncertainty": dict(case.uncertainty),
        "verdicts": on_modes,
        "airframe_verdicts": on_airframe,
    }


def _spectrum(modes: tuple[Mode, ...]) -> dict:
    """Every eigenvalue with its mode's name and its eigenvector, conjugates included."""
    values, names, vectors = [], [], []
    for mode in modes:
        for sign in (1, -1) if mode.oscillatory else (1,):
            values.append([mode.eigenvalue.real, sign * mode.eigenvalue.imag])
            names.append(mode.name)
            vectors.append(
                {
                    state: {"magnitude": float(abs(z)), "phase_deg": sign * float(np.degrees(np.angle(z)))}
                    for state, z in zip(mode.states, mode.eigenvector, strict=True)
                }
            )
    return {"eigenvalues": values, "names": names, "eigenvectors": vectors}


def _flight(case: ModesCase) -> dict:
    point = case.point
    return {
        "name": point.name,
        "mach": point.mach,
        "altitude_m": point.altitude,
        "alpha_deg": math.degrees(point.alpha),
        "beta_deg": math.degrees(point.beta),
        "gamma_deg": math.degrees(point.gamma),
        "bank_deg": math.degrees(point.bank),
        "CL": point.CL,
        "CD": point.CD,
        "velocity_ms": point.velocity,
        "dynamic_pressure_Pa": point.dynamic_pressure,
        "pressure_Pa": point.ambient.pressure,
        "temperature_K": point.ambient.temperature,
        "density_kgm3": point.ambient.density,
        "air": point.ambient.source,
    }


def _derivatives(derivatives: Derivatives) -> dict:
    plain = {f.name: getattr(derivatives, f.name) for f in fields(derivatives) if f.name != "controls"}
    return {**plain, **derivatives.controls}
