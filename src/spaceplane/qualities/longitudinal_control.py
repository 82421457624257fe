"""MIL-F-8785C 3.2.1.1, 3.2.1.3, 3.2.2.2 and 3.2.3: the elevator over speed and load factor, and how far it reaches."""

from __future__ import annotations

import math

from spaceplane.environment.constants import STANDARD_GRAVITY
from spaceplane.qualities import limits
from spaceplane.qualities.airframe import Airframe
from spaceplane.qualities.glide_slope import gradient_at
from spaceplane.qualities.gradients import LoadGradient, SpeedGradient, load_gradient, pitches, speed_gradient
from spaceplane.qualities.verdict import AIRFRAME, BELOW, Context, Level, Verdict, level_of_most, most_text

KNOT = 1852.0 / 3600.0  # m/s
NO_ELEVATOR = "not applicable: no elevator with a pitching moment is known"


def verdicts(airframe: Airframe, context: Context) -> list[Verdict]:
    """All longitudinal requirements on trim gradients and control power."""
    arguments = (airframe.point, airframe.mass, airframe.reference, airframe.derivatives)
    by_speed, by_load = speed_gradient(*arguments), load_gradient(*arguments)
    return [
        _speed_stability(airframe, by_speed, context),
        _path_stability(by_speed, context),
        _path_stability_below(airframe, by_speed, context),
        _maneuver_stability(airframe, by_load, context),
        _trim_control(airframe, context),
        _maneuver_control(airframe, by_load, context),
    ]


def _speed_stability(airframe: Airframe, found: SpeedGradient | None, context: Context) -> Verdict:
    quantity = "nose-down elevator per airspeed"
    if found is None or found.elevator is None:
        return context.verdict("speed_stability", AIRFRAME, quantity, applicable=False, note=NO_ELEVATOR)
    sense = math.copysign(1.0, airframe.derivatives.control("Cm", "elevator"))
    value = -sense * math.degrees(found.elevator)
    return context.verdict(
        "speed_stability",
        AIRFRAME,
        quantity,
        value=value,
        unit="deg s/m",
        limits={"1": "> 0", "2": "> 0", "3": "see the divergence"},
        margin=value,
        met=value > 0,
        note="flying faster must take nose-down control; straight flight, wings level; no levels but by the divergence",
    )


def _path_stability(found: SpeedGradient | None, context: Context) -> Verdict:
    entry = limits.specification()["path_stability"]
    highs = entry["slope_high_deg_per_knot"]
    quantity = "path angle per airspeed"
    if found is None:
        return context.verdict(
            "path_stability", AIRFRAME, quantity, applicable=False, note="not applicable: no lift over angle of attack"
        )
    value = math.degrees(found.gamma) * KNOT
    applies = context.category in entry["categories"]
    note = "taken at this flight point, which must be the landing approach at the least operating speed"
    return context.verdict(
        "path_stability",
        AIRFRAME,
        quantity,
        value=value,
        unit="deg/knot",
        limits=most_text(highs),
        level=level_of_most(value, highs) if applies else None,
        margin=highs[0] - value,
        applicable=applies,
        note=note if applies else "not applicable: asked of the landing approach (category C) only",
    )


def _path_stability_below(airframe: Airframe, found: SpeedGradient | None, context: Context) -> Verdict:
    entry = limits.specification()["path_stability_below"]
    most, quantity = entry["change_high_deg_per_knot"], "path angle per airspeed, growth when slower"
    reason, slower = "", None
    if context.category not in entry["categories"]:
        reason = "asked of the landing approach (category C) only"
    elif found is not None:
        arguments = (airframe.point, airframe.mass, airframe.reference, airframe.derivatives)
        slower = gradient_at(-entry["slower_knots"] * KNOT, *arguments)
    if found is None or slower is None:
        note = f"not applicable: {reason or 'no glide at the lower speed'}"
        return context.verdict("path_stability_below", AIRFRAME, quantity, applicable=False, note=note)
    value = math.degrees(slower.gamma - found.gamma) * KNOT
    return context.verdict(
        "path_stability_below",
        AIRFRAME,
        quantity,
        value=value,
        unit="deg/knot",
        limits=most_text([most] * 3),
        margin=most - value,
        met=value <= most,
        note=f"{entry['slower_knots']:g} knots below this flight point; drag with the square of the lift; no levels",
    )


def _maneuver_stability(airframe: Airframe, found: LoadGradient | None, context: Context) -> Verdict:
    quantity = "nose-up elevator per load factor"
    if found is None:
        return context.verdict("maneuver_stability", AIRFRAME, quantity, applicable=False, note=NO_ELEVATOR)
    value = math.copysign(1.0, airframe.derivatives.control("Cm", "elevator")) * math.degrees(found.elevator)
    return context.verdict(
        "maneuver_stability",
        AIRFRAME,
        quantity,
        value=value,
        unit="deg/g",
        limits={"1": "> 0", "2": "> 0", "3": "> 0"},
        margin=value,
        met=value > 0,
        note=f"pull-up at constant speed; alpha changes by {math.degrees(found.alpha):.3g} deg/g; no levels",
    )


def _trim_control(airframe: Airframe, context: Context) -> Verdict:
    quantity = "elevator for trim"
    if not pitches(airframe.derivatives) or airframe.pitching_moment is None:
        note = "not applicable: C_m of the flight point is not known" if pitches(airframe.derivatives) else NO_ELEVATOR
        return context.verdict("trim_control", AIRFRAME, quantity, applicable=False, note=note)
    slope = airframe.derivatives.control("Cm", "elevator")
    needed = math.degrees(airframe.elevator - airframe.pitching_moment / slope)
    low, high = (math.degrees(x) for x in airframe.elevator_limits())
    text = f"{low:.4g} to {high:.4g}"
    return context.verdict(
        "trim_control",
        AIRFRAME,
        quantity,
        value=needed,
        unit="deg",
        limits={"1": text, "2": text, "3": text},
        margin=min(needed - low, high - needed),
        met=low <= needed <= high,
        note="by the slope of C_m at this flight point; limits are those of the surfaces; no levels",
    )


def _maneuver_control(airframe: Airframe, found: LoadGradient | None, context: Context) -> Verdict:
    quantity = "greatest load factor"
    if found is None or found.elevator == 0.0:
        note = NO_ELEVATOR if found is None else "not applicable: neutral, any load factor holds itself"
        return context.verdict("maneuver_control", AIRFRAME, quantity, applicable=False, note=note)
    here = airframe.point.dynamic_pressure * airframe.reference.area * airframe.point.coefficients()[0]
    here /= airframe.mass.mass * STANDARD_GRAVITY
    reach = sorted(here + (bound - airframe.elevator) / found.elevator for bound in airframe.elevator_limits())
    note = f"the elevator reaches {reach[0]:.3g} to {reach[1]:.3g} g by the slopes at this point ({here:.3g} g)"
    if airframe.load_factors is None:
        return context.verdict(
            "maneuver_control",
            AIRFRAME,
            quantity,
            value=reach[1],
            unit="g",
            applicable=False,
            note=f"not applicable: the operational load factors are not known; {note}",
        )
    entry = limits.specification()["maneuver_control"]
    low, high = airframe.load_factors
    relaxed = entry["level_3_high"] if high <= entry["level_3_knee"] else 0.5 * (high + 1.0)
    relaxed = min(relaxed, high)
    level: Level = BELOW
    if reach[0] <= entry["level_3_low"] and reach[1] >= relaxed:
        level = 3
    if reach[0] <= low and reach[1] >= high:
        level = 1
    return context.verdict(
        "maneuver_control",
        AIRFRAME,
        quantity,
        value=reach[1],
        unit="g",
        limits={
            "1": f"{low:.4g} to {high:.4g}",
            "2": f"{low:.4g} to {high:.4g}",
            "3": f"{entry['level_3_low']:.4g} to {relaxed:.4g}",
        },
        level=level,
        margin=min(reach[1] - high, low - reach[0]),
        note=note,
    )
