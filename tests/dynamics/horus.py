"""HORUS-2B at the TAEM interface as the thesis gives it (Tables 6.1, 6.2 and 6.3), for the tests of this folder."""

from __future__ import annotations

from spaceplane.aero.model.derivatives import Derivatives, from_mapping, per_radian
from spaceplane.dynamics.flightpoint import FlightPoint, flight_point
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths

MASS = MassProperties(26_000.0, 119_000.0, 769_000.0, 806_000.0)
TILTED = MassProperties(26_000.0, 119_000.0, 769_000.0, 806_000.0, -60_000.0)
"""With a product of inertia: principal axes 5.0 deg nose up of the body's."""
REFERENCE = ReferenceLengths(110.0, 23.0, 13.0, (13.0, 0.0, 0.0))

PER_DEGREE = {
    "CD_alpha": 0.0179,
    "CL_alpha": 0.0323,
    "Cm_alpha": 0.00071,
    "CY_beta": -0.01725,
    "Cl_beta": -0.00139,
    "Cn_beta": -0.00048,
    "CD_M": -0.0415,
    "CL_M": -0.0965,
    "Cm_M": 0.01195,
}

# Every optional derivative at a value of its usual size, so that no term of the linearisation is left out of a test.
EXTRA = {
    "CL_q": 0.9,
    "Cm_q": -1.8,
    "CL_alphadot": 0.6,
    "Cm_alphadot": -0.7,
    "CY_p": 0.12,
    "Cl_p": -0.31,
    "Cn_p": 0.04,
    "CY_r": 0.22,
    "Cl_r": 0.07,
    "Cn_r": -0.45,
    "CL_elevon_left": 0.20,
    "CD_elevon_left": 0.03,
    "CY_elevon_left": 0.01,
    "Cl_elevon_left": 0.05,
    "Cm_elevon_left": -0.09,
    "Cn_elevon_left": 0.02,
    "CL_elevon_right": 0.21,
    "CD_elevon_right": 0.02,
    "Cl_elevon_right": -0.06,
    "Cm_elevon_right": -0.08,
    "Cn_elevon_right": -0.03,
    "CY_rudder_left": 0.04,
    "Cn_rudder_left": -0.02,
    "Cl_rudder_left": 0.01,
    "CY_rudder_right": -0.04,
    "Cn_rudder_right": 0.02,
    "Cm_body_flap": -0.05,
    "CL_body_flap": 0.11,
    "CD_body_flap": 0.04,
}


def derivatives(**changes: float) -> Derivatives:
    """Table 6.1 per rad, with some of them changed or added (per rad)."""
    return from_mapping({**per_radian(PER_DEGREE), **changes})


def point(**changes: float) -> FlightPoint:
    """The flight point of Table 6.1 in the US 1976 atmosphere at 26.7 km."""
    values = {"mach": 2.5, "altitude_m": 26_700.0, "alpha_deg": 16.6, "gamma_deg": -8.4, "bank_deg": 55.0}
    return flight_point(**{**values, "CL": 0.36, "CD": 0.20, **changes})  # type: ignore[arg-type]


def thesis_ambient() -> FlightPoint:
    """The same point with the pressure and temperature that the thesis prints (those of 25 km)."""
    return point(pressure_Pa=2511.02, temperature_K=221.65)
