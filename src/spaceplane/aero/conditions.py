"""Which free streams are solved to know the derivatives at a flight point."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from spaceplane.environment.atmosphere import Ambient
from spaceplane.errors import InputError
from spaceplane.flow.solution import PERFECT, FlowConditions
from spaceplane.vehicle.properties import ReferenceLengths

BASE = "base"
RATES = ("p", "q", "r")
LARGEST_RATE = 0.05
"""Reduced rate: a wing tip then moves at a twentieth of the flight speed, well within what is linear."""
QUANTITIES = ("alpha", "mach", "beta", *RATES)
"""What is varied about a flight point."""
MIRRORED = ("beta", "p", "r")
"""Quantities that change sign in a mirror; at zero one side of them stands for the other on a symmetric vehicle."""


class AeroPoint(Protocol):
    """What the aerodynamic stage needs of a flight point.

    Attributes:
        mach: Mach number.
        alpha: angle of attack, rad.
        beta: sideslip, rad, wind from the right positive.
        ambient: undisturbed air, which a gas that is not perfect needs.
    """

    mach: float
    alpha: float
    beta: float
    ambient: Ambient


@dataclass(frozen=True)
class DerivativeSteps:
    """Steps of the difference quotients.

    Attributes:
        alpha: angle-of-attack step, rad.
        beta: sideslip step, rad.
        mach_fraction: Mach step as a fraction of the Mach number.
        rate: step of the reduced rates p b/2V, q c/2V and r b/2V; 0 leaves the damping derivatives out.
        two_step_sizes: also solve at half the steps, for Richardson's extrapolation and error estimate.
    """

    alpha: float = math.radians(1.0)
    beta: float = math.radians(2.0)
    mach_fraction: float = 0.05
    rate: float = 0.01
    two_step_sizes: bool = False

    def __post_init__(self) -> None:
        for name, value, upper in (
            ("alpha", self.alpha, math.radians(10.0)),
            ("beta", self.beta, math.radians(10.0)),
            ("mach_fraction", self.mach_fraction, 0.3),
        ):
            if not (math.isfinite(value) and 0.0 < value <= upper):
                raise InputError(f"derivative step {name} = {value}: above 0 and at most {upper:.4g}")
        if not (math.isfinite(self.rate) and 0.0 <= self.rate <= LARGEST_RATE):
            raise InputError(f"derivative step rate = {self.rate}: 0 to {LARGEST_RATE:g}")


@dataclass(frozen=True)
class Variation:
    """One varied quantity of a flight point and the conditions that hold its two sides.

    Attributes:
        quantity: "alpha", "beta", "mach", "p", "q" or "r".
        step: full distance from the base to either side, rad, Mach number or reduced rate.
        plus: index of the condition at base + step.
        minus: index of the condition at base - step; None where the mirrored `plus` stands for it.
    """

    quantity: str
    step: float
    plus: int
    minus: int | None


@dataclass(frozen=True)
class PointPlan:
    """Conditions of one flight point.

    Attributes:
        base: index of the base condition.
        variations: steps around it; with two step sizes the full step comes before the half one.
    """

    base: int
    variations: tuple[Variation, ...]

    def of(self, quantity: str) -> tuple[Variation, ...]:
        """Variations of one quantity, largest step first."""
        return tuple(v for v in self.variations if v.quantity == quantity)


@dataclass(frozen=True)
class ConditionPlan:
    """An ensemble of free streams and what each is for.

    Attributes:
        conditions: the ensemble, in the order of the solver.
        labels: [condition] base, alpha+, alpha-, mach+, mach-, beta (or beta+, beta-), p, q+, q-, r, with "/2" for half
            steps.
        point: [condition] index of the flight point.
        points: one PointPlan per flight point.
    """

    conditions: FlowConditions
    labels: tuple[str, ...]
    point: np.ndarray
    points: tuple[PointPlan, ...]


def plan(
    points: list[AeroPoint],
    steps: DerivativeSteps,
    symmetric: bool = True,
    gamma: float = 1.4,
    reference: ReferenceLengths | None = None,
    gas: str = PERFECT,
    quantities: Sequence[str] = QUANTITIES,
) -> ConditionPlan:
    """Expand flight points into the ensemble that gives their derivatives.

    Args:
        points: flight points with `mach`, `alpha` and `beta` (rad).
        steps: difference steps.
        symmetric: whether the vehicle is its own mirror image; then one side of sideslip is solved and mirrored
            (at a base sideslip of zero only).
        gamma: ratio of specific heats.
        reference: chord, span and moment centre, SI, for steady rates; None leaves the damping derivatives out.
        gas: name in `flow.solution.GASES`.
        quantities: those of `QUANTITIES` that are varied.

    Raises:
        InputError: a Mach number that is not positive and finite, or an angle that is not finite.
    """
    ensemble = _Ensemble(reference if steps.rate > 0.0 else None)
    rates = dict.fromkeys(RATES, steps.rate) if ensemble.reference is not None else {}
    plans = []
    for number, point in enumerate(points):
        _check(point)
        base = ensemble.add(number, point, BASE, {})
        variations = []
        for scale, mark in ((1.0, ""), (0.5, "/2")) if steps.two_step_sizes else ((1.0, ""),):
            sizes = {"alpha": steps.alpha, "mach": steps.mach_fraction * point.mach, "beta": steps.beta}
            sizes |= rates
            for quantity, full in sizes.items():
                if quantity not in quantities:
                    continue
                size = full * scale
                mirrored = quantity in MIRRORED and symmetric and point.beta == 0.0
                plus = ensemble.add(number, point, f"{quantity}{'' if mirrored else '+'}{mark}", {quantity: size})
                minus = None if mirrored else ensemble.add(number, point, f"{quantity}-{mark}", {quantity: -size})
                variations.append(Variation(quantity, size, plus, minus))
        plans.append(PointPlan(base, tuple(variations)))
    streams = ensemble.conditions(gamma)
    if gas != PERFECT:
        streams = in_air(streams, gas, [points[number].ambient for number in ensemble.owner])
    return ConditionPlan(streams, tuple(ensemble.labels), np.array(ensemble.owner), tuple(plans))


class _Ensemble:
    """Collects conditions while a plan is made."""

    def __init__(self, reference: ReferenceLengths | None) -> None:
        self.reference = reference
        self.rows: list[list[float]] = []
        self.labels: list[str] = []
        self.owner: list[int] = []

    def add(self, number: int, point: AeroPoint, label: str, change: dict[str, float]) -> int:
        """Append flight point `number` changed by `change`; return the index of the condition."""
        at = [float(getattr(point, key)) + change.get(key, 0.0) for key in ("mach", "alpha", "beta")]
        self.rows.append(at + [change.get(key, 0.0) for key in RATES])
        self.labels.append(label)
        self.owner.append(number)
        return len(self.rows) - 1

    def conditions(self, gamma: float) -> FlowConditions:
        """All of them as the solver wants them."""
        table = np.array(self.rows, dtype=float).reshape(-1, 6)
        streams = FlowConditions(*np.ascontiguousarray(table[:, :3].T), gamma)
        return streams if self.reference is None else turning(streams, table[:, 3:], self.reference)


def turning(conditions: FlowConditions, reduced: np.ndarray, reference: ReferenceLengths) -> FlowConditions:
    """The conditions with steady rates about the moment centre.

    Args:
        conditions: free streams.
        reduced: [condition, (p, q, r)] reduced rates p b/2V, q c/2V, r b/2V.
        reference: chord c, span b and moment centre, SI.
    """
    lengths = np.array([reference.span, reference.chord, reference.span])
    rates = np.asarray(reduced, dtype=float) * 2.0 * conditions.mach[:, None] / lengths
    return replace(conditions, rates=rates, center=tuple(float(v) for v in reference.moment_center))


def in_air(conditions: FlowConditions, gas: str, ambient: Sequence[Ambient]) -> FlowConditions:
    """The conditions in a gas that is not perfect, with the undisturbed air of each."""
    density, pressure = (np.array([getattr(air, name) for air in ambient]) for name in ("density", "pressure"))
    return replace(conditions, gas=gas, density=density, pressure=pressure)


def product(machs: list[float], alphas: list[float], betas: list[float], gamma: float = 1.4) -> FlowConditions:
    """Every combination of Mach number, angle of attack and sideslip (rad), Mach varying slowest, beta fastest.

    Raises:
        InputError: an empty list, or a value that no flow can have.
    """
    grid = [(m, a, b) for m in machs for a in alphas for b in betas]
    if not grid:
        raise InputError("conditions: at least one Mach number, one alpha and one beta are needed")
    for m, a, b in grid:
        if not (math.isfinite(m) and m > 0.0):
            raise InputError(f"mach = {m}: a positive number is needed")
        if not (math.isfinite(a) and abs(a) <= math.pi / 2):
            raise InputError(f"alpha = {math.degrees(a):g} deg: between -90 and 90 deg")
        if not (math.isfinite(b) and abs(b) <= math.pi / 2):
            raise InputError(f"beta = {math.degrees(b):g} deg: between -90 and 90 deg")
    return FlowConditions(*np.ascontiguousarray(np.array(grid, dtype=float).T), gamma)


def _check(point: AeroPoint) -> None:
    if not (math.isfinite(point.mach) and point.mach > 0.0):
        raise InputError(f"mach = {point.mach}: a positive number is needed")
    for name in ("alpha", "beta"):
        value = getattr(point, name)
        if not math.isfinite(value):
            raise InputError(f"{name} = {value}: a finite angle in rad is needed")
