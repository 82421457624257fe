"""Pressure laws: one to a file, chosen by name; each made for a Mach number and gamma, then applied to many panels.

A windward law takes [panel] inclinations, rad: the angle from the stream to the panel, 0 along it and pi/2 square to
it. A leeward law takes [panel] turnings, rad: the angle by which the panel lies turned away from the stream, 0 or more.
Both give [panel] pressure coefficients.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from spaceplane.aero.inclination.laws.free_stream import free_stream
from spaceplane.aero.inclination.laws.newtonian import newtonian
from spaceplane.aero.inclination.laws.prandtl_meyer import prandtl_meyer
from spaceplane.aero.inclination.laws.tangent_cone import tangent_cone
from spaceplane.aero.inclination.laws.tangent_wedge import tangent_wedge

Law = Callable[[np.ndarray], np.ndarray]

WINDWARD: dict[str, Callable[[float, float], Law]] = {
    "newtonian": newtonian,
    "tangent_wedge": tangent_wedge,
    "tangent_cone": tangent_cone,
}
"""Name -> law for panels that the stream strikes, made with (Mach number, gamma)."""

LEEWARD: dict[str, Callable[[float, float], Law]] = {"prandtl_meyer": prandtl_meyer, "free_stream": free_stream}
"""Name -> law for panels that look away from the stream; hidden panels take its value for no turning."""

__all__ = ["LEEWARD", "WINDWARD", "Law"]
