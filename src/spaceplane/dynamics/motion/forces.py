"""Aerodynamic forces and moments, and the moments of thrusters, that act on the vehicle."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from spaceplane.dynamics.motion.state import FlightState
from spaceplane.dynamics.motion.vehicle import Vehicle
from spaceplane.dynamics.statespace import MOMENT_INPUTS
from spaceplane.environment.atmosphere import Ambient
from spaceplane.errors import InputError

Air = Callable[[float], Ambient]
"""The air at an altitude, m; raises InputError where it knows none."""

ControlLaw = Callable[[float, FlightState], Mapping[str, float]]
"""Deflections, rad, and moments `moment_x`, `moment_y`, `moment_z`, N m, at a time, s, in a state."""

Controls = Mapping[str, float] | ControlLaw
"""Constant deflections and moments, or a law that gives them."""

COEFFICIENTS = ("CL", "CD", "CY", "Cl", "Cm", "Cn")


@dataclass(frozen=True)
class Loads:
    """What acts on the vehicle apart from gravity.

    Attributes:
        drag, side, lift: N, in wind axes: aft, right and up.
        moment: [3] N m about the centre of mass, body axes.
        mach: Mach number; NaN in vacuum.
        dynamic_pressure: Pa.
        coefficients: CL, CD, CY, Cl, Cm, Cn; 0 in vacuum.
    """

    drag: float
    side: float
    lift: float
    moment: np.ndarray
    mach: float
    dynamic_pressure: float
    coefficients: Mapping[str, float]


def controls_at(controls: Controls, time: float, state: Callable[[], FlightState]) -> Mapping[str, float]:
    """Deflections, rad, and moments, N m, at a time, s; the state is made only where a law asks for it."""
    return controls(time, state()) if callable(controls) else controls


def loads(
    vehicle: Vehicle,
    air: Air,
    altitude: float,
    V: float,
    alpha: float,
    beta: float,
    turning: np.ndarray,
    controls: Mapping[str, float],
) -> Loads:
    """Forces and moments on the vehicle.

    Args:
        vehicle: with its aerodynamics.
        air: the air by altitude.
        altitude: m.
        V: airspeed, m/s.
        alpha, beta: rad.
        turning: [3] angular velocity against the air, body axes, rad/s.
        controls: deflections by surface, rad, and `moment_x`, `moment_y`, `moment_z`, N m.

    Raises:
        InputError: outside of the air or of the aerodynamics known, or a control that does not exist.
    """
    thrusters = np.array([float(controls.get(name, 0.0)) for name in MOMENT_INPUTS])
    deflections = {name: float(value) for name, value in controls.items() if name not in MOMENT_INPUTS}
    if vehicle.aerodynamics is None:
        if any(deflections.values()):
            raise InputError(f"controls = {', '.join(deflections)}: a vehicle without aerodynamics has none")
        return Loads(0.0, 0.0, 0.0, thrusters, math.nan, 0.0, dict.fromkeys(COEFFICIENTS, 0.0))
    ambient = air(altitude)
    reference = vehicle.aerodynamics.reference
    span, chord = reference.span, reference.chord
    p, q, r = (float(x) for x in turning)
    mach = V / ambient.speed_of_sound
    reduced = (p * span / (2 * V), q * chord / (2 * V), r * span / (2 * V))
    c = vehicle.aerodynamics.coefficients(mach, alpha, beta, reduced, deflections)
    pressure = 0.5 * ambient.density * V**2
    force = pressure * reference.area
    moment = force * np.array([span * c["Cl"], chord * c["Cm"], span * c["Cn"]]) + thrusters
    return Loads(force * c["CD"], force * c["CY"], force * c["CL"], moment, mach, pressure, c)
