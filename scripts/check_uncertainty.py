"""The stated numerical uncertainty beside the true error, on vehicles and on the bodies of the validation.

    python scripts/check_uncertainty.py [--flows out/uncertainty] [--out docs/data/uncertainty.json] [--only CASE ...]

HORUS-2B, another vehicle, the Basic Finner, the HB-2 and the ONERA M6 wing have a fine mesh as reference, cones and
the sphere their exact solution. Every flow is solved once and kept as NetCDF in the folder of --flows: a run that was
broken off goes on where it was, and one after a change of the estimate solves nothing (take a new folder for a new
solver). docs/generate.py makes the page docs/uncertainty.md of the stored result. Exit code 1 when fewer than 90 % of
the intervals hold the true value, or when the median interval is more than ten times as wide as the error: of all
bodies or of those held out, in all and apart for longitudinal and lateral coefficients and derivatives; or on any one
body with at least 20 values, in all, for the median of fewer means little (the sphere has 12 and counts in the others).

At each Mach number: every coefficient at the base condition, with alpha and Mach number moved either way and in
sideslip, and every stability, damping and (of the vehicles) control derivative. On cones: C_A of the forebody,
C_N_alpha, C_m_alpha and their lateral twins. On the sphere: C_A of the front half, and C_D at Mach 0.5. The error of
the reference itself is part of the error found, for what is stated is meant to hold the limit of ever smaller cells.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from uncertainty_cases import BODIES, CONTROL_STEP, HELD_OUT, Body
from uncertainty_flows import Task, kept

from spaceplane import __version__
from spaceplane.aero.derivatives import Move, control_derivatives, differentiate
from spaceplane.aero.exact.blunt_sphere import sphere_flow
from spaceplane.aero.exact.conical import center_of_pressure, taylor_maccoll
from spaceplane.aero.exact.inclined_cone import normal_force_slope
from spaceplane.aero.integrate import TOTAL
from spaceplane.aero.uncertainty.arms import arms_of, floors
from spaceplane.aero.uncertainty.companion import RATIO, coarser
from spaceplane.aero.uncertainty.errors import WITH_ERROR, of_coefficients, of_derivatives
from spaceplane.aero.uncertainty.grid import ORDER, SAFETY, SAFETY_SUPERSONIC, half_width
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import bodies, cones, sphere
from spaceplane.validation.flowcase import ITERATIONS, reference_of

CONES, SPHERE = "cones", "sphere"
STORED = Path("docs/data/uncertainty.json")
CONDITIONS_SHOWN = 6
"""Of each flight point: base, alpha+, alpha-, mach+, mach- and beta; the turning ones are in the derivatives."""
LATERAL = ("CY", "Cl", "Cn", "C_Y", "C_n")
NOTHING = 1e-5
"""Below this a value is zero by symmetry, and its error is no test."""
LEAST_COVERED, WIDEST = 0.9, 10.0
FEWEST = 20
"""Values of one body that are enough to judge it by."""


@dataclass(frozen=True)
class Row:
    """One value, what is stated of its error, and the error.

    Attributes:
        case: name of the body.
        kind: "coefficient" or "derivative".
        side: "longitudinal" or "lateral".
        quantity: such as CL or Cm_alpha.
        condition: where.
        value: on the mesh whose uncertainty is stated.
        stated: half width of its 95 % interval.
        error: value less the exact one, or that on the fine mesh.
    """

    case: str
    kind: str
    side: str
    quantity: str
    condition: str
    value: float
    stated: float
    error: float


def row_of(case: str, kind: str, quantity: str, condition: str, value, stated, true) -> Row:
    """A row; its side is known by the name of the quantity."""
    side = "lateral" if quantity.startswith(LATERAL) else "longitudinal"
    return Row(case, kind, side, quantity, condition, float(value), float(stated), float(value) - float(true))


def body_rows(name: str, body: Body, flows: Path) -> tuple[list[Row], dict]:
    """Rows of a body and the cells of its three meshes."""
    meshes = {"mesh": body.mesh, "companion": coarser(body.mesh, body.mesh.wall_cell), "reference": body.fine}
    base = np.array([p.base for p in body.plan.points])
    mach = body.plan.conditions.mach[base]
    stem = name.lower().replace(", ", "-").replace(" ", "-")

    def on(mesh: str) -> tuple[xr.Dataset, xr.Dataset]:
        found = {}
        for moved, surface in {"": body.surface, **body.moved}.items():
            streams = body.plan.conditions.take(base) if moved else body.plan.conditions
            path = flows / f"{stem}_{mesh}{moved and '_' + moved}.nc"
            found[moved] = kept(path, Task(surface, meshes[mesh], streams, body.reference, FlowSettings()))
        still = found.pop("")
        slopes = [differentiate(still, body.plan)]
        if found:
            moves = {n: [Move(CONTROL_STEP, still.isel(condition=base), data)] for n, data in found.items()}
            slopes.append(control_derivatives(moves))
        return still, xr.merge(slopes, join="exact")

    (fine, slopes), (coarse, rough), (true, exact) = (on(mesh) for mesh in meshes)
    slopes = of_derivatives(slopes, rough, mach, RATIO, arms_of(fine)).sel(part=TOTAL)
    fine = of_coefficients(fine, coarse, RATIO).sel(part=TOTAL)
    true, exact = true.sel(part=TOTAL), exact.sel(part=TOTAL)
    rows = []
    for number, point in enumerate(body.plan.points):
        for index in range(point.base, point.base + CONDITIONS_SHOWN):
            where = f"Mach {mach[number]:g}, {body.plan.labels[index]}"
            rows += [
                row_of(name, "coefficient", q, where, fine[q][index], fine[f"{q}_error"][index], true[q][index])
                for q in WITH_ERROR
            ]
        for q in (str(n) for n in slopes.data_vars if f"{n}_status" in slopes):
            value, error = slopes[q][number], slopes[f"{q}_error"][number]
            rows.append(row_of(name, "derivative", q, f"Mach {mach[number]:g}", value, error, exact[q][number]))
    cells = {mesh: int(data.attrs["cells"]) for mesh, data in (("mesh", fine), ("companion", coarse))}
    return [r for r in rows if abs(r.value) > NOTHING], cells | {"reference": int(true.attrs["cells"])}


def sphere_rows(flows: Path) -> list[Row]:
    """Rows of the sphere on both meshes of the validation."""
    return [row for fine in (False, True) for row in _sphere(flows, fine)]


def _sphere(flows: Path, fine: bool) -> list[Row]:
    """Drag of the front half, and all of the drag where it is none."""
    machs = np.array(sphere.MACHS)
    conditions = FlowConditions(machs, 0.0 * machs, 0.0 * machs)
    reference = reference_of(math.pi, 2.0, (1.0, 0.0, 0.0))
    usual = sphere.mesh_settings(fine)
    cells = round(2.0 / usual.wall_cell)
    pair = []
    for name, mesh in (("mesh", usual), ("companion", coarser(usual, usual.wall_cell))):
        task = Task(bodies.sphere(), mesh, conditions, reference, FlowSettings(iterations=ITERATIONS))
        pair.append(kept(flows / f"sphere_{cells}_{name}.nc", task))
    stated = of_coefficients(*pair, RATIO).sel(part=TOTAL)
    rows = []
    for index, mach in enumerate(sphere.MACHS):
        name, what, exact = "CD", "C_D", 0.0
        if mach > 1.0:
            name, what = "CA_forebody", "C_A forebody"
            exact = sphere_flow(mach, angles=20, last_angle=0.5 * math.pi).front_drag()
        value, error = stated[name][index], stated[f"{name}_error"][index]
        rows.append(row_of(SPHERE, "coefficient", what, f"Mach {mach:g}, {cells} cells across", value, error, exact))
    return rows


def cone_rows(flows: Path) -> list[Row]:
    """Rows of cones whose flow is conical, on the coarser mesh of the validation case."""
    rows = []
    for angle_deg in cones.HALF_ANGLES_DEG:
        angle = math.radians(angle_deg)
        by_mesh: dict[MeshSettings, list[float]] = {}
        for mach in cones.MACHS:
            if taylor_maccoll(mach, angle).surface_mach > 1.0:
                by_mesh.setdefault(cones.mesh_plan(mach, angle, False).settings, []).append(mach)
        for mesh, machs in by_mesh.items():
            rows += _cone(flows, angle, machs, mesh)
    return rows


def _cone(flows: Path, angle: float, machs: list[float], usual: MeshSettings) -> list[Row]:
    step = cones.STEP
    mach = np.repeat(machs, 3)
    alpha, beta = np.tile([0.0, step, 0.0], len(machs)), np.tile([0.0, 0.0, step], len(machs))
    conditions, reference = FlowConditions(mach, alpha, beta), reference_of(math.pi * math.tan(angle) ** 2, 1.0)
    surface = bodies.cone(angle, tail=cones.TAIL)
    pair = []
    for name, mesh in (("mesh", usual), ("companion", coarser(usual, usual.wall_cell))):
        task = Task(surface, mesh, conditions, reference, FlowSettings(iterations=ITERATIONS))
        found = kept(flows / f"cone_{math.degrees(angle):.0f}_{1.0 / usual.wall_cell:.0f}_{name}.nc", task)
        # what is measured is the cone's first metre, not what holds its end
        pair.append(found.sel(part=["forebody"]).assign_coords(part=[TOTAL]))
    along = np.array(machs)
    stated = of_coefficients(*pair, RATIO).sel(part=TOTAL)
    names = ("C_N_alpha", "C_Y_beta", "C_m_alpha", "C_n_beta")
    fine, coarse = (_cone_slopes(data.sel(part=TOTAL), step) for data in pair)
    scales = ["lift", "side", "pitch", "yaw"]
    widths = half_width(fine, coarse, along, scales, RATIO, floors(scales, arms_of(stated), along))
    rows = []
    for i, number in enumerate(machs):
        where = f"Mach {number:g}, half angle {math.degrees(angle):g} deg"
        front, error = float(stated.CA_forebody[3 * i]), float(stated.CA_forebody_error[3 * i])
        exact = taylor_maccoll(number, angle).surface_cp
        rows.append(row_of(CONES, "coefficient", "C_A forebody", where, front, error, exact))
        slope = normal_force_slope(number, angle)
        moment = -slope * center_of_pressure(angle)
        for name, row, width, true in zip(names, fine, widths, (slope, -slope, moment, -moment), strict=True):
            rows.append(row_of(CONES, "derivative", name, where, row[i], width[i], true))
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


def against_the_limit(rows: list[Row], ratio: float) -> float:
    """Share of the intervals that hold the limit of reference and mesh, if errors fall as assumed.

    The reference has an error of its own; where both fall with the assumed power of the cell, that of the mesh is
    larger than the difference between them by 1 / (1 - ratio^ORDER).

    Args:
        rows: of one body.
        ratio: wall cell of the reference on that of the mesh.
    """
    grown = 1.0 / (1.0 - ratio**ORDER)
    return sum(abs(row.error) * grown <= row.stated for row in rows) / len(rows)


def groups(rows: list[Row]) -> list[dict]:
    """Summaries by body, kind and side; "held out" and "all" stand for several bodies."""
    members = {case: (case,) for case in dict.fromkeys(row.case for row in rows)}
    members |= {"held out": (*HELD_OUT, SPHERE), "all": tuple(members)}
    found = []
    for case, names in members.items():
        for kind in ("coefficient", "derivative"):
            for side in ("longitudinal", "lateral"):
                own = [row for row in rows if row.case in names and (row.kind, row.side) == (kind, side)]
                if own:
                    found.append({"case": case, "kind": kind, "side": side} | summary(own))
        own = [row for row in rows if row.case in names]
        if own:
            found.append({"case": case, "kind": "all", "side": "all"} | summary(own))
    return found


def misses(found: list[dict]) -> list[dict]:
    """Of the groups that are judged, those whose intervals hold too little or are too wide."""
    pooled = ("held out", "all")
    judged = [one for one in found if one["case"] in pooled or (one["kind"] == "all" and one["values"] >= FEWEST)]
    return [one for one in judged if one["covered"] < LEAST_COVERED or one["median_ratio"] > WIDEST]


def main() -> int:
    """Solve what is missing, compare, print and keep."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--flows", type=Path, default=Path("out/uncertainty"), help="folder of solved flows")
    parser.add_argument("--out", type=Path, help=f"stored result (default {STORED}; with --only nothing is stored)")
    names = (*BODIES, CONES, SPHERE)
    parser.add_argument("--only", nargs="+", choices=names, metavar="CASE", help=f"of {', '.join(names)}")
    options = parser.parse_args()
    out = options.out or (None if options.only else STORED)
    names = options.only or names
    rows, meshes = [], []
    for number, name in enumerate(names):
        print(f"case {number + 1} of {len(names)}: {name}", file=sys.stderr, flush=True)
        if name == CONES:
            rows += cone_rows(options.flows)
        elif name == SPHERE:
            rows += sphere_rows(options.flows)
        else:
            body = BODIES[name]()
            own, cells = body_rows(name, body, options.flows)
            rows += own
            cell, fine = body.mesh.wall_cell, body.fine.wall_cell
            sizes = {"wall_cell_m": cell, "reference_cell_m": fine}
            limit = {"covered_limit": against_the_limit(own, fine / cell)}
            meshes.append({"case": name, "held_out": name in HELD_OUT} | cells | sizes | limit)
    found = groups(rows)
    for row in rows:
        mark = "" if abs(row.error) <= row.stated else "  outside"
        print(
            f"{row.case:26s} {row.quantity:15s} {row.condition:32s} {row.value:10.5f} +- {row.stated:8.5f}, "
            f"error {row.error:9.5f}{mark}"
        )
    for one in found:
        print(
            f"{one['case']:26s} {one['side']:12s} {one['kind']:12s} {one['values']:4d} values, "
            f"{100 * one['covered']:.0f} % covered, median of stated over true {one['median_ratio']:.1f}"
        )
    document = {
        "version": __version__,
        "ratio": RATIO,
        "order": ORDER,
        "safety": SAFETY,
        "safety_supersonic": SAFETY_SUPERSONIC,
        "meshes": meshes,
        "groups": found,
        "rows": [{k: round(v, 7) if isinstance(v, float) else v for k, v in asdict(row).items()} for row in rows],
    }
    if out is not None:
        out.write_text(json.dumps(document, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    missed = misses(found)
    for one in missed:
        print(f"not as wanted: {one['case']}, {one['side']}, {one['kind']}", file=sys.stderr)
    return int(bool(missed))


if __name__ == "__main__":
    sys.exit(main())
