"""Tangent wedge: the exact weak oblique shock that turns the stream along the panel.

Past detachment see `tables.shock_law`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from spaceplane.aero.exact.oblique import detachment, weak_shock_cp
from spaceplane.aero.exact.stagnation import stagnation_cp
from spaceplane.aero.inclination.laws.tables import places, shock_law


@lru_cache(maxsize=64)
def tangent_wedge(mach: float, gamma: float) -> Callable[[np.ndarray], np.ndarray]:
    """The law at one Mach number: [panel] inclination, rad -> [panel] Cp."""
    most = detachment(mach, gamma).deflection
    return shock_law(weak_shock_cp(mach, most * (1.0 - places() ** 2), gamma), most, stagnation_cp(mach, gamma))
