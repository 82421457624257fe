"""Validation case: HORUS-2B against its published aerodynamic tables."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr

from spaceplane.aero.integrate import integrate
from spaceplane.flow.solution import FlowConditions
from spaceplane.mesh.settings import MeshSettings
from spaceplane.validation import horus_tables
from spaceplane.validation.cases import Progress
from spaceplane.validation.flowcase import solve_body
from spaceplane.validation.records import Record
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import ControlDeflections
from spaceplane.vehicle.presets import Vehicle, horus_2b

CASE = "horus"
MACHS = (1.5, 2.0, 3.0)
ALPHAS_DEG = (0.0, 5.0, 10.0, 15.0, 20.0)
LATERAL_MACH, LATERAL_ALPHA_DEG, LATERAL_STEP_DEG = 2.5, 16.6, 1.0
BAND = 0.30
ROUNDING = {"CL": 0.005, "CD": 0.005, "Cm": 0.0005}
CELL_FINE, CELL_COARSE = 0.125, 0.25


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
        fine: wall cells of 0.125 m instead of 0.25 m.
        progress: told what runs.
    """
    vehicle, cell = horus_2b(), CELL_FINE if fine else CELL_COARSE
    stages = 1 + len(DEFLECTED)
    progress("clean", 0.0)
    clean = coefficients(vehicle, CLEAN, cell)
    records = static_records(clean) + lateral_records(clean) + moment_center_records(clean)
    for index, configuration in enumerate(DEFLECTED):
        progress(configuration.name, (1 + index) / stages)
        records += increment_records(clean, coefficients(vehicle, configuration, cell), configuration)
    return records


def conditions(lateral: bool) -> FlowConditions:
    """The grid of the tables, Mach varying slowest; with `lateral`, the two sideslips of the lateral point last."""
    grid = [(mach, math.radians(alpha), 0.0) for mach in MACHS for alpha in ALPHAS_DEG]
    if lateral:
        step = math.radians(LATERAL_STEP_DEG)
        grid += [(LATERAL_MACH, math.radians(LATERAL_ALPHA_DEG), side * step) for side in (1.0, -1.0)]
    return FlowConditions(*np.array(grid).T.copy())


def coefficients(vehicle: Vehicle, configuration: Configuration, cell: float) -> xr.Dataset:
    """Total coefficients on the grid of the tables; wall `cell` m. An unconverged condition has NaN."""
    surface = build(vehicle.shape, ControlDeflections.from_degrees(**configuration.deflections_deg))
    solution = solve_body(surface, MeshSettings(wall_cell=cell), conditions(lateral=configuration is CLEAN))
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
            records.append(_record(f"d{name}, {configuration.name}", mach, alpha, published, computed, name))
    return records


def lateral_records(clean: xr.Dataset) -> list[Record]:
    """The one published lateral point; the last two conditions of `clean` are its sideslips."""
    records = []
    for name, published in horus_tables.LATERAL_POINT.items():
        coefficient = clean[name.removesuffix("_beta")]
        computed = float(coefficient[-2] - coefficient[-1]) / (2.0 * LATERAL_STEP_DEG)
        records.append(
            Record(
                case=CASE,
                quantity=name,
                condition=f"Mach {LATERAL_MACH:g}, alpha {LATERAL_ALPHA_DEG:g} deg",
                unit="1/deg",
                published=published,
                computed=_finite(computed),
                band=BAND,
                kind="relative",
                source=horus_tables.SOURCE,
            )
        )
    return records


def moment_center_records(clean: xr.Dataset) -> list[Record]:
    """The moment centre used beside the one that fits the published C_m best; shown, not judged."""
    station, both = fit_moment_center(clean, "x"), fit_moment_center(clean, "xz")
    used = clean.attrs["moment_center_m"]
    rows = (
        ("station, height kept", station.x, used[0], station.after),
        ("station, with the height free", both.x, used[0], both.after),
        ("height, with the station free", both.z, used[2], both.after),
    )
    common = dict(case=CASE, unit="m", kind="absolute", gate=False, source=horus_tables.SOURCE)
    common |= dict(condition="Mach 1.5 to 3, alpha 0 to 20 deg", band=0.5)
    return [
        Record(
            quantity=f"moment centre, best fit of C_m: {what}",
            published=before,
            computed=_finite(value),
            note=f"{what}: root-mean-square difference of C_m {station.before:.4f} as used, {after:.4f} at the fit.",
            **common,
        )
        for what, value, before, after in rows
    ]


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


def fit_moment_center(clean: xr.Dataset, vary: str = "xz") -> MomentCenterFit:
    """Least-squares moment centre over the grid of the tables.

    Moving the centre aft by dx and up by dz changes C_m by (C_N dx - C_A dz) / c_ref.

    Args:
        clean: coefficients on `conditions`, with the attributes of `spaceplane.aero.integrate.integrate`.
        vary: "x", "z" or "xz": which coordinates, in m, may move.
    """
    count = len(MACHS) * len(ALPHAS_DEG)
    table = horus_tables.base("Cm")
    gap = np.array([table.at(mach, alpha) for mach, alpha in _grid()]) - clean.Cm.values[:count]
    chord, center = clean.attrs["c_ref_m"], clean.attrs["moment_center_m"]
    columns = {"x": clean.CN.values[:count] / chord, "z": -clean.CA.values[:count] / chord}
    matrix = np.column_stack([columns[name] for name in vary])
    known = np.isfinite(gap)
    shift, *_ = np.linalg.lstsq(matrix[known], gap[known], rcond=None)
    move = dict(zip(vary, shift, strict=True))
    rest = gap[known] - matrix[known] @ shift
    return MomentCenterFit(
        x=center[0] + move.get("x", 0.0),
        z=center[2] + move.get("z", 0.0),
        before=float(np.sqrt(np.mean(gap[known] ** 2))),
        after=float(np.sqrt(np.mean(rest**2))),
    )


def _grid() -> list[tuple[float, float]]:
    return [(mach, alpha) for mach in MACHS for alpha in ALPHAS_DEG]


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _record(quantity: str, mach: float, alpha: float, published: float, computed: float, name: str) -> Record:
    return Record(
        case=CASE,
        quantity=quantity,
        condition=f"Mach {mach:g}, alpha {alpha:g} deg",
        unit="-",
        published=published,
        computed=_finite(computed),
        band=BAND,
        kind="relative",
        source=horus_tables.SOURCE,
        floor=ROUNDING[name],
    )
