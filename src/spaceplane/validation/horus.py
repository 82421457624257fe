"""Validation case: HORUS-2B against its published aerodynamic tables.

Judged against the 30 % that the thesis asks for: C_L and C_D of the clean vehicle from 10 to 20 deg, where it flies,
and by impact theory. Every other row is shown with its deviation, inside or outside the same band, and
docs/validation.md says why: C_m hangs on a reference point that was never printed, C_L near zero on the camber of a
shape known from a table of sizes only, control increments and the lateral point on methods of 1988 that know no base
flow.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr

from spaceplane.aero.inclination.settings import InclinationSettings
from spaceplane.aero.inclination.solve import local_inclination
from spaceplane.aero.integrate import integrate
from spaceplane.flow.solution import FlowConditions
from spaceplane.mesh.settings import MeshSettings
from spaceplane.plain import finite
from spaceplane.validation import horus_tables
from spaceplane.validation.cases import Progress
from spaceplane.validation.flowcase import solve_body
from spaceplane.validation.records import Record
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.presets import Vehicle, horus_2b
from spaceplane.vehicle.properties import ReferenceLengths

CASE = "horus"
MACHS = (1.5, 2.0, 3.0)
ALPHAS_DEG = (0.0, 5.0, 10.0, 15.0, 20.0)
LATERAL_MACH, LATERAL_ALPHA_DEG, LATERAL_STEP_DEG = 2.5, 16.6, 2.0
IMPACT_MACH, IMPACT_ALPHAS_DEG = 20.0, (20.0, 25.0, 30.0, 35.0, 40.0, 45.0)
BAND, JUDGED_FROM_DEG = 0.30, 10.0
ROUNDING = {"CL": 0.005, "CD": 0.005, "Cm": 0.0005, "dCL": 0.0005, "dCD": 0.0005, "dCm": 0.00005}
"""Half a unit of the last printed digit of the base tables and of the increments."""
CELL_FINE, CELL_COARSE = 0.25, 0.4


@dataclass(frozen=True)
class Configuration:
    """A setting of the controls that the tables give increments for.

    Attributes:
        name: as shown in the table.
        deflections_deg: control -> deg.
        table: name of the table of increments; empty for the clean vehicle.
        deflection_deg: row of that table, deg.
        share: fraction of the computed increment that the table's belongs to (one elevon of a pair: 0.5).
    """

    name: str
    deflections_deg: dict[str, float]
    table: str = ""
    deflection_deg: float = 0.0
    share: float = 1.0


CLEAN = Configuration("clean", {})
DEFLECTED = (
    Configuration("body flap -20 deg", {"body_flap": -20.0}, "bodyflap", -20.0),
    Configuration("one elevon -10 deg", {"elevon_left": -10.0, "elevon_right": -10.0}, "one_elevon", -10.0, 0.5),
    Configuration("one elevon -20 deg", {"elevon_left": -20.0, "elevon_right": -20.0}, "one_elevon", -20.0, 0.5),
)


def run(fine: bool, progress: Progress) -> list[Record]:
    """C_L, C_D and C_m over alpha at Mach 1.5, 2 and 3, increments of flap and elevons, and the lateral point.

    Args:
        fine: wall cells of 0.25 m instead of 0.4 m.
        progress: told what runs.
    """
    vehicle, cell = horus_2b(), CELL_FINE if fine else CELL_COARSE
    stages = 1 + len(DEFLECTED)
    progress("clean", 0.0)
    clean = coefficients(vehicle, CLEAN, cell, progress)
    records = static_records(clean) + impact_records(vehicle) + lateral_records(clean)
    records += moment_center_records(clean, vehicle)
    for index, configuration in enumerate(DEFLECTED):
        progress(configuration.name, (1 + index) / stages)
        records += increment_records(clean, coefficients(vehicle, configuration, cell), configuration)
    return records


def conditions(lateral: bool) -> FlowConditions:
    """The grid of the tables, Mach varying slowest; with `lateral`, a sideslip at the lateral point last.

    The vehicle is symmetric to round-off, so one sideslip gives the lateral derivatives.
    """
    grid = [(mach, math.radians(alpha), 0.0) for mach in MACHS for alpha in ALPHAS_DEG]
    if lateral:
        grid.append((LATERAL_MACH, math.radians(LATERAL_ALPHA_DEG), math.radians(LATERAL_STEP_DEG)))
    return FlowConditions(*np.array(grid).T.copy())


def coefficients(
    vehicle: Vehicle, configuration: Configuration, cell: float, progress: Progress | None = None
) -> xr.Dataset:
    """Total coefficients on the grid of the tables. An unconverged condition has NaN.

    Args:
        vehicle: shape and reference lengths.
        configuration: of the controls.
        cell: wall cell, m.
        progress: see `flowcase.solve_body`.
    """
    surface = build(vehicle.shape, ControlDeflections.from_degrees(**configuration.deflections_deg))
    solution = solve_body(surface, MeshSettings(wall_cell=cell), conditions(lateral=configuration is CLEAN), progress)
    total = integrate(solution, vehicle.reference).sel(part="total")
    return total.where([record.good for record in solution.records])


def static_records(clean: xr.Dataset) -> list[Record]:
    """The clean vehicle against the base tables."""
    return [
        _record(f"{name}", mach, alpha, horus_tables.base(name).at(mach, alpha), float(clean[name][index]), name)
        for name in horus_tables.COEFFICIENTS
        for index, (mach, alpha) in enumerate(_grid())
    ]


def increment_records(clean: xr.Dataset, deflected: xr.Dataset, configuration: Configuration) -> list[Record]:
    """Increments by deflection against the tables of increments."""
    records = []
    for name in horus_tables.COEFFICIENTS:
        table = horus_tables.increment(name, configuration.table)
        for index, (mach, alpha) in enumerate(_grid()):
            published = table.at(mach, alpha, configuration.deflection_deg)
            computed = configuration.share * float(deflected[name][index] - clean[name][index])
            records.append(_record(f"d{name}, {configuration.name}", mach, alpha, published, computed, f"d{name}"))
    return records


def lateral_records(clean: xr.Dataset) -> list[Record]:
    """The one published lateral point; the last condition of `clean` is its sideslip."""
    records = []
    for name, published in horus_tables.LATERAL_POINT.items():
        computed = float(clean[name.removesuffix("_beta")][-1]) / LATERAL_STEP_DEG
        records.append(
            Record(
                case=CASE,
                quantity=name,
                condition=f"Mach {LATERAL_MACH:g}, alpha {LATERAL_ALPHA_DEG:g} deg",
                unit="1/deg",
                published=published,
                computed=finite(computed),
                band=BAND,
                kind="relative",
                source=horus_tables.SOURCE,
                gate=False,
            )
        )
    return records


def impact_records(vehicle: Vehicle) -> list[Record]:
    """The clean vehicle at Mach 20 by impact theory against the base tables: a check of the shape alone."""
    struck = impact(vehicle)
    return [
        _record(
            f"{name}, impact theory",
            IMPACT_MACH,
            alpha,
            horus_tables.base(name).at(IMPACT_MACH, alpha),
            float(struck[name][index]),
            name,
        )
        for index, alpha in enumerate(IMPACT_ALPHAS_DEG)
        for name in ("CL", "CD")
    ]


def impact(vehicle: Vehicle) -> xr.Dataset:
    """Total coefficients of the clean vehicle by modified Newtonian theory at IMPACT_ALPHAS_DEG, without shadows."""
    alpha = np.radians(IMPACT_ALPHAS_DEG)
    conditions = FlowConditions(np.full(len(alpha), IMPACT_MACH), alpha, np.zeros(len(alpha)))
    settings = InclinationSettings(leeward="free_stream", shadow=False)
    return local_inclination(build(vehicle.shape), conditions, vehicle.reference, settings).sel(part="total")


@dataclass(frozen=True)
class MomentCenterFit:
    """The moment centre that would bring computed pitching moments closest to the published ones.

    Attributes:
        x: station, m aft of the nose.
        z: height, m.
        before: root-mean-square difference of C_m at the centre used.
        after: the same at (x, z).
    """

    x: float
    z: float
    before: float
    after: float


def fit_moment_center(
    normal: np.ndarray, axial: np.ndarray, gap: np.ndarray, reference: ReferenceLengths, vary: str = "xz"
) -> MomentCenterFit:
    """Least-squares moment centre.

    Moving the centre aft by dx and up by dz changes C_m by (C_N dx - C_A dz) / c_ref.

    Args:
        normal: [row] computed C_N.
        axial: [row] computed C_A.
        gap: [row] published less computed C_m; rows that are not finite are left out.
        reference: its moment centre, m, is the one that C_m was computed about.
        vary: "x", "z" or "xz": which coordinates may move.
    """
    columns = {"x": normal / reference.chord, "z": -axial / reference.chord}
    known = np.isfinite(gap)
    matrix = np.column_stack([columns[name] for name in vary])[known]
    shift, *_ = np.linalg.lstsq(matrix, gap[known], rcond=None)
    move = dict(zip(vary, shift.tolist(), strict=True))
    center = reference.moment_center
    return MomentCenterFit(
        x=center[0] + move.get("x", 0.0),
        z=center[2] + move.get("z", 0.0),
        before=float(np.sqrt(np.mean(gap[known] ** 2))),
        after=float(np.sqrt(np.mean((gap[known] - matrix @ shift) ** 2))),
    )


def moment_center_records(clean: xr.Dataset, vehicle: Vehicle) -> list[Record]:
    """The moment centre used beside the ones that fit the published C_m best; shown, not judged."""
    count, table, reference = len(_grid()), horus_tables.base("Cm"), vehicle.reference
    gap = np.array([table.at(mach, alpha) for mach, alpha in _grid()]) - clean.Cm.values[:count]
    flow = (clean.CN.values[:count], clean.CA.values[:count], gap)
    struck = impact(vehicle)
    impact_gap = np.array([table.at(IMPACT_MACH, alpha) for alpha in IMPACT_ALPHAS_DEG]) - struck.Cm.values
    hypersonic = (struck.CN.values, struck.CA.values, impact_gap)
    low, high = "flow, Mach 1.5 to 3, alpha 0 to 20 deg", "impact theory, Mach 20, alpha 20 to 45 deg"
    fits = (
        ("station, height kept", 0, low, fit_moment_center(*flow, reference, "x")),
        ("station, height free", 0, low, fit_moment_center(*flow, reference, "xz")),
        ("height, station free", 2, low, fit_moment_center(*flow, reference, "xz")),
        ("station, height kept", 0, high, fit_moment_center(*hypersonic, reference, "x")),
    )
    return [
        Record(
            case=CASE,
            quantity=f"moment centre by C_m: {what}",
            condition=f"{where}; rms difference of C_m {fit.before:.4f} before, {fit.after:.4f} after",
            unit="m",
            published=reference.moment_center[axis],
            computed=finite(fit.x if axis == 0 else fit.z),
            band=0.5,
            kind="absolute",
            source=horus_tables.SOURCE,
            gate=False,
        )
        for what, axis, where, fit in fits
    ]


def _grid() -> list[tuple[float, float]]:
    return [(mach, alpha) for mach in MACHS for alpha in ALPHAS_DEG]


def _judged(quantity: str, alpha: float) -> bool:
    return "impact" in quantity or (quantity in ("CL", "CD") and alpha >= JUDGED_FROM_DEG)


def _record(quantity: str, mach: float, alpha: float, published: float, computed: float, name: str) -> Record:
    return Record(
        case=CASE,
        quantity=quantity,
        condition=f"Mach {mach:g}, alpha {alpha:g} deg",
        unit="-",
        published=published,
        computed=finite(computed),
        band=BAND,
        kind="relative",
        source=horus_tables.SOURCE,
        floor=ROUNDING[name],
        gate=_judged(quantity, alpha),
    )
