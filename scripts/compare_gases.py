"""Equilibrium air beside the perfect gas on HORUS-2B along an entry: coefficients, centre of pressure and trim.

    python scripts/compare_gases.py [--runs out/real-gas] [--out docs/data/real_gas.json]

The coefficients of each gas and elevon deflection are read from the NetCDF files of earlier runs where they exist, and
solved and kept there where they do not (a few minutes each). docs/generate.py makes the tables of docs/real-gas.md of
the stored result.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path

import numpy as np
import xarray as xr

from spaceplane import __version__
from spaceplane.aero.conditions import in_air, product
from spaceplane.aero.integrate import TOTAL, integrate
from spaceplane.environment.atmosphere import us1976
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import GASES, PERFECT, FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.presets import Vehicle, horus_2b

MACHS, ALTITUDES_M = (5.0, 10.0, 15.0, 20.0), (38e3, 50e3, 58e3, 65e3)
ALPHAS_DEG = (20.0, 30.0, 35.0, 40.0)
CASES = ((0.25, 0.0), (0.25, -20.0), (0.35, 0.0))
"""(wall cell, m; angle of both elevons, deg)."""
SHOWN = ("CL", "CD", "Cm", "CN")


def conditions(gas: str) -> FlowConditions:
    """Every angle of attack at every Mach number and the altitude that goes with it."""
    streams = product(list(MACHS), [math.radians(alpha) for alpha in ALPHAS_DEG], [0.0])
    if gas == PERFECT:
        return streams
    altitude = dict(zip(MACHS, ALTITUDES_M, strict=True))
    return in_air(streams, gas, [us1976(altitude[float(mach)]) for mach in streams.mach])


def coefficients(vehicle: Vehicle, wall_cell: float, elevon_deg: float, gas: str, path: Path) -> xr.Dataset:
    """Coefficients on this wall cell, m, with both elevons at this angle, from the file or solved and kept in it."""
    if path.exists():
        return xr.load_dataset(path)
    began = time.perf_counter()
    deflections = ControlDeflections.from_degrees(elevon_left=elevon_deg, elevon_right=elevon_deg)
    mesh = generate(build(vehicle.shape, deflections), MeshSettings(wall_cell=wall_cell))
    solution = solve(mesh, conditions(gas), FlowSettings())
    data = integrate(solution, vehicle.reference)
    data = data.assign_attrs(cells=mesh.cells, wall_seconds=time.perf_counter() - began)
    path.parent.mkdir(parents=True, exist_ok=True)
    data.to_netcdf(path)
    return data


def totals(data: xr.Dataset) -> dict[str, list[float | str]]:
    """Shown coefficients of the whole vehicle and the verdicts, [condition]."""
    values = {name: [round(float(v), 6) for v in data[name].sel(part=TOTAL)] for name in SHOWN}
    return values | {"verdict": [str(v) for v in data.verdict.values]}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=Path, default=Path("out/real-gas"))
    parser.add_argument("--out", type=Path, default=Path("docs/data/real_gas.json"))
    options = parser.parse_args()
    vehicle = horus_2b()
    runs = []
    for gas in GASES:
        for cell, elevon in CASES:
            data = coefficients(vehicle, cell, elevon, gas, options.runs / f"{gas}{elevon:+g}-{cell:g}.nc")
            run = {"gas": gas, "wall_cell_m": cell, "elevon_deg": elevon, "cells": int(data.attrs["cells"])}
            runs.append(run | totals(data))
    document = {
        "version": __version__,
        "machs": MACHS,
        "altitudes_m": ALTITUDES_M,
        "alphas_deg": ALPHAS_DEG,
        "c_ref_m": float(vehicle.reference.chord),
        "moment_station_m": float(np.asarray(vehicle.reference.moment_center)[0]),
        "runs": runs,
    }
    options.out.write_text(json.dumps(document, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    print(f"wrote {options.out}")


if __name__ == "__main__":
    main()
