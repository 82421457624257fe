"""Axes in which coefficients are given, as seen from the geometry axes (x aft, y right, z up)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spaceplane.flow import freestream

FORCES_AND_MOMENTS = ("CL", "CD", "CY", "Cl", "Cm", "Cn")
"""The six coefficients: lift, drag and side force in wind axes, rolling, pitching and yawing moment in body axes."""


@dataclass(frozen=True)
class WindAxes:
    """Unit vectors of the wind axes, each [condition, xyz] in geometry axes.

    Attributes:
        drag: along the free stream, positive downstream.
        side: positive to the right.
        lift: in the plane of symmetry, normal to the free stream, positive up.
    """

    drag: np.ndarray
    side: np.ndarray
    lift: np.ndarray


def wind_axes(alpha: ArrayLike, beta: ArrayLike) -> WindAxes:
    """Wind axes at angle of attack `alpha` and sideslip `beta`, rad, each [condition] or scalar."""
    alpha, beta = np.broadcast_arrays(np.asarray(alpha, dtype=float), np.asarray(beta, dtype=float))
    side = np.stack([np.cos(alpha) * np.sin(beta), np.cos(beta), np.sin(alpha) * np.sin(beta)], axis=-1)
    lift = np.stack([-np.sin(alpha), np.zeros_like(alpha), np.cos(alpha)], axis=-1)
    return WindAxes(freestream.direction(alpha, beta), side, lift)


def geometry_to_body(vector: ArrayLike) -> np.ndarray:
    """Components in body axes (x forward, y right, z down) of vectors given in geometry axes; [..., xyz].

    A turn by 180 degrees about y: forces, moments and rates transform alike, and the transform is its own inverse.
    """
    return np.asarray(vector, dtype=float) * np.array([-1.0, 1.0, -1.0])
