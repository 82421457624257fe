"""Modes followed along the Mach number through flight points that lie near enough to each other to be joined.

Between flight points models are made too where their maker is given, `STEP` apart; otherwise only those at the points
are known. Between known ones A is taken linear in the Mach number. That means something only where neighbours are
alike. How far they may differ is a choice of this project, told with every refusal.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from spaceplane.dynamics.flightpoint import FlightPoint
from spaceplane.dynamics.statespace import StateSpace, from_matrix
from spaceplane.dynamics.tracking import Branches, follow, interpolated

GREATEST_MACH_RATIO = 2.0
GREATEST_PRESSURE_RATIO = 3.0
GREATEST_ANGLE = math.radians(30.0)
"""Between neighbours, in angle of attack, path and bank angle, rad."""
STEP = 0.02
"""Greatest step between models of which A is interpolated, a share of the Mach number."""


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


def track(
    points: Sequence[FlightPoint],
    systems: Sequence[StateSpace | None],
    system_at: Callable[[float], StateSpace | None] | None = None,
) -> Tracked:
    """Follow the modes along the Mach number.

    Args:
        points: flight points in any order.
        systems: the linear model at each; None where there is none.
        system_at: the linear model at a Mach number between them, None where there is none; without it A is linear
            between the flight points.
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
    models = {points[k].mach: _bare(systems[k]) for k in longest}
    for mach in _between(grid) if system_at else ():
        found = system_at(mach)  # type: ignore[misc]
        if found is not None and found.states == systems[longest[0]].states:  # type: ignore[union-attr]
            models[mach] = _bare(found)
    fine = sorted(models)
    branches = follow(interpolated(fine, [models[mach] for mach in fine]), fine, "mach")
    given = np.isin(branches.dataset["mach"].values, grid)
    return Tracked(
        replace(branches, dataset=branches.dataset.assign_coords(given=("mach", given))), tuple(longest), tuple(reasons)
    )


def _bare(system: StateSpace | None) -> StateSpace:
    return from_matrix(system.A, system.states)  # type: ignore[union-attr]


def _between(grid: Sequence[float]) -> list[float]:
    """Mach numbers that part the steps of the grid into equal ratios of at most 1 + `STEP`."""
    found: list[float] = []
    for low, high in itertools.pairwise(grid):
        count = math.ceil(math.log(high / low) / math.log1p(STEP) - 1e-9)
        found += np.geomspace(low, high, count + 1)[1:-1].tolist()
    return found


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
