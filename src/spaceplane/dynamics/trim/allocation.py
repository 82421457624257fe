"""Deflections of redundant surfaces that give wanted moments, within limits.

Of all solutions the one whose most used surface is used least is taken, use being deflection over limit, with a small
weight on the sum of all uses; see `spaceplane.dynamics.trim.program`. Limits of 0 to 40 deg keep rudders outboard.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.aero.integrate import LATERAL
from spaceplane.aero.model.derivatives import PAIRS
from spaceplane.aero.model.model import AeroModel
from spaceplane.dynamics.trim.effects import Effects, Limits, SurfaceEffect, effects
from spaceplane.dynamics.trim.program import SIDESLIP, Task, solve
from spaceplane.errors import InputError, unknown_name

MOMENTS = ("Cl", "Cm", "Cn")
_SIDES = tuple({(left, right): None for left, right, _ in PAIRS.values()})
_AT_LIMIT = 1e-6  # rad
_NONE = 1e-15  # reduced rate or coefficient
_SOLVED = 1e-7  # of what the strongest surface gives


@dataclass(frozen=True)
class Allocation:
    """Deflections that were found, or the nearest there are.

    Attributes:
        deflections: control surface -> rad, held ones included.
        beta: sideslip, rad.
        coefficients: the six, with these deflections, sideslip and rates.
        lacking: coefficient -> wanted less given, for those that are not met; NaN where it is not known.
        saturated: surfaces at a limit, held ones apart.
        margin: least distance of a free surface to a limit other than 0, rad; inf if none is free.
        reason: why there is no trim; empty where there is one.
    """

    deflections: Mapping[str, float]
    beta: float
    coefficients: Mapping[str, float]
    lacking: Mapping[str, float]
    saturated: tuple[str, ...]
    margin: float
    reason: str = ""

    @property
    def found(self) -> bool:
        """Whether everything wanted is met."""
        return not self.lacking


def allocate(
    model: AeroModel,
    mach: float,
    alpha: float,
    wanted: Mapping[str, float] | None = None,
    beta: float | None = 0.0,
    rates: tuple[float, float, float] = (0.0, 0.0, 0.0),
    held: Mapping[str, float] | None = None,
    limits: Limits | None = None,
) -> Allocation:
    """Find deflections that give wanted coefficients.

    A pair of surfaces of which a wanted lateral coefficient is unknown moves alike, where it cancels. With one of them
    held elsewhere than the other could follow, there is no answer.

    Args:
        model: aerodynamics about the centre of mass.
        mach: Mach number.
        alpha: rad.
        wanted: totals of coefficients, Cl = Cm = Cn = 0 by default.
        beta: sideslip, rad; None leaves it free within the model's limit.
        rates: reduced, p b/2V, q c/2V, r b/2V.
        held: surfaces that stand at a deflection, rad, and cannot move: failed, or set by a schedule.
        limits: narrower than those of the tables, rad.

    Raises:
        OutsideTables: the condition, or a held deflection, is not in the tables.
        InputError: an unknown coefficient or surface, or a value that is not finite.
    """
    wanted, held = _checked(wanted, held, model)
    at = effects(model, mach, alpha, beta or 0.0, rates, limits)
    base = at.clean.copy()
    if held:
        stuck, clean = model.coefficients(mach, alpha, deflections=held), model.coefficients(mach, alpha)
        base += np.array([stuck[name] - clean[name] for name in FORCES_AND_MOMENTS])
    movers = {name: surface for name, surface in at.surfaces.items() if name not in held}
    if beta is None and model.beta_limit > 0.0:
        limit = model.beta_limit
        tilted = effects(model, mach, alpha, limit, rates).clean
        movers[SIDESLIP] = SurfaceEffect(np.array([-limit, limit]), np.outer([-1.0, 1.0], tilted - at.clean))
    blind = _blind_pairs(model, wanted)
    for left, right in blind:
        for stands, follows in ((left, right), (right, left)):
            if stands in held and follows in movers:
                movers[follows] = _at_only(movers[follows], held[stands])
    task = Task(base, movers, wanted, tuple(pair for pair in blind if set(pair) <= set(movers)))
    even = replace(task, alike=tuple(pair for pair in _SIDES if set(pair) <= set(movers)))
    # What is symmetric has a symmetric answer; where only others exist, those are found next.
    lateral = (rates[0], rates[2], *(wanted.get(name, 0.0) for name in LATERAL))
    symmetric = beta == 0.0 and not held and max(map(abs, lateral)) < _NONE
    values = (solve(even) if symmetric else None) or solve(task) or solve(task, exact=False)
    if values is None:
        raise InputError(f"Mach {mach:g}, alpha {math.degrees(alpha):g} deg: the increments of {model.name} are empty")
    return _result(model, at, task, values, held, beta)


def _blind_pairs(model: AeroModel, wanted: Mapping[str, float]) -> tuple[tuple[str, str], ...]:
    """Left and right surfaces of which a lateral coefficient that is wanted is unknown."""
    unknown = set(model.unknown())
    lateral = [name for name in wanted if name in LATERAL]
    return tuple(
        pair
        for pair in _SIDES
        if set(pair) <= set(model.surfaces) and any(f"{name}_{pair[0]}" in unknown for name in lateral)
    )


def _at_only(effect: SurfaceEffect, deflection: float) -> SurfaceEffect:
    """The surface at one deflection, or at the limit nearest to it, rad."""
    nearest = float(np.clip(deflection, effect.deflection[0], effect.deflection[-1]))
    return SurfaceEffect(np.array([nearest]), effect.at(nearest)[None])


def _result(
    model: AeroModel, at: Effects, task: Task, values: dict[str, float], held: Mapping[str, float], beta: float | None
) -> Allocation:
    gap, scale = task.gap(values), task.scales()
    lacking = {
        name: float(short)
        for name, short, size in zip(task.wanted, gap, scale, strict=True)
        if abs(short) > _SOLVED * size
    }
    deflections = {name: held.get(name, values.get(name, 0.0)) for name in at.surfaces}
    unsure = {
        name: (left, right)
        for left, right in _blind_pairs(model, task.wanted)
        if abs(deflections[left] - deflections[right]) > _AT_LIMIT
        for name in task.wanted
        if f"{name}_{left}" in model.unknown() and name in LATERAL
    }
    lacking |= dict.fromkeys(unsure, math.nan)
    free = {name: at.surfaces[name].deflection for name in at.surfaces if name not in held}
    ends = {name: [end for end in (float(d[0]), float(d[-1])) if end != 0.0] for name, d in free.items()}
    distance = {name: min((abs(end - deflections[name]) for end in e), default=math.inf) for name, e in ends.items()}
    saturated = tuple(name for name, value in distance.items() if value < _AT_LIMIT)
    reasons = [_why(model, task, name, short) for name, short in lacking.items() if name not in unsure]
    reasons += [f"{name} of {left} and {right} unknown where they differ" for name, (left, right) in unsure.items()]
    if lacking and saturated:
        reasons.append(f"at the limit: {', '.join(saturated)}")
    return Allocation(
        deflections=deflections,
        beta=values.get(SIDESLIP, beta or 0.0),
        coefficients=dict(zip(FORCES_AND_MOMENTS, task.total(values).tolist(), strict=True)),
        lacking=lacking,
        saturated=saturated,
        margin=min(distance.values(), default=math.inf),
        reason="; ".join(reasons),
    )


def _why(model: AeroModel, task: Task, name: str, short: float) -> str:
    """What a coefficient needs and what there is."""
    row = FORCES_AND_MOMENTS.index(name)
    needed = task.wanted[name] - task.base[row]
    if any(np.nanmax(np.abs(effect.increments[:, row])) > 0.0 for effect in task.movers.values()):
        return f"needs {name} {needed:.4g} from the surfaces, {needed - short:.4g} within limits"
    unknown = [f"{name}_{surface}" for surface in model.surfaces if f"{name}_{surface}" in model.unknown()]
    text = f" ({', '.join(unknown)} unknown)" if unknown else ""
    return f"needs {name} {needed:.4g} from the surfaces, none gives any{text}"


def _checked(
    wanted: Mapping[str, float] | None, held: Mapping[str, float] | None, model: AeroModel
) -> tuple[dict[str, float], dict[str, float]]:
    wanted = dict.fromkeys(MOMENTS, 0.0) if wanted is None else dict(wanted)
    held = dict(held or {})
    for name in wanted:
        if name not in FORCES_AND_MOMENTS:
            raise InputError(unknown_name("coefficient", name, FORCES_AND_MOMENTS))
    for name in held:
        if name not in model.surfaces:
            raise InputError(unknown_name("control surface of the model", name, model.surfaces))
    for name, value in {**wanted, **held}.items():
        if not math.isfinite(value):
            raise InputError(f"{name} = {value}: must be a finite number")
    return wanted, held
