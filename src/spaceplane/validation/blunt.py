"""Published values for the sphere."""

from __future__ import annotations

import math

from spaceplane.errors import InputError

DRAG_LOTH = {0.5: 0.484, 0.8: 0.642, 1.0: 0.858, 1.5: 0.996, 2.0: 0.991, 3.0: 0.954, 5.0: 0.904, 10.0: 0.901}
"""Mach -> C_D of a sphere at Reynolds number 1e6, continuum. Loth, Daspit, Jeong, Nagata and Nonomura,
"Supersonic and hypersonic drag coefficients for a sphere", AIAA J. 59 (2021), doi 10.2514/1.J060153."""


def standoff_billig(mach: float) -> float:
    """Shock stand-off distance over the radius of a sphere, gamma 1.4.

    Source: Billig, "Shock-wave shapes around spherical- and cylindrical-nosed bodies", J. Spacecraft 4 (1967).

    Raises:
        InputError: a Mach number of 1 or below.
    """
    if not mach > 1.0:
        raise InputError(f"mach = {mach}: a bow shock needs a Mach number above 1")
    return 0.143 * math.exp(3.24 / mach**2)


def standoff_seiff(mach: float, gamma: float = 1.4) -> float:
    """Shock stand-off distance over the radius of a sphere: 0.78 of the density ratio across the normal shock.

    Source: Seiff, "Recent information on hypersonic flow fields", NASA SP-24 (1962).

    Raises:
        InputError: a Mach number of 1 or below.
    """
    if not mach > 1.0:
        raise InputError(f"mach = {mach}: a bow shock needs a Mach number above 1")
    return 0.78 * (2.0 + (gamma - 1.0) * mach**2) / ((gamma + 1.0) * mach**2)
