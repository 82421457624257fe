"""MIL-F-8785C 3.2.1.2: the phugoid."""

from __future__ import annotations

from collections.abc import Sequence

from spaceplane.dynamics.modes import Mode
from spaceplane.qualities import limits
from spaceplane.qualities.verdict import BELOW, Context, Level, Verdict, absent, of_kind


def phugoid(modes: Sequence[Mode], context: Context) -> list[Verdict]:
    """Damping ratio of the phugoid, at level 3 its time to double; so of other oscillations of airspeed that grow.

    An oscillation of pitch with speed, or of pitch with roll, is no phugoid. Where it grows it is held to the limits of
    one, the mildest of all on an oscillation, for no other paragraph holds it.
    """
    entry = limits.specification()["phugoid"]
    zeta1, zeta2 = entry["damping_ratio_low"]
    slowest = entry["double_time_low_s"]
    text = {"1": f">= {zeta1:.4g}", "2": f">= {zeta2:.4g}", "3": f"time to double >= {slowest:.4g} s"}
    found = of_kind(modes, "phugoid", "path_oscillation")
    found += [m for m in of_kind(modes, "third_oscillation", "coupled_oscillation") if m.double_time is not None]
    if not found:
        others = of_kind(
            modes, "path_aperiodic", "height", "pitch_speed_aperiodic", "third_oscillation", "coupled_aperiodic"
        )
        return [absent(context, "phugoid", "phugoid", "damping ratio", others)]
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
