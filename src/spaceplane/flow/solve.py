"""Steady flow of all conditions of one shape: start on coarse levels, converge on the mesh, judge each condition."""

from __future__ import annotations

import math
import time
from functools import partial

import numpy as np

from spaceplane.errors import InputError
from spaceplane.flow.coarsen import Sequence, sequence
from spaceplane.flow.compilation import compile_kernels
from spaceplane.flow.ensemble import Ensemble, free_stream
from spaceplane.flow.history import History
from spaceplane.flow.march import Caution, converged, finished, march
from spaceplane.flow.prolong import prolong
from spaceplane.flow.settings import FlowSettings, check
from spaceplane.flow.solution import EQUILIBRIUM, PERFECT, ConvergenceRecord, FlowConditions, Solution
from spaceplane.flow.topology import prepare
from spaceplane.mesh.mesh import Mesh
from spaceplane.progress import Progress, silent

LARGEST_BATCH = 64

BOLDEST = {PERFECT: math.inf, EQUILIBRIUM: 5.0}
"""Largest CFL number by gas: beyond it shocks in equilibrium air, even of first order, never come to rest."""


def solve(
    mesh: Mesh | Sequence,
    conditions: FlowConditions,
    settings: FlowSettings | None = None,
    progress: Progress | None = None,
) -> Solution:
    """Solve the Euler equations for every condition at once.

    Args:
        mesh: the mesh, or one with its coarse levels (see `coarsen.Sequence`); by default the levels are made here.
        conditions: free streams; checked.
        settings: numerics; defaults when None.
        progress: called with (phase, done, total, text).

    Returns:
        Solution with one ConvergenceRecord per condition. A condition that fails twice has NaN as state and wall
        pressure and the verdict "failed".

    Raises:
        InputError: bad conditions or a mesh without cells.
    """
    settings = settings or FlowSettings()
    conditions = check(conditions)
    say = progress or silent
    began = time.perf_counter()
    levels = mesh if isinstance(mesh, Sequence) else sequence(mesh, settings.coarse_levels)
    fine = levels.meshes[0]
    if not fine.cells:
        raise InputError("mesh: 0 cells; at least one is needed")
    compile_kernels(settings, conditions, progress)
    topologies = [prepare(level, settings.dtype) for level in levels.meshes]
    prepared = time.perf_counter()
    seconds = {"prepare": prepared - began}

    job = _Job(levels, topologies, conditions, settings, say)
    boldest = BOLDEST[conditions.gas]
    first = Caution(min(settings.cfl_start, boldest), min(settings.cfl_max, boldest))
    second = Caution(min(5.0, settings.cfl_start), min(25.0, settings.cfl_max, boldest), 1.2, 0.25)
    for which in batches(np.argsort(conditions.mach, kind="stable")):
        job.run(which, first, seconds)
    retry = np.array([c for c in range(len(conditions)) if job.worth_retry(c)], dtype=int)
    if len(retry):
        say("retry", 0, len(retry), f"{len(retry)} conditions once more, carefully")
        for which in batches(retry):
            job.run(which, second, seconds)
    records = tuple(judge(job.histories[c], settings) for c in range(len(conditions)))
    seconds["total"] = time.perf_counter() - began
    warnings = [f"condition {c}: {r.verdict}: {r.reason}" for c, r in enumerate(records) if not r.good]
    statistics = {
        "cells": fine.cells,
        "level_cells": [m.cells for m in levels.meshes],
        "seconds": seconds["total"],
        "seconds_by_phase": {k: v for k, v in seconds.items() if k != "total"},
        "iterations": max(r.iterations for r in records),
        "precision": settings.precision,
        "conditions": len(conditions),
        "retried": [int(c) for c in retry],
        "warnings": warnings,
    }
    return Solution(fine, conditions, job.state, job.wall_pressure, records, statistics)


class _Job:
    """State shared by the first run and the retries of one call of `solve`."""

    def __init__(self, levels, topologies, conditions, settings, say):
        self.levels, self.topologies, self.conditions = levels, topologies, conditions
        self.settings, self.say = settings, say
        fine = levels.meshes[0]
        self.state = np.full((fine.cells, 5, len(conditions)), np.nan, settings.dtype)
        self.wall_pressure = np.full((len(fine.wall_cell), len(conditions)), np.nan, settings.dtype)
        self.histories: dict[int, History] = {}

    def worth_retry(self, condition: int) -> bool:
        """A condition that broke, or whose residual hardly fell: again with smaller steps."""
        history = self.histories[condition]
        return bool(history.failure) or (not converged(history, self.settings) and history.drop() < 0.8)

    def run(self, which: np.ndarray, caution: Caution, seconds: dict[str, float]) -> None:
        """March the conditions `which` through all levels, coarse to fine.

        Those that took longest on a level begin first on the next: they need as long again, and would otherwise hold
        the last lane alone.
        """
        settings, start = self.settings, None
        for level, order in stages(len(self.levels.meshes), settings.order):
            began = time.perf_counter()
            mesh, topology = self.levels.meshes[level], self.topologies[level]
            subset = self.conditions.take(which)
            ensemble = Ensemble(mesh, topology, subset, settings, order)
            if start is not None:
                ensemble.load(start)
            last = level == 0 and order == settings.order
            phase = "fine" if last else f"start level {level}, order {order}"
            limit = settings.iterations if last else settings.coarse_iterations
            refine = level > 0 and order == settings.order
            parent, offset = self._way_down(level) if refine else (np.arange(mesh.cells, dtype=np.int32), None)
            offset = np.zeros((len(parent), 3), settings.dtype) if offset is None else offset
            result = np.empty((len(parent), 5, len(which)), settings.dtype)

            hand_on = partial(self._hand_on, start, parent, offset, result)
            finish = partial(self._keep, which) if last else hand_on
            stop = partial(finished, settings=settings) if last else partial(fallen, decades=1.5 if order == 1 else 2.0)
            tick = partial(self._tell, phase, settings.residual_drop if last else 2.0)
            histories = march(ensemble, limit, caution, stop, finish, tick, start, impulsive=start is None)
            if not last:
                longest = np.argsort([-len(histories[column].residual) for column in range(len(which))], kind="stable")
                which, start = which[longest], result[:, :, longest]
            seconds[phase] = seconds.get(phase, 0.0) + time.perf_counter() - began

    def _hand_on(self, start, parent, offset, result, column, ensemble, lane, history):
        """Fill `result[:, :, column]`, where the next finer level starts from, with a lane of this one."""
        if not history.failure and history.drop() >= 0.0:
            prolong(parent, offset, ensemble.state, ensemble.gradient, ensemble.order, lane, result, column)
        # A level that broke hands on what it was given; the next one may still succeed.
        elif start is None:
            result[:, :, column] = free_stream(ensemble.conditions)[:, column]
        else:
            result[:, :, column] = start[parent, :, column]

    def _tell(self, phase: str, aim: float, iteration: int, histories: dict[int, History], active: int) -> None:
        """Report how far a level is, in per cent: conditions by their decades of `aim`, those through with it fully."""
        begun = [h for h in histories.values() if h.residual]
        drops = np.nan_to_num([h.drop() for h in begun])
        share = np.where([h.done or bool(h.failure) for h in begun], 1.0, np.clip(drops / aim, 0.0, 1.0))
        text = f"iteration {iteration}, {active} active, {drops.min():.1f} decades"
        self.say(phase, round(100 * share.sum() / len(histories)), 100, text)

    def _way_down(self, level: int) -> tuple[np.ndarray, np.ndarray]:
        """For `prolong` from `level` to the next finer one: (parent, offset), rows in the finer level's kernel
        order."""
        coarse, fine = self.levels.meshes[level], self.levels.meshes[level - 1]
        place = np.empty(coarse.cells, dtype=np.int32)
        place[self.topologies[level].order] = np.arange(coarse.cells, dtype=np.int32)
        order = self.topologies[level - 1].order
        parent = self.levels.parents[level - 1][order]
        offset = fine.cell_center[order] - coarse.cell_center[parent]
        return place[parent], offset.astype(self.settings.dtype)

    def _keep(self, which, column, ensemble, lane, history):
        """Store a fine-mesh result, unless an earlier attempt was better."""
        condition = which[column]
        earlier = self.histories.get(int(condition))
        if earlier is not None and not earlier.failure and (history.failure or history.drop() < earlier.drop()):
            return
        self.histories[int(condition)] = history
        if history.failure:
            self.state[:, :, condition] = np.nan
            self.wall_pressure[:, condition] = np.nan
            return
        self.state[ensemble.topology.order, :, condition] = ensemble.state[:, :, lane]
        self.wall_pressure[:, condition] = ensemble.wall_pressure()[:, lane]


def batches(which: np.ndarray) -> list[np.ndarray]:
    """Conditions in groups of which all solutions fit into memory together."""
    return np.array_split(which, -(-len(which) // LARGEST_BATCH)) if len(which) else []


def stages(levels: int, order: int) -> list[tuple[int, int]]:
    """(level, order) to march through: first order on the coarsest level, then the asked order on all, coarse to
    fine."""
    last = levels - 1
    begin = [(last, 1)] if order == 2 else []
    return begin + [(level, order) for level in range(last, -1, -1)]


def fallen(history: History, decades: float) -> bool:
    """Whether the residual of a coarse level has fallen far enough, in decades, to go on to the next."""
    return history.drop() >= decades


def judge(history: History, settings: FlowSettings) -> ConvergenceRecord:
    """The verdict on one condition, from residual and force window together."""
    residual, force = np.array(history.residual), np.array(history.force)
    good = not history.failure and converged(history, settings)
    # What still wanders is averaged over the longer window by which it is judged.
    window = force[-settings.window if good else -4 * settings.window :]
    drop = history.drop()
    if history.failure:
        verdict, reason = "failed", history.failure
    elif good:
        verdict, reason = "converged", ""
    else:
        long = history.spread(4 * settings.window)
        verdict = "oscillating" if drop > 0.5 and long < 0.05 else "failed"
        reason = (
            f"residual fell {drop:.1f} decades in {len(residual) - 1} iterations, force wanders by {100 * long:.2g} %"
        )
    return ConvergenceRecord(
        verdict=verdict,
        residual_drop=drop if np.isfinite(drop) else 0.0,
        iterations=len(residual) - 1,
        residual_history=np.log10(np.maximum(residual, 1e-300) / history.first),
        force_history=force,
        window_mean=window.mean(axis=0),
        window_spread=0.5 * np.ptp(window, axis=0),
        reason=reason,
    )
