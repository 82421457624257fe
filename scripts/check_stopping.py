"""Compare what the stopping rule gives with runs that go on for ten times as long: HORUS-2B, 16 conditions.

Examples:
    python scripts/check_stopping.py --cell 0.25 --json docs/data/stopping.json --plot docs/images/convergence.png
    python scripts/check_stopping.py --benchmark --precision double --decades 5 --end-game 3
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path

import numpy as np

from spaceplane.analysis.settings import DEFLECTIONS_TAEM
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions, Solution
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.build import build
from spaceplane.vehicle.presets import horus_2b

MACH, ALPHA_DEG = (0.5, 0.8, 0.95, 1.2, 1.5, 2.5, 5.0, 10.0), (5.0, 15.0)
SHOWN_ITERATIONS = 200
NEVER = 16.0
"""Decades that no run reaches: it ends when its residual has stood still."""


def grid(cell: float) -> tuple[Mesh, FlowConditions]:
    """The vehicle as at the TAEM interface on this wall cell, m; all Mach numbers at both angles of attack."""
    mach = np.repeat(MACH, len(ALPHA_DEG))
    alpha = np.radians(np.tile(ALPHA_DEG, len(MACH)))
    mesh = generate(build(horus_2b().shape, DEFLECTIONS_TAEM), MeshSettings(wall_cell=cell))
    return mesh, FlowConditions(mach, alpha, 0.0 * mach)


def benchmark() -> tuple[Mesh, FlowConditions]:
    """Mesh and conditions that `benchmarks/run.py` times."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
    from common import conditions, vehicle_mesh

    return vehicle_mesh(300_000), conditions(16)


def main() -> None:
    """Run both and print the differences."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cell", type=float, default=0.25, help="wall cell, m")
    parser.add_argument("--benchmark", action="store_true", help="mesh and conditions of the benchmark instead")
    parser.add_argument("--decades", type=float, default=NEVER, help="of the long run; by default as many as it falls")
    parser.add_argument("--end-game", type=float, default=NEVER, help="decades at which its end game may begin")
    parser.add_argument("--iterations", type=int, default=450, help="most iterations of the long run")
    parser.add_argument("--precision", choices=("single", "double"), default="single", help="of the long run")
    parser.add_argument("--json", type=Path, help="write every record here")
    parser.add_argument("--plot", type=Path, help="draw the histories of the long run here, PNG")
    options = parser.parse_args()

    mesh, conditions = benchmark() if options.benchmark else grid(options.cell)
    usual = solve(mesh, conditions)
    patient = FlowSettings(
        residual_drop=options.decades,
        end_game_drop=options.end_game,
        least_drop=options.decades,
        iterations=options.iterations,
        precision=options.precision,
        window=2 * FlowSettings().window,  # waits twice as long for a residual that stands still
    )
    long = solve(mesh, conditions, patient)
    rows = []
    for i, (one, other) in enumerate(zip(usual.records, long.records, strict=True)):
        force = other.window_mean
        rows.append(
            {
                "mach": float(conditions.mach[i]),
                "alpha_deg": math.degrees(conditions.alpha[i]),
                "beta_deg": math.degrees(conditions.beta[i]),
                "verdict": one.verdict,
                "iterations": one.iterations,
                "decades": one.residual_drop,
                "long_iterations": other.iterations,
                "long_decades": -float(other.residual_history.min()),
                "force_percent": 100.0 * float(np.linalg.norm(one.window_mean - force) / np.linalg.norm(force)),
                "axial_percent": 100.0 * float(one.window_mean[0] / force[0] - 1.0),
                "normal_percent": 100.0 * float(one.window_mean[2] / force[2] - 1.0),
                "spread_percent": 100.0 * float(one.window_spread.max() / np.linalg.norm(force)),
            }
        )
    print(f"{mesh.cells} cells")
    print("Mach alpha  stop: its decades  long: its decades  force, axial, normal differ by %")
    for r in rows:
        print(
            f"{r['mach']:4.3g} {r['alpha_deg']:5.0f} {r['iterations']:10d} {r['decades']:7.2f} "
            f"{r['long_iterations']:10d} {r['long_decades']:7.2f} "
            f"{r['force_percent']:10.3f} {r['axial_percent']:+.3f} {r['normal_percent']:+.3f}"
        )
    if options.json:
        options.json.write_text(json.dumps({"cells": mesh.cells, "rows": rows}, indent=1) + "\n", encoding="utf-8")
    if options.plot:
        plot(conditions, usual, long, options.plot)


def plot(conditions: FlowConditions, usual: Solution, long: Solution, path: Path) -> None:
    """Residual and distance of the force from its last mean, by iteration; dots where the stopping rule ends a run."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (upper, lower) = pyplot.subplots(2, 1, figsize=(8.0, 8.0), sharex=True, layout="constrained")
    machs, alphas = (np.unique(values.round(6)) for values in (conditions.mach, conditions.alpha))
    colours = pyplot.get_cmap("viridis")(np.linspace(0.0, 0.95, len(machs)))
    shown = min(max(len(record.residual_history) for record in long.records), SHOWN_ITERATIONS)
    for i, (one, other) in enumerate(zip(usual.records, long.records, strict=True)):
        mach, alpha = conditions.mach[i], conditions.alpha[i]
        line = ("--", "-", "-.", ":", (0, (5, 1, 1, 1, 1, 1)))[int(np.argmin(np.abs(alphas - alpha)))]
        style = {"color": colours[int(np.argmin(np.abs(machs - mach)))], "linestyle": line, "lw": 1.2}
        residual = other.residual_history[:shown]
        force = other.force_history
        away = np.linalg.norm(force - other.window_mean, axis=1) / np.linalg.norm(other.window_mean)
        upper.plot(residual, label=f"Mach {mach:.3g}, {math.degrees(alpha):.0f} deg", **style)
        lower.semilogy(100.0 * np.maximum(away[:shown], 1e-6), **style)
        stop = one.iterations
        if stop < len(residual):
            upper.plot(stop, residual[stop], "o", color=style["color"], ms=5)
            lower.semilogy(stop, max(100.0 * away[stop], 1e-4), "o", color=style["color"], ms=5)
    upper.set_ylabel("density residual, decades")
    upper.legend(fontsize=7, ncols=2)
    lower.axhline(0.1, color="grey", lw=0.8)
    lower.set_ylim(1e-4, 1e2)
    lower.set_ylabel("force: distance from its last mean, %")
    lower.set_xlabel("iterations on the fine mesh")
    for axes in (upper, lower):
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
