"""MIL-F-8785C 3.3.1.2 to 3.3.1.4: roll mode, spiral, and both joined into an oscillation."""

from __future__ import annotations

from collections.abc import Sequence

from spaceplane.dynamics.modes import Mode
from spaceplane.qualities import limits
from spaceplane.qualities.verdict import BELOW, Context, Level, Verdict, absent, least_text, level_of_least, of_kind


def roll(modes: Sequence[Mode], context: Context) -> list[Verdict]:
    """Time constant of the roll mode."""
    highs: Sequence[float] = context.entry("roll")  # type: ignore[assignment]
    found = of_kind(modes, "roll")
    if not found:
        others = of_kind(modes, "roll_aperiodic", "roll_yaw_aperiodic", "yaw_aperiodic", "roll_spiral_oscillation")
        verdict = absent(context, "roll", "roll mode", "time constant", others, oscillation=False)
        return [verdict]
    verdicts = []
    for mode in found:
        tau = -1.0 / mode.eigenvalue.real
        level: Level = next((k for k, high in enumerate(highs, start=1) if tau <= high), BELOW)
        verdicts.append(
            context.verdict(
                "roll",
                mode.name,
                "time constant",
                value=tau,
                unit="s",
                limits={str(k): f"<= {high:.4g}" for k, high in enumerate(highs, start=1)},
                level=level,
                margin=highs[0] - tau,
            )
        )
    return verdicts


def spiral(modes: Sequence[Mode], context: Context) -> list[Verdict]:
    """Time to double of the spiral, and of whatever else takes the bank angle with it without oscillation.

    The paragraph limits how fast a bank angle may double, whatever the motion is called: an airframe that diverges in
    yaw and roll would otherwise meet every lateral criterion that still applies to it.
    """
    lows: Sequence[float] = context.entry("spiral")  # type: ignore[assignment]
    kinds = ("roll_aperiodic", "roll_yaw_aperiodic", "yaw_aperiodic", "coupled_aperiodic")
    found = of_kind(modes, "spiral") + [mode for mode in of_kind(modes, *kinds) if mode.double_time is not None]
    if not found:
        others = of_kind(modes, "roll_yaw_aperiodic", "yaw_aperiodic", "roll_spiral_oscillation", "coupled_aperiodic")
        return [absent(context, "spiral", "spiral", "time to double", others, oscillation=False)]
    verdicts = []
    for mode in found:
        time = mode.double_time
        verdicts.append(
            context.verdict(
                "spiral",
                mode.name,
                "time to double",
                value=time,
                unit="s",
                limits=least_text(lows),
                level=1 if time is None else level_of_least(time, lows),
                margin=None if time is None else time - lows[0],
                note="" if mode.half_time is None else f"stable: halves in {mode.half_time:.4g} s",
            )
        )
    return verdicts


def roll_spiral(modes: Sequence[Mode], context: Context) -> list[Verdict]:
    """Only where roll mode and spiral have joined into an oscillation."""
    lows = limits.specification()["roll_spiral"]["zeta_omega"]
    verdicts = []
    for mode in of_kind(modes, "roll_spiral_oscillation"):
        product = -mode.eigenvalue.real
        allowed = context.category != "A"
        verdicts.append(
            context.verdict(
                "roll_spiral",
                mode.name,
                "damping ratio times frequency",
                value=product,
                unit="rad/s",
                limits=least_text(lows) if allowed else {"1": "not allowed", "2": "not allowed", "3": "not allowed"},
                level=level_of_least(product, lows) if allowed else BELOW,
                margin=product - lows[0],
                note="" if allowed else "category A allows no coupled roll-spiral oscillation",
            )
        )
    return verdicts
