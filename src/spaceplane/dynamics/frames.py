"""Axes of the flight dynamics and the turns between them.

Body axes: x forward, y right, z down; p, q, r right-handed about them. Geometry axes (`spaceplane.aero.axes`): x aft,
y right, z up. Stability axes: body axes turned by the angle of attack about y, so that x lies under the velocity.
Wind axes: stability axes turned by the sideslip about z, so that x lies along the velocity. Trajectory axes: x along
the velocity, y horizontal to the right, z in the vertical plane; the bank angle turns them about x into the wind axes.

Angle of attack is positive nose up, sideslip positive with the wind from the right, bank positive right wing down.
C_L up and C_D downstream are along -z and -x of the wind axes, C_Y along their +y; C_A aft and C_N up are along -x
and -z of the body axes; C_l, C_m, C_n are about body x, y, z: right wing down, nose up, nose right.

On to the planet (section 3.1 of the thesis): inertial axes, x in the equator and z north; planet axes, which turn
with the planet about z, x through longitude 0; horizon axes, x north, y east, z down, where down is towards the
centre for a planetocentric latitude and along the vertical for a geodetic one; then trajectory axes, by the heading
chi (from north, positive to the east) about z and the flight-path angle gamma (positive climbing) about y.

    inertial -> planet -> horizon -> trajectory -> wind -> body
             t Omega   lon, lat   chi, gamma    sigma   beta, alpha
"""

from __future__ import annotations

import math

import numpy as np

from spaceplane.aero.axes import geometry_to_body
from spaceplane.errors import InputError

__all__ = [
    "air_angles",
    "axial_normal_to_drag_lift",
    "bank_angle",
    "body_to_wind",
    "drag_lift_to_axial_normal",
    "geometry_to_body",
    "horizon_to_body",
    "horizon_to_trajectory",
    "inertial_to_planet",
    "path_angles",
    "planet_to_horizon",
    "trajectory_to_wind",
    "turn_x",
    "turn_y",
    "turn_z",
    "velocity_body",
    "velocity_horizon",
    "wind_to_body",
    "wind_to_trajectory",
]


def turn_x(angle: float) -> np.ndarray:
    """[3, 3] components in axes turned by `angle`, rad, right-handed about x, of a vector given in the old axes."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])


def turn_y(angle: float) -> np.ndarray:
    """[3, 3] components in axes turned by `angle`, rad, right-handed about y."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])


def turn_z(angle: float) -> np.ndarray:
    """[3, 3] components in axes turned by `angle`, rad, right-handed about z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def body_to_wind(alpha: float, beta: float) -> np.ndarray:
    """[3, 3] wind-axes components of a vector given in body axes; angles in rad. Orthogonal: invert by transposing."""
    return turn_z(beta) @ turn_y(-alpha)


def wind_to_trajectory(bank: float) -> np.ndarray:
    """[3, 3] trajectory-axes components of a vector given in wind axes; bank angle in rad."""
    return turn_x(-bank)


def trajectory_to_wind(bank: float) -> np.ndarray:
    """[3, 3] wind-axes components of a vector given in trajectory axes; bank angle in rad."""
    return turn_x(bank)


def wind_to_body(alpha: float, beta: float) -> np.ndarray:
    """[3, 3] body-axes components of a vector given in wind axes; angles in rad."""
    return turn_y(alpha) @ turn_z(-beta)


def inertial_to_planet(angle: float) -> np.ndarray:
    """[3, 3] planet-axes components of a vector given in inertial axes; angle turned since they coincided, rad."""
    return turn_z(angle)


def planet_to_horizon(longitude: float, latitude: float) -> np.ndarray:
    """[3, 3] horizon-axes components (north, east, down) of a vector given in planet axes; rad.

    The latitude decides what down is: planetocentric or geodetic.
    """
    return turn_y(-latitude - math.pi / 2) @ turn_z(longitude)


def horizon_to_trajectory(gamma: float, chi: float) -> np.ndarray:
    """[3, 3] trajectory-axes components of a vector given in horizon axes; flight-path angle and heading in rad."""
    return turn_y(gamma) @ turn_z(chi)


def horizon_to_body(gamma: float, chi: float, bank: float, alpha: float, beta: float) -> np.ndarray:
    """[3, 3] body-axes components of a vector given in horizon axes, by the aerodynamic attitude; rad."""
    return wind_to_body(alpha, beta) @ trajectory_to_wind(bank) @ horizon_to_trajectory(gamma, chi)


def velocity_horizon(V: float, gamma: float, chi: float) -> np.ndarray:
    """[3] north, east and down velocity, m/s, from the speed, m/s, flight-path angle and heading, rad."""
    return V * np.array([math.cos(gamma) * math.cos(chi), math.cos(gamma) * math.sin(chi), -math.sin(gamma)])


def path_angles(velocity: np.ndarray) -> tuple[float, float, float]:
    """(V m/s, gamma rad, chi rad in (-pi, pi]) of a velocity [3] in horizon axes, m/s; straight up or down chi is 0.

    Raises:
        InputError: the velocity is zero.
    """
    north, east, down = (float(x) for x in velocity)
    level = math.hypot(north, east)
    speed = math.hypot(level, down)
    if not speed > 0.0:
        raise InputError(f"V = {speed} m/s: must be above 0")
    return speed, math.atan2(-down, level), math.atan2(east, north)


def velocity_body(V: float, alpha: float, beta: float) -> np.ndarray:
    """[3] velocity u, v, w in body axes, m/s, from the speed, m/s, angle of attack and sideslip, rad."""
    return V * np.array([math.cos(alpha) * math.cos(beta), math.sin(beta), math.sin(alpha) * math.cos(beta)])


def air_angles(velocity: np.ndarray) -> tuple[float, float, float]:
    """(V m/s, alpha rad in (-pi, pi], beta rad) of a velocity [3] in body axes, m/s.

    Raises:
        InputError: the velocity is zero.
    """
    u, v, w = (float(x) for x in velocity)
    symmetric = math.hypot(u, w)
    speed = math.hypot(symmetric, v)
    if not speed > 0.0:
        raise InputError(f"V = {speed} m/s: must be above 0")
    return speed, math.atan2(w, u), math.atan2(v, symmetric)


def bank_angle(horizon_to_body_axes: np.ndarray, gamma: float, chi: float, alpha: float, beta: float) -> float:
    """Bank angle, rad in (-pi, pi], of an attitude [3, 3] horizon to body axes; the four other angles in rad."""
    turn = body_to_wind(alpha, beta) @ horizon_to_body_axes @ horizon_to_trajectory(gamma, chi).T
    return math.atan2(turn[1, 2], turn[1, 1])


def axial_normal_to_drag_lift(CA: float, CN: float, alpha: float) -> tuple[float, float]:
    """(CD, CL) of axial (aft) and normal (up) force coefficients at zero sideslip; `alpha` in rad."""
    c, s = np.cos(alpha), np.sin(alpha)
    return CA * c + CN * s, CN * c - CA * s


def drag_lift_to_axial_normal(CD: float, CL: float, alpha: float) -> tuple[float, float]:
    """(CA, CN) of drag and lift coefficients at zero sideslip; `alpha` in rad."""
    c, s = np.cos(alpha), np.sin(alpha)
    return CD * c - CL * s, CL * c + CD * s
