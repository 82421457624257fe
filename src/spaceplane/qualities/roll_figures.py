"""MIL-F-8785C 3.3.2.2.1 and 3.3.2.3: limits of roll rate and bank angle oscillations over psi_beta, figures 4 and 5.

Each figure has three curves and two abscissae: one for a roll rate that leads the sideslip by 45 to 225 deg (positive
dihedral), one half a turn on for the rest. Changing the sign of the sideslip changes nothing of how the vehicle rolls
and turns both psi_beta and the lead by 180 deg, so that the second follows from the first.
"""

from __future__ import annotations

import math

import numpy as np

from spaceplane.dynamics.statespace import StateSpace
from spaceplane.qualities import limits
from spaceplane.qualities.roll_oscillation import RollOscillation, roll_oscillation
from spaceplane.qualities.verdict import AIRFRAME, Context, Level, Verdict, level_of_most, most_text

QUANTITIES = {
    "roll_rate_oscillation_small": "oscillation over average, p_osc/p_av",
    "bank_oscillation": "oscillation over average, phi_osc/phi_av",
}


def abscissa(phase: float, lead: float, bounds: tuple[float, float]) -> float:
    """psi_beta on the figures' first abscissa, deg, above -360 and up to 0.

    Args:
        phase: psi_beta, deg.
        lead: angle by which roll rate leads sideslip, deg.
        bounds: leads, deg, between which the first abscissa holds.
    """
    first = bounds[0] <= lead % 360.0 <= bounds[1]
    return -((-phase if first else 180.0 - phase) % 360.0)


def curve_limits(criterion: str, category: str, at: float | None) -> list[float]:
    """Greatest ratios at levels 1 and 2 from the curves of the category.

    Args:
        criterion: "roll_rate_oscillation_small" or "bank_oscillation".
        category: flight phase category A, B or C.
        at: place on the first abscissa, deg; None for the least of each curve.
    """
    entry = limits.specification()[criterion]
    found = []
    for name in entry[category]:
        x, y = np.array(entry["curves"][name]).T
        found.append(float(y.min()) if at is None else float(np.interp(at, x[::-1], y[::-1], period=360.0)))
    return found


def verdicts(system: StateSpace, context: Context, reason: str = "") -> list[Verdict]:
    """Two verdicts: roll rate after a small step, bank angle after an impulse of the aileron.

    Args:
        system: rigid-body linear model.
        context: class and category.
        reason: why there is no aileron to move, if there is none.
    """
    found = None if reason else roll_oscillation(system)
    if found is None:
        note = reason or "not applicable: nothing lateral oscillates, or it diverges aperiodically within a period"
        return [context.verdict(key, AIRFRAME, QUANTITIES[key], applicable=False, note=note) for key in QUANTITIES]
    return [
        _verdict("roll_rate_oscillation_small", found.rate_ratio, found.rate_phase, found, context),
        _verdict("bank_oscillation", found.bank_ratio, found.bank_phase, found, context),
    ]


def _verdict(
    criterion: str, value: float | None, phase: float | None, found: RollOscillation, context: Context
) -> Verdict:
    entry = limits.specification()[criterion]
    at, said = None, "the aileron does not excite it in sideslip: the least limits of each curve"
    if phase is not None and found.lead is not None:
        psi, lead = math.degrees(phase), math.degrees(found.lead)
        at = abscissa(psi, lead, tuple(entry["first_abscissa_lead_deg"]))
        said = f"ψ_beta {psi:.0f} deg, roll rate leads sideslip by {lead:.0f} deg"
    highs = curve_limits(criterion, context.category, at)
    level = _level(value, highs)
    tolerance = entry["reading_tolerance_deg"]
    notes = [f"{said}; damping ratio {found.damping_ratio:.2g}"]
    if value is None:
        notes.append("on the average it rolls against the aileron")
    if at is not None:
        near = {_level(value, curve_limits(criterion, context.category, at + d)) for d in (-tolerance, 0.0, tolerance)}
        doubt = f", within which the level is {min(near)} to {max(near)}" if len(near) > 1 else ""
        notes.append(f"limits read from figure {entry['figure']} to ±{tolerance:.0f} deg{doubt}")
    return context.verdict(
        criterion,
        AIRFRAME,
        QUANTITIES[criterion],
        value=value,
        limits=most_text([*(float(f"{high:.3g}") for high in highs), None]),
        level=level,
        margin=None if value is None else highs[0] - value,
        note="; ".join(notes),
    )


def _level(value: float | None, highs: list[float]) -> Level:
    return 3 if value is None else level_of_most(value, [*highs, None])
