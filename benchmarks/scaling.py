"""How time and memory grow with cells and with conditions."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path

SIZES = (75_000, 150_000, 300_000, 600_000, 1_200_000, 2_400_000)
CONDITIONS = (1, 4, 16, 32)
ITERATIONS = 8


def measure(largest: int, count_cells: int = 75_000) -> dict[str, float]:
    """Seconds of the mesh and of one fine iteration of 16 conditions by cells up to `largest`; of all iterations by
    conditions on `count_cells`. Each size runs in a process of its own, so that its peak memory is its own."""
    result = {}
    for cells in (size for size in SIZES if size <= largest):
        found = _apart(cells, 16, ITERATIONS)
        for figure in ("mesh_s", "iteration_s", "peak_memory_gb"):
            result[f"{cells} {figure}"] = found[figure]
        result[f"{cells} ns_per_cell_and_iteration"] = 1e9 * found["iteration_s"] / found["cells"]
    for conditions in CONDITIONS:
        result[f"{conditions} conditions solver_s"] = _apart(count_cells, conditions, None)["solver_s"]
    return result


def _apart(cells: int, count: int, iterations: int | None) -> dict[str, float]:
    """`one` in a process of its own."""
    command = [sys.executable, str(Path(__file__)), str(cells), str(count), str(iterations or 0)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()[-1])


def one(cells: int, count: int, iterations: int) -> dict[str, float]:
    """Mesh of about `cells` cells, then `iterations` fine iterations of `count` conditions, or to convergence for 0."""
    import resource

    from common import conditions, timed, vehicle_mesh

    from spaceplane.flow.settings import FlowSettings
    from spaceplane.flow.solve import solve

    solve(vehicle_mesh(5_000), conditions(1), FlowSettings(iterations=3, coarse_iterations=3))
    meshing, mesh = timed(lambda: vehicle_mesh(cells))
    limit = {"iterations": iterations, "coarse_levels": 0, "residual_drop": 16.0} if iterations else {}
    started = time.perf_counter()
    solution = solve(mesh, conditions(count), FlowSettings(**limit))
    fine = solution.statistics["seconds_by_phase"]["fine"]
    return {
        "cells": mesh.cells,
        "mesh_s": meshing,
        "solver_s": time.perf_counter() - started,
        "iteration_s": fine / max(iterations, 1),
        "peak_memory_gb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
    }


if __name__ == "__main__":
    print(json.dumps(one(*(int(value) for value in sys.argv[1:]))))
