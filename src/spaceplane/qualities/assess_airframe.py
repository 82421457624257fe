"""Criteria on the airframe and its controls: what MIL-F-8785C asks beside the modes, and departure.

They need the derivatives themselves. All are of the bare airframe, about the flight point, with the controls as
surfaces: no actuators, no pilot forces. docs/flying-qualities.md lists the paragraphs left out.
"""

from __future__ import annotations

from spaceplane.dynamics.linearise import linearise
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.qualities import departure, limits, longitudinal_control, roll_control, steady_sideslip
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.verdict import Context, Verdict


def assess_airframe(
    airframe: Airframe, vehicle_class: str = "III", category: str = "B", system: StateSpace | None = None
) -> tuple[Verdict, ...]:
    """Hold an airframe against MIL-F-8785C 3.2.1, 3.2.2.2, 3.2.3, 3.3.2, 3.3.4, 3.3.6 and departure criteria.

    Every criterion answers, if only to say that it does not apply and why.

    Args:
        airframe: vehicle at its flight point.
        vehicle_class: I, II-L, II-C, III or IV.
        category: flight phase category A, B or C.
        system: rigid-body linear model of the airframe; linearised here where it is not given.

    Raises:
        InputError: unknown class or category, or CL or CD missing.
    """
    limits.check(vehicle_class, category)
    context = Context(vehicle_class, category)
    if system is None or system.form == "thesis":
        system = linearise(airframe.point, airframe.mass, airframe.reference, airframe.derivatives)
    return (
        *longitudinal_control.verdicts(airframe, context),
        *roll_control.verdicts(airframe, system, context),
        *steady_sideslip.verdicts(airframe, context),
        *departure.verdicts(airframe, context),
    )
