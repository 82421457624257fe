"""Neutral point, static margin, and the centre of mass that given deflections would trim.

With C_N = C_L cos a + C_D sin a and C_A = C_D cos a - C_L sin a, moving the centre aft by x and up by z adds
(C_N x - C_A z) / c_ref to C_m. At fixed deflections and height the slope of C_m with alpha vanishes about the neutral
point, x_np = x_cm - c_ref C_m_alpha / C_N_alpha, and the static margin is (x_np - x_cm) / c_ref (Etkin and Reid,
Dynamics of Flight, 3rd ed., section 2.3, there with C_L for the small angles of aeroplanes).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from spaceplane.aero.model.derivatives import Derivatives
from spaceplane.aero.model.model import AeroModel
from spaceplane.errors import InputError


@dataclass(frozen=True)
class StaticMargin:
    """Static stability in pitch at fixed deflections.

    Attributes:
        Cm_alpha: 1/rad, about the model's moment centre.
        CN_alpha: 1/rad.
        margin: of c_ref, positive for a stable vehicle.
        neutral_point: m aft of the nose, at the height of the moment centre; NaN where that is not a known place.
    """

    Cm_alpha: float
    CN_alpha: float
    margin: float
    neutral_point: float


@dataclass(frozen=True)
class CenterShift:
    """Where the centre of mass would have to be for given deflections to trim.

    Every shift with C_N dx - C_A dz = -c_ref C_m does.

    Attributes:
        Cm: left over about the model's moment centre.
        CN, CA: normal and axial force coefficient.
        aft: dx, m aft, at the same height; NaN without normal force.
        up: dz, m up, at the same station; NaN without axial force.
    """

    Cm: float
    CN: float
    CA: float
    aft: float
    up: float


def static_margin(
    model: AeroModel, mach: float, alpha: float, deflections: Mapping[str, float] | None = None
) -> StaticMargin:
    """Neutral point and static margin.

    Args:
        model: aerodynamics.
        mach: Mach number.
        alpha: rad.
        deflections: control surface -> rad, held fixed.

    Raises:
        OutsideTables: the condition is not in the tables.
        InputError: the normal force does not change with alpha, so there is no neutral point.
    """
    found = model.coefficients(mach, alpha, deflections=deflections)
    return margin_of(model, alpha, found, model.derivatives(mach, alpha, deflections))


def margin_of(model: AeroModel, alpha: float, found: Mapping[str, float], slopes: Derivatives) -> StaticMargin:
    """Static margin from coefficients and derivatives that are known already.

    Args:
        model: aerodynamics, for its reference lengths.
        alpha: rad.
        found: CL and CD there.
        slopes: derivatives there, per rad.

    Raises:
        InputError: the normal force does not change with alpha.
    """
    cos_a, sin_a = math.cos(alpha), math.sin(alpha)
    CN_alpha = (slopes.CL_alpha + found["CD"]) * cos_a + (slopes.CD_alpha - found["CL"]) * sin_a
    if CN_alpha == 0.0:
        raise InputError(f"alpha = {math.degrees(alpha):g} deg: CN does not change there, so there is no neutral point")
    margin = -slopes.Cm_alpha / CN_alpha
    start = model.reference.moment_center[0] if model.center_known else math.nan
    station = start + margin * model.reference.chord
    return StaticMargin(slopes.Cm_alpha, CN_alpha, margin, station)


def center_shift(model: AeroModel, mach: float, alpha: float, deflections: Mapping[str, float]) -> CenterShift:
    """The shift of the centre of mass that would trim given deflections.

    Args:
        model: aerodynamics.
        mach: Mach number.
        alpha: rad.
        deflections: control surface -> rad.

    Raises:
        OutsideTables: the condition is not in the tables.
    """
    found = model.coefficients(mach, alpha, deflections=deflections)
    cos_a, sin_a = math.cos(alpha), math.sin(alpha)
    CN = found["CL"] * cos_a + found["CD"] * sin_a
    CA = found["CD"] * cos_a - found["CL"] * sin_a
    arm = -model.reference.chord * found["Cm"]
    return CenterShift(found["Cm"], CN, CA, arm / CN if CN else math.nan, -arm / CA if CA else math.nan)
