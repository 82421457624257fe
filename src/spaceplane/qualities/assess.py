"""Verdicts of MIL-F-8785C on eigenmodes: level, value, limits, margin, or why a criterion does not apply and what does.

A criterion is met at the best level whose limits the value meets. Where several quantities count (Dutch roll; short
period), the level is the worst of theirs. Aperiodic motion has no damping ratio, and none is made up for it: the
growing one is held against its time to double where the specification has such a limit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field

import numpy as np

from spaceplane.dynamics.modes import Mode
from spaceplane.qualities import limits

BELOW = "below 3"
Level = int | str | None


@dataclass(frozen=True)
class Verdict:
    """One criterion on one mode.

    Attributes:
        mode: name of the mode, or of the mode that the criterion asks for and that is absent.
        criterion: title of the criterion.
        quantity: what is measured, for example "damping ratio".
        paragraph: of MIL-F-8785C.
        vehicle_class: I, II-L, II-C, III or IV.
        category: flight phase category A, B or C.
        value: measured value; None if there is none.
        unit: of value, limits and margin.
        limits: {"1": text, ...} per level.
        level: 1, 2, 3, "below 3", or None if the criterion does not apply.
        margin: distance of the value to the nearest bound of level 1, positive inside; None if there is no value.
        applicable: whether the criterion applies.
        note: what applies instead, or how the value was formed.
    """

    mode: str
    criterion: str
    quantity: str
    paragraph: str
    vehicle_class: str
    category: str
    value: float | None = None
    unit: str = ""
    limits: dict[str, str] = field(default_factory=dict)
    level: Level = None
    margin: float | None = None
    applicable: bool = True
    note: str = ""


@dataclass(frozen=True)
class _Context:
    vehicle_class: str
    category: str

    def verdict(self, criterion: str, mode: str, quantity: str, **values: object) -> Verdict:
        """A verdict with title and paragraph of the criterion; `values` are the other fields of `Verdict`."""
        entry = limits.specification()[criterion]
        return Verdict(
            mode,
            entry["title"],
            quantity,
            entry["paragraph"],
            self.vehicle_class,
            self.category,
            **values,  # type: ignore[arg-type]
        )

    def entry(self, criterion: str) -> dict:
        """Limits of the criterion for this class and category."""
        return limits.of(criterion, self.category, self.vehicle_class)  # type: ignore[return-value]


def assess(
    modes: Sequence[Mode], vehicle_class: str = "III", category: str = "B", n_alpha: float | None = None
) -> tuple[Verdict, ...]:
    """Hold modes against MIL-F-8785C: phugoid, short period, Dutch roll, roll mode, spiral.

    Every criterion answers, if only to say that it does not apply and why.

    Args:
        modes: of `spaceplane.dynamics.modes.identify`.
        vehicle_class: I, II-L, II-C, III or IV.
        category: flight phase category A, B or C.
        n_alpha: load factor per angle of attack, g/rad, for the control anticipation parameter.

    Raises:
        InputError: unknown class or category.
    """
    limits.check(vehicle_class, category)
    context = _Context(vehicle_class, category)
    return (
        *_phugoid(modes, context),
        *_static_stability(modes, context),
        *_short_period(modes, context, n_alpha),
        *_dutch_roll(modes, context),
        *_roll(modes, context),
        *_spiral(modes, context),
        *_roll_spiral(modes, context),
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


def worst(levels: Sequence[Level]) -> Level:
    """The worst of some levels; None stands for no requirement and is passed over."""
    order: dict[Level, int] = {1: 1, 2: 2, 3: 3, BELOW: 4}
    known = [level for level in levels if level is not None]
    return max(known, key=lambda level: order[level]) if known else None


def to_record(verdict: Verdict) -> dict:
    """The verdict as plain JSON types."""
    return asdict(verdict)


def _level_of_least(value: float, lows: Sequence[float | None]) -> Level:
    """Best level whose least value is met; None means that a level sets no limit."""
    for level, low in enumerate(lows, start=1):
        if low is None or value >= low:
            return level
    return BELOW


def _level_of_range(value: float, lows: Sequence[float], highs: Sequence[float | None]) -> Level:
    for level, low in enumerate(lows, start=1):
        high = highs[level - 1] if level <= len(highs) else None
        if value >= low and (high is None or value <= high):
            return level
    return BELOW


def _least_text(lows: Sequence[float | None]) -> dict[str, str]:
    return {str(k): "not specified" if low is None else f">= {low:.4g}" for k, low in enumerate(lows, start=1)}


def _range_text(lows: Sequence[float], highs: Sequence[float | None]) -> dict[str, str]:
    text = {}
    for level, low in enumerate(lows, start=1):
        high = highs[level - 1] if level <= len(highs) else None
        text[str(level)] = f">= {low:.4g}" if high is None else f"{low:.4g} to {high:.4g}"
    return text


def _of_kind(modes: Sequence[Mode], *kinds: str) -> list[Mode]:
    return [mode for mode in modes if mode.kind in kinds]


def _describe(modes: Sequence[Mode]) -> str:
    """What some modes do, for a note."""
    texts = []
    for mode in modes:
        if mode.double_time is not None:
            texts.append(f"{mode.name}: doubles in {mode.double_time:.3g} s")
        elif mode.half_time is not None:
            texts.append(f"{mode.name}: halves in {mode.half_time:.3g} s")
    return "; ".join(texts)


def _absent(
    context: _Context, criterion: str, mode: str, quantity: str, instead: Sequence[Mode], oscillation: bool = True
) -> Verdict:
    """A criterion whose mode, an oscillation or not, does not exist; `instead` is what the vehicle does."""
    split = oscillation and any(not m.oscillatory for m in instead)
    reason = "not applicable: aperiodic" if split else f"not applicable: no {mode}"
    found = _describe(instead)
    return context.verdict(
        criterion, mode, quantity, applicable=False, note=f"{reason}. Instead {found}." if found else f"{reason}."
    )


def _phugoid(modes: Sequence[Mode], context: _Context) -> list[Verdict]:
    entry = limits.specification()["phugoid"]
    zeta1, zeta2 = entry["damping_ratio_low"]
    slowest = entry["double_time_low_s"]
    text = {"1": f">= {zeta1:.4g}", "2": f">= {zeta2:.4g}", "3": f"time to double >= {slowest:.4g} s"}
    found = _of_kind(modes, "phugoid", "path_oscillation")
    if not found:
        others = _of_kind(
            modes, "path_aperiodic", "height", "pitch_speed_aperiodic", "third_oscillation", "coupled_aperiodic"
        )
        return [_absent(context, "phugoid", "phugoid", "damping ratio", others)]
    verdicts = []
    for mode in found:
        zeta = float(mode.damping_ratio)  # type: ignore[arg-type]
        if zeta >= zeta1:
            level: Level = 1
        elif zeta >= zeta2:
            level = 2
        else:
            level = 3 if mode.double_time is None or mode.double_time >= slowest else BELOW
        note = f"doubles in {mode.double_time:.3g} s" if mode.double_time is not None else ""
        verdicts.append(
            context.verdict(
                "phugoid",
                mode.name,
                "damping ratio",
                value=zeta,
                limits=text,
                level=level,
                margin=zeta - zeta1,
                note=note,
            )
        )
    return verdicts


def _static_stability(modes: Sequence[Mode], context: _Context) -> list[Verdict]:
    """What takes the place of short period and phugoid on an aperiodic longitudinal divergence."""
    least = limits.specification()["static_stability"]["double_time_low_s"]
    kinds = ("pitch_aperiodic", "pitch_speed_aperiodic", "path_aperiodic")
    verdicts = []
    for mode in _of_kind(modes, *kinds):
        if mode.double_time is None:
            continue
        verdicts.append(
            context.verdict(
                "static_stability",
                mode.name,
                "time to double",
                value=mode.double_time,
                unit="s",
                limits={"1": "no aperiodic divergence", "2": "no aperiodic divergence", "3": f">= {least:.4g}"},
                level=3 if mode.double_time >= least else BELOW,
                margin=mode.double_time - least,
                note="margin is to level 3; levels 1 and 2 allow no aperiodic divergence, level 3 by approval only",
            )
        )
    return verdicts


def _short_period(modes: Sequence[Mode], context: _Context, n_alpha: float | None) -> list[Verdict]:
    pairs = [(m.name, m.natural_frequency, m.damping_ratio or 0.0, "") for m in _of_kind(modes, "short_period")]
    aperiodic = _of_kind(modes, "pitch_aperiodic", "pitch_speed_aperiodic", "third_oscillation")
    if not pairs:
        stable = [m for m in _of_kind(modes, "pitch_aperiodic") if m.stable]
        if len(stable) == 2 and all(m.stable for m in aperiodic):
            a, b = (m.eigenvalue.real for m in stable)
            omega = math.sqrt(a * b)
            note = "overdamped: two stable real roots taken as one short period of damping ratio above 1"
            pairs = [("short period (overdamped)", omega, -(a + b) / (2 * omega), note)]
    if not pairs:
        return [
            _absent(context, "short_period_damping", "short period", "damping ratio", aperiodic),
            _absent(context, "short_period_frequency", "short period", "omega^2 / (n/alpha)", aperiodic),
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
                limits=_range_text(lows, highs),
                level=_level_of_range(zeta, lows, highs),
                margin=min(zeta - lows[0], highs[0] - zeta),
                note=note,
            )
        )
        verdicts.append(_anticipation(context, name, omega, n_alpha))
    return verdicts


def _anticipation(context: _Context, name: str, omega: float, n_alpha: float | None) -> Verdict:
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
    levels: list[Level] = [_level_of_range(value, lows, highs)]
    notes = [f"n/alpha = {n_alpha:.3g} g/rad"]
    for key, measured, label in (("frequency_low", omega, "omega"), ("load_low", n_alpha, "n/alpha")):
        least = entry.get(key)
        least = least.get(context.vehicle_class) if isinstance(least, dict) else least
        if least:
            level = _level_of_least(measured, [*least, None])
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
        limits=_range_text(lows, highs),
        level=worst(levels),
        margin=min(value - lows[0], highs[0] - value),
        note="; ".join(notes),
    )


def _dutch_roll(modes: Sequence[Mode], context: _Context) -> list[Verdict]:
    found = _of_kind(modes, "dutch_roll", "lateral_oscillation")
    if not found:
        others = _of_kind(modes, "yaw_aperiodic", "roll_yaw_aperiodic", "roll_aperiodic", "coupled_oscillation")
        return [_absent(context, "dutch_roll", "Dutch roll", "damping ratio, frequency and their product", others)]
    verdicts: list[Verdict] = []
    for mode in found:
        verdicts.extend(_dutch_roll_of(mode, context))
    return verdicts


def _dutch_roll_of(mode: Mode, context: _Context) -> list[Verdict]:
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
            limits=_least_text(lows),
            level=_level_of_least(value, lows),
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


def _product_limits(mode: Mode, base: Sequence[float], context: _Context) -> tuple[list[float | None], str]:
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


def _roll(modes: Sequence[Mode], context: _Context) -> list[Verdict]:
    highs: Sequence[float] = context.entry("roll")  # type: ignore[assignment]
    found = _of_kind(modes, "roll")
    if not found:
        others = _of_kind(modes, "roll_aperiodic", "roll_yaw_aperiodic", "yaw_aperiodic", "roll_spiral_oscillation")
        verdict = _absent(context, "roll", "roll mode", "time constant", others, oscillation=False)
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


def _spiral(modes: Sequence[Mode], context: _Context) -> list[Verdict]:
    lows: Sequence[float] = context.entry("spiral")  # type: ignore[assignment]
    found = _of_kind(modes, "spiral")
    if not found:
        others = _of_kind(modes, "roll_yaw_aperiodic", "yaw_aperiodic", "roll_spiral_oscillation", "coupled_aperiodic")
        return [_absent(context, "spiral", "spiral", "time to double", others, oscillation=False)]
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
                limits=_least_text(lows),
                level=1 if time is None else _level_of_least(time, lows),
                margin=None if time is None else time - lows[0],
                note=f"stable: halves in {mode.half_time:.4g} s" if mode.half_time is not None else "",
            )
        )
    return verdicts


def _roll_spiral(modes: Sequence[Mode], context: _Context) -> list[Verdict]:
    """Only where roll mode and spiral have joined into an oscillation."""
    lows = limits.specification()["roll_spiral"]["zeta_omega"]
    verdicts = []
    for mode in _of_kind(modes, "roll_spiral_oscillation"):
        product = -mode.eigenvalue.real
        allowed = context.category != "A"
        verdicts.append(
            context.verdict(
                "roll_spiral",
                mode.name,
                "damping ratio times frequency",
                value=product,
                unit="rad/s",
                limits=_least_text(lows) if allowed else {"1": "not allowed", "2": "not allowed", "3": "not allowed"},
                level=_level_of_least(product, lows) if allowed else BELOW,
                margin=product - lows[0],
                note="" if allowed else "category A allows no coupled roll-spiral oscillation",
            )
        )
    return verdicts
