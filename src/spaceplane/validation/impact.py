"""Modified Newtonian impact theory on a surface: a check of the shape that owes nothing to mesh and flow solver."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spaceplane.aero.exact.stagnation import stagnation_cp
from spaceplane.flow.freestream import direction
from spaceplane.vehicle.properties import ReferenceLengths
from spaceplane.vehicle.surface import Surface


@dataclass(frozen=True)
class ImpactForces:
    """Coefficients at zero sideslip: CL and CD in wind axes, CN and CA in geometry axes, Cm nose up."""

    CL: float
    CD: float
    CN: float
    CA: float
    Cm: float


def newtonian(surface: Surface, mach: float, alpha: float, reference: ReferenceLengths) -> ImpactForces:
    """Cp = Cp_stagnation sin^2 of the angle between stream and surface where the stream strikes, zero elsewhere.

    No triangle shades another. Source: Lees, "Hypersonic flow", 5th International Aeronautical Conference (1955).

    Args:
        surface: closed surface.
        mach: free-stream Mach number, for the stagnation pressure behind the bow shock.
        alpha: angle of attack, rad.
        reference: reference lengths and moment centre, SI.
    """
    vectors = surface.area_vectors
    size = np.linalg.norm(vectors, axis=1)
    sine = np.divide(-(vectors @ direction(alpha, 0.0)), size, out=np.zeros_like(size), where=size > 0.0)
    force = -(stagnation_cp(mach) * np.maximum(sine, 0.0) ** 2)[:, None] * vectors / reference.area
    moment = np.cross(surface.centroids - np.asarray(reference.moment_center), force).sum(axis=0) / reference.chord
    axial, normal = float(force[:, 0].sum()), float(force[:, 2].sum())
    return ImpactForces(
        CL=normal * math.cos(alpha) - axial * math.sin(alpha),
        CD=axial * math.cos(alpha) + normal * math.sin(alpha),
        CN=normal,
        CA=axial,
        Cm=float(moment[1]),
    )
