"""Verdicts of MIL-F-8785C on eigenmodes: level, value, limits, margin, or why a criterion does not apply and what does.

A criterion is met at the best level whose limits the value meets. Where several quantities count (Dutch roll; short
period), the level is the worst of theirs. Aperiodic motion has no damping ratio, and none is made up for it: the
growing one is held against its time to double where the specification has such a limit.
"""

from __future__ import annotations

from collections.abc import Sequence

from spaceplane.dynamics.modes import Mode
from spaceplane.qualities import limits
from spaceplane.qualities.divergence import divergence
from spaceplane.qualities.dutch_roll import dutch_roll
from spaceplane.qualities.phugoid import phugoid
from spaceplane.qualities.roll_and_spiral import roll, roll_spiral, spiral
from spaceplane.qualities.short_period import load_factor_slope, short_period
from spaceplane.qualities.verdict import BELOW, Context, Level, Verdict, to_record, worst

__all__ = ["BELOW", "Level", "Verdict", "assess", "load_factor_slope", "to_record", "worst"]


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
    context = Context(vehicle_class, category)
    return (
        *phugoid(modes, context),
        *divergence(modes, context),
        *short_period(modes, context, n_alpha),
        *dutch_roll(modes, context),
        *roll(modes, context),
        *spiral(modes, context),
        *roll_spiral(modes, context),
    )
