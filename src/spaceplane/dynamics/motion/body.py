"""The body form: Cartesian position and velocity, quaternion attitude, body rates. No singularity anywhere in flight.

Against inertial axes I (Newton and Euler, (3.5) and (3.13) of the thesis):

    dr/dt = v
    dv/dt = F/m + g(r)
    dq/dt = q (0, omega) / 2
    I domega/dt = M - omega x I omega

Against the planet-fixed axes P, which turn with Omega:

    dv/dt = F/m + g(r) - 2 Omega x v - Omega x (Omega x r)
    dq/dt = q (0, omega - Omega in body axes) / 2

F is the aerodynamic force at the velocity against the air, v - Omega x r inertially and v in planet-fixed axes; the
aerodynamic rates are those against the air as well, omega - Omega. There is no wind.
"""

from __future__ import annotations

import math

import numpy as np

from spaceplane.dynamics import attitude, frames
from spaceplane.dynamics.motion.forces import Air, Controls, controls_at, loads
from spaceplane.dynamics.motion.state import from_fixed, from_inertial
from spaceplane.dynamics.motion.vehicle import Vehicle, angular_acceleration
from spaceplane.dynamics.planet import Planet, geodetic_meridian, gravity


def inertial_rates(
    time: float, values: np.ndarray, vehicle: Vehicle, planet: Planet, controls: Controls, air: Air
) -> np.ndarray:
    """[13] time derivatives of the body-inertial form, SI units.

    Args:
        time: s.
        values: [13] position m, velocity m/s, attitude, rates rad/s against inertial axes.
        vehicle: mass, inertia, aerodynamics.
        planet: figure, gravity, rotation.
        controls: deflections rad and moments N m.
        air: the air by altitude, m.

    Raises:
        InputError: outside of the air or of the aerodynamics known.
    """
    position, velocity = values[:3], values[3:6]
    x, y, _ = position
    against_air = velocity - planet.rotation * np.array([-y, x, 0.0])
    given = controls_at(controls, time, lambda: from_inertial(values, planet, time))
    specific, turning, relative = _acting(values, against_air, vehicle, planet, given, air)
    del relative  # the attitude here is against inertial axes
    return np.concatenate(
        [velocity, specific + gravity(planet, position), attitude.rate(values[6:10], values[10:13]), turning]
    )


def fixed_rates(
    time: float, values: np.ndarray, vehicle: Vehicle, planet: Planet, controls: Controls, air: Air
) -> np.ndarray:
    """[13] time derivatives of the body-fixed form, SI units; arguments as for `inertial_rates`, planet-fixed axes.

    Args:
        time: s.
        values: [13] position m, velocity m/s, attitude, rates rad/s.
        vehicle, planet, controls, air: as there.

    Raises:
        InputError: outside of the air or of the aerodynamics known.
    """
    position, velocity = values[:3], values[3:6]
    given = controls_at(controls, time, lambda: from_fixed(values))
    specific, turning, relative = _acting(values, velocity, vehicle, planet, given, air)
    spin = planet.rotation
    (x, y, _), (u, v, _) = position, velocity
    apparent = np.array([2 * spin * v + spin**2 * x, -2 * spin * u + spin**2 * y, 0.0])
    return np.concatenate(
        [velocity, specific + gravity(planet, position) + apparent, attitude.rate(values[6:10], relative), turning]
    )


def _acting(
    values: np.ndarray, against_air: np.ndarray, vehicle: Vehicle, planet: Planet, controls: dict, air: Air
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(aerodynamic force per mass in the axes of the position, d omega/dt, body rates against the planet)."""
    x, y, z = (float(c) for c in values[:3])
    to_axes = attitude.matrix(values[6:10])
    omega = values[10:13]
    # z is the axis of rotation in both sets of axes, so the planet's rate has the same components.
    relative = omega - planet.rotation * to_axes[2]
    if vehicle.aerodynamics is None:
        altitude, V, alpha, beta = 0.0, 0.0, 0.0, 0.0
    else:
        altitude = geodetic_meridian(planet, math.hypot(x, y), z)[0]
        V, alpha, beta = frames.air_angles(to_axes.T @ against_air)
    acting = loads(vehicle, air, altitude, V, alpha, beta, relative, controls)
    force = frames.wind_to_body(alpha, beta) @ np.array([-acting.drag, acting.side, -acting.lift])
    return to_axes @ force / vehicle.mass, angular_acceleration(vehicle, omega, acting.moment), relative
