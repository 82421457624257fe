"""Modes followed along the Mach number through flight points that lie near enough to each other to be joined.

Only the linear models at the flight points are known; between them A is taken linear in the Mach number. That means
something only where neighbours are alike. How far they may differ is a choice of this project, told with every refusal.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from spaceplane.dynamics.flightpoint import FlightPoint
from spaceplane.dynamics.statespace import StateSpace, from_matrix
from spaceplane.dynamics.tracking import Branches, follow, interpolated

GREATEST_MACH_RATIO = 2.0
GREATEST_PRESSURE_RATIO = 3.0
GREATEST_ANGLE = math.radians(30.0)
"""Between neighbours, in angle of attack, path and bank angle, rad."""


@dataclass(frozen=True)
class Tracked:
    """Modes along the Mach number.

    Attributes:
        branches: through the longest run of neighbours; None where no two can be joined.
        used: indices of the flight points on it, by Mach number.
        reasons: why the run is not longer, one line for each gap.
    """

    branches: Branches | None
    used: tuple[int, ...]
    reasons: tuple[str, ...]


def track(points: Sequence[FlightPoint], systems: Sequence[StateSpace | None]) -> Tracked:
    """Follow the modes along the Mach number.

    Args:
        points: flight points in any order.
        systems: the linear model at each; None where there is none.
    """
    order = sorted(range(len(points)), key=lambda k: points[k].mach)
    runs: list[list[int]] = [[]]
    reasons = []
    for k in order:
        gap = _gap(points, systems, runs[-1][-1], k) if runs[-1] else ""
        if systems[k] is None:
            reasons.append(f"no linear model at {points[k].name}")
            runs.append([])
        elif gap:
            reasons.append(gap)
            runs.append([k])
        else:
            runs[-1].append(k)
    longest = max(runs, key=len)
    if len(longest) < 2:
        return Tracked(None, (), tuple(reasons or ["a single flight point"]))
    grid = [points[k].mach for k in longest]
    # eigenvalues need no inputs, and these may differ where a control derivative is missing
    models = [from_matrix(systems[k].A, systems[k].states) for k in longest]  # type: ignore[union-attr]
    return Tracked(follow(interpolated(grid, models), grid, "mach"), tuple(longest), tuple(reasons))


def _gap(points: Sequence[FlightPoint], systems: Sequence[StateSpace | None], a: int, b: int) -> str:
    """Why two neighbours are not joined; empty where they are."""
    one, other = points[a], points[b]
    between = f"between {one.name} and {other.name}"
    if one.mach == other.mach:
        return f"{between} the Mach number is the same"
    if systems[b] is not None and systems[a].states != systems[b].states:  # type: ignore[union-attr]
        return f"{between} the states of the linear models differ"
    if other.mach / one.mach > GREATEST_MACH_RATIO:
        return f"{between} the Mach number grows {other.mach / one.mach:.3g} times, at most {GREATEST_MACH_RATIO:g}"
    ratio = max(one.dynamic_pressure, other.dynamic_pressure) / min(one.dynamic_pressure, other.dynamic_pressure)
    if ratio > GREATEST_PRESSURE_RATIO:
        return f"{between} the dynamic pressure changes {ratio:.3g} times, at most {GREATEST_PRESSURE_RATIO:g}"
    for name, text in (("alpha", "angle of attack"), ("gamma", "path angle"), ("bank", "bank angle")):
        change = abs(getattr(other, name) - getattr(one, name))
        if change > GREATEST_ANGLE * (1 + 1e-9):
            return f"{between} the {text} changes by {math.degrees(change):.3g} deg, at most 30 deg"
    return ""
