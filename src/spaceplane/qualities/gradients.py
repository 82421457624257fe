"""How the trim of a glider changes with airspeed and load factor, from its derivatives alone.

Straight flight, wings level, no thrust, at constant altitude for what the air is concerned:

    L = m (g - V^2/R) cos(gamma),   D = -m g sin(gamma),   C_m = 0

Their differentials about the flight point are linear in d alpha, d elevator and d gamma per dV. In a pull-up at
constant speed

    C_L_alpha d alpha + C_L_q q^ + C_L_e d e = dn m g / (q S),   C_m_alpha d alpha + C_m_q q^ + C_m_e d e = 0,
    q^ = dn g c / (2 V^2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spaceplane.aero.model.derivatives import Derivatives
from spaceplane.dynamics.flightpoint import FlightPoint
from spaceplane.environment.constants import STANDARD_GRAVITY
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths


@dataclass(frozen=True)
class SpeedGradient:
    """Change of the trim with airspeed.

    Attributes:
        alpha: d alpha / dV, rad s/m.
        elevator: d elevator / dV, rad s/m; None without an elevator that pitches.
        gamma: d gamma / dV, rad s/m.
    """

    alpha: float
    elevator: float | None
    gamma: float


@dataclass(frozen=True)
class LoadGradient:
    """Change of the trim with load factor in a pull-up.

    Attributes:
        alpha: d alpha / dn, rad/g.
        elevator: d elevator / dn, rad/g.
    """

    alpha: float
    elevator: float


def pitches(derivatives: Derivatives) -> bool:
    """Whether there is an elevator with a pitching moment."""
    return "elevator" in derivatives.available_controls() and derivatives.control("Cm", "elevator") != 0.0


def speed_gradient(
    point: FlightPoint, mass: MassProperties, reference: ReferenceLengths, derivatives: Derivatives
) -> SpeedGradient | None:
    """Trim over airspeed; without an elevator the lift follows the angle of attack alone, whatever holds it.

    Args:
        point: flight point with CL and CD; its bank angle is not used.
        mass: kg.
        reference: m2, m.
        derivatives: per rad and per unit Mach number.

    Returns:
        The gradients, or None where no angle of attack changes the lift.
    """
    d, V = derivatives, point.velocity
    CL, CD = point.coefficients()
    force = point.dynamic_pressure * reference.area
    sound = point.ambient.speed_of_sound
    weight = mass.mass * point.gravity
    excess = weight - mass.mass * V**2 / point.radius  # what is left of the weight for the lift
    has_elevator = pitches(d)
    controls = [d.control(name, "elevator") if has_elevator else 0.0 for name in ("CL", "CD", "Cm")]
    sin_g, cos_g = np.sin(point.gamma), np.cos(point.gamma)
    # unknowns d alpha, d elevator, d gamma per dV; rows: lift, drag, pitching moment
    matrix = np.array(
        [
            [force * d.CL_alpha, force * controls[0], excess * sin_g],
            [force * d.CD_alpha, force * controls[1], weight * cos_g],
            [d.Cm_alpha, controls[2], 0.0] if has_elevator else [0.0, 1.0, 0.0],
        ]
    )
    right = np.array(
        [
            -force * (2 * CL / V + d.CL_M / sound) - 2 * mass.mass * V / point.radius * cos_g,
            -force * (2 * CD / V + d.CD_M / sound),
            -d.Cm_M / sound if has_elevator else 0.0,
        ]
    )
    found = _solve(matrix, right)
    if found is None:
        return None
    return SpeedGradient(float(found[0]), float(found[1]) if has_elevator else None, float(found[2]))


def load_gradient(
    point: FlightPoint, mass: MassProperties, reference: ReferenceLengths, derivatives: Derivatives
) -> LoadGradient | None:
    """Trim over load factor at constant speed; None without an elevator that pitches or that changes the lift.

    Args:
        point: flight point.
        mass: kg.
        reference: m2, m.
        derivatives: per rad and per unit Mach number.
    """
    d = derivatives
    if not pitches(d):
        return None
    force = point.dynamic_pressure * reference.area
    rate = point.gravity * reference.chord / (2 * point.velocity**2)
    matrix = np.array([[d.CL_alpha, d.control("CL", "elevator")], [d.Cm_alpha, d.control("Cm", "elevator")]])
    right = np.array([mass.mass * STANDARD_GRAVITY / force - d.CL_q * rate, -d.Cm_q * rate])
    found = _solve(matrix, right)
    return None if found is None else LoadGradient(float(found[0]), float(found[1]))


def _solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray | None:
    """The solution, or None where rows depend on each other to round-off."""
    scale = np.abs(matrix).max(axis=1)
    if not np.all(scale > 0) or np.linalg.cond(matrix / scale[:, None]) > 1e12:
        return None
    return np.linalg.solve(matrix, right)
