"""What an aerodynamic database holds and how its flow is computed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from spaceplane.aero.conditions import DerivativeSteps
from spaceplane.aero.inclination.settings import METHODS, method, require_mach
from spaceplane.aero.increments.settings import VISCOUS, IncrementSettings
from spaceplane.dynamics.flightpoint import trajectory_altitude
from spaceplane.environment.atmosphere import us1976
from spaceplane.errors import InputError, unknown_name
from spaceplane.flow.settings import FlowSettings
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.controls import CONTROL_LIMITS_DEG, CONTROLS

EULER, FAST = TIERS = ("euler", "fast")
"""The Euler solver on meshes, or local inclination on the surface."""
MOVED = tuple(name for name in CONTROLS if not name.endswith("_right"))
"""Surfaces that are moved; those to the right are their mirror images."""
COARSE_MESH = MeshSettings(wall_cell=0.5, growth_layers=2, fine_edges=True, edge_levels=1)
"""Mesh of the Euler tier unless another is asked for, see docs/database.md for what it costs and how far it is off."""
FASTEST = 50.0
"""Greatest Mach number of a table."""
_ROUND_OFF_DEG = 1e-9

_MACHS = {EULER: (0.8, 1.2, 1.5, 2.5, 5.0, 10.0, 20.0), FAST: (2.0, 2.5, 3.0, 4.0, 5.0, 7.5, 10.0, 15.0, 20.0)}
_ALPHAS_DEG = {EULER: (0.0, 10.0, 20.0, 30.0, 40.0), FAST: tuple(float(a) for a in range(0, 46, 5))}
_DEFLECTIONS_DEG = {
    EULER: {
        "elevon_left": (-40.0, -20.0, -10.0, 0.0, 10.0, 20.0, 40.0),
        "rudder_left": (0.0, 20.0, 40.0),
        "body_flap": (-20.0, 0.0, 15.0, 30.0),
    },
    FAST: {
        "elevon_left": tuple(float(d) for d in range(-40, 41, 10)),
        "rudder_left": tuple(float(d) for d in range(0, 41, 10)),
        "body_flap": tuple(float(d) for d in range(-20, 31, 10)),
    },
}


@dataclass(frozen=True)
class TableSettings:
    """An aerodynamic database.

    Attributes:
        tier: of `TIERS`.
        machs: increasing Mach numbers, two or more.
        alphas: increasing angles of attack, rad, two or more.
        deflections: of `MOVED` -> deflections, rad, in any order; 0 belongs to each. A surface that is not named stays
            unknown.
        steps: of sideslip and of the reduced rates; a rate of 0 leaves the damping derivatives out.
        altitude_m: geometric altitude, m, of the air at every Mach number; None takes the descent of thesis Table 4.1.
            Skin friction alone needs it.
        mesh, flow, increments: of the Euler tier.
        method: of the fast tier, see `aero.inclination.settings.METHODS`.

    Raises:
        InputError: naming the field, its value and what is allowed.
    """

    tier: str = EULER
    machs: tuple[float, ...] = _MACHS[EULER]
    alphas: tuple[float, ...] = tuple(math.radians(a) for a in _ALPHAS_DEG[EULER])
    deflections: Mapping[str, tuple[float, ...]] = field(default_factory=lambda: _radians(_DEFLECTIONS_DEG[EULER]))
    steps: DerivativeSteps = field(default_factory=DerivativeSteps)
    altitude_m: float | None = None
    mesh: MeshSettings = COARSE_MESH
    flow: FlowSettings = field(default_factory=FlowSettings)
    increments: IncrementSettings = VISCOUS
    method: str = next(iter(METHODS))

    def __post_init__(self) -> None:
        if self.tier not in TIERS:
            raise InputError(unknown_name("tier", self.tier, TIERS))
        _increasing("mach", self.machs, 1.0, "", 0.0, FASTEST)
        if self.machs[0] <= 0.0:
            raise InputError(f"mach = {self.machs[0]:g}: must be above 0")
        _increasing("alpha", self.alphas, math.degrees(1.0), " deg", -90.0, 90.0)
        object.__setattr__(self, "machs", tuple(float(m) for m in self.machs))
        object.__setattr__(self, "alphas", tuple(float(a) for a in self.alphas))
        found = {name: _deflections(name, self.deflections[name]) for name in self.deflections}
        object.__setattr__(self, "deflections", {name: found[name] for name in MOVED if name in found})
        method(self.method)
        if self.tier == FAST:
            require_mach(self.machs)
        if self.needs_air:
            for mach in self.machs:
                us1976(self.altitude(mach))

    @property
    def needs_air(self) -> bool:
        """Whether the undisturbed air counts: for skin friction on the Euler flow alone."""
        return self.tier == EULER and self.increments.friction != "off"

    def altitude(self, mach: float) -> float:
        """Geometric altitude of the air at a Mach number, m.

        Raises:
            InputError: none is given and the descent does not pass the Mach number.
        """
        return trajectory_altitude(mach) if self.altitude_m is None else self.altitude_m


def default_settings(tier: str, **given: object) -> TableSettings:
    """Settings with the grid of a tier, and what is `given` (fields of `TableSettings`) instead of its own.

    Raises:
        InputError: as `TableSettings`.
    """
    if tier not in TIERS:
        raise InputError(unknown_name("tier", tier, TIERS))
    grid = {
        "machs": _MACHS[tier],
        "alphas": tuple(math.radians(a) for a in _ALPHAS_DEG[tier]),
        "deflections": _radians(_DEFLECTIONS_DEG[tier]),
    }
    return TableSettings(**{"tier": tier, **grid, **given})  # type: ignore[arg-type]


def _radians(deflections: Mapping[str, Sequence[float]]) -> dict[str, tuple[float, ...]]:
    return {name: tuple(math.radians(d) for d in values) for name, values in deflections.items()}


def _increasing(name: str, values: Sequence[float], factor: float, unit: str, lower: float, upper: float) -> None:
    shown = [factor * float(v) for v in values]
    listed = ", ".join(f"{v:g}" for v in shown)
    if len(shown) < 2:
        raise InputError(f"{name} = {listed or 'nothing'}: two or more values are needed")
    for value in shown:
        if not lower - _ROUND_OFF_DEG <= value <= upper + _ROUND_OFF_DEG:
            raise InputError(f"{name} = {value:g}{unit}: allowed {lower:g} to {upper:g}{unit}")
    if any(b <= a for a, b in pairwise(shown)):
        raise InputError(f"{name} = {listed}{unit}: must increase from each value to the next")


def _deflections(name: str, values: Sequence[float]) -> tuple[float, ...]:
    """Increasing, with 0 among them."""
    if name not in MOVED:
        raise InputError(unknown_name("control surface to move", name, MOVED))
    found = sorted({0.0, *(float(v) for v in values)})
    given = [float(v) for v in values]
    for k, value in enumerate(given):
        lower, upper = CONTROL_LIMITS_DEG[name]
        degrees = math.degrees(value)
        if not lower - _ROUND_OFF_DEG <= degrees <= upper + _ROUND_OFF_DEG:
            raise InputError(f"{name} = {degrees:g} deg: allowed {lower:g} to {upper:g} deg")
        if value in given[:k]:
            raise InputError(f"{name} = {degrees:g} deg: given twice")
    if len(found) < 2:
        raise InputError(f"{name}: a deflection other than 0 is needed")
    return tuple(found)
