"""MIL-F-8785C 3.3.1.1: the Dutch roll and other lateral oscillations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spaceplane.dynamics.modes import Mode
from spaceplane.qualities import limits
from spaceplane.qualities.verdict import Context, Verdict, absent, least_text, level_of_least, of_kind, worst


def dutch_roll(modes: Sequence[Mode], context: Context) -> list[Verdict]:
    """Damping ratio, frequency and their product, and the worst of the three."""
    found = of_kind(modes, "dutch_roll", "lateral_oscillation")
    if not found:
        others = of_kind(modes, "yaw_aperiodic", "roll_yaw_aperiodic", "roll_aperiodic", "coupled_oscillation")
        return [absent(context, "dutch_roll", "Dutch roll", "damping ratio, frequency and their product", others)]
    verdicts: list[Verdict] = []
    for mode in found:
        verdicts.extend(_of_mode(mode, context))
    return verdicts


def _of_mode(mode: Mode, context: Context) -> list[Verdict]:
    entry = context.entry("dutch_roll")
    zeta, omega = float(mode.damping_ratio), mode.natural_frequency  # type: ignore[arg-type]
    product_lows, product_note = _product_limits(mode, entry["zeta_omega"], context)
    measured = (
        ("damping ratio", zeta, "", entry["zeta"], ""),
        ("damping ratio times frequency", zeta * omega, "rad/s", product_lows, product_note),
        ("natural frequency", omega, "rad/s", entry["omega"], ""),
    )
    verdicts = [
        context.verdict(
            "dutch_roll",
            mode.name,
            quantity,
            value=value,
            unit=unit,
            limits=least_text(lows),
            level=level_of_least(value, lows),
            margin=value - lows[0],
            note=note,
        )
        for quantity, value, unit, lows, note in measured
    ]
    levels = [v.level for v in verdicts]
    governing = worst(levels)
    by = ", ".join(v.quantity for v in verdicts if v.level == governing)
    overall = context.verdict(
        "dutch_roll",
        mode.name,
        "overall",
        level=governing,
        limits={str(k): "all three" for k in (1, 2, 3)},
        note=f"the worst of the three, set by {by}",
    )
    return [*verdicts, overall]


def _product_limits(mode: Mode, base: Sequence[float], context: Context) -> tuple[list[float | None], str]:
    """Limits of zeta omega at levels 1 to 3 with the class III relief and the rise for strong rolling."""
    entry = limits.specification()["dutch_roll"]
    lows: list[float | None] = [*base, None]
    notes = []
    ratio = _roll_to_sideslip(mode)
    if ratio is not None:
        excess = mode.natural_frequency**2 * ratio - entry["coupling_threshold"]
        if excess > 0:
            lows = [(low or 0.0) + slope * excess for low, slope in zip(lows, entry["coupling_slope"], strict=True)]
            notes.append(f"limits raised for omega^2 |phi/beta| = {excess + entry['coupling_threshold']:.3g} (rad/s)^2")
    cap = entry["zeta_required_at_most"].get(context.vehicle_class)
    if cap is not None:
        most = cap * mode.natural_frequency
        if any(low is not None and low > most for low in lows):
            lows = [None if low is None else min(low, most) for low in lows]
            notes.append(f"class {context.vehicle_class} needs no more than a damping ratio of {cap:g}")
    return lows, "; ".join(notes)


def _roll_to_sideslip(mode: Mode) -> float | None:
    """|phi/beta| of a mode; None if the system lacks either state."""
    component = dict(zip(mode.states, np.abs(mode.eigenvector), strict=True))
    bank = component.get("sigma", component.get("phi"))
    slip = component.get("beta")
    if bank is None or slip is None or slip == 0.0:
        return None
    return float(bank / slip)
