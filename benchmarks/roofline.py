"""Roofline of the flow kernels: what moves, what is computed, how much of the machine is reached, what limits.

S. Williams, A. Waterman, D. Patterson, Commun. ACM 52 (2009) 65-76. Bytes are the least that must cross from memory:
every array a step reads or writes, once, written ones twice (a line is fetched before it is written). Operations are
counted by running the kernels' text (`operations.py`). Bandwidth and speed of the machine are measured here, with the
same convention.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numba
import numpy as np
from common import conditions, vehicle_mesh
from numba import njit, prange

from spaceplane.flow.compiled import LANES
from spaceplane.flow.ensemble import Ensemble
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.topology import prepare

ENTRY = ("other", "normal", "area")
RESIDUAL = ("gradients", "fluxes")


def measure(cells: int, repeats: int = 5) -> dict[str, float]:
    """Figures by kernel, `KERNEL figure`, on HORUS-2B with about `cells` cells, and those of the machine."""
    settings = FlowSettings()
    mesh = vehicle_mesh(cells)
    ensemble = Ensemble(mesh, prepare(mesh, settings.dtype), conditions(LANES), settings, 2)
    noise = np.random.default_rng(0).uniform(0.99, 1.01, (mesh.cells, 5, 1))
    ensemble.state *= noise.astype(settings.dtype)
    cfl, calm = np.full(LANES, 10.0), np.ones(LANES, dtype=bool)
    steps = {
        "gradients": ensemble.reconstruct,
        "fluxes": ensemble.balance,
        "diagonals": lambda: ensemble.factorise(cfl, calm),
        "sweeps": ensemble.relax,
        "update": lambda: ensemble.apply(0.0, calm),
    }
    for _ in range(settings.anderson_depth + 1):  # until all of its slots are in use
        steps["update"]()
    moved, done = traffic(ensemble), operations(mesh)
    bandwidth, speed = machine_bandwidth(), machine_speed()
    share = mesh.cells * LANES
    result = {"cells": mesh.cells, "bandwidth_gb_per_s": bandwidth, "speed_gflop_per_s": speed}
    for name, step in steps.items():
        seconds = best(step, repeats)
        figures = {
            "ns": 1e9 * seconds / share,
            "bytes": moved[name] / share,
            "flops": done.get(name, 0.0),
            "of_bandwidth": moved[name] / seconds / 1e9 / bandwidth,
            "of_speed": done.get(name, 0.0) * share / seconds / 1e9 / speed,
        }
        result |= {f"{name} {figure}": value for figure, value in figures.items()}
    seconds = sum(result[f"{name} ns"] for name in RESIDUAL)
    result["residual of_bandwidth"] = sum(moved[name] for name in RESIDUAL) / share / seconds / bandwidth
    result["residual of_speed"] = sum(done[name] for name in RESIDUAL) / seconds / speed
    return result


def best(task: Callable[[], object], repeats: int) -> float:
    """Least seconds of a task; on a busy machine the time used, shared between the threads, is the fairer measure."""
    task()
    least = np.inf
    for _ in range(repeats):
        began, used = time.perf_counter(), time.process_time()
        task()
        least = min(least, time.perf_counter() - began, (time.process_time() - used) / numba.get_num_threads())
    return least


def traffic(ensemble: Ensemble) -> dict[str, float]:
    """Least bytes that each step moves between memory and processor."""
    t, settings, acceleration = ensemble.topology, ensemble.settings, ensemble.anderson

    def read(*names: str) -> int:
        return sum(getattr(t, name).nbytes for name in names)

    def size(*arrays: np.ndarray) -> int:
        return sum(array.nbytes for array in arrays)

    e = ensemble
    stencil = read("stencil_start", "stencil_other", "stencil_weight", "start", "reach", "size")
    faces = read("chunk_faces", "face_cells", "face_normal", "face_area", "face_reach", "edge_start", "edge_row")
    walls = read("boundary_normal", "boundary_area", "boundary_reach")
    entries = read("start", *ENTRY)
    one_pass = size(e.state, e.sensor, e.residual, e.inverse) + entries / 2 + 2 * size(e.change, e.passed)
    slots = acceleration.used
    a_slot = e.change.nbytes
    record = size(e.change, acceleration.last_change, acceleration.last_step) + (slots - 1 + 4) * a_slot
    apply = (
        size(e.change) + slots * a_slot + 2 * size(e.state, e.pace, acceleration.last_change, acceleration.last_step)
    )
    return {
        "gradients": size(e.state) + stencil + 2 * size(e.gradient, e.sensor),
        "fluxes": size(e.state, e.gradient, e.sensor) + faces + walls + 2 * size(e.residual),
        "diagonals": size(e.state, e.sensor, e.pace) + entries + walls + 2 * size(e.inverse),
        "sweeps": 2 * settings.sweeps * one_pass,
        "update": record + apply,
    }


def operations(mesh) -> dict[str, float]:
    """Operations of each step per cell and condition, on a mesh with as many faces a cell as this one."""
    script = Path(__file__).with_name("operations.py")
    output = subprocess.run(
        [sys.executable, str(script)],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    counted = json.loads(output)
    more = len(mesh.face_cells) / mesh.cells / counted.pop("faces_per_cell")
    return {name: value * more for name, value in counted.items()}


@njit(parallel=True, fastmath=True)
def _triad(a, b, c, factor):
    for i in prange(len(a)):
        a[i] = b[i] + factor * c[i]


@njit(parallel=True, fastmath=True)
def _polynomial(x, rounds):
    for block in prange(x.shape[0]):
        for _ in range(rounds):
            for i in range(x.shape[1]):
                v = x[block, i]
                y = v
                for _k in range(32):
                    y = y * v + np.float32(1e-3)
                x[block, i] = y


def machine_bandwidth() -> float:
    """GB/s of a = b + s c on arrays far larger than the caches; the line of `a` is fetched before it is written."""
    a, b, c = (np.full(40_000_000, 1.0, np.float32) for _ in range(3))
    return 4 * a.nbytes / best(lambda: _triad(a, b, c, np.float32(0.5)), 5) / 1e9


def machine_speed() -> float:
    """GFlop/s in single precision of multiplications and additions that stay in the registers."""
    x = np.full((numba.get_num_threads(), 2048), 0.5, np.float32)
    rounds = 2000
    return 64 * x.size * rounds / best(lambda: _polynomial(x, rounds), 5) / 1e9
