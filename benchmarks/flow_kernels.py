"""Time the flow kernels: nanoseconds per cell and condition.

    python benchmarks/flow_kernels.py [cells] [conditions] [single|double]

Works on a box of hexahedra; kernels see the same access pattern as on octree meshes.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import numba
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from flow.structured import box
from spaceplane.flow.ensemble import Ensemble
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.topology import prepare
from spaceplane.mesh.mesh import Mesh


def time_kernels(mesh: Mesh, conditions: int, precision: str, repeats: int = 5) -> dict[str, float]:
    """ns per cell and condition of each step of an iteration, best of `repeats`, after one warm-up."""
    settings = FlowSettings(precision=precision)
    mach = np.linspace(0.8, 2.5, conditions)
    ensemble = Ensemble(mesh, prepare(mesh, settings.dtype), FlowConditions(mach, 0.1 * mach, 0 * mach), settings, 2)
    noise = np.random.default_rng(0).uniform(0.99, 1.01, (mesh.cells, 5, 1))
    ensemble.state *= noise.astype(settings.dtype)
    cfl = np.full(len(ensemble.lanes), 10.0)
    calm = np.ones(len(ensemble.lanes), dtype=bool)
    steps = {
        "gradients": ensemble.reconstruct,
        "fluxes": ensemble.balance,
        "diagonals": lambda: ensemble.factorise(cfl, calm),
        "two sweeps": ensemble.relax,
        "acceleration and update": lambda: ensemble.apply(0.0, calm),
        "forces": ensemble.forces,
    }
    result = {}
    for name, step in steps.items():
        step()
        best = np.inf
        for _ in range(repeats):
            began, used = time.perf_counter(), time.process_time()
            step()
            # On a busy machine the time used, shared between the threads, is the fairer measure.
            best = min(best, time.perf_counter() - began, (time.process_time() - used) / numba.get_num_threads())
        result[name] = 1e9 * best / mesh.cells / len(ensemble.lanes)
    result["iteration"] = sum(result.values())
    return result


def main(arguments: list[str]) -> None:
    """Print a table and one line of JSON."""
    cells = int(arguments[0]) if arguments else 64000
    conditions = int(arguments[1]) if len(arguments) > 1 else 16
    precision = arguments[2] if len(arguments) > 2 else "single"
    mesh = box(round(cells ** (1 / 3)), 0.2)
    result = time_kernels(mesh, conditions, precision)
    print(f"{mesh.cells} cells, {conditions} conditions, {precision} precision: ns per cell and condition")
    for name, value in result.items():
        print(f"  {name:26s}{value:8.1f}")
    print(json.dumps({"cells": mesh.cells, "conditions": conditions, "precision": precision, "ns": result}))


if __name__ == "__main__":
    main(sys.argv[1:])
