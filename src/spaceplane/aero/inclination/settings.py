"""Which pressure law acts where."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from spaceplane.aero.inclination.laws import LEEWARD, WINDWARD
from spaceplane.errors import InputError, unknown_name

LEAST_MACH = 2.0
"""Below, shocks detach from wedges of 23 deg and a panel's pressure is no longer a matter of its own inclination."""


@dataclass(frozen=True)
class InclinationSettings:
    """How pressures follow from inclinations.

    Attributes:
        windward: law in `laws.WINDWARD` of panels that the stream strikes, where neither of the next two says more.
        by_part: name of a part to its law; `wing` stands for `wing_left` and `wing_right`.
        blunt: law of blunt panels (noses, leading edges) of any part; None treats them as the rest of their part.
        blunt_radius: radius of curvature, as a fraction of the body's length, below which a convex panel is blunt.
        leeward: law in `laws.LEEWARD` of panels that look away from the stream. A hidden panel takes its value at its
            own turning, 0 where it faces the stream.
        shadow: whether parts of the body hide others from the stream.
        panel: longest edge of a panel, as a fraction of the body's size; the resolution of shadows.

    Raises:
        InputError: an unknown law, or a fraction that is not allowed.
    """

    windward: str = "newtonian"
    by_part: Mapping[str, str] = field(default_factory=dict)
    blunt: str | None = None
    blunt_radius: float = 0.03
    leeward: str = "prandtl_meyer"
    shadow: bool = True
    panel: float = 0.02

    def __post_init__(self) -> None:
        for name in (self.windward, *self.by_part.values(), *([] if self.blunt is None else [self.blunt])):
            if name not in WINDWARD:
                raise InputError(unknown_name("windward law", name, WINDWARD))
        if self.leeward not in LEEWARD:
            raise InputError(unknown_name("leeward law", self.leeward, LEEWARD))
        for name, lower in (("blunt_radius", 0.0), ("panel", 1e-4)):
            value = getattr(self, name)
            if not (math.isfinite(value) and lower <= value <= 1.0):
                raise InputError(f"{name} = {value}: allowed {lower:g} to 1, a fraction of the body's size")
        object.__setattr__(self, "by_part", MappingProxyType(dict(self.by_part)))

    def law_of(self, part: str) -> str:
        """The windward law of a part's panels that are not blunt."""
        return self.by_part.get(part) or self.by_part.get(
            part.removesuffix("_left").removesuffix("_right"), self.windward
        )


_PLATES = ("wing", "winglet", "elevon", "rudder", "body_flap")

METHODS: dict[str, InclinationSettings] = {
    "newtonian-expansion": InclinationSettings(),
    "newtonian": InclinationSettings(leeward="free_stream"),
    "tangent": InclinationSettings(
        windward="tangent_cone", by_part=dict.fromkeys(_PLATES, "tangent_wedge"), blunt="newtonian"
    ),
    "tangent-cone": InclinationSettings(windward="tangent_cone"),
    "tangent-wedge": InclinationSettings(windward="tangent_wedge"),
}
"""Settings by the name that the command line takes; the first are the default ones.

They are Newtonian everywhere because that is nearest to the Euler solver on a blunt body of low aspect ratio from Mach
3 to 20 and 10 to 40 deg (docs/fast-tier.md): air spills round the edges of the underside, which relieves it of what a
wedge or a cone of its inclination would hold. The tangent methods are for slender bodies with attached shocks.
"""


def method(name: str) -> InclinationSettings:
    """The settings of a method.

    Raises:
        InputError: an unknown name.
    """
    if name not in METHODS:
        raise InputError(unknown_name("method", name, METHODS))
    return METHODS[name]


def require_mach(machs: Iterable[float]) -> None:
    """Refuse Mach numbers at which the pressure of a panel does not follow from its inclination.

    Raises:
        InputError: naming the Mach number.
    """
    for mach in machs:
        if not (math.isfinite(mach) and mach >= LEAST_MACH):
            raise InputError(f"mach = {mach:g}: local inclination needs Mach {LEAST_MACH:g} or more")
