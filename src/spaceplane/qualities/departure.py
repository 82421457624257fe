"""Criteria of departure from controlled flight: C_n_beta,dyn, LCDP and the regions of their plane.

C_n_beta,dyn = C_n_beta cos(alpha) - (Izz/Ixx) C_l_beta sin(alpha) is the stiffness of sideslip when the vehicle turns
freely about both body axes: without gravity, side force and damping the lateral oscillation has omega^2 =
C_n_beta,dyn q S b / Izz exactly. The lateral control departure parameter LCDP = C_n_beta - C_l_beta C_n_a / C_l_a is
the stiffness in yaw when the aileron holds the wings: below zero, sideslip grows and the vehicle ends up rolling
against the aileron. A rudder that follows the aileron by a ratio k puts C_n_a + k C_n_r and C_l_a + k C_l_r in its
place. With a product of inertia Ixz every pair (C_l, C_n) is primed in both (`spaceplane.dynamics.inertia.primed`),
so that they mean the same. Moul and Paulson, NACA RM L58E16 (1958); Weissman, J. Aircraft 12 (1975).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from spaceplane.aero.model.derivatives import Derivatives
from spaceplane.dynamics.inertia import primed
from spaceplane.errors import InputError
from spaceplane.qualities import limits
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.verdict import AIRFRAME, Context, Verdict
from spaceplane.vehicle.properties import MassProperties

PER_DEGREE = math.pi / 180.0


@dataclass(frozen=True)
class Region:
    """A region of the plane of LCDP and C_n_beta,dyn.

    Attributes:
        name: letter.
        lcdp: least and greatest LCDP, 1/deg, the greatest excluded.
        directional: least and greatest C_n_beta,dyn, 1/deg, the greatest excluded.
        meaning: what flight there is like.
        good: whether it is resistant to departure.
    """

    name: str
    lcdp: tuple[float, float]
    directional: tuple[float, float]
    meaning: str
    good: bool


def dynamic_directional(derivatives: Derivatives, mass: MassProperties, alpha: float) -> float:
    """C_n_beta,dyn, 1/rad.

    Args:
        derivatives: Cn_beta and Cl_beta, body axes, per rad.
        mass: its inertia.
        alpha: angle of attack, rad.
    """
    Cl, Cn = primed(mass, derivatives.Cl_beta, derivatives.Cn_beta)
    return Cn * math.cos(alpha) - mass.Izz / mass.Ixx * Cl * math.sin(alpha)


def lateral_control_departure(
    derivatives: Derivatives, mass: MassProperties, rudder_per_aileron: float | None = None
) -> float | None:
    """LCDP, 1/rad; None where the roll control has no rolling moment.

    Args:
        derivatives: per rad.
        mass: its inertia.
        rudder_per_aileron: ratio of the rudder that follows the aileron; None for none.
    """
    mix = rudder_per_aileron or 0.0
    roll, yaw = (derivatives.control(c, "aileron") + mix * derivatives.control(c, "rudder") for c in ("Cl", "Cn"))
    roll, yaw = primed(mass, roll, yaw)
    if "aileron" not in derivatives.available_controls() or roll == 0.0:
        return None
    Cl, Cn = primed(mass, derivatives.Cl_beta, derivatives.Cn_beta)
    return Cn - Cl * yaw / roll


def coordinating_rudder(derivatives: Derivatives) -> float | None:
    """Rudder per aileron, ratio, at which LCDP is zero; None where no rudder changes it."""
    if not {"aileron", "rudder"} <= set(derivatives.available_controls()):
        return None
    aileron, rudder = (
        derivatives.Cn_beta * derivatives.control("Cl", c) - derivatives.Cl_beta * derivatives.control("Cn", c)
        for c in ("aileron", "rudder")
    )
    return None if rudder == 0.0 else -aileron / rudder


def regions() -> tuple[Region, ...]:
    """The regions of `departure.toml`: simplified boundaries, see there."""
    entry = limits.departure()["regions"]
    return tuple(
        Region(name, tuple(r["lcdp"]), tuple(r["directional"]), r["meaning"], name in entry["good"])
        for name, r in entry.items()
        if isinstance(r, dict)
    )


def region(lcdp: float, directional: float) -> Region:
    """The region of a point; both values 1/rad.

    Raises:
        InputError: a value is not finite.
    """
    x, y = lcdp * PER_DEGREE, directional * PER_DEGREE
    for r in regions():
        if r.lcdp[0] <= x < r.lcdp[1] and r.directional[0] <= y < r.directional[1]:
            return r
    raise InputError(f"lcdp, directional = {lcdp}, {directional}: must be finite numbers, 1/rad")


def verdicts(airframe: Airframe, context: Context) -> list[Verdict]:
    """Directional stability, its guideline, lateral control, and the region of both; no levels, `met` instead."""
    d = airframe.derivatives
    directional = dynamic_directional(d, airframe.mass, airframe.point.alpha)
    lcdp = lateral_control_departure(d, airframe.mass, airframe.rudder_per_aileron)
    note = f"C_n_beta {d.Cn_beta * PER_DEGREE:.3g} and C_l_beta {d.Cl_beta * PER_DEGREE:.3g} per deg"
    mixed = airframe.rudder_per_aileron is not None
    how = f"rudder per aileron {airframe.rudder_per_aileron:.3g}" if mixed else "aileron alone"
    zero = coordinating_rudder(d)
    if zero is not None:
        how += f"; LCDP is zero with {zero:.3g} of rudder per aileron"
    found = [
        _least("directional", "C_n_beta,dyn", directional, note, context),
        _least("guideline", "C_n_beta,dyn", directional, "a guideline for fighters, no requirement", context),
        _least("lateral_control", "LCDP", lcdp, how, context),
    ]
    if lcdp is None:
        return [*found, _verdict("regions", "region", context, applicable=False, note=_NO_ROLL)]
    where = region(lcdp, directional)
    note = f"region {where.name}: {where.meaning}; simplified boundaries"
    return [*found, _verdict("regions", "region", context, limits={"met": "A"}, met=where.good, note=note)]


_NO_ROLL = "not applicable: no aileron with a rolling moment is known"


def _least(key: str, quantity: str, value: float | None, note: str, context: Context) -> Verdict:
    if value is None:
        return _verdict(key, quantity, context, applicable=False, note=_NO_ROLL)
    low, per_degree = limits.departure()[key]["low_per_deg"], value * PER_DEGREE
    return _verdict(
        key,
        quantity,
        context,
        value=per_degree,
        unit="1/deg",
        limits={"met": f"> {low:g}"},
        margin=per_degree - low,
        met=per_degree > low,
        note=note,
    )


def _verdict(key: str, quantity: str, context: Context, **values: object) -> Verdict:
    """A verdict whose paragraph is the source of the criterion."""
    entry = limits.departure()[key]
    return Verdict(
        AIRFRAME,
        entry["title"],
        quantity,
        entry["source"],
        context.vehicle_class,
        context.category,
        **values,  # type: ignore[arg-type]
    )
