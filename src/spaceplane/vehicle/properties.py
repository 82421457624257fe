"""Mass properties and reference lengths of a vehicle, SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass

from spaceplane.errors import InputError


@dataclass(frozen=True)
class MassProperties:
    """Mass, kg, and principal moments of inertia about body x, y, z, kg m2; products of inertia are taken as zero."""

    mass: float
    Ixx: float
    Iyy: float
    Izz: float

    def __post_init__(self) -> None:
        _require_positive(self, ("mass", "Ixx", "Iyy", "Izz"))


@dataclass(frozen=True)
class ReferenceLengths:
    """What coefficients are made dimensionless with.

    Attributes:
        area: m2.
        chord: m, for the pitching moment.
        span: m, for the rolling and yawing moments.
        moment_center: (x, y, z) in geometry axes (x aft, y right, z up), m.
    """

    area: float
    chord: float
    span: float
    moment_center: tuple[float, float, float]

    def __post_init__(self) -> None:
        _require_positive(self, ("area", "chord", "span"))
        if len(self.moment_center) != 3 or not all(math.isfinite(v) for v in self.moment_center):
            raise InputError(f"moment_center = {self.moment_center}: must be three finite numbers, m")


def _require_positive(record: object, names: tuple[str, ...]) -> None:
    for name in names:
        value = getattr(record, name)
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"{name} = {value}: must be a finite number above 0")
