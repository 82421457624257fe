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
    to_axes = attitude.matrix(values[6:10])
    omega = values[10:13]
    relative = _against_planet(omega, to_axes, planet)

    def other() -> np.ndarray:
        """Acceleration against the air without that of the aerodynamic force, m/s2."""
        return fall - turned - air_acceleration(air, planet, position, velocity)

    acting, specific = _acting(position, to_axes, against_air, relative, omega, other, vehicle, planet, given, air)
    turning = angular_acceleration(vehicle, omega, acting.moment)
    return np.concatenate([velocity, specific + fall, attitude.rate(values[6:10], omega), turning])


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
    acting, acceleration, relative = _fixed(time, values, vehicle, planet, controls, air)
    turning = angular_acceleration(vehicle, values[10:13], acting.moment)
    return np.concatenate([values[3:6], acceleration, attitude.rate(values[6:10], relative), turning])


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
    return _fixed(time, values, vehicle, planet, controls, air)[0]


def _fixed(
    time: float, values: np.ndarray, vehicle: Vehicle, planet: Planet, controls: Controls, air: Air
) -> tuple[Loads, np.ndarray, np.ndarray]:
    """(loads, d velocity/dt in planet-fixed axes, body rates against the planet)."""
    position, velocity = values[:3], values[3:6]
    spin = planet.rotation
    (x, y, _), (u, v, _) = position, velocity
    fall = gravity(planet, position) + np.array([2 * spin * v + spin**2 * x, -2 * spin * u + spin**2 * y, 0.0])
    against_air = velocity - air_velocity(air, planet, position)
    given = controls_at(controls, time, lambda: from_fixed(values))
    to_axes = attitude.matrix(values[6:10])
    relative = _against_planet(values[10:13], to_axes, planet)

    def other() -> np.ndarray:
        """Acceleration against the air without that of the aerodynamic force, m/s2."""
        return fall - air_acceleration(air, planet, position, velocity)

    acting, specific = _acting(position, to_axes, against_air, relative, relative, other, vehicle, planet, given, air)
    return acting, specific + fall, relative


def _against_planet(omega: np.ndarray, to_axes: np.ndarray, planet: Planet) -> np.ndarray:
    """Body rates against the planet; z is its axis in both sets of axes, so its rate has the same components."""
    return omega - planet.rotation * to_axes[2]


def _acting(
    position: np.ndarray,
    to_axes: np.ndarray,
    against_air: np.ndarray,
    relative: np.ndarray,
    turning: np.ndarray,
    other: Callable[[], np.ndarray],
    vehicle: Vehicle,
    planet: Planet,
    controls: Mapping[str, float],
    air: Air,
) -> tuple[Loads, np.ndarray]:
    """(loads, aerodynamic force per mass in the axes of the position).

    `relative` are the body rates against the planet, `turning` those against the axes of the position, and `other`
    gives all other accelerations against the air.
    """
    if vehicle.aerodynamics is None:
        return loads(vehicle, air, 0.0, 0.0, 0.0, 0.0, relative, controls), np.zeros(3)
    x, y, z = (float(c) for c in position)
    altitude = geodetic_meridian(planet, math.hypot(x, y), z)[0]
    body = to_axes.T @ against_air
    V, alpha, beta = frames.air_angles(body)
    acting = loads(vehicle, air, altitude, V, alpha, beta, relative, controls)
    from_wind = frames.wind_to_body(alpha, beta) / vehicle.mass
    specific = from_wind @ np.array([-acting.drag, acting.side, -acting.lift])
    if any(acting.lag):
        change = specific + to_axes.T @ other() - np.cross(turning, body)
        rate = (body[0] * change[2] - body[2] * change[0]) / (body[0] ** 2 + body[2] ** 2)
        acting = with_lag(acting, vehicle, V, beta, float(rate))
        specific = from_wind @ np.array([-acting.drag, acting.side, -acting.lift])
    return acting, to_axes @ specific
