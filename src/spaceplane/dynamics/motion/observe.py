"""What can be read off a state of flight: the quantities of a simulated history and of its events."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from spaceplane.dynamics import attitude, frames
from spaceplane.dynamics.motion.body import fixed_loads
from spaceplane.dynamics.motion.forces import COEFFICIENTS, Air, Controls
from spaceplane.dynamics.motion.state import TRAJECTORY_STATES, FlightState, to_fixed, to_trajectory
from spaceplane.dynamics.motion.vehicle import Vehicle
from spaceplane.dynamics.motion.wind import air_velocity
from spaceplane.dynamics.planet import Planet, geodetic, potential
from spaceplane.environment.constants import STANDARD_GRAVITY

QUANTITIES: dict[str, tuple[str, str]] = {
    "V": ("m/s", "speed against the air"),
    "gamma": ("rad", "flight-path angle through the air above the planetocentric horizon"),
    "chi": ("rad", "heading of the path through the air, from north to the east, in (-pi, pi]"),
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
    "ground_speed": ("m/s", "speed against the planet; V without wind"),
    "track": ("rad", "heading of the path over the planet, in (-pi, pi]; chi without wind"),
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
    in_air = replace(state, velocity=state.velocity - air_velocity(air, planet, state.position))
    found = dict(zip(TRAJECTORY_STATES, (float(x) for x in to_trajectory(in_air)), strict=True))
    altitude, _, latitude = geodetic(planet, state.position)
    to_axes = attitude.matrix(state.attitude)
    acting = fixed_loads(time, to_fixed(state), vehicle, planet, controls, air)
    to_horizon = frames.planet_to_horizon(found["lon"], found["lat"])
    north, east, _ = to_horizon @ state.velocity
    ground_speed = float(np.linalg.norm(state.velocity))
    horizon = attitude.from_matrix(to_horizon @ to_axes)
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
        "ground_speed": ground_speed,
        "track": math.atan2(east, north),
        "energy": 0.5 * ground_speed**2 + float(potential(planet, state.position)) - centrifugal,
        **{name: float(acting.coefficients[name]) for name in COEFFICIENTS},
    }
