"""Modified Newtonian theory: Cp = Cp_stagnation sin^2 of the inclination.

L. Lees, "Hypersonic flow", 5th International Aeronautical Conference (1955); the stagnation pressure behind the bow
shock by Rayleigh's pitot formula.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from spaceplane.aero.exact.stagnation import stagnation_cp


def newtonian(mach: float, gamma: float) -> Callable[[np.ndarray], np.ndarray]:
    """The law at one Mach number: [panel] inclination, rad -> [panel] Cp."""
    most = stagnation_cp(mach, gamma)
    return lambda inclination: most * np.sin(inclination) ** 2
