"""Compare what the stopping rule gives with runs that go on for ten times as long: HORUS-2B, 16 conditions.

Example: python scripts/check_stopping.py --cell 0.25 --json stopping.json
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path

import numpy as np

from spaceplane.analysis.settings import DEFLECTIONS_TAEM
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.build import build
from spaceplane.vehicle.presets import horus_2b

MACH, ALPHA_DEG = (0.5, 0.8, 0.95, 1.2, 1.5, 2.5, 5.0, 10.0), (5.0, 15.0)
NEVER = 16.0
"""Decades that no run reaches: it ends when its residual has stood still."""


def main() -> None:
    """Run both and print the differences."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cell", type=float, default=0.25, help="wall cell, m")
    parser.add_argument("--iterations", type=int, default=450, help="most iterations of the long run")
    parser.add_argument("--precision", choices=("single", "double"), default="single", help="of the long run")
    parser.add_argument("--json", type=Path, help="write every record here")
    options = parser.parse_args()

    mesh = generate(build(horus_2b().shape, DEFLECTIONS_TAEM), MeshSettings(wall_cell=options.cell))
    mach = np.repeat(MACH, len(ALPHA_DEG))
    alpha = np.radians(np.tile(ALPHA_DEG, len(MACH)))
    conditions = FlowConditions(mach, alpha, 0.0 * mach)
    usual = solve(mesh, conditions)
    patient = FlowSettings(
        residual_drop=NEVER, least_drop=NEVER, iterations=options.iterations, precision=options.precision
    )
    long = solve(mesh, conditions, patient)
    rows = []
    for i, (one, other) in enumerate(zip(usual.records, long.records, strict=True)):
        force = other.window_mean
        rows.append(
            {
                "mach": float(mach[i]),
                "alpha_deg": math.degrees(alpha[i]),
                "verdict": one.verdict,
                "iterations": one.iterations,
                "decades": one.residual_drop,
                "long_iterations": other.iterations,
                "long_decades": -float(other.residual_history.min()),
                "force_percent": 100.0 * float(np.linalg.norm(one.window_mean - force) / np.linalg.norm(force)),
                "axial_percent": 100.0 * float(one.window_mean[0] / force[0] - 1.0),
                "normal_percent": 100.0 * float(one.window_mean[2] / force[2] - 1.0),
            }
        )
    print(f"{mesh.cells} cells")
    print("Mach alpha  stop: its decades  long: its decades  force, axial, normal differ by %")
    for r in rows:
        print(
            f"{r['mach']:4g} {r['alpha_deg']:5.0f} {r['iterations']:10d} {r['decades']:7.2f} "
            f"{r['long_iterations']:10d} {r['long_decades']:7.2f} "
            f"{r['force_percent']:10.3f} {r['axial_percent']:+.3f} {r['normal_percent']:+.3f}"
        )
    if options.json:
        options.json.write_text(json.dumps({"cells": mesh.cells, "rows": rows}, indent=1))


if __name__ == "__main__":
    main()
