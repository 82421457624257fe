"""Mass properties and reference lengths, and how the moment centre follows the shape."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np

from spaceplane.errors import InputError
from spaceplane.vehicle.layout import KEEL_DEPTH
from spaceplane.vehicle.shape import ShapeParameters, finite_number

HORUS_LENGTH = 25.0  # m, over all
HORUS_HEIGHT = 4.5  # m, keel to crown
MOMENT_CENTER_STATION = 13.0  # m behind the nose; reported once for HORUS-2B, with low confidence
MOMENT_CENTER_HEIGHT = 0.0  # m above the reference axis


@dataclass(frozen=True)
class MassProperties:
    """Mass, moments of inertia and the one product of inertia that a mirror-symmetric vehicle has.

    Attributes:
        mass: kg.
        Ixx, Iyy, Izz: kg m2 about the body axes x forward, y right, z down, through the centre of mass.
        Ixz: kg m2, the integral of x z dm: positive with mass low in front and high behind. The tensor has -Ixz.

    Raises:
        InputError: a value is not a positive number (Ixz: not finite), or the inertias are those of no rigid body.
    """

    mass: float
    Ixx: float
    Iyy: float
    Izz: float
    Ixz: float = 0.0

    def __post_init__(self) -> None:
        _require_positive(self, skip=("Ixz",))
        object.__setattr__(self, "Ixz", finite_number("Ixz", self.Ixz))
        a, b, c = sorted((self.Ixx, self.Iyy, self.Izz))
        if a + b < c:
            raise InputError(
                f"Ixx, Iyy, Izz = {self.Ixx:g}, {self.Iyy:g}, {self.Izz:g} kg m2: the largest exceeds the sum"
            )
        # Principal moments in the x-z plane differ by sqrt((Ixx - Izz)^2 + 4 Ixz^2), by Iyy at most; then none is
        # negative, since they add to Ixx + Izz, which is no less than Iyy.
        most = 0.5 * math.sqrt(max(self.Iyy**2 - (self.Ixx - self.Izz) ** 2, 0.0))
        if abs(self.Ixz) > most or self.Ixz**2 >= self.Ixx * self.Izz:
            raise InputError(f"Ixz = {self.Ixz:g} kg m2: allowed with these moments are {-most:g} to {most:g} kg m2")


@dataclass(frozen=True)
class ReferenceLengths:
    """What coefficients are made with.

    Attributes:
        area: m2.
        chord: m, for pitching moments.
        span: m, for rolling and yawing moments.
        moment_center: (x, y, z) m in geometry axes: x aft of the nose, y right, z above the reference axis.

    Raises:
        InputError: a length or the area is not a positive number, or the moment centre is not three numbers.
    """

    area: float
    chord: float
    span: float
    moment_center: tuple[float, float, float]

    def __post_init__(self) -> None:
        _require_positive(self, skip=("moment_center",))
        center = np.asarray(self.moment_center, dtype=float)
        if center.shape != (3,) or not np.isfinite(center).all():
            raise InputError(f"moment_center = {self.moment_center}: must be three finite numbers, m")
        object.__setattr__(self, "moment_center", tuple(float(x) for x in center))


def _require_positive(record: object, skip: tuple[str, ...] = ()) -> None:
    for f in fields(record):  # type: ignore[arg-type]
        if f.name not in skip:
            value = finite_number(f.name, getattr(record, f.name))
            if value <= 0:
                raise InputError(f"{f.name} = {value:g}: must be positive")
            object.__setattr__(record, f.name, value)


HORUS_MASS = MassProperties(mass=26_000.0, Ixx=119_000.0, Iyy=769_000.0, Izz=806_000.0)
"""HORUS-2B at re-entry, inertias of the landing configuration (thesis section 2.4)."""

HORUS_REFERENCE = ReferenceLengths(110.0, 23.0, 13.0, (MOMENT_CENTER_STATION, 0.0, MOMENT_CENTER_HEIGHT))
"""HORUS-2B (thesis section 2.4; chord and span of the published tables)."""


def scaled_moment_center(
    shape: ShapeParameters, station: float = MOMENT_CENTER_STATION, height: float = MOMENT_CENTER_HEIGHT
) -> tuple[float, float, float]:
    """Moment centre of a changed shape.

    The thesis moves the centre by a share of the change of fuselage length, likewise in z, and does not print the
    share (section 7.1). Here the centre keeps its place in proportion: x moves by station / 25 m of the change of
    `fuselage_length_m`, z by (height above the keel) / 4.5 m of the change of `fuselage_height_m`. No other
    parameter moves it.

    Args:
        shape: the changed shape.
        station: m behind the nose, at the default shape.
        height: m above the reference axis, at the default shape.

    Returns:
        x, y, z in geometry axes, m.
    """
    default = ShapeParameters()
    longer = shape.fuselage_length_m - default.fuselage_length_m
    higher = shape.fuselage_height_m - default.fuselage_height_m
    share = (height + KEEL_DEPTH) / HORUS_HEIGHT
    return station + longer * station / HORUS_LENGTH, 0.0, height + higher * share


def scaled_reference(
    shape: ShapeParameters,
    base: ReferenceLengths = HORUS_REFERENCE,
    station: float = MOMENT_CENTER_STATION,
    height: float = MOMENT_CENTER_HEIGHT,
) -> ReferenceLengths:
    """Reference lengths of a changed shape: area, chord and span stay, the moment centre (m) moves.

    Args:
        shape: the changed shape.
        base: area m2, chord m and span m of the default shape.
        station, height: moment centre of the default shape, m, see `scaled_moment_center`.
    """
    return replace(base, moment_center=scaled_moment_center(shape, station, height))
