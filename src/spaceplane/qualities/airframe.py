"""A vehicle at a flight point, as criteria on the airframe and its controls see it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from spaceplane.aero.model.derivatives import Derivatives
from spaceplane.dynamics.flightpoint import FlightPoint
from spaceplane.errors import InputError, unknown_name
from spaceplane.vehicle.controls import CONTROL_LIMITS_DEG, CONTROLS
from spaceplane.vehicle.properties import MassProperties, ReferenceLengths

SPEED_RANGES = ("VL", "L", "M", "H")


def default_limits() -> dict[str, tuple[float, float]]:
    """Limits of the control surfaces, rad, of `spaceplane.vehicle.controls`."""
    return {name: (math.radians(low), math.radians(high)) for name, (low, high) in CONTROL_LIMITS_DEG.items()}


@dataclass(frozen=True)
class Airframe:
    """A vehicle at a flight point, as these criteria see it.

    Attributes:
        point: flight point with CL and CD.
        mass: kg, kg m2.
        reference: m2, m.
        derivatives: per rad and per unit Mach number.
        pitching_moment: C_m at the flight point with the elevator at `elevator`; None if unknown.
        elevator: deflection of the elevator at the flight point, rad, trailing edge down positive.
        load_factors: least and greatest load factor of the operational flight envelope, g; None if unknown.
        speed_range: VL, L, M or H of the roll requirements of classes III and IV; class III counts VL as L.
        control_limits: least and greatest deflection of each surface, rad.
        rudder_per_aileron: deflection of the rudder that goes with one of the aileron, ratio, for the lateral control
            departure parameter; None for aileron alone.

    Raises:
        InputError: a value is out of range or a name unknown.
    """

    point: FlightPoint
    mass: MassProperties
    reference: ReferenceLengths
    derivatives: Derivatives
    pitching_moment: float | None = None
    elevator: float = 0.0
    load_factors: tuple[float, float] | None = None
    speed_range: str = "M"
    control_limits: Mapping[str, tuple[float, float]] = field(default_factory=default_limits)
    rudder_per_aileron: float | None = None

    def __post_init__(self) -> None:
        for name in ("pitching_moment", "elevator", "rudder_per_aileron"):
            value = getattr(self, name)
            if value is not None and not math.isfinite(value):
                raise InputError(f"{name} = {value}: must be a finite number")
        if self.load_factors is not None:
            low, high = self.load_factors
            if not (math.isfinite(low) and math.isfinite(high) and low < 1.0 < high):
                raise InputError(f"load_factors = {self.load_factors}: must be a least below 1 g and a greatest above")
        if self.speed_range not in SPEED_RANGES:
            raise InputError(unknown_name("speed_range", self.speed_range, SPEED_RANGES))
        for name, pair in self.control_limits.items():
            if name not in CONTROLS:
                raise InputError(unknown_name("control surface", name, CONTROLS))
            if not (all(math.isfinite(x) for x in pair) and pair[0] < pair[1]):
                raise InputError(f"control_limits[{name!r}] = {pair}: must be a least and a greater deflection, rad")

    def elevator_limits(self) -> tuple[float, float]:
        """Least and greatest elevator, rad: both elevons within theirs."""
        pairs = [self.control_limits[name] for name in ("elevon_left", "elevon_right") if name in self.control_limits]
        if not pairs:
            return -math.inf, math.inf
        return max(low for low, _ in pairs), min(high for _, high in pairs)

    def aileron_limit(self) -> float:
        """Greatest aileron either way, rad, beside the elevator of the flight point; 0 where that leaves none."""
        low, high = self.elevator_limits()
        return max(0.0, min(high - self.elevator, self.elevator - low))
