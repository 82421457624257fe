"""Which inputs a feedback may use: surfaces whose effect is known, and thrusters about the other axes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from spaceplane.aero.model.derivatives import DAMPING, Derivatives
from spaceplane.control.authority import Authority, authority

AXES = (("elevator", "Cm", "moment_y"), ("aileron", "Cl", "moment_x"), ("rudder", "Cn", "moment_z"))
"""Each combined control, the moment it is for, and the thruster that stands in for it."""
MOMENTS = {"Cm": "pitching", "Cl": "rolling", "Cn": "yawing"}


@dataclass(frozen=True)
class Inputs:
    """What a feedback may use. The body flap is left to trim.

    Attributes:
        limits: of surfaces and thrusters from the trim.
        surfaces: combined controls among them.
        stand_ins: {moment of a thruster: why it stands in for the control of its axis}.
    """

    limits: Authority
    surfaces: tuple[str, ...]
    stand_ins: Mapping[str, str]

    def of_surfaces(self) -> Authority | None:
        """Limits of the surfaces alone; None without any."""
        return authority(self.surfaces, self.limits.trim) if self.surfaces else None


def usable_inputs(derivatives: Derivatives, trim: Mapping[str, float], thruster: float) -> Inputs:
    """Elevator, aileron and rudder where their own moment is known and their trim leaves room, else thrusters.

    Args:
        derivatives: per rad.
        trim: deflections of surfaces in trimmed flight, rad.
        thruster: N m that count as one full input.

    Raises:
        InputError: an unknown surface or a trim outside its limits.
    """
    surfaces, stand_ins = [], {}
    for control, coefficient, moment in AXES:
        if control not in derivatives.available_controls() or derivatives.control(coefficient, control) == 0.0:
            stand_ins[moment] = f"no {MOMENTS[coefficient]} moment of the {control} is known"
            continue
        alone = authority([control], trim)
        if alone.low[0] < 0.0 < alone.high[0]:
            surfaces.append(control)
        else:
            stand_ins[moment] = f"the trim leaves the {control} nothing on one side"
    limits = authority([*surfaces, *stand_ins], trim, dict.fromkeys(stand_ins, thruster))
    return Inputs(limits, tuple(surfaces), stand_ins)


def unknown_damping(derivatives: Derivatives) -> tuple[str, ...]:
    """Damping derivatives with the rates that are not known, and so zero in the linear model."""
    return tuple(name for name in DAMPING if not name.endswith("alphadot") and getattr(derivatives, name) == 0.0)
