"""How time and memory grow with cells and with conditions.

Each size runs in a process of its own, so that its peak memory is its own. Times are wall seconds and seconds of
processor time over all threads: on a machine that does other work as well, only the latter mean something.
"""

from __future__ import annotations

import contextlib
import itertools
import json
import statistics
import subprocess
import sys
import time
from pathlib import Path

SIZES = (75_000, 150_000, 300_000, 600_000, 1_200_000, 2_400_000)
CONDITIONS = (1, 4, 16, 32)
ITERATIONS = 6
ANDERSON_DEPTH = 1
"""Differences kept for the acceleration while iterations are timed: with the usual three, memory grows by a half."""
BYTES_PER_CELL = 7_500
"""Memory that a size is expected to need, per cell; a size for which there is less is left out, and said so."""


def measure(largest: int, count_cells: int = 20_000) -> dict[str, float]:
    """Cost of the mesh and of one fine iteration of 16 conditions by cells up to `largest`; of all iterations by
    conditions on `count_cells`."""
    result = {}
    for cells in (size for size in SIZES if size <= largest):
        if available_memory() < BYTES_PER_CELL * cells:
            print(f"scaling: {cells} cells left out, memory for {BYTES_PER_CELL * cells / 1e9:.1f} GB is missing")
            continue
        found = _apart(cells, 16, ITERATIONS)
        result |= {f"{cells} {figure}": value for figure, value in found.items() if not figure.startswith("solver")}
    for conditions in CONDITIONS:
        found = _apart(count_cells, conditions, None)
        result |= {f"{conditions} conditions {figure}": found[figure] for figure in ("solver_s", "solver_cpu_s")}
    return result


def by_cells(figures: dict[str, float]) -> dict[int, dict[str, float]]:
    """The figures of each size, by the cells asked for."""
    return {
        size: {name.partition(" ")[2]: value for name, value in figures.items() if name.startswith(f"{size} ")}
        for size in SIZES
        if f"{size} cells" in figures
    }


def plot(figures: dict[str, float], path: Path) -> None:
    """Draw processor time of an iteration and peak memory by cells, with lines of proportion, and time by
    conditions."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    from spaceplane.report.figure_style import FIGURE_STYLE

    rows = list(by_cells(figures).values())
    cells = [row["cells"] / 1e3 for row in rows]
    with plt.rc_context({**FIGURE_STYLE, "font.size": 9}):
        figure, axes = plt.subplots(1, 3, figsize=(10, 3.2), layout="constrained")
        for axis, key, label in (
            (axes[0], "iteration_cpu_s", "one iteration, s of processor time"),
            (axes[1], "peak_memory_gb", "peak memory, GB"),
        ):
            values = [row[key] for row in rows]
            axis.loglog(cells, [values[-1] * cell / cells[-1] for cell in cells], "--", color="#999999", lw=1)
            axis.loglog(cells, values, "o-", color="#1f5fa8", ms=4)
            axis.set_xlabel("thousand cells, sixteen conditions")
            axis.set_ylabel(label)
            axis.set_xticks(cells, [f"{cell:.0f}" for cell in cells])
            axis.minorticks_off()
        spent = [figures[f"{count} conditions solver_cpu_s"] for count in CONDITIONS]
        axes[2].plot(CONDITIONS, [spent[0] * count for count in CONDITIONS], "--", color="#999999", lw=1)
        axes[2].plot(CONDITIONS, spent, "o-", color="#1f5fa8", ms=4)
        axes[2].set(ylim=(0, 3 * max(spent)), xlabel="conditions", ylabel="all iterations, s of processor time")
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=150)
        plt.close(figure)


def available_memory() -> float:
    """Bytes of memory that nobody uses; infinite where the system does not tell."""
    info = Path("/proc/meminfo")
    lines = info.read_text().splitlines() if info.exists() else []
    return next((1024.0 * float(line.split()[1]) for line in lines if line.startswith("MemAvailable")), float("inf"))


def _apart(cells: int, count: int, iterations: int | None) -> dict[str, float]:
    """`one` in a process of its own."""
    command = [sys.executable, str(Path(__file__)), str(cells), str(count), str(iterations or 0)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()[-1])


def one(cells: int, count: int, iterations: int) -> dict[str, float]:
    """Mesh of about `cells` cells, then `iterations` fine iterations of `count` conditions, or to convergence for 0.

    The cost of an iteration, of all lanes, is the median of those after the first, in ns per cell and lane; memory is
    the peak of the process less what it held before the mesh, in bytes per cell and condition.
    """
    from common import conditions, peak_memory, vehicle_mesh

    from spaceplane.flow.compiled import LANES
    from spaceplane.flow.settings import FlowSettings
    from spaceplane.flow.solve import solve

    solve(vehicle_mesh(5_000), conditions(count), FlowSettings(iterations=3, coarse_iterations=3))
    before, clocks = peak_memory(), (time.perf_counter, time.process_time)
    began = [clock() for clock in clocks]
    mesh = vehicle_mesh(cells)
    meshed = [clock() for clock in clocks]
    ticks = []

    def tick(phase: str, *_) -> None:
        if phase == "fine":
            ticks.append([clock() for clock in clocks])
            if 0 < iterations < len(ticks):
                raise StopIteration  # enough is timed

    limit = {"coarse_iterations": 1, "coarse_levels": 0, "residual_drop": 16.0, "anderson_depth": ANDERSON_DEPTH}
    limit = limit if iterations else {}
    with contextlib.suppress(StopIteration):
        solve(mesh, conditions(count), FlowSettings(**limit), tick)
    ended = [clock() for clock in clocks]
    spans = [[b - a for a, b in itertools.pairwise(x[1:])] for x in zip(*ticks, strict=True)]
    wall, cpu = (statistics.median(span) if span else 0.0 for span in spans)
    share = 1e9 / (mesh.cells * LANES)
    return {
        "cells": mesh.cells,
        "mesh_s": meshed[0] - began[0],
        "mesh_cpu_s": meshed[1] - began[1],
        "iteration_s": wall,
        "iteration_cpu_s": cpu,
        "cpu_ns": cpu * share,
        "wall_ns": wall * share,
        "peak_memory_gb": peak_memory() / 1e9,
        "bytes": (peak_memory() - before) / (mesh.cells * count),
        "solver_s": ended[0] - meshed[0],
        "solver_cpu_s": ended[1] - meshed[1],
    }


if __name__ == "__main__":
    print(json.dumps(one(*(int(value) for value in sys.argv[1:]))))
