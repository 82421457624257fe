"""A model that is linear about one flight point, from its coefficients and derivatives."""

from __future__ import annotations

import math

import numpy as np

from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.aero.model.derivatives import PAIRS, Derivatives
from spaceplane.aero.model.model import BASE, SLOPES, AeroModel, SurfaceTable
from spaceplane.errors import InputError
from spaceplane.vehicle.controls import CONTROL_LIMITS_DEG
from spaceplane.vehicle.properties import ReferenceLengths

_STATIC_LATERAL = ("CY_beta", "Cl_beta", "Cn_beta")


def linear_model(
    name: str,
    derivatives: Derivatives,
    reference: ReferenceLengths,
    mach: float,
    alpha: float,
    CL: float,
    CD: float,
    Cm: float = 0.0,
    alpha_range: float = math.radians(5.0),
    mach_range: float = 0.2,
    source: str = "",
    center_known: bool = True,
) -> AeroModel:
    """The model C = C0 + C_alpha (alpha - alpha0) + C_M (M - M0) + ..., in a range about the flight point.

    Derivatives with elevator and aileron are shared out between the elevons, those with the rudder between the rudders.
    Damping derivatives of 0 count as unknown. Those with the rate of alpha are the model's `lag`.

    Args:
        name: of the model.
        derivatives: per rad and per unit Mach.
        reference: m2, m; moments are about its moment centre.
        mach, alpha: flight point; Mach number and rad.
        CL, CD, Cm: coefficients there, without deflection.
        alpha_range: rad to either side in which the derivatives are taken to hold.
        mach_range: the same in Mach number.
        source: where the numbers come from.
        center_known: whether the moment centre is a known place, see `AeroModel`.

    Raises:
        InputError: a value is not finite, or a range is not positive or reaches Mach numbers below 0.
    """
    for what, value in {"mach": mach, "alpha": alpha, "CL": CL, "CD": CD, "Cm": Cm}.items():
        if not math.isfinite(value):
            raise InputError(f"{what} = {value}: must be a finite number")
    for what, value in {"alpha_range": alpha_range, "mach_range": mach_range}.items():
        if not (math.isfinite(value) and value > 0.0):
            raise InputError(f"{what} = {value}: must be a positive number")
    alphas, machs = alpha + alpha_range * np.array([-1.0, 1.0]), mach + mach_range * np.array([-1.0, 1.0])
    attack, faster = np.meshgrid(alphas - alpha, machs - mach, indexing="ij")
    start = dict(zip(BASE, (CL, CD, Cm), strict=True))
    base = {
        c: start[c] + getattr(derivatives, f"{c}_alpha") * attack + getattr(derivatives, f"{c}_M") * faster
        for c in BASE
    }
    known = {slope: getattr(derivatives, slope) for slope in SLOPES}
    slopes = {
        slope: np.full(attack.shape, value) for slope, value in known.items() if value or slope in _STATIC_LATERAL
    }
    about = f"linear about Mach {mach:g}, alpha {math.degrees(alpha):g} deg"
    return AeroModel(
        name=name,
        source=f"{source or 'derivatives as given'}; {about}",
        reference=reference,
        alpha=alphas,
        mach=machs,
        base=base,
        surfaces={surface: _table(surface, per_rad, attack.shape) for surface, per_rad in _surfaces(derivatives)},
        slopes=slopes,
        lag=(derivatives.CL_alphadot, derivatives.Cm_alphadot),
        center_known=center_known,
    )


def _surfaces(derivatives: Derivatives) -> list[tuple[str, dict[str, float]]]:
    """Each surface with its derivatives, per rad, those of combined controls shared out."""
    found: dict[str, dict[str, float]] = {}
    given = derivatives.given_controls()
    for control in given:
        known = [c for c in FORCES_AND_MOMENTS if f"{c}_{control}" in derivatives.controls]
        for coefficient in known:
            value = derivatives.control(coefficient, control)
            # A combined control moves both by the same angle, the second with the sign of the pair.
            shares = {control: 1.0}
            if control in PAIRS:
                first, second, sign = PAIRS[control]
                shares = {first: 0.5, second: 0.5 * sign}
            for surface, share in shares.items():
                table = found.setdefault(surface, {})
                table[coefficient] = table.get(coefficient, 0.0) + share * value
    return list(found.items())


def _table(surface: str, per_rad: dict[str, float], shape: tuple[int, ...]) -> SurfaceTable:
    deflection = np.unique(np.radians([*CONTROL_LIMITS_DEG[surface], 0.0]))
    along = deflection[:, None, None] * np.ones(shape)
    return SurfaceTable(deflection, {name: value * along for name, value in per_rad.items()})
