"""Leeward panels: the free stream expanded through the angle by which the panel turns away, at most to vacuum."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from spaceplane.aero.exact.prandtl_meyer import expanded_cp
from spaceplane.aero.inclination.laws.tables import even_table

KNOTS = 4096
"""Steps of the table over a right angle; between them Cp is linear, good to 1e-6."""


@lru_cache(maxsize=64)
def prandtl_meyer(mach: float, gamma: float) -> Callable[[np.ndarray], np.ndarray]:
    """The law at one Mach number: [panel] turning, rad, 0 to pi/2 -> [panel] Cp."""
    most = 0.5 * math.pi
    return even_table(expanded_cp(mach, np.linspace(0.0, most, KNOTS + 1), gamma), most)
