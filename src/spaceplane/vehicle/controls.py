"""Deflections of the five control surfaces, their limits and positive senses."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass

from spaceplane.errors import InputError, unknown_name
from spaceplane.vehicle.shape import finite_number

CONTROL_LIMITS_DEG: dict[str, tuple[float, float]] = {
    "elevon_left": (-40.0, 40.0),
    "elevon_right": (-40.0, 40.0),
    "rudder_left": (0.0, 40.0),
    "rudder_right": (0.0, 40.0),
    "body_flap": (-20.0, 30.0),
}
"""Limits in degrees (thesis section 2.4, after the MBB study of 1988)."""

CONTROL_POSITIVE: dict[str, str] = {
    "elevon_left": "trailing edge down",
    "elevon_right": "trailing edge down",
    "rudder_left": "trailing edge outboard",
    "rudder_right": "trailing edge outboard",
    "body_flap": "trailing edge down",
}
"""Positive sense of each deflection."""

CONTROLS: tuple[str, ...] = tuple(CONTROL_LIMITS_DEG)


@dataclass(frozen=True)
class ControlDeflections:
    """Deflections of the five control surfaces, rad.

    Limits: `CONTROL_LIMITS_DEG`.

    Attributes:
        elevon_left, elevon_right, body_flap: positive with the trailing edge down.
        rudder_left, rudder_right: positive with the trailing edge outboard.

    Raises:
        InputError: a deflection is not a finite number.
    """

    elevon_left: float = 0.0
    elevon_right: float = 0.0
    rudder_left: float = 0.0
    rudder_right: float = 0.0
    body_flap: float = 0.0

    def __post_init__(self) -> None:
        for name in CONTROLS:
            object.__setattr__(self, name, finite_number(name, getattr(self, name)))

    @classmethod
    def from_degrees(
        cls, values: Mapping[str, object] | None = None, allow_outside_limits: bool = False, **named: object
    ) -> ControlDeflections:
        """Checked deflections from degrees, as a mapping, by keyword or both.

        Raises:
            InputError: unknown surface (with the nearest valid name), not a number, or out of limits.
        """
        radians = {}
        for name, value in {**(values or {}), **named}.items():
            if name not in CONTROL_LIMITS_DEG:
                raise InputError(unknown_name("control surface", name, CONTROLS))
            radians[name] = math.radians(finite_number(name, value))
        deflections = cls(**radians)
        deflections.validate(allow_outside_limits)
        return deflections

    def to_degrees(self) -> dict[str, float]:
        """Deflections in degrees by name of the surface."""
        return {name: math.degrees(value) for name, value in asdict(self).items()}

    def validate(self, allow_outside_limits: bool = False) -> None:
        """Check the limits.

        Raises:
            InputError: naming the surface, its deflection and the limits.
        """
        for name, value in self.to_degrees().items():
            lower, upper = (-75.0, 75.0) if allow_outside_limits else CONTROL_LIMITS_DEG[name]
            if not lower - 1e-9 <= value <= upper + 1e-9:
                raise InputError(
                    f"{name} = {value:g} deg: allowed {lower:g} to {upper:g} deg, positive {CONTROL_POSITIVE[name]}"
                )
