"""Local inclination beside the Euler solver on HORUS-2B: coefficients of both and the time that the fast tier takes.

    python scripts/compare_tiers.py [--euler out/fast-tier/euler.nc] [--out docs/data/fast_tier.json]

The Euler coefficients are read from the NetCDF file where it exists, and solved and kept there where it does not (a few
minutes). docs/generate.py makes the page docs/fast-tier.md of the stored result.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path

import xarray as xr

from spaceplane import __version__
from spaceplane.aero.conditions import product
from spaceplane.aero.inclination.settings import METHODS
from spaceplane.aero.inclination.solve import local_inclination
from spaceplane.aero.integrate import TOTAL, integrate
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.build import DEFAULT_SPACING, build
from spaceplane.vehicle.presets import Vehicle, horus_2b

MACHS = (3.0, 5.0, 10.0, 20.0)
ALPHAS_DEG = (10.0, 20.0, 30.0, 40.0)
WALL_CELL = 0.25
SHOWN = ("CL", "CD", "Cm", "Cp_max")
COARSE_SPACING = 0.3
REPEATS = 7


def euler(vehicle: Vehicle, conditions: FlowConditions) -> xr.Dataset:
    """Coefficients by the Euler solver, with its mesh and time as attributes."""
    began = time.perf_counter()
    mesh = generate(build(vehicle.shape), MeshSettings(wall_cell=WALL_CELL))
    data = integrate(solve(mesh, conditions, FlowSettings()), vehicle.reference)
    return data.assign_attrs(cells=mesh.cells, wall_seconds=time.perf_counter() - began)


def milliseconds(vehicle: Vehicle, spacing: float, conditions: FlowConditions, name: str) -> dict:
    """Median time for a condition with triangles of `spacing`, m, cutting into panels included."""
    surface = build(vehicle.shape, spacing=spacing)
    local_inclination(surface, conditions, vehicle.reference, METHODS[name])  # compiles, and makes the tables
    seconds = []
    for _ in range(REPEATS):
        began = time.perf_counter()
        local_inclination(surface, conditions, vehicle.reference, METHODS[name])
        seconds.append(time.perf_counter() - began)
    each = 1e3 * sorted(seconds)[REPEATS // 2] / len(conditions)
    return {"method": name, "triangles": len(surface.triangles), "conditions": len(conditions), "ms": round(each, 2)}


def totals(data: xr.Dataset) -> dict[str, list[float]]:
    """Shown coefficients of the whole vehicle, [condition]."""
    return {name: [round(float(v), 6) for v in data[name].sel(part=TOTAL)] for name in SHOWN}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--euler", type=Path, default=Path("out/fast-tier/euler.nc"))
    parser.add_argument("--out", type=Path, default=Path("docs/data/fast_tier.json"))
    options = parser.parse_args()
    vehicle = horus_2b()
    conditions = product(list(MACHS), [math.radians(a) for a in ALPHAS_DEG], [0.0])
    if options.euler.exists():
        flow = xr.load_dataset(options.euler)
    else:
        flow = euler(vehicle, conditions)
        options.euler.parent.mkdir(parents=True, exist_ok=True)
        flow.to_netcdf(options.euler)
    surface = build(vehicle.shape)
    one = product([10.0], [math.radians(30.0)], [0.0])
    document = {
        "version": __version__,
        "machs": MACHS,
        "alphas_deg": ALPHAS_DEG,
        "wall_cell_m": WALL_CELL,
        "cells": int(flow.attrs["cells"]),
        "euler_seconds": round(float(flow.attrs["wall_seconds"]), 1),
        "euler_verdicts": [str(v) for v in flow.verdict.values],
        "euler": totals(flow),
        "fast": {
            name: totals(local_inclination(surface, conditions, vehicle.reference, settings))
            for name, settings in METHODS.items()
        },
        "times": [
            milliseconds(vehicle, spacing, these, name)
            for spacing in (DEFAULT_SPACING, COARSE_SPACING)
            for name in ("newtonian-expansion", "tangent")
            for these in (conditions, one)
        ],
    }
    options.out.write_text(json.dumps(document, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    print(f"wrote {options.out}")


if __name__ == "__main__":
    main()
