"""The shape parameters of the vehicle: one record each of name, unit, default, limits, meaning and source."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from numbers import Real

from spaceplane.errors import InputError, unknown_name

TABLE_5_1 = "thesis, Table 5.1"
OPEN = "not given in the thesis; chosen here"


@dataclass(frozen=True)
class ParameterInfo:
    """What is known about one shape parameter; drives validation, the command line and the documentation.

    Attributes:
        name: keyword in `ShapeParameters`, the unit being its last word.
        unit: m, deg or 1.
        default: value for HORUS-2B.
        lower: smallest value allowed.
        upper: largest value allowed.
        description: what the parameter measures.
        source: where default and limits come from.
    """

    name: str
    unit: str
    default: float
    lower: float
    upper: float
    description: str
    source: str


def _parameter(default: float, lower: float, upper: float, description: str, source: str = TABLE_5_1) -> float:
    """A dataclass field that carries its own limits and meaning."""
    metadata = {"lower": lower, "upper": upper, "description": description, "source": source}
    return field(default=default, metadata=metadata)  # type: ignore[return-value]


@dataclass(frozen=True)
class ShapeParameters:
    """Everything that decides the vehicle's shape; lengths in m, angles in degrees (unit in the name).

    The first 19 are those of thesis Table 5.1 with its limits (open upper limits taken as the printed number). The
    others are what the thesis leaves open. Construct through `ShapeParameters.create` to have values checked, or
    call `validate`.
    """

    fuselage_width_m: float = _parameter(2.5, 2.0, 4.5, "half-width at the top of the side wall")
    fuselage_height_m: float = _parameter(1.57, 1.0, 3.0, "height of the straight part of the side wall")
    nosecone_height_m: float = _parameter(1.5, 1.0, 2.0, "height of the nose tip's axis above the keel")
    fuselage_length_m: float = _parameter(10.0, 5.0, 15.0, "length of the constant section; the wing moves with it")
    fuselage_bottom_curvature_width_m: float = _parameter(
        5.5, 4.5, 6.6, "w of the underside z = h (y/w)^2, whose chord outboard of the chine is the wing's lower skin"
    )
    fuselage_bottom_curvature_height_m: float = _parameter(
        1.5, 1.0, 2.0, "h of the underside z = h (y/w)^2; more height, more dihedral"
    )
    wing_width_m: float = _parameter(3.1, 2.8, 3.9, "from the chine to the corner of wing and winglet, along y")
    wing_corner_width_m: float = _parameter(1.5, 1.2, 2.5, "leading-edge kink outboard of the chine, along y")
    wing_corner_length_m: float = _parameter(4.8, 4.6, 5.5, "leading-edge kink ahead of the base, along x")
    wing_thickness_m: float = _parameter(0.2, 0.18, 0.3, "thickness of the wing at its corner with the winglet")
    winglet_bottom_length_m: float = _parameter(4.5, 4.0, 4.7, "chord at the corner of wing and winglet")
    winglet_top_length_m: float = _parameter(2.5, 2.2, 3.5, "chord at the winglet's tip; the trailing edge stays")
    winglet_length_m: float = _parameter(3.2, 2.5, 4.5, "from the corner to the winglet's tip, in the winglet's plane")
    winglet_angle_deg: float = _parameter(12.0, 5.0, 25.0, "cant of the winglet, outwards from vertical")
    winglet_angle_back_deg: float = _parameter(20.0, 10.0, 30.0, "sweep of the winglet's trailing edge, backwards")
    elevon_length_m: float = _parameter(1.4, 1.3, 2.0, "chord of the elevon normal to its hinge")
    rudder_length_m: float = _parameter(1.2, 1.1, 1.4, "chord of the rudder normal to its hinge")
    rudder_height_bottom_m: float = _parameter(0.8, 0.6, 1.2, "from the corner to the rudder's lower edge")
    body_flap_length_m: float = _parameter(2.0, 1.8, 2.5, "from the base to the body flap's trailing edge")

    nose_radius_m: float = _parameter(
        0.8, 0.4, 0.95, "radius of the spherical nose", "0.8 m reported for HORUS-2B (MBB 1988); limits chosen here"
    )
    nosecone_length_m: float = _parameter(
        13.0, 10.0, 16.0, "from the nose to the constant section", "25 m over all less fuselage and body flap"
    )
    fuselage_flare_m: float = _parameter(
        0.2, 0.1, 0.35, "by how much the chine is wider than the top of the side wall", "5.4 m width of HORUS-2B"
    )
    fuselage_crown_ratio: float = _parameter(
        1.03, 0.95, 1.1, "height of the arched top over the half-width fuselage_width_m", "4.5 m height of HORUS-2B"
    )
    strake_length_m: float = _parameter(
        11.7, 9.0, 13.0, "strake apex ahead of the base (trimmed to the nosecone)", OPEN
    )
    leading_edge_radius_m: float = _parameter(
        0.25, 0.1, 0.4, "leading-edge radius at the root; outboard at most half the thickness", OPEN
    )
    wing_root_thickness_m: float = _parameter(0.6, 0.4, 0.8, "thickness of the wing at the chine", OPEN)
    trailing_edge_sweep_deg: float = _parameter(
        15.0, 5.0, 20.0, "sweep of the wing's trailing edge seen from above", OPEN
    )
    trailing_edge_thickness_m: float = _parameter(0.03, 0.02, 0.06, "thickness of all trailing edges", OPEN)
    winglet_bend_radius_m: float = _parameter(
        1.2, 0.5, 1.5, "radius of the bend between wing and winglet (trimmed to end below the rudder)", OPEN
    )
    body_flap_width_m: float = _parameter(3.4, 2.4, 3.6, "full width of the body flap", OPEN)

    @classmethod
    def create(cls, values: Mapping[str, object] | None = None, allow_outside_limits: bool = False) -> ShapeParameters:
        """Checked parameters from a mapping of names to values; what is not named keeps its default.

        Raises:
            InputError: unknown name (with the nearest valid one), not a number, or out of limits.
        """
        return cls().replace(values or {}, allow_outside_limits)

    def replace(self, values: Mapping[str, object], allow_outside_limits: bool = False) -> ShapeParameters:
        """A checked copy with some values changed; errors as `create`."""
        merged = asdict(self)
        for name, value in values.items():
            merged[parameter_info(name).name] = finite_number(name, value)
        changed = ShapeParameters(**merged)
        changed.validate(allow_outside_limits)
        return changed

    def validate(self, allow_outside_limits: bool = False) -> None:
        """Check that every value is a number, positive, and within its limits unless these are waived.

        Raises:
            InputError: naming the parameter, its value and the limits.
        """
        for info in PARAMETERS:
            value = finite_number(info.name, getattr(self, info.name))
            if value <= 0.0:
                raise InputError(f"{info.name} = {value:g} {info.unit}: must be positive")
            if not allow_outside_limits and not info.lower <= value <= info.upper:
                raise InputError(
                    f"{info.name} = {value:g} {info.unit}: allowed {info.lower:g} to {info.upper:g} {info.unit} "
                    "(--allow-outside-limits to go on)"
                )

    def outside_limits(self) -> tuple[str, ...]:
        """Names of the parameters that lie outside their limits."""
        return tuple(i.name for i in PARAMETERS if not i.lower <= getattr(self, i.name) <= i.upper)

    def as_dict(self) -> dict[str, float]:
        """Parameter values by name, each in the unit (m, deg or 1) that its name ends in."""
        return asdict(self)


def _unit(name: str) -> str:
    return {"m": "m", "deg": "deg"}.get(name.rsplit("_", 1)[-1], "1")


PARAMETERS: tuple[ParameterInfo, ...] = tuple(
    ParameterInfo(f.name, _unit(f.name), f.default, **f.metadata)  # type: ignore[arg-type]
    for f in fields(ShapeParameters)
)
"""All shape parameters in order: the 19 of thesis Table 5.1, then those it leaves open."""

THESIS_PARAMETERS: tuple[str, ...] = tuple(p.name for p in PARAMETERS if p.source == TABLE_5_1)
"""Names of the 19 parameters of thesis Table 5.1, in its order."""

_BY_NAME = {p.name: p for p in PARAMETERS}


def parameter_info(name: str) -> ParameterInfo:
    """The record of a parameter.

    Raises:
        InputError: unknown name, with the nearest valid one.
    """
    if name in _BY_NAME:
        return _BY_NAME[name]
    raise InputError(unknown_name("shape parameter", name, tuple(_BY_NAME)))


def finite_number(name: str, value: object) -> float:
    """The value as a float.

    Raises:
        InputError: not a number, or not finite.
    """
    if isinstance(value, bool) or not isinstance(value, Real):
        try:
            value = float(value) if isinstance(value, str) else math.nan
        except ValueError as err:
            raise InputError(f"{name} = '{value}': must be a number") from err
    number = float(value)
    if not math.isfinite(number):
        raise InputError(f"{name} = {value}: must be a finite number")
    return number
