"""The trajectory form: V, gamma, chi, R, lon, lat, p, q, r, alpha, beta, sigma over a rotating ellipsoid.

With D aft, Y right, L up in wind axes, gravity g_n to the north and g_d down in the planetocentric horizon, Omega the
rotation of the planet and delta the planetocentric latitude:

    dV/dt = -D/m - g_d sin(gamma) + g_n cos(gamma) cos(chi)
            + Omega^2 R cos(delta) (sin(gamma) cos(delta) - cos(gamma) sin(delta) cos(chi))
    V dgamma/dt = (L cos(sigma) - Y sin(sigma))/m - g_d cos(gamma) - g_n sin(gamma) cos(chi)
            + 2 Omega V cos(delta) sin(chi) + V^2/R cos(gamma)
            + Omega^2 R cos(delta) (cos(gamma) cos(delta) + sin(gamma) sin(delta) cos(chi))
    V cos(gamma) dchi/dt = (L sin(sigma) + Y cos(sigma))/m - g_n sin(chi)
            + 2 Omega V (sin(delta) cos(gamma) - cos(delta) sin(gamma) cos(chi))
            + V^2/R cos^2(gamma) tan(delta) sin(chi) + Omega^2 R cos(delta) sin(delta) sin(chi)
    dR/dt = V sin(gamma),  dlon/dt = V cos(gamma) sin(chi) / (R cos(delta)),  ddelta/dt = V cos(gamma) cos(chi) / R

These are (3.6) to (3.11) of the thesis with the side force, the north component of gravity and one speed V, which is
that against the air. The rotation is (3.13) with the full inertia tensor, p, q, r against inertial space. The
attitude follows from the turning rate of the trajectory axes against inertial space,

    omega_T = (-dchi/dt sin(gamma), dgamma/dt, dchi/dt cos(gamma)) + that of the horizon and of the planet,

turned by the bank angle into the wind axes (omega_x, omega_y, omega_z), and the body rates in wind axes (P, Q, R_w):

    dalpha/dt = (Q - omega_y) / cos(beta)
    dbeta/dt  = omega_z - R_w
    dsigma/dt = P - omega_x - dalpha/dt sin(beta)

On a sphere at rest they are the equations of `spaceplane.dynamics.equations`.
"""

from __future__ import annotations

import math

import numpy as np

from spaceplane.dynamics import frames
from spaceplane.dynamics.motion.forces import Air, Controls, Loads, controls_at, loads, with_lag
from spaceplane.dynamics.motion.state import check_regular, from_trajectory_array
from spaceplane.dynamics.motion.vehicle import Vehicle, angular_acceleration
from spaceplane.dynamics.motion.wind import MovingAir
from spaceplane.dynamics.planet import Planet, geodetic_meridian, gravity_north_down
from spaceplane.errors import InputError


def trajectory_rates(
    time: float, values: np.ndarray, vehicle: Vehicle, planet: Planet, controls: Controls, air: Air
) -> np.ndarray:
    """[12] time derivatives of the trajectory form, SI units and rad.

    Args:
        time: s.
        values: [12] in the order of `TRAJECTORY_STATES`.
        vehicle: mass, inertia, aerodynamics.
        planet: figure, gravity, rotation.
        controls: deflections rad and moments N m.
        air: the air by altitude, m.

    Raises:
        InputError: outside of the air or of the aerodynamics known, at a singularity of this form, or a wind.
    """
    _still(air)
    check_regular(values)
    acting = _acting(time, values, vehicle, planet, controls, air)
    alpha, beta = float(values[9]), float(values[10])
    P, Q, yaw = frames.body_to_wind(alpha, beta) @ values[6:9]
    path = _path(values, vehicle, planet, acting)
    wind = _wind_rates(values, path, planet)
    if any(acting.lag):
        acting = with_lag(acting, vehicle, float(values[0]), beta, (Q - wind[1]) / math.cos(beta))
        path = _path(values, vehicle, planet, acting)
        wind = _wind_rates(values, path, planet)
    alpha_dot = (Q - wind[1]) / math.cos(beta)
    attitude = (alpha_dot, wind[2] - yaw, P - wind[0] - alpha_dot * math.sin(beta))
    return np.array([*path, *angular_acceleration(vehicle, values[6:9], acting.moment), *attitude])


def steady_rates(
    values: np.ndarray, vehicle: Vehicle, planet: Planet, controls: Controls, air: Air, time: float = 0.0
) -> np.ndarray:
    """[3] p, q, r, rad/s, with which angle of attack, sideslip and bank do not change.

    On a sphere at rest without side force they are (3.27) to (3.29) of the thesis in this project's axes. Where the
    forces depend on the rates, they are found by iteration.

    Args:
        values: [12] in the order of `TRAJECTORY_STATES`; its own rates are where the iteration starts.
        vehicle, planet, controls, air: as for `trajectory_rates`.
        time: s, for a control law.

    Raises:
        InputError: outside of the air or of the aerodynamics known, at a singularity of this form, or a wind.
    """
    _still(air)
    check_regular(values)
    values = np.array(values, dtype=float)
    to_body = frames.wind_to_body(float(values[9]), float(values[10]))
    for _ in range(50):
        acting = _acting(time, values, vehicle, planet, controls, air)
        rates = to_body @ _wind_rates(values, _path(values, vehicle, planet, acting), planet)
        change = np.abs(rates - values[6:9]).max()
        values[6:9] = rates
        if change <= 1e-15 + 1e-14 * np.abs(rates).max():
            break
    return values[6:9]


def _still(air: Air) -> None:
    if isinstance(air, MovingAir):
        raise InputError("wind: the trajectory form takes none, its speed and angles are those against still air")


def _acting(time: float, values: np.ndarray, vehicle: Vehicle, planet: Planet, controls: Controls, air: Air) -> Loads:
    """Aerodynamic forces and moments; the rates against the air are those against the planet."""
    V, gamma, chi, R, _, lat = (float(x) for x in values[:6])
    alpha, beta, sigma = (float(x) for x in values[9:12])
    given = controls_at(controls, time, lambda: from_trajectory_array(values))
    spin = planet.rotation * np.array([math.cos(lat), 0.0, -math.sin(lat)])  # north, east, down
    relative = values[6:9] - frames.horizon_to_body(gamma, chi, sigma, alpha, beta) @ spin
    altitude = geodetic_meridian(planet, R * math.cos(lat), R * math.sin(lat))[0]
    return loads(vehicle, air, altitude, V, alpha, beta, relative, given)


def _path(values: np.ndarray, vehicle: Vehicle, planet: Planet, acting: Loads) -> tuple[float, ...]:
    """Time derivatives of V, gamma, chi, R, lon, lat."""
    V, gamma, chi, R, _, lat = (float(x) for x in values[:6])
    sigma = float(values[11])
    m, spin = vehicle.mass, planet.rotation
    north, down = gravity_north_down(planet, R, lat)
    sin_g, cos_g = math.sin(gamma), math.cos(gamma)
    sin_c, cos_c = math.sin(chi), math.cos(chi)
    sin_d, cos_d = math.sin(lat), math.cos(lat)
    sin_s, cos_s = math.sin(sigma), math.cos(sigma)
    centrifugal = spin**2 * R * cos_d
    along = (
        -acting.drag / m - down * sin_g + north * cos_g * cos_c + centrifugal * (sin_g * cos_d - cos_g * sin_d * cos_c)
    )
    up = (
        (acting.lift * cos_s - acting.side * sin_s) / m
        - down * cos_g
        - north * sin_g * cos_c
        + 2 * spin * V * cos_d * sin_c
        + V**2 / R * cos_g
        + centrifugal * (cos_g * cos_d + sin_g * sin_d * cos_c)
    )
    right = (
        (acting.lift * sin_s + acting.side * cos_s) / m
        - north * sin_c
        + 2 * spin * V * (sin_d * cos_g - cos_d * sin_g * cos_c)
        + V**2 / R * cos_g**2 * math.tan(lat) * sin_c
        + centrifugal * sin_d * sin_c
    )
    return (
        along,
        up / V,
        right / (V * cos_g),
        V * sin_g,
        V * cos_g * sin_c / (R * cos_d),
        V * cos_g * cos_c / R,
    )


def _wind_rates(values: np.ndarray, path: tuple[float, ...], planet: Planet) -> np.ndarray:
    """[3] angular velocity of the wind axes at a constant bank angle, against inertial space, wind axes, rad/s."""
    gamma, chi, lat = float(values[1]), float(values[2]), float(values[5])
    _, gamma_dot, chi_dot, _, lon_dot, lat_dot = path
    east_turn = planet.rotation + lon_dot
    horizon = np.array([east_turn * math.cos(lat), -lat_dot, -east_turn * math.sin(lat)])
    own = np.array([-chi_dot * math.sin(gamma), gamma_dot, chi_dot * math.cos(gamma)])
    turning = own + frames.horizon_to_trajectory(gamma, chi) @ horizon
    return frames.trajectory_to_wind(float(values[11])) @ turning
