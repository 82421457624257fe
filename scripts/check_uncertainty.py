"""The stated numerical uncertainty beside the true error: cones with their exact solution, HORUS-2B with a fine mesh.

    python scripts/check_uncertainty.py [--flows out/uncertainty] [--out docs/data/uncertainty.json]

Every flow is solved once and kept as NetCDF in the folder of --flows; the reference of HORUS-2B, 523 000 cells with 44
conditions, takes about fifteen minutes on two cores, all the rest five. docs/generate.py makes the page
docs/uncertainty.md of the stored result. Exit code 1 when fewer than 90 % of the intervals hold the true value, or when
the median interval is ten times as wide as the error, on either body, for coefficients or for derivatives.

On cones: C_A of the forebody, C_N_alpha, C_m_alpha and their lateral twins. On HORUS-2B, at Mach 0.8, 1.5, 2.5 and 5:
every coefficient at the base condition, with alpha and Mach number moved either way and in sideslip, and every
stability, damping and (of the left elevon) control derivative. The error of the reference itself is part of the error
found, for what is stated is meant to hold the limit of ever smaller cells.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import xarray as xr

from spaceplane import __version__
from spaceplane.aero.conditions import ConditionPlan, DerivativeSteps, plan
from spaceplane.aero.derivatives import Move, control_derivatives, differentiate
from spaceplane.aero.exact.conical import CN_ALPHA_STONE, center_of_pressure, taylor_maccoll
from spaceplane.aero.integrate import TOTAL, integrate
from spaceplane.aero.uncertainty.companion import RATIO, coarser
from spaceplane.aero.uncertainty.errors import ARMS, WITH_ERROR, of_coefficients, of_derivatives
from spaceplane.aero.uncertainty.grid import ORDER, SAFETY, half_width
from spaceplane.analysis.settings import DEFLECTIONS_TAEM
from spaceplane.dynamics.flightpoint import taem_point
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import bodies, cones
from spaceplane.validation.flowcase import ITERATIONS, reference_of
from spaceplane.vehicle.build import build
from spaceplane.vehicle.presets import horus_2b
from spaceplane.vehicle.surface import Surface

MACHS = (0.8, 1.5, 2.5, 5.0)
WALL_CELL, REFERENCE_CELL = 0.25, 0.08
ELEVON_STEP = math.radians(10.0)
CONDITIONS_SHOWN = 6
"""Of each flight point: base, alpha+, alpha-, mach+, mach- and beta; the turning ones are in the derivatives."""
NOTHING = 1e-5
"""Below this a value is zero by symmetry, and its error is no test."""
LEAST_COVERED, WIDEST = 0.9, 10.0


@dataclass(frozen=True)
class Row:
    """One value, what is stated of its error, and the error.

    Attributes:
        case: "cones" or "HORUS-2B".
        kind: "coefficient" or "derivative".
        quantity: such as CL or Cm_alpha.
        condition: where.
        value: on the mesh whose uncertainty is stated.
        stated: half width of its 95 % interval.
        error: value less the exact one, or that on the fine mesh.
    """

    case: str
    kind: str
    quantity: str
    condition: str
    value: float
    stated: float
    error: float


def kept(path: Path, make: Callable[[], xr.Dataset]) -> xr.Dataset:
    """Coefficients from the file, or made now and kept there."""
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        print(f"solving {path.stem}", file=sys.stderr, flush=True)
        make().to_netcdf(path)
    return xr.load_dataset(path)


def solved(surface: Surface, mesh: MeshSettings, conditions: FlowConditions, reference, settings) -> xr.Dataset:
    """Coefficients on one mesh, with its number of cells."""
    made = generate(surface, mesh)
    return integrate(solve(made, conditions, settings), reference).assign_attrs(cells=made.cells)


def horus(flows: Path) -> tuple[list[Row], dict]:
    """Rows of HORUS-2B and the cells of the three meshes."""
    vehicle = horus_2b()
    more = {5.0: {"alpha_deg": 10.0, "altitude_m": 20_000.0}}
    points = [taem_point(mach, **more.get(mach, {})) for mach in MACHS]
    ensemble = plan(points, DerivativeSteps(), True, reference=vehicle.reference)
    moved = replace(DEFLECTIONS_TAEM, elevon_left=DEFLECTIONS_TAEM.elevon_left + ELEVON_STEP)
    usual = MeshSettings(wall_cell=WALL_CELL)
    meshes = {
        "mesh": usual,
        "companion": coarser(usual, WALL_CELL),
        "reference": MeshSettings(wall_cell=REFERENCE_CELL),
    }

    def on(name: str) -> tuple[xr.Dataset, xr.Dataset]:
        found = []
        rows = np.array([p.base for p in ensemble.points])
        for ending, deflections, conditions in (
            ("", DEFLECTIONS_TAEM, ensemble.conditions),
            ("_elevon", moved, ensemble.conditions.take(rows)),
        ):
            args = build(vehicle.shape, deflections), meshes[name], conditions, vehicle.reference, FlowSettings()
            found.append(kept(flows / f"horus_{name}{ending}.nc", lambda args=args: solved(*args)))
        return found[0], _derivatives(*found, ensemble)

    (fine, slopes), (coarse, rough), (true, exact) = (on(name) for name in meshes)
    fine = of_coefficients(fine, coarse, RATIO).sel(part=TOTAL)
    slopes = of_derivatives(slopes, rough, np.array(MACHS), RATIO).sel(part=TOTAL)
    true, exact = true.sel(part=TOTAL), exact.sel(part=TOTAL)
    rows = []
    for number, point in enumerate(ensemble.points):
        for index in range(point.base, point.base + CONDITIONS_SHOWN):
            where = f"Mach {MACHS[number]:g}, {ensemble.labels[index]}"
            rows += [
                _row("coefficient", name, where, fine[name][index], fine[f"{name}_error"][index], true[name][index])
                for name in WITH_ERROR
            ]
        for name in (str(n) for n in slopes.data_vars if f"{n}_status" in slopes):
            value, error = slopes[name][number], slopes[f"{name}_error"][number]
            rows.append(_row("derivative", name, f"Mach {MACHS[number]:g}", value, error, exact[name][number]))
    cells = {name: int(data.attrs["cells"]) for name, data in (("mesh", fine), ("companion", coarse))}
    return [r for r in rows if abs(r.value) > NOTHING], cells | {"reference": int(true.attrs["cells"])}


def _derivatives(base: xr.Dataset, moved: xr.Dataset, ensemble: ConditionPlan) -> xr.Dataset:
    rows = [p.base for p in ensemble.points]
    moves = {"elevon_left": [Move(ELEVON_STEP, base.isel(condition=rows), moved)]}
    return xr.merge([differentiate(base, ensemble), control_derivatives(moves)], join="exact")


def _row(kind: str, name: str, where: str, value, stated, true) -> Row:
    return Row("HORUS-2B", kind, name, where, float(value), float(stated), float(value) - float(true))


def cone_rows(flows: Path) -> list[Row]:
    """Rows of cones whose flow is conical, on the coarser setting of the validation case."""
    rows = []
    for angle_deg in cones.HALF_ANGLES_DEG:
        angle = math.radians(angle_deg)
        by_cell: dict[float, list[float]] = {}
        for mach in cones.MACHS:
            if taylor_maccoll(mach, angle).surface_mach > 1.0:
                by_cell.setdefault(cones.wall_cell(mach, angle, False), []).append(mach)
        for cell, machs in by_cell.items():
            rows += _cone(flows, angle, machs, cell)
    return rows


def _cone(flows: Path, angle: float, machs: list[float], cell: float) -> list[Row]:
    step = cones.STEP
    mach = np.repeat(machs, 3)
    alpha, beta = np.tile([0.0, step, 0.0], len(machs)), np.tile([0.0, 0.0, step], len(machs))
    conditions, reference = FlowConditions(mach, alpha, beta), reference_of(math.pi * math.tan(angle) ** 2, 1.0)
    usual = MeshSettings(wall_cell=cell, far_field=2.0, wall_layers=cones.WALL_LAYERS, growth_layers=1)
    pair = []
    for name, mesh in (("mesh", usual), ("companion", coarser(usual, cell))):
        args = bodies.cone(angle), mesh, conditions, reference, FlowSettings(iterations=ITERATIONS)
        path = flows / f"cone_{math.degrees(angle):.0f}_{1.0 / cell:.0f}_{name}.nc"
        pair.append(kept(path, lambda args=args: solved(*args)))
    along = np.array(machs)
    stated = of_coefficients(*pair, RATIO).sel(part=TOTAL)
    names = ("C_N_alpha", "C_Y_beta", "C_m_alpha", "C_n_beta")
    fine, coarse = (_cone_slopes(data.sel(part=TOTAL), step) for data in pair)
    widths = half_width(fine, coarse, along, ["lift", "side", "pitch", "lateral"], RATIO, ARMS)
    rows = []
    for i, number in enumerate(machs):
        where = f"Mach {number:g}, half angle {math.degrees(angle):g} deg"
        front, error = float(stated.CA_forebody[3 * i]), float(stated.CA_forebody_error[3 * i])
        exact = taylor_maccoll(number, angle).surface_cp
        rows.append(Row("cones", "coefficient", "C_A forebody", where, front, error, front - exact))
        slope = CN_ALPHA_STONE[number, round(math.degrees(angle), 6)]
        moment = -slope * center_of_pressure(angle)
        for name, row, width, true in zip(names, fine, widths, (slope, -slope, moment, -moment), strict=True):
            rows.append(Row("cones", "derivative", name, where, row[i], width[i], row[i] - true))
    return rows


def _cone_slopes(data: xr.Dataset, step: float) -> np.ndarray:
    """[quantity, Mach number] slopes per rad of CN, of the side force along the body's y axis, of Cm and of Cn."""
    side = (data.CY - data.CA * np.sin(data.beta)) / np.cos(data.beta)
    pitch, yaw = slice(1, None, 3), slice(2, None, 3)
    pairs = ((data.CN, pitch), (side, yaw), (data.Cm, pitch), (data.Cn, yaw))
    return np.stack([(values.values[at] - values.values[::3]) / step for values, at in pairs])


def summary(rows: list[Row]) -> dict:
    """How many intervals hold the true value, and how wide they are."""
    ratios = [row.stated / max(abs(row.error), 1e-12) for row in rows]
    return {
        "values": len(rows),
        "covered": sum(abs(row.error) <= row.stated for row in rows) / len(rows),
        "median_ratio": statistics.median(ratios),
    }


def against_the_limit(rows: list[Row]) -> float:
    """Share of HORUS-2B's intervals that hold the limit of reference and mesh, if errors fall as assumed.

    The reference has an error of its own; where both fall with the assumed power of the cell, that of the mesh is
    larger than the difference between them by 1 / (1 - ratio of the cells to that power).
    """
    grown = 1.0 / (1.0 - (REFERENCE_CELL / WALL_CELL) ** ORDER)
    own = [row for row in rows if row.case == "HORUS-2B"]
    return sum(abs(row.error) * grown <= row.stated for row in own) / len(own)


def groups(rows: list[Row]) -> list[dict]:
    """Summaries by case and kind, of each case and of each kind."""
    found = []
    for case in (*dict.fromkeys(row.case for row in rows), "all"):
        for kind in ("coefficient", "derivative", "all"):
            own = [row for row in rows if case in (row.case, "all") and kind in (row.kind, "all")]
            found.append({"case": case, "kind": kind} | summary(own))
    return found


def main() -> int:
    """Solve what is missing, compare, print and keep."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--flows", type=Path, default=Path("out/uncertainty"), help="folder of solved flows")
    parser.add_argument("--out", type=Path, default=Path("docs/data/uncertainty.json"), help="stored result")
    options = parser.parse_args()
    rows, cells = horus(options.flows)
    rows += cone_rows(options.flows)
    found = groups(rows)
    for row in rows:
        mark = "" if abs(row.error) <= row.stated else "  outside"
        print(
            f"{row.case:9s} {row.quantity:15s} {row.condition:32s} {row.value:10.5f} +- {row.stated:8.5f}, "
            f"error {row.error:9.5f}{mark}"
        )
    for one in found:
        print(
            f"{one['case']:9s} {one['kind']:12s} {one['values']:4d} values, {100 * one['covered']:.0f} % covered, "
            f"median of stated over true {one['median_ratio']:.1f}"
        )
    print(f"HORUS-2B, reference extrapolated with the assumed order: {100 * against_the_limit(rows):.0f} % covered")
    document = {
        "version": __version__,
        "wall_cell_m": WALL_CELL,
        "reference_cell_m": REFERENCE_CELL,
        "cells": cells,
        "ratio": RATIO,
        "order": ORDER,
        "safety": SAFETY,
        "covered_limit": against_the_limit(rows),
        "groups": found,
        "rows": [{k: round(v, 7) if isinstance(v, float) else v for k, v in asdict(row).items()} for row in rows],
    }
    options.out.write_text(json.dumps(document, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    judged = [one for one in found if "all" in (one["case"], one["kind"])]
    return int(any(one["covered"] < LEAST_COVERED or one["median_ratio"] > WIDEST for one in judged))


if __name__ == "__main__":
    sys.exit(main())
