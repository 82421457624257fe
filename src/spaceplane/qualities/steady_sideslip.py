"""MIL-F-8785C 3.3.6: senses of rudder, bank angle and aileron in steady straight sideslips, and how much aileron.

Nothing turns and the wings are nearly level, so for aileron a, rudder r and bank angle phi per sideslip beta

    C_l_beta + C_l_a a + C_l_r r = 0,   C_n_beta + C_n_a a + C_n_r r = 0,
    C_Y_beta + C_Y_a a + C_Y_r r + m g cos(gamma) / (q S) phi = 0.

In right sideslip (beta > 0, the wind from the right) the rudder must yaw the nose to the left, the right wing be down
and the aileron roll to the right. Without the controls the signs of C_n_beta, C_Y_beta and C_l_beta say the same.
Positive dihedral may not take more than a share of the aileron (3.3.6.3.2); the sideslip is that of 3.3.7.1.
"""

from __future__ import annotations

import math

import numpy as np

from spaceplane.qualities import limits
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.verdict import AIRFRAME, Context, Verdict, most_text

RULES = (
    # criterion, quantity with controls, derivative without them, sign wanted of it
    ("sideslip_yaw", "rudder moment to the left per right sideslip", "Cn_beta", 1.0),
    ("sideslip_force", "bank to the right per right sideslip", "CY_beta", -1.0),
    ("sideslip_roll", "aileron moment to the right per right sideslip", "Cl_beta", -1.0),
)


def solve(airframe: Airframe) -> tuple[float, float, float] | None:
    """(aileron, rudder, bank angle) per sideslip, rad/rad; None where aileron or rudder are not known or not enough."""
    d = airframe.derivatives
    if not {"aileron", "rudder"} <= set(d.available_controls()):
        return None
    matrix = np.array([[d.control(c, "aileron"), d.control(c, "rudder")] for c in ("Cl", "Cn")])
    if not np.all(np.isfinite(matrix)) or np.linalg.cond(matrix) > 1e10:
        return None
    aileron, rudder = np.linalg.solve(matrix, [-d.Cl_beta, -d.Cn_beta])
    point = airframe.point
    weight = airframe.mass.mass * point.gravity * math.cos(point.gamma)
    side = d.CY_beta + d.control("CY", "aileron") * aileron + d.control("CY", "rudder") * rudder
    return float(aileron), float(rudder), float(-side * point.dynamic_pressure * airframe.reference.area / weight)


def verdicts(airframe: Airframe, context: Context) -> list[Verdict]:
    """Four verdicts: senses of yawing moment, side force and rolling moment, without levels; aileron for dihedral."""
    found = solve(airframe)
    return [*_senses(airframe, found, context), _dihedral(airframe, found, context)]


def _senses(airframe: Airframe, found: tuple[float, float, float] | None, context: Context) -> list[Verdict]:
    d = airframe.derivatives
    if found is None:
        return [
            _of_sign(context, criterion, derivative, sign, getattr(d, derivative))
            for criterion, _, derivative, sign in RULES
        ]
    aileron, rudder, bank = found
    moments = (-d.control("Cn", "rudder") * rudder, bank, d.control("Cl", "aileron") * aileron)
    notes = (f"rudder {rudder:.3g}", "deg of bank per deg", f"aileron {aileron:.3g}")
    return [
        context.verdict(
            criterion,
            AIRFRAME,
            quantity,
            value=value,
            unit="deg/deg" if criterion == "sideslip_force" else "1/rad",
            limits={k: "> 0" for k in "123"},
            margin=value,
            met=value > 0,
            note=f"{note} per sideslip; steady, wings nearly level; no levels",
        )
        for (criterion, quantity, _, _), value, note in zip(RULES, moments, notes, strict=True)
    ]


def _of_sign(context: Context, criterion: str, name: str, sign: float, value: float) -> Verdict:
    return context.verdict(
        criterion,
        AIRFRAME,
        f"sign of C_{name[1:]}",
        value=value,
        unit="1/rad",
        limits={k: "> 0" if sign > 0 else "< 0" for k in "123"},
        margin=sign * value,
        met=sign * value > 0,
        note="aileron and rudder are not both known: judged by the derivative alone; no levels",
    )


def _dihedral(airframe: Airframe, found: tuple[float, float, float] | None, context: Context) -> Verdict:
    """Aileron that holds the sideslip, as a share of what there is beside the elevator of the flight point."""
    d, limit, quantity = airframe.derivatives, airframe.aileron_limit(), "share of the aileron that holds the sideslip"
    entry = limits.specification()["dihedral_limit"]
    power = d.control("Cl", "aileron") if "aileron" in d.available_controls() else 0.0
    reason = ""
    if power == 0.0 or not math.isfinite(limit):
        reason = "no aileron with a rolling moment and limits is known"
    elif limit == 0.0:
        reason = "the elevator leaves no aileron"
    else:
        aileron = found[0] if found is not None else -d.Cl_beta / power
        if power * aileron <= 0.0:
            reason = "dihedral is not positive"
    if reason:
        return context.verdict("dihedral_limit", AIRFRAME, quantity, applicable=False, note=f"not applicable: {reason}")
    slip, most = entry["sideslip_deg"], entry["share_high_percent"]
    value = 100.0 * abs(aileron) * math.radians(slip) / limit
    how = "by C_l_beta alone: rudder and aileron not known"
    if found is not None:
        how = f"{abs(found[1]) * slip:.3g} deg of rudder hold the yawing moment"
    return context.verdict(
        "dihedral_limit",
        AIRFRAME,
        quantity,
        value=value,
        unit="%",
        limits=most_text([most, most, None]),
        margin=most - value,
        met=value <= most,
        note=f"{abs(aileron) * slip:.3g} of {math.degrees(limit):.3g} deg for {slip:g} deg of sideslip; {how}",
    )
