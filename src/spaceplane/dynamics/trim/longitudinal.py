"""Trim in pitch: the elevator for an angle of attack, or the angle of attack for given deflections.

Pitching moments of `AeroModel` are linear between nodes in each variable, so every trim is found exactly, however the
moment bends in between.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.aero.model.model import AeroModel, OutsideTables
from spaceplane.dynamics.trim.effects import Effects, Limits, SurfaceEffect, effects
from spaceplane.dynamics.trim.margins import StaticMargin, static_margin
from spaceplane.dynamics.trim.roots import beyond, zeros
from spaceplane.errors import InputError

ELEVONS = ("elevon_left", "elevon_right")
_PITCH = FORCES_AND_MOMENTS.index("Cm")
_SAME = 1e-9  # rad, two trims that are one
_SENSELESS = math.radians(90.0)  # no elevator that the ends' slopes lead to says anything beyond


@dataclass(frozen=True)
class PitchTrim:
    """A condition without pitching moment.

    Attributes:
        mach: Mach number.
        alpha: rad.
        elevator: of both elevons, rad, trailing edge down positive.
        body_flap: rad, trailing edge down positive; 0 where the model has none.
        CL, CD: trimmed.
        margin: from the elevator to the nearer of its limits, rad.
        static: neutral point and static margin with deflections held.
    """

    mach: float
    alpha: float
    elevator: float
    body_flap: float
    CL: float
    CD: float
    margin: float
    static: StaticMargin

    @property
    def lift_to_drag(self) -> float:
        """CL / CD."""
        return self.CL / self.CD if self.CD else math.nan

    @property
    def stable(self) -> bool:
        """Whether the pitching moment brings a disturbed angle of attack back."""
        return self.static.Cm_alpha < 0.0


@dataclass(frozen=True)
class PitchTrims:
    """Every trim that exists, or why there is none.

    Attributes:
        trims: that with the largest margin first for a given angle of attack; by angle of attack for given deflections.
        reason: why there is none; empty where there is one.
        needed: the elevator, rad, that the slope at the limit promises beyond it; None where it does not.
    """

    trims: tuple[PitchTrim, ...]
    reason: str = ""
    needed: float | None = None

    @property
    def best(self) -> PitchTrim | None:
        """The first trim, if there is one."""
        return self.trims[0] if self.trims else None


def trim_elevator(
    model: AeroModel,
    mach: float,
    alpha: float,
    body_flap: float | None = 0.0,
    moment: float = 0.0,
    limits: Limits | None = None,
) -> PitchTrims:
    """Elevator that trims an angle of attack: every solution within the limits.

    Args:
        model: aerodynamics about the centre of mass.
        mach: Mach number.
        alpha: rad.
        body_flap: rad; None chooses the one that leaves the elevator the largest margin.
        moment: coefficient of other pitching moments to be balanced, such as thrusters', on q S c_ref.
        limits: narrower than those of the tables, rad.

    Raises:
        InputError: the model has no elevons, or the body flap or a limit is out of range.
    """
    _require_elevons(model)
    _finite("moment", moment)
    if body_flap is not None:
        _check_flap(model, body_flap, limits)
    try:
        at = effects(model, mach, alpha, limits=limits)
    except OutsideTables as error:
        return PitchTrims((), f"outside the tables: {error}")
    elevator = elevator_effect(at)
    if body_flap is None:
        body_flap = widest_margin(at, elevator, moment)
    flap = at.surfaces["body_flap"].at(body_flap) if "body_flap" in at.surfaces else np.zeros(len(FORCES_AND_MOMENTS))
    rest = at.clean + flap
    values = rest[_PITCH] + moment + elevator.increments[:, _PITCH]
    found = zeros(elevator.deflection, values)
    if not found:
        reason, needed = _why(elevator, values, model, mach, alpha)
        return PitchTrims((), reason, needed)
    trims = [_trim(model, mach, alpha, value, body_flap, elevator) for value in found]
    return PitchTrims(tuple(sorted(trims, key=lambda t: -t.margin)))


def trim_alpha(
    model: AeroModel,
    mach: float,
    elevator: float = 0.0,
    body_flap: float = 0.0,
    moment: float = 0.0,
) -> PitchTrims:
    """Angles of attack that given deflections trim: every one in the tables, stable or not.

    Args:
        model: aerodynamics about the centre of mass.
        mach: Mach number.
        elevator, body_flap: rad.
        moment: coefficient of other pitching moments to be balanced, on q S c_ref.

    Raises:
        InputError: the model lacks a surface that is deflected, or a deflection is out of range.
    """
    _require_elevons(model)
    _finite("moment", moment)
    deflections = _deflections(model, elevator, body_flap)
    for name, value in deflections.items():
        lower, upper = model.limits(name)
        if not lower - _SAME <= value <= upper + _SAME:
            raise InputError(
                f"{name} = {math.degrees(value):g} deg: allowed {math.degrees(lower):g} to {math.degrees(upper):g} deg"
            )
    values = np.full(len(model.alpha), np.nan)
    empty = ""
    for row, alpha in enumerate(model.alpha):
        try:
            values[row] = model.coefficients(mach, alpha, deflections=deflections)["Cm"] + moment
        except OutsideTables as error:
            if error.quantity == "mach":
                return PitchTrims((), f"outside the tables: {error}")
            empty = str(error)
    known = values[np.isfinite(values)]
    found = zeros(model.alpha, values)
    if not found:
        if not len(known):
            return PitchTrims((), f"outside the tables: {empty}")
        low, high = (math.degrees(model.alpha[row]) for row in (0, -1))
        return PitchTrims(
            (), f"Cm runs from {known.min():.4g} to {known.max():.4g} between alpha {low:g} and {high:g} deg"
        )
    pair = elevator_effect(effects(model, mach, found[0]))
    return PitchTrims(tuple(_trim(model, mach, alpha, elevator, body_flap, pair) for alpha in found))


def elevator_effect(at: Effects) -> SurfaceEffect:
    """Both elevons moved alike, within the limits of both.

    Raises:
        InputError: they have no deflection in common.
    """
    left, right = (at.surfaces[name] for name in ELEVONS)
    lower = max(left.deflection[0], right.deflection[0])
    upper = min(left.deflection[-1], right.deflection[-1])
    if lower > upper:
        raise InputError("limits of elevon_left and elevon_right: no elevator deflection lies within both")
    nodes = np.unique(np.clip([*left.deflection, *right.deflection], lower, upper))
    return SurfaceEffect(nodes, np.array([left.at(node) + right.at(node) for node in nodes]))


def widest_margin(at: Effects, elevator: SurfaceEffect, moment: float = 0.0) -> float:
    """The body-flap deflection, rad, whose trim elevator keeps furthest from its limits; the smallest of equals.

    Within a cell between nodes of flap and elevator the trims lie on a straight line, so the best one lies where that
    line leaves the cell or crosses the middle of the elevator's range: trying these finds the best of all. Where no
    flap trims, the one that leaves the least moment with the elevator at its limits.

    Args:
        at: flight condition.
        elevator: both elevons.
        moment: coefficient of other pitching moments.
    """
    flap = at.surfaces.get("body_flap")
    if flap is None:
        return 0.0
    middle = 0.5 * (elevator.deflection[0] + elevator.deflection[-1])
    with_flap = at.clean[_PITCH] + moment + flap.increments[:, _PITCH]
    tried = [float(node) for node in flap.deflection]
    for node in (*elevator.deflection, middle):
        tried += zeros(flap.deflection, with_flap + elevator.at(node)[_PITCH])
    ranked = []
    for value in tried:
        rest = at.clean[_PITCH] + moment + flap.at(value)[_PITCH]
        totals = rest + elevator.increments[:, _PITCH]
        if np.all(np.isnan(totals)):
            continue
        margins = [_margin(elevator, root) for root in zeros(elevator.deflection, totals)]
        lacking = 0.0 if margins else float(np.nanmin(np.abs(totals)))
        ranked.append((lacking, -round(max(margins, default=0.0), 12), abs(value), value))
    return min(ranked)[-1] if ranked else 0.0


def _trim(
    model: AeroModel, mach: float, alpha: float, elevator: float, body_flap: float, pair: SurfaceEffect
) -> PitchTrim:
    deflections = _deflections(model, elevator, body_flap)
    found = model.coefficients(mach, alpha, deflections=deflections)
    return PitchTrim(
        mach=mach,
        alpha=alpha,
        elevator=elevator,
        body_flap=body_flap,
        CL=found["CL"],
        CD=found["CD"],
        margin=_margin(pair, elevator),
        static=static_margin(model, mach, alpha, deflections),
    )


def _deflections(model: AeroModel, elevator: float, body_flap: float) -> dict[str, float]:
    flap = {"body_flap": body_flap} if "body_flap" in model.surfaces or body_flap else {}
    return dict.fromkeys(ELEVONS, elevator) | flap


def _margin(elevator: SurfaceEffect, value: float) -> float:
    return min(value - float(elevator.deflection[0]), float(elevator.deflection[-1]) - value)


def _why(
    elevator: SurfaceEffect, values: np.ndarray, model: AeroModel, mach: float, alpha: float
) -> tuple[str, float | None]:
    """(reason, elevator needed) of a condition without trim."""
    known = np.isfinite(values)
    if not np.any(known):
        at = f"Mach {mach:g}, alpha {math.degrees(alpha):g} deg"
        return f"outside the tables: increments of {model.name} are empty at {at}", None
    low, high = (math.degrees(elevator.deflection[known][end]) for end in (0, -1))
    needed = beyond(elevator.deflection, values)
    if needed is None or abs(needed) > _SENSELESS:
        least, most = values[known].min(), values[known].max()
        return f"Cm runs from {least:.4g} to {most:.4g} between elevator {low:g} and {high:g} deg", needed
    limit = low if math.degrees(needed) < low else high
    return f"needs elevator {math.degrees(needed):.4g} deg, limit {limit:g} deg", needed


def _check_flap(model: AeroModel, body_flap: float, limits: Limits | None) -> None:
    _finite("body_flap", body_flap)
    if "body_flap" not in model.surfaces:
        if body_flap != 0.0:
            raise InputError(f"body_flap = {math.degrees(body_flap):g} deg: {model.name} has no table of it")
        return
    lower, upper = dict(limits or {}).get("body_flap", model.limits("body_flap"))
    if not lower - _SAME <= body_flap <= upper + _SAME:
        allowed = f"{math.degrees(lower):g} to {math.degrees(upper):g} deg"
        raise InputError(f"body_flap = {math.degrees(body_flap):g} deg: allowed {allowed}")


def _require_elevons(model: AeroModel) -> None:
    missing = [name for name in ELEVONS if name not in model.surfaces]
    if missing:
        raise InputError(f"{model.name}: has no table of {' and '.join(missing)}, which trim in pitch needs")


def _finite(name: str, value: float) -> None:
    if not math.isfinite(value):
        raise InputError(f"{name} = {value}: must be a finite number")


def schedule_at(schedule: Mapping[float, float], mach: float) -> float | None:
    """Body flap, rad, of a schedule at a Mach number, linear between its points; None outside.

    Args:
        schedule: Mach number -> rad.
        mach: Mach number.
    """
    machs = sorted(schedule)
    if not machs or not machs[0] <= mach <= machs[-1]:
        return None
    return float(np.interp(mach, machs, [schedule[m] for m in machs]))


HORUS_2B_BODY_FLAP = {0.0: math.radians(-20.0), 2.55: math.radians(-20.0)}
"""Mach number -> body flap of HORUS-2B, rad: -20 deg through the TAEM phase and at subsonic speed, below the TAEM
interface at Mach 2.55 (thesis sections 2.4 and 3.4, after Mooij). No value is known above; there the widest margin is
taken."""
