"""The stated numerical uncertainty beside the true error, on meshes like the default one of `analyse`.

    python scripts/check_uncertainty.py [--flows out/uncertainty] [--out docs/data/uncertainty.json]

HORUS-2B, another vehicle and the Basic Finner have a fine mesh as reference, cones their exact solution. Every flow is
solved once and kept as NetCDF in the folder of --flows; the reference of HORUS-2B, 524 000 cells with 44 conditions,
takes about a quarter of an hour on two cores, all the rest twice as long. docs/generate.py makes the page
docs/uncertainty.md of the stored result. Exit code 1 when fewer than 90 % of the intervals hold the true value, or when
the median interval is ten times as wide as the error: on any body, or for longitudinal or lateral coefficients or
derivatives of all bodies or of those held out.

At each Mach number: every coefficient at the base condition, with alpha and Mach number moved either way and in
sideslip, and every stability, damping and (of the vehicles) control derivative. On cones: C_A of the forebody,
C_N_alpha, C_m_alpha and their lateral twins. The error of the reference itself is part of the error found, for what is
stated is meant to hold the limit of ever smaller cells.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import sys
from collections.abc import Callable, Mapping
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
from spaceplane.analysis.settings import DEFLECTIONS_TAEM, QUICK_MESH
from spaceplane.dynamics.flightpoint import flight_point, taem_point
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import bodies, cones
from spaceplane.validation.flowcase import ITERATIONS, reference_of
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.presets import horus_2b
from spaceplane.vehicle.properties import ReferenceLengths
from spaceplane.vehicle.surface import Surface

HORUS, WIDE, FINNER, CONES = "HORUS-2B", "wide vehicle", "Basic Finner", "cones"
HELD_OUT = (WIDE, FINNER)
"""Bodies, at Mach numbers of their own, that nothing in the estimate was chosen by."""
MACHS, OTHER_MACHS = (0.8, 1.5, 2.5, 5.0), (1.2, 2.0, 3.5)
WIDER = {
    "fuselage_width_m": 3.5,
    "wing_width_m": 3.8,
    "wing_thickness_m": 0.28,
    "winglet_angle_deg": 22.0,
    "winglet_length_m": 4.0,
    "nose_radius_m": 0.5,
    "fuselage_length_m": 8.0,
}
"""Shape parameters of the wide vehicle that differ from those of HORUS-2B."""
WIDE_DEFLECTIONS = ControlDeflections.from_degrees(elevon_left=5.0, elevon_right=5.0, body_flap=10.0)
CONTROL_STEP = math.radians(10.0)
CONDITIONS_SHOWN = 6
"""Of each flight point: base, alpha+, alpha-, mach+, mach- and beta; the turning ones are in the derivatives."""
CONE_LAYERS = 9
"""Layers of the finest cells about the cones, the same on the companion."""
LATERAL = ("CY", "Cl", "Cn", "C_Y", "C_n")
NOTHING = 1e-5
"""Below this a value is zero by symmetry, and its error is no test."""
LEAST_COVERED, WIDEST = 0.9, 10.0


@dataclass(frozen=True)
class Body:
    """A body whose reference is a fine mesh.

    Attributes:
        surface: the body.
        reference: lengths.
        plan: conditions.
        mesh: settings of the mesh whose uncertainty is stated.
        fine: settings of the reference mesh.
        moved: control surface to the body with that surface moved by CONTROL_STEP.
    """

    surface: Surface
    reference: ReferenceLengths
    plan: ConditionPlan
    mesh: MeshSettings
    fine: MeshSettings
    moved: Mapping[str, Surface]


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


def finer(settings: MeshSettings, cell: float, growth_layers: int) -> MeshSettings:
    """Settings of a reference mesh."""
    return replace(settings, wall_cell=cell, edge_levels=1, growth_layers=growth_layers)


def horus() -> Body:
    """HORUS-2B with the deflections and the mesh that `analyse` takes by default."""
    vehicle = horus_2b()
    more = {5.0: {"alpha_deg": 10.0, "altitude_m": 20_000.0}}
    points = [taem_point(mach, **more.get(mach, {})) for mach in MACHS]
    return Body(
        build(vehicle.shape, DEFLECTIONS_TAEM),
        vehicle.reference,
        plan(points, DerivativeSteps(), True, reference=vehicle.reference),
        QUICK_MESH,
        MeshSettings(wall_cell=0.08),
        moved_surfaces(vehicle.shape, DEFLECTIONS_TAEM, ("elevon_left",)),
    )


def wide() -> Body:
    """Another vehicle, with other deflections."""
    vehicle = horus_2b()
    shape = replace(vehicle.shape, **WIDER)
    points = [taem_point(mach) for mach in OTHER_MACHS]
    return Body(
        build(shape, WIDE_DEFLECTIONS),
        vehicle.reference,
        plan(points, DerivativeSteps(), True, reference=vehicle.reference),
        QUICK_MESH,
        finer(QUICK_MESH, 0.125, 3),
        moved_surfaces(shape, WIDE_DEFLECTIONS, ("elevon_left",)),
    )


def test_body(surface: Surface, length: float, center: float, fine: float, alpha_deg: float) -> Body:
    """A test body on a mesh as fine as the default one is on HORUS-2B's 25 m.

    Args:
        length: of the body, m.
        center: moment station, m.
        fine: wall cell of the reference mesh on that of the mesh.
        alpha_deg: angle of attack of the base conditions.
    """
    reference = reference_of(math.pi / 4.0, 1.0, (center, 0.0, 0.0))
    points = [flight_point(mach, 10_000.0, alpha_deg) for mach in OTHER_MACHS]
    usual = replace(QUICK_MESH, wall_cell=QUICK_MESH.wall_cell * length / 25.0)
    steps = DerivativeSteps(rate=0.002)
    reference_mesh = finer(usual, fine * usual.wall_cell, usual.growth_layers)
    return Body(surface, reference, plan(points, steps, True, reference=reference), usual, reference_mesh, {})


BODIES: dict[str, Callable[[], Body]] = {
    HORUS: horus,
    WIDE: wide,
    FINNER: lambda: test_body(bodies.basic_finner(), 10.0, 5.5, 0.35, 4.0),
}


def moved_surfaces(shape, deflections: ControlDeflections, names: tuple[str, ...]) -> dict[str, Surface]:
    """The vehicle with each of the surfaces moved."""
    return {
        name: build(shape, replace(deflections, **{name: getattr(deflections, name) + CONTROL_STEP})) for name in names
    }


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


def body_rows(name: str, flows: Path) -> tuple[list[Row], dict]:
    """Rows of a body and the cells of its three meshes."""
    body = BODIES[name]()
    meshes = {"mesh": body.mesh, "companion": coarser(body.mesh, body.mesh.wall_cell), "reference": body.fine}
    base = np.array([p.base for p in body.plan.points])
    mach = body.plan.conditions.mach[base]
    stem = name.lower().replace(" ", "-")

    def on(mesh: str) -> tuple[xr.Dataset, xr.Dataset]:
        found = {}
        for moved, surface in {"": body.surface, **body.moved}.items():
            streams = body.plan.conditions.take(base) if moved else body.plan.conditions
            args = surface, meshes[mesh], streams, body.reference, FlowSettings()
            path = flows / f"{stem}_{mesh}{moved and '_' + moved}.nc"
            found[moved] = kept(path, lambda args=args: solved(*args))
        still = found.pop("")
        slopes = [differentiate(still, body.plan)]
        if found:
            moves = {n: [Move(CONTROL_STEP, still.isel(condition=base), data)] for n, data in found.items()}
            slopes.append(control_derivatives(moves))
        return still, xr.merge(slopes, join="exact")

    (fine, slopes), (coarse, rough), (true, exact) = (on(mesh) for mesh in meshes)
    fine = of_coefficients(fine, coarse, RATIO).sel(part=TOTAL)
    slopes = of_derivatives(slopes, rough, mach, RATIO).sel(part=TOTAL)
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
    usual = MeshSettings(wall_cell=cell, far_field=2.0, wall_layers=CONE_LAYERS, growth_layers=1)
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
        rows.append(row_of(CONES, "coefficient", "C_A forebody", where, front, error, exact))
        slope = CN_ALPHA_STONE[number, round(math.degrees(angle), 6)]
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
    members |= {"held out": HELD_OUT, "all": tuple(members)}
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


def main() -> int:
    """Solve what is missing, compare, print and keep."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--flows", type=Path, default=Path("out/uncertainty"), help="folder of solved flows")
    parser.add_argument("--out", type=Path, default=Path("docs/data/uncertainty.json"), help="stored result")
    options = parser.parse_args()
    rows, meshes = [], []
    for name in BODIES:
        own, cells = body_rows(name, options.flows)
        rows += own
        body = BODIES[name]()
        cell, fine = body.mesh.wall_cell, body.fine.wall_cell
        sizes = {"wall_cell_m": cell, "reference_cell_m": fine, "covered_limit": against_the_limit(own, fine / cell)}
        meshes.append({"case": name, "held_out": name in HELD_OUT} | cells | sizes)
    rows += cone_rows(options.flows)
    found = groups(rows)
    for row in rows:
        mark = "" if abs(row.error) <= row.stated else "  outside"
        print(
            f"{row.case:12s} {row.quantity:15s} {row.condition:32s} {row.value:10.5f} +- {row.stated:8.5f}, "
            f"error {row.error:9.5f}{mark}"
        )
    for one in found:
        print(
            f"{one['case']:12s} {one['side']:12s} {one['kind']:12s} {one['values']:4d} values, "
            f"{100 * one['covered']:.0f} % covered, median of stated over true {one['median_ratio']:.1f}"
        )
    document = {
        "version": __version__,
        "ratio": RATIO,
        "order": ORDER,
        "safety": SAFETY,
        "meshes": meshes,
        "groups": found,
        "rows": [{k: round(v, 7) if isinstance(v, float) else v for k, v in asdict(row).items()} for row in rows],
    }
    options.out.write_text(json.dumps(document, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    judged = [one for one in found if one["kind"] == "all" or one["case"] in ("held out", "all")]
    return int(any(one["covered"] < LEAST_COVERED or one["median_ratio"] > WIDEST for one in judged))


if __name__ == "__main__":
    sys.exit(main())
