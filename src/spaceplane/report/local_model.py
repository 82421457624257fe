"""A flight point of an analysis as an aerodynamic model that is linear about it."""

from __future__ import annotations

import math
from collections.abc import Mapping

from spaceplane.aero.model.derivatives import CONTROL_DERIVATIVES, DAMPING, STATIC, from_mapping
from spaceplane.aero.model.from_derivatives import linear_model
from spaceplane.aero.model.model import BASE
from spaceplane.decks.source import Source
from spaceplane.dynamics.flightpoint import FlightPoint, flight_point
from spaceplane.dynamics.given_errors import NAMES, GivenError
from spaceplane.errors import InputError
from spaceplane.vehicle.controls import CONTROLS
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths


def local_model(result: Mapping, point: str | None = None) -> Source:
    """The model about one flight point, and the vehicle's mass.

    At the flight point with the deflections of the analysis it has the coefficients of the analysis; from there all is
    linear, so that the coefficients without deflection are extrapolated by the control derivatives. The errors that the
    analysis states of derivatives, C_L and C_D go along, about its own moment centre.

    Args:
        result: what `report.read.read_result` gave.
        point: name of the flight point, such as "Mach 2.5", or its Mach number; needed where there are several.

    Raises:
        InputError: no such flight point, several where none is named, or a coefficient or derivative that the analysis
            does not have since its flow failed.
    """
    chosen = _point(result["flight_points"], point)
    vehicle, name = result["vehicle"], chosen["name"]
    found = {key: one["value"] for key, one in chosen["derivatives"].items()}
    values = {key: found[key] for key in (*STATIC, *DAMPING, *CONTROL_DERIVATIVES) if key in found}
    start = {key: chosen["coefficients"][key] for key in BASE}
    for key, value in {**start, **values}.items():
        if value is None or not math.isfinite(value):
            raise InputError(f"{name}: {key} is missing, its flow did not come to an end")
    derivatives = from_mapping(values)
    deflections = {key: math.radians(vehicle["deflections_deg"].get(key, 0.0)) for key in CONTROLS}
    for key, deflection in deflections.items():
        for coefficient in BASE:
            start[coefficient] -= derivatives.control(coefficient, key) * deflection
    moved = ", ".join(f"{key} {math.degrees(d):.4g} deg" for key, d in deflections.items() if d)
    reference = vehicle["reference"]
    model = linear_model(
        f"{vehicle['name']}-{name}".replace(" ", "-"),
        derivatives,
        ReferenceLengths(
            reference["area_m2"], reference["c_ref_m"], reference["b_ref_m"], tuple(reference["moment_center_m"])
        ),
        chosen["mach"],
        math.radians(chosen["alpha_deg"]),
        source=f"spaceplane analyse, {vehicle['name']} at {name}"
        + (f"; linear about {moved}, extrapolated to no deflection" if moved else ""),
        **start,
    )
    mass = vehicle["mass"]
    properties = MassProperties(
        *(mass[key] for key in ("mass_kg", "Ixx_kgm2", "Iyy_kgm2", "Izz_kgm2")), mass.get("Ixz_kgm2", 0.0)
    )
    return Source(model, properties, _errors(chosen), point=_flown(chosen))


def _flown(point: Mapping) -> FlightPoint:
    angles = (point[key] for key in ("alpha_deg", "gamma_deg", "bank_deg"))
    return flight_point(point["mach"], point["altitude_m"], *angles)


def _errors(point: Mapping) -> dict[str, GivenError]:
    """Half widths of 95 % intervals by name, those that the analysis has."""
    stated = {key: one["error"] for key, one in point["derivatives"].items()} | point["coefficient_errors"]
    known = {key: stated.get(key) for key in NAMES}
    return {key: GivenError(error) for key, error in known.items() if error is not None and math.isfinite(error)}


def _point(points: list[dict], wanted: str | None) -> dict:
    names = ", ".join(point["name"] for point in points)
    if wanted is None:
        if len(points) != 1:
            raise InputError(f"--point: needed, the analysis has {names}")
        return points[0]
    found = [point for point in points if wanted.strip() in (point["name"], f"{point['mach']:g}")]
    if len(found) != 1:
        raise InputError(f"--point: {wanted!r} names {len(found)} flight points of {names}")
    return found[0]
