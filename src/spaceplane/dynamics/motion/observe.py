"""What can be read off a state of flight: the quantities of a simulated history and of its events."""

from __future__ import annotations

import math

from spaceplane.dynamics import attitude, frames
from spaceplane.dynamics.motion.forces import COEFFICIENTS, Air, Controls, controls_at, loads
from spaceplane.dynamics.motion.state import TRAJECTORY_STATES, FlightState, to_trajectory
from spaceplane.dynamics.motion.vehicle import Vehicle
from spaceplane.dynamics.planet import Planet, geodetic, planet_rate, potential
from spaceplane.environment.constants import STANDARD_GRAVITY

QUANTITIES: dict[str, tuple[str, str]] = {
    "V": ("m/s", "speed against the air"),
    "gamma": ("rad", "flight-path angle above the planetocentric horizon"),
    "chi": ("rad", "heading from north to the east, in (-pi, pi]"),
    "R": ("m", "distance from the planet's centre"),
    "lon": ("rad", "longitude, in (-pi, pi]"),
    "lat": ("rad", "planetocentric latitude"),
    "p": ("rad/s", "roll rate against inertial space, body axes"),
    "q": ("rad/s", "pitch rate against inertial space, body axes"),
    "r": ("rad/s", "yaw rate against inertial space, body axes"),
    "alpha": ("rad", "angle of attack"),
    "beta": ("rad", "sideslip, wind from the right positive"),
    "sigma": ("rad", "bank angle, right wing down positive, in (-pi, pi]"),
    "altitude": ("m", "above the planet's ellipsoid"),
    "geodetic_lat": ("rad", "geodetic latitude"),
    "psi": ("rad", "Euler angle of yaw against the planetocentric horizon"),
    "theta": ("rad", "Euler angle of pitch against the planetocentric horizon"),
    "phi": ("rad", "Euler angle of roll against the planetocentric horizon"),
    "mach": ("1", "Mach number; NaN in vacuum"),
    "dynamic_pressure": ("Pa", "half the density times the square of the speed"),
    "load_factor": ("1", "aerodynamic force up in body axes over the weight at standard gravity"),
    "energy": ("J/kg", "kinetic against the planet, gravitational and centrifugal potential"),
    "CL": ("1", "lift coefficient, wind axes, up"),
    "CD": ("1", "drag coefficient, wind axes, downstream"),
    "CY": ("1", "side-force coefficient, wind axes, right"),
    "Cl": ("1", "rolling-moment coefficient, body axes, right wing down"),
    "Cm": ("1", "pitching-moment coefficient, body axes, nose up"),
    "Cn": ("1", "yawing-moment coefficient, body axes, nose right"),
}
"""Name -> (unit, meaning)."""


def observe(
    state: FlightState, time: float, vehicle: Vehicle, planet: Planet, controls: Controls, air: Air
) -> dict[str, float]:
    """All `QUANTITIES` of a state, SI and rad.

    The energy is the one that rotating axes conserve without aerodynamic forces (Jacobi's).

    Args:
        state: of flight.
        time: s, for a control law.
        vehicle: mass, inertia, aerodynamics.
        planet: figure, gravity, rotation.
        controls: deflections rad and moments N m.
        air: the air by altitude, m.

    Raises:
        InputError: outside of the air or of the aerodynamics known.
    """
    found = dict(zip(TRAJECTORY_STATES, (float(x) for x in to_trajectory(state)), strict=True))
    altitude, _, latitude = geodetic(planet, state.position)
    to_axes = attitude.matrix(state.attitude)
    relative = state.rates - to_axes.T @ planet_rate(planet)
    given = controls_at(controls, time, lambda: state)
    acting = loads(vehicle, air, altitude, found["V"], found["alpha"], found["beta"], relative, given)
    horizon = attitude.from_matrix(frames.planet_to_horizon(found["lon"], found["lat"]) @ to_axes)
    yaw, pitch, roll = attitude.euler_angles(horizon)
    cos_a, sin_a = math.cos(found["alpha"]), math.sin(found["alpha"])
    cos_b, sin_b = math.cos(found["beta"]), math.sin(found["beta"])
    up = acting.lift * cos_a + (acting.drag * cos_b + acting.side * sin_b) * sin_a
    x, y, _ = state.position
    centrifugal = 0.5 * planet.rotation**2 * (x * x + y * y)
    return found | {
        "altitude": altitude,
        "geodetic_lat": latitude,
        "psi": float(yaw),
        "theta": float(pitch),
        "phi": float(roll),
        "mach": acting.mach,
        "dynamic_pressure": acting.dynamic_pressure,
        "load_factor": up / (vehicle.mass * STANDARD_GRAVITY),
        "energy": 0.5 * found["V"] ** 2 + float(potential(planet, state.position)) - centrifugal,
        **{name: float(acting.coefficients[name]) for name in COEFFICIENTS},
    }
