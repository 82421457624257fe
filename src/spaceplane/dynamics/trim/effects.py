"""What each control surface can do at one flight condition.

The coefficients of `AeroModel` are a sum of the clean vehicle's and of one function of deflection for each surface,
linear between the nodes of its table. Sampled at these nodes, they are known exactly everywhere between.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.aero.model.model import AeroModel
from spaceplane.errors import InputError, unknown_name

Limits = Mapping[str, tuple[float, float]]
"""Control surface -> least and greatest deflection, rad."""


@dataclass(frozen=True)
class SurfaceEffect:
    """Increments of one surface at one flight condition.

    Attributes:
        deflection: [node] rad; the first and last are the limits.
        increments: [node, coefficient] in the order of FORCES_AND_MOMENTS; NaN where the tables are empty.
    """

    deflection: np.ndarray
    increments: np.ndarray

    def at(self, deflection: float) -> np.ndarray:
        """[coefficient] increments at a deflection, rad, within the limits."""
        return np.array([np.interp(deflection, self.deflection, column) for column in self.increments.T])


@dataclass(frozen=True)
class Effects:
    """The clean vehicle and its surfaces at one flight condition.

    Attributes:
        clean: [coefficient] in the order of FORCES_AND_MOMENTS, with sideslip and rates, without deflections.
        surfaces: by control surface.
    """

    clean: np.ndarray
    surfaces: Mapping[str, SurfaceEffect]

    def total(self, deflections: Mapping[str, float]) -> dict[str, float]:
        """The six coefficients at deflections, rad."""
        values = self.clean + sum((self.surfaces[name].at(d) for name, d in deflections.items()), np.zeros(6))
        return dict(zip(FORCES_AND_MOMENTS, values.tolist(), strict=True))


def effects(
    model: AeroModel,
    mach: float,
    alpha: float,
    beta: float = 0.0,
    rates: tuple[float, float, float] = (0.0, 0.0, 0.0),
    limits: Limits | None = None,
) -> Effects:
    """Sample a model at one flight condition.

    Args:
        model: aerodynamics.
        mach: Mach number.
        alpha, beta: rad.
        rates: reduced, p b/2V, q c/2V, r b/2V.
        limits: of surfaces that may not use the whole of their tables, rad.

    Raises:
        OutsideTables: the condition is not in the tables.
        InputError: limits of an unknown surface, reversed, or beyond the tables.
    """
    allowed = check_limits(model, limits)
    clean = np.array([model.coefficients(mach, alpha, beta, rates)[name] for name in FORCES_AND_MOMENTS])
    found = {}
    for name, surface in model.surfaces.items():
        lower, upper = allowed[name]
        axis = surface.deflection
        nodes = np.unique([lower, *axis[(axis > lower) & (axis < upper)], upper])
        increments = np.zeros((len(nodes), len(FORCES_AND_MOMENTS)))
        for coefficient, values in model.increments(name, mach, alpha).items():
            increments[:, FORCES_AND_MOMENTS.index(coefficient)] = np.interp(nodes, axis, values)
        found[name] = SurfaceEffect(nodes, increments)
    return Effects(clean, found)


def check_limits(model: AeroModel, limits: Limits | None) -> dict[str, tuple[float, float]]:
    """Limits of every surface of a model, rad, those of its tables where none are given.

    Raises:
        InputError: naming the surface and its limits.
    """
    allowed = {name: surface.limits for name, surface in model.surfaces.items()}
    for name, (lower, upper) in (limits or {}).items():
        if name not in allowed:
            raise InputError(unknown_name("control surface of the model", name, allowed))
        least, greatest = allowed[name]
        if not least - 1e-9 <= lower <= upper <= greatest + 1e-9:
            given, table = (f"{math.degrees(a):g} to {math.degrees(b):g}" for a, b in ((lower, upper), allowed[name]))
            raise InputError(f"limits of {name}: {given} deg, must lie in order within {table} deg")
        allowed[name] = (max(lower, least), min(upper, greatest))
    return allowed
