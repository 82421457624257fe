"""How the flight-path angle of a straight glide goes on with airspeed, for the second sentence of MIL-F-8785C 3.2.1.3.

The gradients of `spaceplane.qualities.gradients` at one speed are the differential equation of the trimmed glide over
speed; one step of the classical Runge-Kutta method carries angle of attack, elevator and path angle to a near speed. On
the way lift and moment are linear, and drag rises with the square of the lift: C_D_alpha = 2 k C_L C_L_alpha makes
d C_D_alpha / d alpha = C_D_alpha C_L_alpha / C_L. Without that curvature the slope would change by speed alone.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spaceplane.aero.model.derivatives import Derivatives
from spaceplane.dynamics.flightpoint import FlightPoint
from spaceplane.qualities.gradients import SpeedGradient, speed_gradient
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths

STEEPEST = 1.5  # rad, of angle of attack and path angle on the way


def gradient_at(
    change: float, point: FlightPoint, mass: MassProperties, reference: ReferenceLengths, derivatives: Derivatives
) -> SpeedGradient | None:
    """Trim over airspeed at a speed near that of the flight point, on the same glide and at the same altitude.

    Args:
        change: of the airspeed, m/s; small beside the airspeed.
        point: flight point with CL and CD.
        mass: kg.
        reference: m2, m.
        derivatives: per rad and per unit Mach number.

    Returns:
        The gradients there, or None where the glide does not go so far.
    """
    d = derivatives
    CL, CD = point.coefficients()
    curvature = max(0.0, d.CD_alpha * d.CL_alpha / CL) if CL != 0.0 else 0.0

    def gradient(dV: float, moved: np.ndarray) -> SpeedGradient | None:
        """At a speed and the changes of angle of attack, elevator and path angle that belong to it."""
        dalpha, elevator, dgamma = (float(x) for x in moved)
        alpha, gamma = point.alpha + dalpha, point.gamma + dgamma
        mach = point.mach + dV / point.ambient.speed_of_sound
        if mach <= 0.0 or not max(abs(alpha), abs(gamma)) < STEEPEST:
            return None
        dM = mach - point.mach
        by_elevator = [d.control(name, "elevator") if elevator else 0.0 for name in ("CL", "CD")]
        there = replace(
            point,
            mach=mach,
            alpha=alpha,
            gamma=gamma,
            CL=CL + d.CL_alpha * dalpha + by_elevator[0] * elevator + d.CL_M * dM,
            CD=CD + (d.CD_alpha + 0.5 * curvature * dalpha) * dalpha + by_elevator[1] * elevator + d.CD_M * dM,
        )
        return speed_gradient(there, mass, reference, replace(d, CD_alpha=d.CD_alpha + curvature * dalpha))

    moved, slopes = np.zeros(3), []
    for share in (0.0, 0.5, 0.5, 1.0):
        found = gradient(share * change, share * change * slopes[-1] if slopes else moved)
        if found is None:
            return None
        slopes.append(np.array([found.alpha, found.elevator or 0.0, found.gamma]))
    return gradient(change, change / 6 * (slopes[0] + 2 * slopes[1] + 2 * slopes[2] + slopes[3]))
