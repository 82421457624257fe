"""The body form: Cartesian position and velocity, quaternion attitude, body rates. No singularity anywhere in flight.

Against inertial axes I (Newton and Euler, (3.5) and (3.13) of the thesis):

    dr/dt = v
    dv/dt = F/m + g(r)
    dq/dt = q (0, omega) / 2
    I domega/dt = M - omega x I omega

Against the planet-fixed axes P, which turn with Omega:

    dv/dt = F/m + g(r) - 2 Omega x v - Omega x (Omega x r)
    dq/dt = q (0, omega - Omega in body axes) / 2

F is the aerodynamic force at the velocity against the air, v - Omega x r - w inertially and v - w in planet-fixed axes
with a wind w (`spaceplane.dynamics.motion.wind`); the aerodynamic rates are those against the planet, omega - Omega.

Where forces depend on dalpha/dt: with u = (u, v, w) the velocity against the air in body axes,

    alpha' = (u w' - w u') / (u^2 + w^2),   u' = F/m + (all other accelerations against the air) - omega x u
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from spaceplane.dynamics import attitude, frames
from spaceplane.dynamics.motion.forces import Air, Controls, Loads, controls_at, loads, with_lag
from spaceplane.dynamics.motion.state import from_fixed, from_inertial
from spaceplane.dynamics.motion.vehicle import Vehicle, angular_acceleration
from spaceplane.dynamics.motion.wind import air_acceleration, air_velocity
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
    spin = planet.rotation
    carried, turned = (spin * np.array([-vector[1], vector[0], 0.0]) for vector in (position, velocity))
    against_air = velocity - carried - air_velocity(air, planet, position)
    given = controls_at(controls, time, lambda: from_inertial(values, planet, time))
    fall = gravity(planet, position)

    def other() -> np.ndarray:
        """Acceleration against the air without that of the aerodynamic force, m/s2."""
        return fall - turned - air_acceleration(air, planet, position, velocity)

    acting = _acting(values, against_air, values[10:13], other, vehicle, planet, given, air)
    specific = _specific_force(values, against_air, acting, vehicle)
    turning = angular_acceleration(vehicle, values[10:13], acting.moment)
    return np.concatenate([velocity, specific + fall, attitude.rate(values[6:10], values[10:13]), turning])


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
    acting, against_air, fall = _fixed_loads(time, values, vehicle, planet, controls, air)
    specific = _specific_force(values, against_air, acting, vehicle)
    turning = angular_acceleration(vehicle, values[10:13], acting.moment)
    swing = attitude.rate(values[6:10], _against_planet(values, planet))
    return np.concatenate([values[3:6], specific + fall, swing, turning])


def fixed_loads(
    time: float, values: np.ndarray, vehicle: Vehicle, planet: Planet, controls: Controls, air: Air
) -> Loads:
    """What acts at a state of the body-fixed form.

    Args:
        time: s.
        values: [13] position m, velocity m/s, attitude, rates rad/s.
        vehicle, planet, controls, air: as for `inertial_rates`.

    Raises:
        InputError: outside of the air or of the aerodynamics known.
    """
    return _fixed_loads(time, values, vehicle, planet, controls, air)[0]


def _fixed_loads(
    time: float, values: np.ndarray, vehicle: Vehicle, planet: Planet, controls: Controls, air: Air
) -> tuple[Loads, np.ndarray, np.ndarray]:
    """(loads, velocity against the air, acceleration by gravity and rotation), planet-fixed axes."""
    position, velocity = values[:3], values[3:6]
    spin = planet.rotation
    (x, y, _), (u, v, _) = position, velocity
    fall = gravity(planet, position) + np.array([2 * spin * v + spin**2 * x, -2 * spin * u + spin**2 * y, 0.0])
    against_air = velocity - air_velocity(air, planet, position)
    given = controls_at(controls, time, lambda: from_fixed(values))
    turning = _against_planet(values, planet)

    def other() -> np.ndarray:
        """Acceleration against the air without that of the aerodynamic force, m/s2."""
        return fall - air_acceleration(air, planet, position, velocity)

    return _acting(values, against_air, turning, other, vehicle, planet, given, air), against_air, fall


def _against_planet(values: np.ndarray, planet: Planet) -> np.ndarray:
    """Body rates against the planet; z is its axis in both sets of axes, so its rate has the same components."""
    return values[10:13] - planet.rotation * attitude.matrix(values[6:10])[2]


def _acting(
    values: np.ndarray,
    against_air: np.ndarray,
    turning: np.ndarray,
    other: Callable[[], np.ndarray],
    vehicle: Vehicle,
    planet: Planet,
    controls: Mapping[str, float],
    air: Air,
) -> Loads:
    """Loads; `turning` are the body rates against the axes of the position, `other` all other accelerations."""
    relative = _against_planet(values, planet)
    if vehicle.aerodynamics is None:
        return loads(vehicle, air, 0.0, 0.0, 0.0, 0.0, relative, controls)
    x, y, z = (float(c) for c in values[:3])
    altitude = geodetic_meridian(planet, math.hypot(x, y), z)[0]
    to_body = attitude.matrix(values[6:10]).T
    body = to_body @ against_air
    V, alpha, beta = frames.air_angles(body)
    acting = loads(vehicle, air, altitude, V, alpha, beta, relative, controls)
    if not any(acting.lag):
        return acting
    change = to_body @ (_specific_force(values, against_air, acting, vehicle) + other()) - np.cross(turning, body)
    rate = (body[0] * change[2] - body[2] * change[0]) / (body[0] ** 2 + body[2] ** 2)
    return with_lag(acting, vehicle, V, beta, rate)


def _specific_force(values: np.ndarray, against_air: np.ndarray, acting: Loads, vehicle: Vehicle) -> np.ndarray:
    """[3] aerodynamic force per mass, m/s2, in the axes of the position."""
    if vehicle.aerodynamics is None:
        return np.zeros(3)
    to_axes = attitude.matrix(values[6:10])
    _, alpha, beta = frames.air_angles(to_axes.T @ against_air)
    force = frames.wind_to_body(alpha, beta) @ np.array([-acting.drag, acting.side, -acting.lift])
    return to_axes @ force / vehicle.mass
