"""Seconds of geometry, mesh and solver on HORUS-2B, beside the stored baseline of the same machine.

    python benchmarks/run.py                 the published size: 200 000 cells, 16 conditions
    python benchmarks/run.py --cells 30000   something quick
    python benchmarks/run.py --store         keep the result as this machine's baseline

Kernels are compiled by a tiny warm-up first, so that no figure contains compilation. The baseline holds one entry per
machine (processor, cores, cells, conditions); a machine without one is told so and compared with nothing.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import platform
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.presets import horus_2b

BASELINE = Path(__file__).with_name("baseline.json")
WIDTHS = (3.0, 3.2, 3.3)
DEFLECTED = {"body_flap": -20.0, "elevon_left": -17.5, "elevon_right": -17.5}


def conditions(count: int) -> FlowConditions:
    """`count` free streams from Mach 0.8 to 2.5 and 0 to 20 deg, every fourth with sideslip."""
    index = np.arange(count)
    mach = np.linspace(0.8, 2.5, count)
    return FlowConditions(mach, np.radians(5.0 * (index % 5)), np.radians(2.0) * (index % 4 == 3))


def timed(task: Callable[[], object], repeats: int = 1) -> tuple[float, object]:
    """Median wall seconds of a task, and its last result."""
    seconds, result = [], None
    for _ in range(repeats):
        start = time.perf_counter()
        result = task()
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds), result


def measure(cells: int, count: int) -> dict[str, float]:
    """Every figure of the benchmark."""
    vehicle = horus_2b()
    deflections = ControlDeflections.from_degrees(DEFLECTED)
    warm_up = generate(build(vehicle.shape, deflections), MeshSettings(wall_cell=0.5))
    solve(warm_up, conditions(count), FlowSettings())

    # Parts are remembered between builds: every repeat has a new shape.
    shapes = iter(
        [dataclasses.replace(vehicle.shape, wing_width_m=width, nose_radius_m=0.01 + width / 4) for width in WIDTHS]
    )
    geometry, _ = timed(lambda: build(next(shapes), deflections), repeats=len(WIDTHS))
    surface = build(vehicle.shape, deflections)
    meshing, mesh = timed(lambda: generate(surface, MeshSettings(target_cells=cells)))
    solving, solution = timed(lambda: solve(mesh, conditions(count), FlowSettings()))
    iterations = sum(record.iterations for record in solution.records)
    return {
        "geometry_s": geometry,
        "mesh_s": meshing,
        "solver_s": solving,
        "total_s": geometry + meshing + solving,
        "cells": mesh.cells,
        "conditions": count,
        "converged": sum(record.good for record in solution.records),
        "fine_iterations_mean": iterations / count,
        "ns_per_cell_and_condition_iteration": 1e9 * solving / (mesh.cells * iterations),
    }


def machine(cells: int, count: int) -> str:
    """What a baseline is valid for."""
    model = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        lines = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        model = lines[0].partition(":")[2].strip() if lines else model
    return f"{model}, {len(os.sched_getaffinity(0))} cores, {cells} cells, {count} conditions"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, default=200_000, help="cells of the mesh")
    parser.add_argument("--conditions", type=int, default=16, help="free streams in the ensemble")
    parser.add_argument("--json", type=Path, default=Path("out/benchmark.json"), help="where the figures go")
    parser.add_argument("--store", action="store_true", help="make this the baseline of this machine")
    options = parser.parse_args()

    name = machine(options.cells, options.conditions)
    figures = measure(options.cells, options.conditions)
    stored = json.loads(BASELINE.read_text(encoding="utf-8")) if BASELINE.exists() else {}
    old = stored.get(name, {})
    print(name)
    print(f"{'figure':38s} {'now':>12s} {'baseline':>12s} {'ratio':>7s}")
    for key, value in figures.items():
        before = old.get(key)
        ratio = f"{value / before:7.2f}" if before and key.endswith(("_s", "_iteration")) else ""
        print(f"{key:38s} {value:12.4g} {'-' if before is None else format(before, '12.4g'):>12s} {ratio:>7s}")
    if not old:
        print("no baseline for this machine; --store keeps one")
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps({"machine": name, "figures": figures, "baseline": old or None}, indent=1) + "\n")
    if options.store:
        BASELINE.write_text(json.dumps(stored | {name: figures}, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
