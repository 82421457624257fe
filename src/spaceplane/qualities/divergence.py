"""MIL-F-8785C 3.2.1.1: aperiodic divergence of pitch, speed and path."""

from __future__ import annotations

from collections.abc import Sequence

from spaceplane.dynamics.modes import Mode
from spaceplane.qualities import limits
from spaceplane.qualities.verdict import BELOW, Context, Verdict, of_kind


def divergence(modes: Sequence[Mode], context: Context) -> list[Verdict]:
    """What takes the place of short period and phugoid on an aperiodic longitudinal divergence."""
    least = limits.specification()["static_stability"]["double_time_low_s"]
    kinds = ("pitch_aperiodic", "pitch_speed_aperiodic", "path_aperiodic")
    verdicts = []
    for mode in of_kind(modes, *kinds):
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
