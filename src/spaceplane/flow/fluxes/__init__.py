"""Numerical fluxes: one scheme to a file, chosen by name.

The kernels compute `blend` with a weight theta per face: "hllc" fixes theta at 0, "hlle" at 1 and "blend" takes it from
the shock sensor; so a choice of flux costs no compilation.
"""

from __future__ import annotations

from spaceplane.flow.fluxes.blend import blend
from spaceplane.flow.fluxes.hllc import hllc
from spaceplane.flow.fluxes.hlle import hlle
from spaceplane.flow.fluxes.lowmach import shrink_normal_jump

#: Name -> (lowest theta, highest theta) that the shock sensor may give.
FLUXES = {"hllc": (0.0, 0.0), "hlle": (1.0, 1.0), "blend": (0.0, 1.0)}

__all__ = ["FLUXES", "blend", "hllc", "hlle", "shrink_normal_jump"]
