"""Axes of the flight dynamics and the turns between them.

Body axes: x forward, y right, z down; p, q, r right-handed about them. Geometry axes (`spaceplane.aero.axes`): x aft,
y right, z up. Stability axes: body axes turned by the angle of attack about y, so that x lies under the velocity.
Wind axes: stability axes turned by the sideslip about z, so that x lies along the velocity. Trajectory axes: x along
the velocity, y horizontal to the right, z in the vertical plane; the bank angle turns them about x into the wind axes.

Angle of attack is positive nose up, sideslip positive with the wind from the right, bank positive right wing down.
C_L up and C_D downstream are along -z and -x of the wind axes, C_Y along their +y; C_A aft and C_N up are along -x
and -z of the body axes; C_l, C_m, C_n are about body x, y, z: right wing down, nose up, nose right.
"""

from __future__ import annotations

import numpy as np

from spaceplane.aero.axes import geometry_to_body

__all__ = [
    "axial_normal_to_drag_lift",
    "body_to_wind",
    "drag_lift_to_axial_normal",
    "geometry_to_body",
    "turn_x",
    "turn_y",
    "turn_z",
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


def axial_normal_to_drag_lift(CA: float, CN: float, alpha: float) -> tuple[float, float]:
    """(CD, CL) of axial (aft) and normal (up) force coefficients at zero sideslip; `alpha` in rad."""
    c, s = np.cos(alpha), np.sin(alpha)
    return CA * c + CN * s, CN * c - CA * s


def drag_lift_to_axial_normal(CD: float, CL: float, alpha: float) -> tuple[float, float]:
    """(CA, CN) of drag and lift coefficients at zero sideslip; `alpha` in rad."""
    c, s = np.cos(alpha), np.sin(alpha)
    return CD * c - CL * s, CL * c + CD * s
