"""An aerodynamic model about one flight point, linear, from a file of derivatives.

    C = C_point + C_alpha (alpha - alpha_point) + C_M (M - M_point) + sum over surfaces of C_surface d_surface + ...

The file says nothing of Cm at the point and of the deflections that hold it: Cm is 0 there (steady flight), and
deflections count from those that hold it. Derivatives say nothing of how far they hold: the ranges are arguments.
"""

from __future__ import annotations

import math

import numpy as np

from spaceplane.aero.model.model import BASE, SLOPES, AeroModel, SurfaceTable
from spaceplane.dynamics.derivatives import COEFFICIENTS, PAIRS, Derivatives
from spaceplane.dynamics.derivatives_file import ModesCase
from spaceplane.errors import InputError
from spaceplane.vehicle.controls import CONTROLS

ALPHA_RANGE_DEG, MACH_RANGE, DEFLECTION_RANGE_DEG, BETA_RANGE_DEG = 2.0, 0.1, 5.0, 2.0
"""To either side of the flight point; this project's choice of "small"."""


def model_about(
    case: ModesCase,
    alpha_range_deg: float = ALPHA_RANGE_DEG,
    mach_range: float = MACH_RANGE,
    deflection_range_deg: float = DEFLECTION_RANGE_DEG,
    beta_range_deg: float = BETA_RANGE_DEG,
) -> AeroModel:
    """The model of a derivatives file, its moment centre at the centre of mass, the origin of its axes.

    Elevator, aileron and rudder become the surfaces that they move. Slopes that are 0 in the file count as unknown.

    Args:
        case: of `dynamics.derivatives_file.read`.
        alpha_range_deg, deflection_range_deg, beta_range_deg: deg to either side for which derivatives shall hold.
        mach_range: Mach numbers to either side.

    Raises:
        InputError: a range that is not above 0, a flight point without CL or CD, or derivatives with dalpha/dt, which
            tables cannot hold.
    """
    ranges = {
        "alpha_range_deg": alpha_range_deg,
        "mach_range": mach_range,
        "deflection_range_deg": deflection_range_deg,
        "beta_range_deg": beta_range_deg,
    }
    for name, value in ranges.items():
        if not (math.isfinite(value) and value > 0.0):
            raise InputError(f"{name} = {value}: must be a number above 0")
    d, point = case.derivatives, case.point
    for name in ("CL_alphadot", "Cm_alphadot"):
        if getattr(d, name) != 0.0:
            raise InputError(f"{name} = {getattr(d, name):g}: tables cannot hold what depends on dalpha/dt; must be 0")
    if point.mach <= mach_range:
        raise InputError(f"mach_range = {mach_range:g}: must be below the Mach number, {point.mach:g}")
    half = math.radians(alpha_range_deg)
    off_alpha, off_mach = np.array([-half, 0.0, half]), np.array([-mach_range, 0.0, mach_range])
    shape = (len(off_alpha), len(off_mach))
    at_point = dict(zip(("CL", "CD"), point.coefficients(), strict=True)) | {"Cm": 0.0}
    base = {
        name: at_point[name]
        + getattr(d, f"{name}_alpha") * off_alpha[:, None]
        + getattr(d, f"{name}_M") * off_mach[None, :]
        for name in BASE
    }
    deflection = math.radians(deflection_range_deg) * np.array([-1.0, 0.0, 1.0])
    surfaces = {
        surface: SurfaceTable(
            deflection,
            {name: value * deflection[:, None, None] * np.ones(shape) for name, value in slopes.items()},
        )
        for surface in CONTROLS
        if (slopes := surface_derivatives(d, surface))
    }
    return AeroModel(
        name=f"{point.name}, linear",
        source=f"derivatives about {point.name}, alpha {math.degrees(point.alpha):.6g} deg, linear; Cm 0 there, "
        "deflections from those that hold it; ranges chosen; the moment centre, at the centre of mass, is the origin",
        reference=case.reference,
        alpha=point.alpha + off_alpha,
        mach=point.mach + off_mach,
        base=base,
        surfaces=surfaces,
        slopes={name: np.full(shape, value) for name in SLOPES if (value := getattr(d, name)) != 0.0},
        beta_limit=math.radians(beta_range_deg),
    )


def surface_derivatives(derivatives: Derivatives, surface: str) -> dict[str, float]:
    """Derivatives of the coefficients with one surface, per rad, from its own or the combined controls that move it.

    With elevator (L + R)/2 and aileron (L - R)/2, the left elevon has half of both, the right one half of their
    difference; the rudders half of rudder = (L - R)/2 each, with opposite signs.
    """
    found = {}
    for name in COEFFICIENTS:
        total, given = 0.0, False
        if f"{name}_{surface}" in derivatives.controls:
            total, given = derivatives.controls[f"{name}_{surface}"], True
        for combined, (left, right, sign) in PAIRS.items():
            value = derivatives.controls.get(f"{name}_{combined}")
            if value is not None and surface in (left, right):
                total, given = total + value * (0.5 if surface == left else 0.5 * sign), True
        if given:
            found[name] = total
    return found
