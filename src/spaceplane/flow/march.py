"""Iterate an ensemble on one level: CFL feedback, stopping and failure by condition."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from spaceplane.flow.ensemble import Ensemble, padded
from spaceplane.flow.settings import FlowSettings

ACCELERATED_BELOW_MACH, ACCELERATED_AFTER_DROP = 2.0, 2.0
"""Anderson acceleration drives blunt-base flows apart at Mach 2.5 and more, until they are close to steady."""

HOLD_SENSOR_AFTER = 20
"""Iterations after which, while the residual is near its best, the shock sensor may only rise: cells stop flipping."""

REJECTED_RISE = 2.5
"""A step after which the residual is this many times the last one is taken back."""


@dataclass
class History:
    """What one condition did on one level."""

    residual: list[float] = field(default_factory=list)
    force: list[np.ndarray] = field(default_factory=list)
    failure: str = ""
    done: bool = False

    def drop(self) -> float:
        """Decades that the residual has fallen since the first iteration."""
        first, last = self.residual[0], self.residual[-1]
        return float(np.log10(max(first, 1e-300) / max(last, 1e-300)))

    def spread(self, window: int) -> float:
        """Half peak-to-peak of the force over the last `window` iterations, on the mean force's size."""
        force = np.array(self.force[-window:])
        scale = max(float(np.linalg.norm(force.mean(axis=0))), 1e-6)
        return float(0.5 * np.ptp(force, axis=0).max() / scale)


@dataclass(frozen=True)
class Caution:
    """How boldly to march: raised when a condition is retried by itself."""

    cfl_start: float
    cfl_max: float
    growth: float = 1.5
    largest: float = 0.4


def starting_cfl(mach: np.ndarray, caution: Caution, impulsive: bool) -> np.ndarray:
    """[lane] first CFL number: a fifth of `cfl_start` from the free stream; falling between Mach 2 and 5, there to 1
    or 5."""
    first = caution.cfl_start * (0.2 if impulsive else 1.0)
    lowest = min(first, 1.0 if impulsive else 5.0)
    return first + np.clip((mach - 2.0) / 3.0, 0.0, 1.0) * (lowest - first)


def highest_cfl(mach: np.ndarray, caution: Caution) -> np.ndarray:
    """[lane] largest CFL number: `cfl_max`, falling to 20 between Mach 2 and 5, where larger ones gain nothing."""
    return np.minimum(caution.cfl_max, 20.0 + np.clip((5.0 - mach) / 3.0, 0.0, 1.0) * max(caution.cfl_max - 20.0, 0.0))


class Steering:
    """What drives each lane: CFL number, memory of the residual, whether acceleration is trusted.

    Attributes:
        cfl, ceiling: [lane] CFL number and the largest it may reach.
        before, best: [lane] last and smallest residual; None before the first.
        limited: [lane] share of cells held back in the last step.
        trusted: [lane] whether Anderson acceleration may be used.
    """

    def __init__(self, mach: np.ndarray, caution: Caution, impulsive: bool):
        self.caution = caution
        self.cfl = starting_cfl(mach, caution, impulsive)
        self.ceiling = highest_cfl(mach, caution)
        self.limited = np.zeros(len(mach))
        self.trusted = mach < ACCELERATED_BELOW_MACH
        self.before: np.ndarray | None = None
        self.best: np.ndarray | None = None

    def rejected(self, norms: np.ndarray) -> np.ndarray:
        """[lane] whether the last step made things so much worse that it is taken back; its CFL number falls."""
        if self.before is None:
            return np.zeros(len(norms), dtype=bool)
        bad = ~(norms < REJECTED_RISE * self.before) & (self.cfl > 1.0)
        self.cfl = np.where(bad, np.maximum(0.3 * self.cfl, 1.0), self.cfl)
        return bad

    def advance(self, norms: np.ndarray, drop: np.ndarray) -> np.ndarray:
        """Take in the residuals and their drop in decades; [lane] whether the next step may be accelerated."""
        calm = np.ones(len(norms), dtype=bool)
        if self.before is not None:
            self.cfl = np.minimum(self.feedback(norms), self.ceiling)
            # Once the residual has risen well above its best, the condition goes on without acceleration.
            self.trusted &= norms < 2.0 * self.best
            self.trusted |= (drop > ACCELERATED_AFTER_DROP) & (norms < 1.2 * self.best)
            calm = self.trusted & (norms < 1.5 * self.before)
        self.best = norms if self.best is None else np.minimum(self.best, norms)
        self.before = norms
        return calm

    def feedback(self, now: np.ndarray) -> np.ndarray:
        """[lane] next CFL number: grows while the residual behaves.

        It falls when the residual jumps, has risen far above its best, or when many cells had to be held back.
        """
        grown = now / np.maximum(self.before, 1e-300)
        factor = np.where(grown < 1.2, self.caution.growth, 1.0)
        factor = np.where(self.limited > 2e-3, 1.0, factor)
        factor = np.where(self.limited > 2e-2, 0.7, factor)
        factor = np.where(now > 4.0 * self.best, 0.8, factor)
        factor = np.where((grown > 2.0) | (self.limited > 0.1), 0.5, factor)
        return np.maximum(self.cfl * factor, min(0.5, self.caution.cfl_start))

    def keep(self, source: np.ndarray) -> None:
        """Keep the lanes `source` [new lane] only."""
        for name in ("cfl", "ceiling", "limited", "trusted", "before", "best"):
            setattr(self, name, getattr(self, name)[source])


def converged(history: History, settings: FlowSettings) -> bool:
    """Whether a condition is good on the fine mesh: residual and force window together.

    Either the residual fell by `residual_drop` with forces within twice the tolerance, or by half a decade more than
    `least_drop` with forces standing over two windows, or by `least_drop` with forces standing over three.
    """
    window, tolerance, drop = settings.window, settings.force_tolerance, history.drop()
    length = len(history.residual)
    if length <= window:
        return False
    if drop >= settings.residual_drop:
        return history.spread(window) < 2 * tolerance
    if drop >= settings.least_drop + 0.5:
        return length > 2 * window and history.spread(2 * window) < tolerance
    return drop >= settings.least_drop and length > 3 * window and history.spread(3 * window) < tolerance


def stalled(history: History, settings: FlowSettings) -> bool:
    """Whether more iterations bring nothing: no better residual for six windows while forces wander within a bound."""
    span = 6 * settings.window
    if len(history.residual) <= 2 * span:
        return False
    return min(history.residual[-span:]) > 0.8 * min(history.residual[:-span]) and history.spread(span) < 0.02


def finished(history: History, settings: FlowSettings) -> bool:
    """Whether a condition leaves the ensemble before its iterations are used up."""
    return converged(history, settings) or stalled(history, settings)


def march(
    ensemble: Ensemble,
    iterations: int,
    caution: Caution,
    stop: Callable[[History], bool],
    finish: Callable[[int, Ensemble, int, History], None],
    tick: Callable[[int, int, float], None],
    impulsive: bool = False,
) -> dict[int, History]:
    """Iterate until every condition has stopped, failed or used up `iterations`.

    Args:
        stop: whether a condition with this history is done.
        finish: called once for each condition with (condition, ensemble, lane, history) when it leaves.
        tick: called each iteration with (iteration, active conditions, worst drop in decades).
        impulsive: whether the state is still the free stream.

    Returns:
        History by condition.
    """
    histories = {int(c): History() for c in ensemble.lanes[: ensemble.count]}
    steering = Steering(ensemble.conditions.mach[ensemble.lanes], caution, impulsive)
    active = np.arange(len(ensemble.lanes)) < ensemble.count
    for iteration in range(iterations + 1):
        norms = ensemble.evaluate()
        rejected = steering.rejected(norms) & active
        if rejected.any():
            ensemble.undo(rejected)
            norms = ensemble.evaluate()
        forces = ensemble.forces()
        for lane in np.flatnonzero(active):
            condition = int(ensemble.lanes[lane])
            history = histories[condition]
            history.residual.append(float(norms[lane]))
            history.force.append(forces[lane])
            if not (np.isfinite(norms[lane]) and np.isfinite(forces[lane]).all()):
                history.failure = f"not a number after {iteration} iterations"
            history.done = not history.failure and stop(history)
            if history.failure or history.done or iteration == iterations:
                finish(condition, ensemble, lane, history)
                active[lane] = False
        staying = np.flatnonzero(active)
        drop = np.array([histories[int(c)].drop() for c in ensemble.lanes])
        tick(iteration, len(staying), float(drop.min()))
        if not len(staying):
            break
        calm = steering.advance(norms, drop)
        ensemble.hold[:] = (iteration >= HOLD_SENSOR_AFTER) & (norms < 2.0 * steering.best)
        # Copying all arrays is dear: lanes that are done run on unread until a whole vector of them can go.
        if padded(len(staying)) < len(ensemble.lanes):
            ensemble.keep(staying)
            source = np.concatenate([staying, np.full(len(ensemble.lanes) - len(staying), staying[-1])])
            active = np.arange(len(ensemble.lanes)) < ensemble.count
            calm = calm[source]
            steering.keep(source)
            ensemble.evaluate()
        ensemble.correct(steering.cfl)
        steering.limited = ensemble.apply(caution.largest, calm)
    return histories
