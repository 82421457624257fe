"""The mixed-integer linear program behind the allocation of deflections.

A mover is a surface, or the sideslip: it adds a function that is linear between nodes. Its value is a convex
combination of two neighbouring nodes, with one binary per interval (the special ordered sets of Beale and Tomlin,
1970). HiGHS solves it to the global optimum, so what it does not find does not exist.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp

from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.dynamics.trim.effects import SurfaceEffect

SIDESLIP = "beta"
_SUM_WEIGHT = 0.01  # of the sum of all uses, against the largest
_LACK_WEIGHT = 1e4  # of what is lacking, against uses
_INSIDE = 1e-7  # rad, from a limit


@dataclass(frozen=True)
class Task:
    """What is wanted and what may move for it.

    Attributes:
        base: [coefficient] totals, in the order of FORCES_AND_MOMENTS, with every mover at 0.
        movers: surfaces and, where it is free, "beta".
        wanted: coefficient -> its total.
        alike: pairs of movers that must have the same deflection.
    """

    base: np.ndarray
    movers: Mapping[str, SurfaceEffect]
    wanted: Mapping[str, float]
    alike: tuple[tuple[str, str], ...] = ()

    @property
    def rows(self) -> list[int]:
        """Places of the wanted coefficients in FORCES_AND_MOMENTS."""
        return [FORCES_AND_MOMENTS.index(name) for name in self.wanted]

    def scales(self) -> np.ndarray:
        """[wanted] what the strongest mover gives; 1 where none gives any."""
        largest = np.zeros(len(self.wanted))
        for effect in self.movers.values():
            largest = np.fmax(largest, np.nanmax(np.abs(effect.increments[:, self.rows]), axis=0))
        return np.where(largest > 0.0, largest, 1.0)

    def total(self, values: Mapping[str, float]) -> np.ndarray:
        """[coefficient] totals at values of the movers, rad."""
        return self.base + sum((self.movers[name].at(v) for name, v in values.items()), np.zeros(len(self.base)))

    def gap(self, values: Mapping[str, float]) -> np.ndarray:
        """[wanted] wanted less given at values of the movers, rad."""
        return np.array(list(self.wanted.values())) - self.total(values)[self.rows]


@dataclass
class _Columns:
    """Variables of the program, all of at least 0."""

    upper: list[float] = field(default_factory=list)
    cost: list[float] = field(default_factory=list)
    whole: list[int] = field(default_factory=list)

    def add(self, upper: float = np.inf, cost: float = 0.0, whole: bool = False) -> int:
        """Number of a new variable."""
        self.upper.append(upper)
        self.cost.append(cost)
        self.whole.append(int(whole))
        return len(self.upper) - 1


def solve(task: Task, exact: bool = True) -> dict[str, float] | None:
    """Values of the movers, rad, that use the most used surface least; None where there are none.

    Args:
        task: what is wanted.
        exact: meet all that is wanted; otherwise lack as little as possible, each coefficient on its scale.
    """
    columns, rows = _Columns(), []
    scale = task.scales()
    largest = columns.add(cost=1.0)
    balance: list[dict[int, float]] = [{} for _ in task.wanted]
    weights: dict[str, list[int]] = {}
    for name, effect in task.movers.items():
        weights[name] = _mover(columns, rows, effect, largest if name != SIDESLIP else None)
        contribution = np.nan_to_num(effect.increments[:, task.rows]) / scale
        for equation, column in zip(balance, contribution.T, strict=True):
            equation.update(zip(weights[name], column, strict=True))
    for equation, wanted, base, size in zip(balance, task.wanted.values(), task.base[task.rows], scale, strict=True):
        if not exact:
            equation[columns.add(cost=_LACK_WEIGHT)] = 1.0
            equation[columns.add(cost=_LACK_WEIGHT)] = -1.0
        rows.append((equation, (wanted - base) / size, (wanted - base) / size))
    for left, right in task.alike:
        row = dict(zip(weights[left], task.movers[left].deflection, strict=True))
        row |= dict(zip(weights[right], -task.movers[right].deflection, strict=True))
        rows.append((row, 0.0, 0.0))
    matrix = np.zeros((len(rows), len(columns.upper)))
    for index, (entries, _, _) in enumerate(rows):
        matrix[index, list(entries)] = list(entries.values())
    constraint = LinearConstraint(matrix, [row[1] for row in rows], [row[2] for row in rows])
    bounds = Bounds(0.0, np.array(columns.upper))
    found = milp(columns.cost, integrality=columns.whole, bounds=bounds, constraints=constraint)
    if found.x is None:
        return None
    values = {
        name: float(np.clip(found.x[weights[name]] @ effect.deflection, effect.deflection[0], effect.deflection[-1]))
        for name, effect in task.movers.items()
    }
    return _polished(task, values) if exact else values


def _mover(columns: _Columns, rows: list, effect: SurfaceEffect, largest: int | None) -> list[int]:
    """Add a mover and give the numbers of its node weights; `largest` is the variable above the use of surfaces."""
    nodes, known = effect.deflection, np.all(np.isfinite(effect.increments), axis=1)
    weights = [columns.add(1.0 if there else 0.0) for there in known]
    usable = [known[k : k + 2].all() for k in range(max(len(nodes) - 1, 1))]
    intervals = [columns.add(1.0 if there else 0.0, whole=True) for there in usable]
    for k, weight in enumerate(weights):  # only the nodes of the chosen interval
        beside = intervals[max(k - 1, 0) : k + 1]
        rows.append(({weight: 1.0, **dict.fromkeys(beside, -1.0)}, -np.inf, 0.0))
    for group in (weights, intervals):
        rows.append((dict.fromkeys(group, 1.0), 1.0, 1.0))
    use = columns.add(cost=_SUM_WEIGHT)
    for limit in (min(nodes[0], 0.0), max(nodes[-1], 0.0)):
        if limit:
            rows.append(({use: 1.0, **dict(zip(weights, -nodes / limit, strict=True))}, 0.0, np.inf))
    if largest is not None:
        rows.append(({largest: 1.0, use: -1.0}, 0.0, np.inf))
    return weights


def _polished(task: Task, values: dict[str, float]) -> dict[str, float]:
    """The same solution to round-off instead of the solver's tolerance, by Newton steps of least size."""
    movers, scale = task.movers, task.scales()
    inner = [
        name for name, e in movers.items() if e.deflection[0] + _INSIDE < values[name] < e.deflection[-1] - _INSIDE
    ]
    for _ in range(4 if inner else 0):
        gap = task.gap(values)
        slopes = [(_slope(movers[name], values[name])[task.rows] / scale) for name in inner]
        constraints = [[float(name == left) - float(name == right) for name in inner] for left, right in task.alike]
        matrix = np.vstack([np.column_stack(slopes), *constraints])
        right_side = np.concatenate([gap / scale, [values[r] - values[l] for l, r in task.alike]])  # noqa: E741
        step, *_ = np.linalg.lstsq(matrix, right_side, rcond=1e-9)
        trial = dict(values)
        for name, change in zip(inner, step, strict=True):
            trial[name] = float(np.clip(values[name] + change, movers[name].deflection[0], movers[name].deflection[-1]))
        if np.max(np.abs(task.gap(trial) / scale)) >= np.max(np.abs(gap / scale)):
            break
        values = trial
    return values


def _slope(effect: SurfaceEffect, value: float) -> np.ndarray:
    """[coefficient] slope of the interval that holds a value, 1/rad; at a node that of a known side."""
    quotients = np.diff(effect.increments, axis=0) / np.diff(effect.deflection)[:, None]
    index = int(np.clip(np.searchsorted(effect.deflection, value, side="right") - 1, 0, len(quotients) - 1))
    return quotients[index] if np.all(np.isfinite(quotients[index])) else quotients[index - 1]
