"""Iterate an ensemble on one level: CFL feedback, stopping and failure by condition."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from itertools import count

import numpy as np

from spaceplane.flow.compiled import LANES
from spaceplane.flow.ensemble import Ensemble
from spaceplane.flow.freezing import Freezer
from spaceplane.flow.history import History
from spaceplane.flow.settings import FlowSettings

ACCELERATED_BELOW_MACH, ACCELERATED_AFTER_DROP = 2.0, 2.3
"""Anderson acceleration drives blunt-base flows apart at Mach 2.5 and more, until they are close to steady."""

WORTH_WAITING = 0.1
"""Decades that a residual must gain in some windows to be worth waiting for, once the forces stand."""

CREEPING = 10
"""Iterations in which a residual that gains no more than that creeps, and needs the end game if it is to fall on."""

PATIENCE, LEAST_PATIENCE = 8, 2
"""Those windows; and the fewer ones by which a condition that has used up its iterations is judged. Some residuals
stand still at two decades and a half for fifty iterations before they go on falling."""

FORMED_AT, FORMING_CFL, FORMING_GROWTH = 1.7, 80.0, 1.3
"""Decades at which a supersonic flow counts as formed; CFL number and its growth from one step to the next until then,
from Mach 2.5 on: bolder steps throw wakes about that must then come to rest, if they do not break."""

REJECTED_RISE = 2.5
"""A step after which the residual is this many times the last one is taken back."""

FORMED_AGAIN_EVERY, FORMED_AGAIN_DROP = 3, 1.0
"""The diagonal blocks of a lane are formed in every iteration, but in every third once its residual has fallen by this
many decades and is near its best: the flow changes little by then. Lane by lane, so that companions change nothing."""


@dataclass(frozen=True)
class Caution:
    """How boldly to march: raised when a condition is retried by itself."""

    cfl_start: float
    cfl_max: float
    growth: float = 1.5
    largest: float = 0.4


def starting_cfl(mach: np.ndarray, caution: Caution, impulsive: bool) -> np.ndarray:
    """[lane] first CFL number: a fifth of `cfl_start` from the free stream, falling to 1 between Mach 2 and 5;
    otherwise `cfl_start`, falling to 5 between Mach 2 and 2.5."""
    first = caution.cfl_start * (0.2 if impulsive else 1.0)
    lowest, at = (1.0, 5.0) if impulsive else (5.0, 2.5)
    return np.interp(mach, [2.0, at], [first, min(first, lowest)])


def highest_cfl(mach: np.ndarray, caution: Caution) -> np.ndarray:
    """[lane] largest CFL number: `cfl_max` up to Mach 2, 60 at Mach 5, from Mach 10 on 20, where larger ones lose more
    than they gain."""
    most = [caution.cfl_max, min(caution.cfl_max, 60.0), min(caution.cfl_max, 20.0)]
    return np.interp(mach, [2.0, 5.0, 10.0], most)


class Steering:
    """What drives each lane: CFL number, memory of the residual, whether acceleration is trusted.

    Attributes:
        cfl, ceiling: [lane] CFL number and the largest it may reach.
        early_growth, early_ceiling: [lane] growth from step to step and ceiling while the flow forms.
        before, best: [lane] last and smallest residual; infinite before the first.
        limited: [lane] share of cells held back in the last step.
        trusted: [lane] whether Anderson acceleration may be used.
    """

    def __init__(self, mach: np.ndarray, caution: Caution, impulsive: bool):
        self.caution, self.impulsive = caution, impulsive
        self.cfl, self.ceiling, self.limited, self.before, self.best = np.zeros((5, len(mach)))
        self.early_growth, self.early_ceiling = np.zeros((2, len(mach)))
        self.trusted = np.zeros(len(mach), dtype=bool)
        self.begin(np.arange(len(mach)), mach)

    def begin(self, lanes: np.ndarray, mach: np.ndarray) -> None:
        """Start anew in the lanes of these indices, which now hold flows at `mach`."""
        self.cfl[lanes] = starting_cfl(mach, self.caution, self.impulsive)
        self.ceiling[lanes] = highest = highest_cfl(mach, self.caution)
        bold = self.caution.growth
        self.early_growth[lanes] = np.interp(mach, [2.0, 2.5], [bold, min(bold, FORMING_GROWTH)])
        self.early_ceiling[lanes] = np.minimum(
            highest, np.interp(mach, [2.0, 2.5], [self.caution.cfl_max, FORMING_CFL])
        )
        self.limited[lanes] = 0.0
        self.before[lanes] = self.best[lanes] = np.inf
        self.trusted[lanes] = mach < ACCELERATED_BELOW_MACH

    def rejected(self, norms: np.ndarray) -> np.ndarray:
        """[lane] whether the last step made things so much worse that it is taken back; its CFL number falls."""
        bad = np.isfinite(self.before) & ~(norms < REJECTED_RISE * self.before) & (self.cfl > 1.0)
        self.cfl = np.where(bad, np.maximum(0.3 * self.cfl, 1.0), self.cfl)
        return bad

    def advance(self, norms: np.ndarray, drop: np.ndarray) -> np.ndarray:
        """Take in the residuals and their drop in decades; [lane] whether the next step may be accelerated."""
        first = np.isinf(self.before)
        forming = drop < FORMED_AT
        growth = np.where(forming, self.early_growth, self.caution.growth)
        ceiling = np.where(forming, self.early_ceiling, self.ceiling)
        self.cfl = np.where(first, self.cfl, np.minimum(self.feedback(norms, growth), ceiling))
        # Once the residual has risen well above its best, the condition goes on without acceleration.
        self.trusted &= norms < 2.0 * self.best
        self.trusted |= (drop > ACCELERATED_AFTER_DROP) & (norms < 1.2 * self.best)
        calm = self.trusted & (norms < 1.5 * self.before)
        self.best = np.minimum(self.best, norms)
        self.before = norms
        return calm

    def feedback(self, now: np.ndarray, growth: np.ndarray) -> np.ndarray:
        """[lane] next CFL number: grows by `growth` while the residual behaves.

        It falls when the residual jumps, has risen far above its best, or when many cells had to be held back.
        """
        grown = now / np.maximum(self.before, 1e-300)
        factor = np.where(grown < 1.2, growth, 1.0)
        factor = np.where(self.limited > 2e-2, 1.0, factor)
        factor = np.where(now > 4.0 * self.best, 0.8, factor)
        factor = np.where((grown > 2.0) | (self.limited > 0.1), 0.5, factor)
        return np.maximum(self.cfl * factor, min(0.5, self.caution.cfl_start))


def drifted(history: History, settings: FlowSettings) -> float:
    """Spread of the force over the later half of a run, two windows at least and `PATIENCE` at most: a slow wake drifts
    by little in a few windows."""
    window = settings.window
    return history.spread(max(2 * window, min(PATIENCE * window, len(history.residual) // 2)))


def creeps(history: History, settings: FlowSettings) -> bool:
    """Whether a condition needs the end game: asked for more decades than its best residual has, it gains no more."""
    return (
        settings.residual_drop > settings.end_game_drop
        and history.age > 2 * CREEPING
        and history.best_drop() >= settings.end_game_drop
        and history.gain(CREEPING) <= WORTH_WAITING
        and history.spread(CREEPING) < settings.force_tolerance
    )


def converged(history: History, settings: FlowSettings, patience: int = LEAST_PATIENCE) -> bool:
    """Whether a condition is good on the fine mesh: residual and force window together.

    Either the residual fell by `residual_drop` with forces within the tolerance, and drifted by no more than twice
    that; or, where it gained nothing more in `patience` windows, by half a decade more than `least_drop` with forces
    standing over two windows, or by `least_drop` with forces standing over three, and drifted by no more than the
    tolerance: what still drifts at a higher residual has farther to go.
    """
    window, tolerance, drop = settings.window, settings.force_tolerance, history.drop()
    length, drift = len(history.residual), drifted(history, settings)
    if length <= window or drift > 2.0 * tolerance:
        return False
    if drop >= settings.residual_drop:
        return history.spread(window) < tolerance
    if drift > tolerance:
        return False
    windows = 2 if drop >= settings.least_drop + 0.5 else 3
    if drop < settings.least_drop or length <= windows * window or history.gain(patience * window) > WORTH_WAITING:
        return False
    return history.spread(windows * window) < tolerance


def stalled(history: History, settings: FlowSettings) -> bool:
    """Whether more iterations bring nothing: no better residual for all that patience, forces within a bound."""
    span = PATIENCE * settings.window
    if len(history.residual) <= 2 * span:
        return False
    return min(history.residual[-span:]) > 0.8 * min(history.residual[:-span]) and history.spread(span) < 0.02


def finished(history: History, settings: FlowSettings) -> bool:
    """Whether a condition leaves the ensemble before its iterations are used up."""
    return converged(history, settings, PATIENCE) or stalled(history, settings)


def march(
    ensemble: Ensemble,
    iterations: int,
    caution: Caution,
    stop: Callable[[History], bool],
    finish: Callable[[int, Ensemble, int, History], None],
    tick: Callable[[int, dict[int, History], int], None],
    start: np.ndarray | None = None,
    impulsive: bool = False,
) -> dict[int, History]:
    """Iterate until every condition of the ensemble has stopped, failed or used up `iterations`.

    Conditions beyond the lanes wait; each takes the first lane that becomes free, in step with the others, so that the
    diagonal blocks of all are due in the same iterations.

    Args:
        stop: whether a condition with this history is done.
        finish: called once for each condition with (condition, ensemble, lane, history) when it leaves.
        tick: called each iteration with (iteration, histories, active conditions).
        start: [cell, 5, condition] where those that wait start from; None for the free stream.
        impulsive: whether that, and the state now, is still the free stream.

    Returns:
        History by condition.
    """
    mach = ensemble.conditions.mach
    histories = {condition: History(norm) for condition, norm in enumerate(ensemble.impulsive_norms())}
    steering = Steering(mach[ensemble.lanes], caution, impulsive)
    freezer = Freezer()
    waiting = deque(range(ensemble.count, len(mach)))
    active = np.arange(LANES) < ensemble.count
    for iteration in count():
        norms = ensemble.evaluate()
        undone = steering.rejected(norms) & active
        if undone.any():
            ensemble.undo(undone)
            norms = ensemble.evaluate()
        active &= ~leave(ensemble, active, norms, histories, iterations, stop, finish)
        in_step = iteration % FORMED_AGAIN_EVERY == 0 or not active.any()
        seated = np.flatnonzero(~active)[: len(waiting)] if in_step else np.empty(0, dtype=int)
        if len(seated):
            for lane in seated:
                condition = waiting.popleft()
                ensemble.seat(lane, condition, None if start is None else start[:, :, condition])
            steering.begin(seated, mach[ensemble.lanes[seated]])
            freezer.begin(seated)
            norms = ensemble.evaluate()
            new = np.isin(np.arange(LANES), seated)
            active |= new
            active &= ~leave(ensemble, new, norms, histories, iterations, stop, finish)
        tick(iteration, histories, int(active.sum()))
        if not active.any() and not waiting:
            break
        here = [histories[int(condition)] for condition in ensemble.lanes]
        drop = np.array([history.drop() for history in here])
        calm = steering.advance(norms, drop)
        age = np.array([history.age for history in here])
        if ensemble.order == 2:
            freezer.update(here, norms, steering.best, drop)
            freezer.close([lane for lane in np.flatnonzero(active) if creeps(here[lane], ensemble.settings)])
            ensemble.keep_bounded(freezer.closing)
            ensemble.hold[:] = freezer.held
            ensemble.frozen[:] = freezer.frozen
        quiet = (drop > FORMED_AGAIN_DROP) & (norms < 2.0 * steering.best) & ~undone
        ensemble.correct(steering.cfl, again=active & (~quiet | (age % FORMED_AGAIN_EVERY == 0)))
        steering.limited = ensemble.apply(caution.largest, calm)
    return histories


def leave(
    ensemble: Ensemble,
    which: np.ndarray,
    norms: np.ndarray,
    histories: dict[int, History],
    iterations: int,
    stop: Callable[[History], bool],
    finish: Callable[[int, Ensemble, int, History], None],
) -> np.ndarray:
    """Record residual and force of the lanes `which` [lane]; those of them that are at their end, told to `finish`."""
    forces = ensemble.forces()
    gone = np.zeros(LANES, dtype=bool)
    for lane in np.flatnonzero(which):
        condition = int(ensemble.lanes[lane])
        history = histories[condition]
        history.residual.append(float(norms[lane]))
        history.force.append(forces[lane])
        if not (np.isfinite(norms[lane]) and np.isfinite(forces[lane]).all()):
            history.failure = f"not a number after {len(history.residual) - 1} iterations"
        history.done = not history.failure and stop(history)
        if history.failure or history.done or len(history.residual) > iterations:
            finish(condition, ensemble, lane, history)
            gone[lane] = True
    return gone
