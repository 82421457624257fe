"""Aerodynamics linear about a flight point, for vehicles of which only derivatives are known."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from spaceplane.dynamics.equations import FlightModel
from spaceplane.dynamics.motion.forces import COEFFICIENTS
from spaceplane.dynamics.statespace import MOMENT_INPUTS
from spaceplane.errors import InputError, unknown_name
from spaceplane.vehicle.properties import ReferenceLengths


@dataclass(frozen=True)
class LinearAerodynamics:
    """The coefficients of a `FlightModel`: CL, CD at its point, trimmed moments, linear in everything else.

    Attributes:
        model: the vehicle at its flight point.
        alpha_reach: how far the angle of attack may leave the point's to either side, rad.
        mach_reach: how far the Mach number may, to either side.
        beta_limit: greatest sideslip to either side, rad.
    """

    model: FlightModel
    alpha_reach: float = math.radians(10.0)
    mach_reach: float = 0.5
    beta_limit: float = math.radians(10.0)

    @property
    def reference(self) -> ReferenceLengths:
        """Reference area and lengths."""
        return self.model.reference

    @property
    def lag(self) -> tuple[float, float]:
        """(CL_alphadot, Cm_alphadot), on dalpha/dt c/2V."""
        return self.model.derivatives.CL_alphadot, self.model.derivatives.Cm_alphadot

    def coefficients(
        self,
        mach: float,
        alpha: float,
        beta: float = 0.0,
        rates: tuple[float, float, float] = (0.0, 0.0, 0.0),
        deflections: Mapping[str, float] | None = None,
    ) -> dict[str, float]:
        """CL, CD, CY in wind axes and Cl, Cm, Cn in body axes, at a steady angle of attack.

        Args:
            mach: Mach number.
            alpha, beta: rad.
            rates: reduced rates (p b/2V, q c/2V, r b/2V).
            deflections: change of a control from the flight point, rad, by the names of the model's inputs.

        Raises:
            InputError: further from the flight point than the model reaches, or an unknown control.
        """
        point, d, steady, ref = self.model.point, self.model.derivatives, self.model.rates, self.model.reference
        for name, value, middle, reach in (
            ("mach", mach, point.mach, self.mach_reach),
            ("alpha_deg", math.degrees(alpha), math.degrees(point.alpha), math.degrees(self.alpha_reach)),
            ("beta_deg", math.degrees(beta), 0.0, math.degrees(self.beta_limit)),
        ):
            if not abs(value - middle) <= reach:
                raise InputError(
                    f"{name} = {value:.6g}: the linear aerodynamics hold from {middle - reach:.6g} to "
                    f"{middle + reach:.6g}"
                )
        attack, faster = alpha - point.alpha, mach - point.mach
        roll = rates[0] - steady.p * ref.span / (2 * point.velocity)
        pitch = rates[1] - steady.q * ref.chord / (2 * point.velocity)
        yaw = rates[2] - steady.r * ref.span / (2 * point.velocity)
        CL, CD = point.coefficients()
        trim_roll, trim_pitch, trim_yaw = self.model.trim
        found = {
            "CL": CL + d.CL_alpha * attack + d.CL_M * faster + d.CL_q * pitch,
            "CD": CD + d.CD_alpha * attack + d.CD_M * faster,
            "CY": d.CY_beta * beta + d.CY_p * roll + d.CY_r * yaw,
            "Cl": trim_roll + d.Cl_beta * beta + d.Cl_p * roll + d.Cl_r * yaw,
            "Cm": trim_pitch + d.Cm_alpha * attack + d.Cm_M * faster + d.Cm_q * pitch,
            "Cn": trim_yaw + d.Cn_beta * beta + d.Cn_p * roll + d.Cn_r * yaw,
        }
        known = [name for name in self.model.inputs if name not in MOMENT_INPUTS]
        for control, deflection in (deflections or {}).items():
            if control not in known:
                raise InputError(unknown_name("control", control, known))
            for coefficient in COEFFICIENTS:
                found[coefficient] += d.control(coefficient, control) * deflection
        return found
