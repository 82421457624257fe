"""Aerodynamic forces and moments, and the moments of thrusters, that act on the vehicle.

Lift and pitching moment may depend on dalpha/dt, which depends on the lift: with alpha'_0 the rate that all other
forces give, L_a = q S CL_alphadot c/2V the lift per rate and m V cos(beta) what it takes to turn the path,

    alpha' = alpha'_0 - L_a alpha' / (m V cos(beta)),  so  alpha' = alpha'_0 / (1 + L_a / (m V cos(beta)))
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from spaceplane.dynamics.motion.state import FlightState
from spaceplane.dynamics.motion.vehicle import Vehicle, lag_of
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
        lag: (lift, pitching moment) per rate of the angle of attack, N s and N m s; not in the above by itself.
    """

    drag: float
    side: float
    lift: float
    moment: np.ndarray
    mach: float
    dynamic_pressure: float
    coefficients: Mapping[str, float]
    lag: tuple[float, float] = (0.0, 0.0)


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
    """Forces and moments on the vehicle, at a steady angle of attack.

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
    lift_lag, pitch_lag = (force * chord / (2 * V) * slope for slope in lag_of(vehicle.aerodynamics))
    lag = (lift_lag, chord * pitch_lag)
    return Loads(force * c["CD"], force * c["CY"], force * c["CL"], moment, mach, pressure, c, lag)


def with_lag(acting: Loads, vehicle: Vehicle, V: float, beta: float, steady_rate: float) -> Loads:
    """The loads with those by the rate of the angle of attack, which they change themselves: solved exactly.

    Args:
        acting: at a steady angle of attack.
        vehicle: its mass, kg, and aerodynamics.
        V: airspeed, m/s.
        beta: rad.
        steady_rate: dalpha/dt, rad/s, that `acting` and gravity would give.

    Raises:
        InputError: CL_alphadot is so negative that no rate solves the equation.
    """
    lift_lag, pitch_lag = acting.lag
    implicit = 1.0 + lift_lag / (vehicle.mass * V * math.cos(beta))
    if not implicit > 0.0:
        raise InputError(
            f"CL_alphadot = {lag_of(vehicle.aerodynamics)[0]:.6g}: the lift it takes away exceeds the vehicle's inertia"
        )
    rate = steady_rate / implicit
    chord = vehicle.aerodynamics.reference.chord
    reduced = rate * chord / (2 * V)
    slopes = dict(zip(("CL", "Cm"), lag_of(vehicle.aerodynamics), strict=True))
    return replace(
        acting,
        lift=acting.lift + lift_lag * rate,
        moment=acting.moment + np.array([0.0, pitch_lag * rate, 0.0]),
        coefficients={name: c + slopes.get(name, 0.0) * reduced for name, c in acting.coefficients.items()},
    )
