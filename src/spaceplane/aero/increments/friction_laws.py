"""Skin friction of a compressible boundary layer on a flat plate by the reference-temperature method.

The incompressible law holds with density and viscosity taken at a reference temperature within the layer (Eckert 1955).
Reference temperatures and the turbulent law are those of Meador and Smart, "Reference enthalpy method developed from
solutions of the boundary-layer equations", AIAA Journal 43 (2005) 135-139; the laminar law is that of Blasius.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spaceplane.environment.atmosphere import sutherland_viscosity
from spaceplane.environment.constants import GAS_CONSTANT_AIR, PRANDTL_NUMBER_AIR, STEFAN_BOLTZMANN


@dataclass(frozen=True)
class FrictionLaw:
    """c_f* = constant / Re*^exponent at T*/T_e = edge + wall T_w/T_e + recovered r (gamma - 1)/2 M_e^2.

    Attributes:
        constant, exponent: of the incompressible law of the local friction coefficient.
        recovery: recovery factor r.
        edge, wall, recovered: weights in the reference temperature.
    """

    constant: float
    exponent: float
    recovery: float
    edge: float
    wall: float
    recovered: float


LAMINAR = FrictionLaw(0.664, 0.5, PRANDTL_NUMBER_AIR**0.5, 0.45, 0.55, 0.16)
TURBULENT = FrictionLaw(0.02296, 0.139, PRANDTL_NUMBER_AIR ** (1.0 / 3.0), 0.5, 0.5, 0.16)
BISECTIONS = 40
LAWS = {"laminar": LAMINAR, "turbulent": TURBULENT}


def local_friction(
    law: FrictionLaw,
    reynolds: np.ndarray,
    mach: np.ndarray,
    temperature: np.ndarray,
    wall_temperature: float | np.ndarray | None,
    gamma: float = 1.4,
) -> np.ndarray:
    """Local friction coefficient tau / (rho_e u_e^2 / 2); arrays of one shape, and so is the answer.

    Args:
        law: LAMINAR or TURBULENT.
        reynolds: Reynolds number on edge conditions and running length; 0 gives no friction.
        mach: edge Mach number.
        temperature: edge temperature, K.
        wall_temperature: K; None for an adiabatic wall.
        gamma: ratio of specific heats.
    """
    rise = 0.5 * (gamma - 1.0) * law.recovery * mach**2
    wall = 1.0 + rise if wall_temperature is None else wall_temperature / temperature
    reference = law.edge + law.wall * wall + law.recovered * rise
    thinned = sutherland_viscosity(temperature) / sutherland_viscosity(reference * temperature) / reference
    star = np.asarray(reynolds * thinned, dtype=float)
    known = star > 0.0
    return np.where(known, law.constant / np.where(known, star, 1.0) ** law.exponent, 0.0) / reference


def radiative_temperature(
    law: FrictionLaw,
    reynolds: np.ndarray,
    mach: np.ndarray,
    temperature: np.ndarray,
    mass_flux: np.ndarray,
    emissivity: float,
    gamma: float = 1.4,
) -> np.ndarray:
    """Temperature, K, of a wall that radiates what the boundary layer brings, in arrays of one shape.

    The heat is St rho_e u_e c_p (T_aw - T_w) with St = c_f / (2 Pr^(2/3)) (Reynolds' analogy after Colburn; Eckert
    1955). It falls and radiation rises with T_w, so that the balance has one solution, found by bisection.

    Args:
        law, reynolds, mach, temperature, gamma: as for `local_friction`.
        mass_flux: rho_e u_e, kg/(m2 s).
        emissivity: of the wall, a ratio above 0 and at most 1.
    """
    recovered = temperature * (1.0 + 0.5 * (gamma - 1.0) * law.recovery * mach**2)
    conductance = mass_flux * gamma / (gamma - 1.0) * GAS_CONSTANT_AIR / (2.0 * PRANDTL_NUMBER_AIR ** (2.0 / 3.0))
    low, high = np.full_like(recovered, 1.0), recovered
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        heat = local_friction(law, reynolds, mach, temperature, middle, gamma) * conductance * (recovered - middle)
        cooler = emissivity * STEFAN_BOLTZMANN * middle**4 > heat
        low, high = np.where(cooler, low, middle), np.where(cooler, middle, high)
    return 0.5 * (low + high)
