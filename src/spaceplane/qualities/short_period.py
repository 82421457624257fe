"""MIL-F-8785C 3.2.2.1: damping and frequency of the short period."""

from __future__ import annotations

import math
from collections.abc import Sequence

from spaceplane.dynamics.modes import Mode
from spaceplane.qualities.verdict import (
    Context,
    Level,
    Verdict,
    absent,
    level_of_least,
    level_of_range,
    of_kind,
    range_text,
    worst,
)


def short_period(modes: Sequence[Mode], context: Context, n_alpha: float | None) -> list[Verdict]:
    """Damping ratio and control anticipation parameter; `n_alpha` in g/rad."""
    pairs = [(m.name, m.natural_frequency, m.damping_ratio or 0.0, "") for m in of_kind(modes, "short_period")]
    aperiodic = of_kind(modes, "pitch_aperiodic", "pitch_speed_aperiodic", "third_oscillation")
    if not pairs:
        stable = [m for m in of_kind(modes, "pitch_aperiodic") if m.stable]
        if len(stable) == 2 and all(m.stable for m in aperiodic):
            a, b = (m.eigenvalue.real for m in stable)
            omega = math.sqrt(a * b)
            note = "overdamped: two stable real roots taken as one short period of damping ratio above 1"
            pairs = [("short period (overdamped)", omega, -(a + b) / (2 * omega), note)]
    if not pairs:
        return [
            absent(context, "short_period_damping", "short period", "damping ratio", aperiodic),
            absent(context, "short_period_frequency", "short period", "omega^2 / (n/alpha)", aperiodic),
        ]
    verdicts = []
    for name, omega, zeta, note in pairs:
        entry = context.entry("short_period_damping")
        lows, highs = entry["low"], entry["high"]
        verdicts.append(
            context.verdict(
                "short_period_damping",
                name,
                "damping ratio",
                value=zeta,
                limits=range_text(lows, highs),
                level=level_of_range(zeta, lows, highs),
                margin=min(zeta - lows[0], highs[0] - zeta),
                note=note,
            )
        )
        verdicts.append(_anticipation(context, name, omega, n_alpha))
    return verdicts


def _anticipation(context: Context, name: str, omega: float, n_alpha: float | None) -> Verdict:
    """Control anticipation parameter, with the least frequency and least n/alpha of categories A and C."""
    if n_alpha is None or n_alpha <= 0:
        return context.verdict(
            "short_period_frequency",
            name,
            "omega^2 / (n/alpha)",
            applicable=False,
            note="not applicable: n/alpha is not known",
        )
    entry = context.entry("short_period_frequency")
    lows, highs = entry["low"], entry["high"]
    value = omega**2 / n_alpha
    levels: list[Level] = [level_of_range(value, lows, highs)]
    notes = [f"n/alpha = {n_alpha:.3g} g/rad"]
    for key, measured, label in (("frequency_low", omega, "omega"), ("load_low", n_alpha, "n/alpha")):
        least = entry.get(key)
        least = least.get(context.vehicle_class) if isinstance(least, dict) else least
        if least:
            level = level_of_least(measured, [*least, None])
            levels.append(level)
            notes.append(
                f"{label} = {measured:.3g}, level 1 from {least[0]:g}, level 2 from {least[1]:g}: level {level}"
            )
    return context.verdict(
        "short_period_frequency",
        name,
        "omega^2 / (n/alpha)",
        value=value,
        unit="1/(g s2)",
        limits=range_text(lows, highs),
        level=worst(levels),
        margin=min(value - lows[0], highs[0] - value),
        note="; ".join(notes),
    )


def load_factor_slope(CL_alpha: float, dynamic_pressure: float, area: float, weight: float) -> float:
    """n/alpha, g/rad: steady normal load factor per angle of attack at constant speed, q S C_L_alpha / W.

    Args:
        CL_alpha: per rad.
        dynamic_pressure: Pa.
        area: reference area, m2.
        weight: N.
    """
    return dynamic_pressure * area * CL_alpha / weight
