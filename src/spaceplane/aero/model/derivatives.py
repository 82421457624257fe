"""Aerodynamic derivatives as one record, per radian and per unit Mach number."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property

from spaceplane.errors import InputError
from spaceplane.vehicle.controls import CONTROLS as SURFACES

STATIC = ("CD_alpha", "CL_alpha", "Cm_alpha", "CY_beta", "Cl_beta", "Cn_beta", "CD_M", "CL_M", "Cm_M")
# On q c/2V and dalpha/dt c/2V; on p b/2V and r b/2V.
DAMPING_PITCH = ("CL_q", "Cm_q", "CL_alphadot", "Cm_alphadot")
DAMPING_LATERAL = ("CY_p", "Cl_p", "Cn_p", "CY_r", "Cl_r", "Cn_r")
DAMPING = (*DAMPING_PITCH, *DAMPING_LATERAL)
COEFFICIENTS = ("CD", "CL", "CY", "Cl", "Cm", "Cn")
COMBINED = ("aileron", "elevator", "rudder")
CONTROLS = (*COMBINED, *SURFACES)
CONTROL_DERIVATIVES = tuple(f"{coefficient}_{control}" for control in CONTROLS for coefficient in COEFFICIENTS)

# A combined control moves a pair of surfaces: (first, second, sign of the second).
# aileron = (left - right)/2 and elevator = (left + right)/2 of the elevons; rudder = (left - right)/2 of the rudders,
# each positive outboard, so a positive rudder has its trailing edges to the left.
PAIRS = {
    "aileron": ("elevon_left", "elevon_right", -1.0),
    "elevator": ("elevon_left", "elevon_right", 1.0),
    "rudder": ("rudder_left", "rudder_right", -1.0),
}


@dataclass(frozen=True)
class Derivatives:
    """Derivatives in the project's axes: CL, CD, CY in wind axes, Cl, Cm, Cn in body axes.

    Angle derivatives per rad; `_M` per unit Mach; rate derivatives on p b/2V, q c/2V, r b/2V and dalpha/dt c/2V. The
    stable signs are Cm_alpha < 0, Cn_beta > 0, Cl_beta < 0, CY_beta < 0 and negative Cm_q, Cl_p, Cn_r.

    The fields are those of thesis Table 7.1 (CD, CL, Cm with alpha and Mach number; CY, Cl, Cn with beta), which every
    analysis has, and the damping derivatives, 0 where they are not known.

    Attributes:
        controls: {"Cm_elevator": per rad, ...}; names as in `CONTROL_DERIVATIVES`.
    """

    CD_alpha: float
    CL_alpha: float
    Cm_alpha: float
    CY_beta: float
    Cl_beta: float
    Cn_beta: float
    CD_M: float
    CL_M: float
    Cm_M: float
    CL_q: float = 0.0
    Cm_q: float = 0.0
    CL_alphadot: float = 0.0
    Cm_alphadot: float = 0.0
    CY_p: float = 0.0
    Cl_p: float = 0.0
    Cn_p: float = 0.0
    CY_r: float = 0.0
    Cl_r: float = 0.0
    Cn_r: float = 0.0
    controls: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for item in fields(self):
            if item.name != "controls":
                _require_finite(item.name, getattr(self, item.name))
        for name, value in self.controls.items():
            if name not in CONTROL_DERIVATIVES:
                raise InputError(
                    f"{name}: not a control derivative; allowed are <coefficient>_<control> with {CONTROLS}"
                )
            _require_finite(name, value)
        for combined, (left, right, _) in PAIRS.items():
            given = set(self.given_controls())
            if combined in given and (left in given or right in given):
                raise InputError(f"{combined}: give its derivatives or those of {left} and {right}, not both")

    @cached_property
    def _given(self) -> tuple[str, ...]:
        given = {name.split("_", 1)[1] for name in self.controls}
        return tuple(control for control in CONTROLS if control in given)

    def given_controls(self) -> tuple[str, ...]:
        """Controls of which at least one derivative is given, in the order of `CONTROLS`."""
        return self._given

    def available_controls(self) -> tuple[str, ...]:
        """The given controls and the combined ones that follow from them."""
        given = self.given_controls()
        available = set(given)
        for combined, (left, right, _) in PAIRS.items():
            if left in given and right in given:
                available.add(combined)
        return tuple(control for control in (*SURFACES, *COMBINED) if control in available)

    def control(self, coefficient: str, control: str) -> float:
        """Derivative of a coefficient with a control, per rad; a combined one from its two surfaces; 0 if not given."""
        name = f"{coefficient}_{control}"
        if name in self.controls or control in self.given_controls() or control not in PAIRS:
            return float(self.controls.get(name, 0.0))
        left, right, sign = PAIRS[control]
        return float(self.controls.get(f"{coefficient}_{left}", 0.0)) + sign * float(
            self.controls.get(f"{coefficient}_{right}", 0.0)
        )


def per_radian(values: Mapping[str, float]) -> dict[str, float]:
    """Per-degree values turned into per-radian ones: angle and deflection derivatives only.

    Mach derivatives and rate derivatives keep their value (the rates are dimensionless already).
    """
    factor = 180.0 / math.pi
    return {name: value * factor if is_per_angle(name) else value for name, value in values.items()}


def per_degree(values: Mapping[str, float]) -> dict[str, float]:
    """Per-radian values turned into per-degree ones; the inverse of `per_radian`."""
    factor = math.pi / 180.0
    return {name: value * factor if is_per_angle(name) else value for name, value in values.items()}


def is_per_angle(name: str) -> bool:
    """Whether a derivative is taken with an angle (alpha, beta or a deflection)."""
    return not (name.endswith("_M") or name in DAMPING)


def from_mapping(values: Mapping[str, float]) -> Derivatives:
    """Derivatives from one flat mapping of names to values, per rad and (`_M`) per unit Mach number.

    Raises:
        InputError: a static derivative is missing, a name is unknown or a value is not finite.
    """
    missing = [name for name in STATIC if name not in values]
    if missing:
        raise InputError(f"derivatives: missing {', '.join(missing)}")
    plain = {name: float(values[name]) for name in (*STATIC, *DAMPING) if name in values}
    controls = {name: float(value) for name, value in values.items() if name not in plain}
    return Derivatives(**plain, controls=controls)


def _require_finite(name: str, value: float) -> None:
    if not math.isfinite(value):
        raise InputError(f"{name} = {value}: must be a finite number")
