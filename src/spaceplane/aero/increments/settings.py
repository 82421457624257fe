"""Which viscous increments are added to the inviscid coefficients, and with what they are computed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spaceplane.environment.atmosphere import Ambient
from spaceplane.errors import InputError
from spaceplane.flow.solution import PERFECT

FRICTION = ("off", "laminar", "turbulent")
BASE = ("inviscid", "correlation")


@dataclass(frozen=True)
class IncrementSettings:
    """Viscous increments; off unless asked for. What a vehicle is analysed with is `VISCOUS`.

    Attributes:
        friction: "off", "laminar" or "turbulent" skin friction, see `skin_friction`.
        base: "inviscid" keeps the computed pressure of blunt bases, "correlation" replaces it, see `base_pressure`.
        wall_temperature_K: temperature of the wall for the friction, K; None takes an adiabatic wall, or `emissivity`.
        emissivity: of a wall that radiates away the heat that the boundary layer brings and has the temperature of this
            balance; None takes an adiabatic wall, or `wall_temperature_K`.
        transition_reynolds: with turbulent friction, Reynolds number on edge conditions and running length below
            which the boundary layer is laminar; None makes it turbulent from the start.
    """

    friction: str = "off"
    base: str = "inviscid"
    wall_temperature_K: float | None = None
    emissivity: float | None = None
    transition_reynolds: float | None = None

    def __post_init__(self) -> None:
        for name, value, allowed in (("friction", self.friction, FRICTION), ("base", self.base, BASE)):
            if value not in allowed:
                raise InputError(f"{name} = {value!r}: allowed are {', '.join(allowed)}")
        for name in ("wall_temperature_K", "transition_reynolds"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0.0):
                raise InputError(f"{name} = {value}: a positive number is needed")
        if self.emissivity is not None and not 0.0 < self.emissivity <= 1.0:
            raise InputError(f"emissivity = {self.emissivity}: above 0 and at most 1")
        for name in ("wall_temperature_K", "emissivity"):
            if getattr(self, name) is not None and self.friction == "off":
                raise InputError(f"{name} = {getattr(self, name):g}: needs friction laminar or turbulent")
        if self.wall_temperature_K is not None and self.emissivity is not None:
            raise InputError(f"emissivity = {self.emissivity:g}: give it or wall_temperature_K, not both")
        if self.transition_reynolds is not None and self.friction != "turbulent":
            raise InputError(f"transition_reynolds = {self.transition_reynolds:g}: needs friction turbulent")

    @property
    def sources(self) -> tuple[str, ...]:
        """Names of the increments that are on: "friction", "base", both or none."""
        return ("friction",) * (self.friction != "off") + ("base",) * (self.base != "inviscid")


VISCOUS = IncrementSettings(friction="turbulent", base="correlation")
"""What agrees best with the published drag of HORUS-2B, HB-2 and the sphere (docs, method)."""


def require_no_friction(gas: str, increments: IncrementSettings | None) -> None:
    """Refuse skin friction in a gas that is not perfect: its boundary layers are those of a perfect gas.

    Raises:
        InputError: friction is on.
    """
    if gas != PERFECT and increments is not None and increments.friction != "off":
        raise InputError(f"friction = {increments.friction!r}: not allowed with gas {gas}; off")


@dataclass(frozen=True)
class Air:
    """What turns the solver's scaled air into one of a certain temperature and viscosity.

    Attributes:
        temperature: [condition] static temperature of the free stream, K.
        sonic_reynolds: [condition] rho_inf a_inf / mu_inf, 1/m: the Reynolds number per metre and Mach number.
    """

    temperature: np.ndarray
    sonic_reynolds: np.ndarray

    @classmethod
    def of(cls, ambients: Sequence[Ambient]) -> Air:
        """The air of each condition from its atmosphere."""
        return cls(
            np.array([a.temperature for a in ambients], dtype=float),
            np.array([a.density * a.speed_of_sound / a.viscosity for a in ambients], dtype=float),
        )

    @classmethod
    def at_reynolds(cls, reynolds: ArrayLike, mach: ArrayLike, temperature: ArrayLike) -> Air:
        """Air of given unit Reynolds numbers rho_inf V_inf / mu_inf, 1/m, at Mach numbers and static temperatures, K.

        Raises:
            InputError: a value that is not finite and positive.
        """
        rows = np.broadcast_arrays(*(np.atleast_1d(np.asarray(v, dtype=float)) for v in (reynolds, mach, temperature)))
        for name, row in zip(("reynolds", "mach", "temperature_K"), rows, strict=True):
            bad = row[~(np.isfinite(row) & (row > 0.0))]
            if len(bad):
                raise InputError(f"{name} = {bad[0]}: a positive number is needed")
        return cls(rows[2].copy(), rows[0] / rows[1])
