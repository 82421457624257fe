"""Reader of a table set: a folder of CSV files with base coefficients, increments by surface and, if at all, slopes.

Files, angles in degrees, Mach numbers in the head as M1.5; empty cells are unknown:

- `CL0.csv`, `CD0.csv`, `Cm0.csv`: columns alpha_deg, M...: the clean vehicle.
- `d<coefficient>_bodyflap.csv`, `d<coefficient>_one_elevon.csv`, `d<coefficient>_one_rudder.csv`: columns delta_deg,
  alpha_deg, M...: increments of the body flap and of ONE elevon or rudder. CL, CD, Cm are those of either side; CY,
  Cl, Cn are those of the left one, and the right one's have the opposite sign.
- `slopes.csv`: columns mach, alpha_deg and names of `SLOPES`, per rad and per reduced rate, or per degree for names
  that end in `_per_deg`. One row holds everywhere; several must make up the grid of the base tables.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.aero.integrate import LATERAL
from spaceplane.aero.model.model import BASE, SLOPES, ZERO, AeroModel, SurfaceTable
from spaceplane.errors import InputError, unknown_name
from spaceplane.vehicle.properties import ReferenceLengths

SURFACE_FILES = {
    "bodyflap": ("body_flap",),
    "one_elevon": ("elevon_left", "elevon_right"),
    "one_rudder": ("rudder_left", "rudder_right"),
}
"""Name in the file names -> the control surfaces that it stands for, the left one first."""

SLOPES_FILE = "slopes.csv"


@dataclass(frozen=True)
class Table:
    """A coefficient on a regular grid.

    Attributes:
        deflection_deg: [deflection] deg, positive trailing edge down or outboard; a single 0 for the clean vehicle.
        alpha_deg: [alpha] angle of attack, deg.
        mach: [mach] Mach number.
        values: [deflection, alpha, mach] the coefficient or its increment; NaN where none was published.
    """

    deflection_deg: np.ndarray
    alpha_deg: np.ndarray
    mach: np.ndarray
    values: np.ndarray

    def at(self, mach: float, alpha_deg: float, deflection_deg: float = 0.0) -> float:
        """Interpolate linearly in Mach number, angle of attack (deg) and deflection (deg); no extrapolation."""
        if len(self.deflection_deg) == 1:
            grid, point = (self.alpha_deg, self.mach), (alpha_deg, mach)
            return RegularGridInterpolator(grid, self.values[0])(point).item()
        grid = (self.deflection_deg, self.alpha_deg, self.mach)
        return RegularGridInterpolator(grid, self.values)((deflection_deg, alpha_deg, mach)).item()


@dataclass(frozen=True)
class SlopeTable:
    """Sideslip and rate slopes at points.

    Attributes:
        mach: [row] Mach number.
        alpha_deg: [row] deg.
        values: name of `SLOPES` -> [row], per rad or per reduced rate; NaN where unknown.
    """

    mach: np.ndarray
    alpha_deg: np.ndarray
    values: Mapping[str, np.ndarray]


def read_table(path: Path) -> Table:
    """One file of base coefficients or increments.

    Raises:
        InputError: missing, not of the layout, a cell that is no number, Mach numbers that do not increase, a row that
            is missing or there twice, or an increment without deflection.
    """
    rows = _rows(path)
    head = [cell.strip() for cell in rows[0]]
    angles = 2 if head[0] == "delta_deg" else 1
    if head[:angles] != ["delta_deg", "alpha_deg"][2 - angles :] or len(head) == angles:
        raise InputError(f"{path}: columns {','.join(head)}: needed are [delta_deg,]alpha_deg,M1.5,...")
    mach = _mach_numbers(path, head[angles:])
    body = _body(path, rows[1:], head, required=angles)
    delta, attack = (body[:, 0] if angles == 2 else np.zeros(len(body))), body[:, angles - 1]
    deflection, alpha = np.unique(delta), np.unique(attack)
    _one_row_each(path, delta, attack, angles == 2)
    order = np.lexsort((attack, delta))
    values = body[:, angles:]
    if angles == 2:
        _nothing_without_deflection(path, head[angles:], delta, values)
    return Table(deflection, alpha, mach, values[order].reshape(len(deflection), len(alpha), len(mach)))


def _mach_numbers(path: Path, names: Sequence[str]) -> np.ndarray:
    for name in names:
        if not name.startswith("M"):
            raise InputError(f"{path}, row 1: column {name!r}: must be M and a Mach number, such as M1.5")
    mach = np.array([_number(path, 1, name, name.removeprefix("M")) for name in names])
    if len(mach) < 2:
        raise InputError(f"{path}, row 1: {names[0]} is the only Mach number; at least two are needed")
    if mach[0] < 0.0:
        raise InputError(f"{path}, row 1: {names[0]}: Mach numbers must not be negative")
    for (before, low), (after, high) in pairwise(zip(names, mach, strict=True)):
        if high <= low:
            raise InputError(f"{path}, row 1: {after} follows {before}; Mach numbers must increase")
    return mach


def _one_row_each(path: Path, delta: np.ndarray, alpha: np.ndarray, deflected: bool) -> None:
    """Refuse a pair of deflection and angle of attack, deg, that stands there twice or not at all."""

    def pair(d: float, a: float) -> str:
        return f"delta_deg {d:g}, alpha_deg {a:g}" if deflected else f"alpha_deg {a:g}"

    seen: dict[tuple[float, float], int] = {}
    for row, one in enumerate(zip(delta, alpha, strict=True), start=2):
        if one in seen:
            raise InputError(f"{path}, row {row}: {pair(*one)} stands in row {seen[one]} already")
        seen[one] = row
    for d in np.unique(delta):
        for a in np.unique(alpha):
            if (d, a) not in seen:
                raise InputError(f"{path}: no row for {pair(d, a)}; every deflection needs every angle of attack")
    if len(np.unique(alpha)) < 2:
        raise InputError(f"{path}: alpha_deg {alpha[0]:g} is the only one; at least two are needed")


def _nothing_without_deflection(path: Path, names: Sequence[str], delta: np.ndarray, values: np.ndarray) -> None:
    neutral = np.flatnonzero(delta == 0.0)
    if not len(neutral):
        raise InputError(f"{path}: no row of delta_deg 0; increments without deflection, all 0, are needed")
    for row in neutral:
        for name, value in zip(names, values[row], strict=True):
            if abs(value) > ZERO:
                raise InputError(f"{path}, row {row + 2}: {name} = {value:g}: must be 0 at deflection 0")


def read_slopes(path: Path) -> SlopeTable:
    """The file of slopes.

    Raises:
        InputError: missing, not of the layout, an unknown name, or a cell that is no number.
    """
    rows = _rows(path)
    head = [cell.strip() for cell in rows[0]]
    if head[:2] != ["mach", "alpha_deg"] or len(head) < 3:
        raise InputError(f"{path}: columns {','.join(head)}: needed are mach,alpha_deg and names of slopes")
    body = _body(path, rows[1:], head, required=2)
    values = {}
    for column, name in enumerate(head[2:], start=2):
        bare = name.removesuffix("_per_deg")
        if bare not in SLOPES or (bare != name and not bare.endswith("_beta")):
            known = [*SLOPES, *(f"{slope}_per_deg" for slope in SLOPES if slope.endswith("_beta"))]
            raise InputError(f"{path}: {unknown_name('slope', name, known)}")
        if bare in values:
            raise InputError(f"{path}: {bare}: given twice")
        values[bare] = body[:, column] * (math.degrees(1.0) if bare != name else 1.0)
    return SlopeTable(body[:, 0], body[:, 1], values)


def read_table_set(
    folder: Path | str, reference: ReferenceLengths, name: str = "", source: str = "", beta_limit_deg: float = 10.0
) -> AeroModel:
    """The model of a folder of tables in the layout above.

    Args:
        folder: with the files.
        reference: area m2, chord and span m and moment centre m that the tables are made with.
        name: of the model; the folder's by default.
        source: where the tables come from; the folder by default. What was assumed in reading is added.
        beta_limit_deg: greatest sideslip, deg, up to which slopes are taken to hold.

    Raises:
        InputError: a file that is missing, damaged or on another grid than the base tables.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise InputError(f"table set: {folder} is not a folder")
    _known_files(folder)
    base = {coefficient: read_table(folder / f"{coefficient}0.csv") for coefficient in BASE}
    grid = base["CL"]
    for coefficient, table in base.items():
        _same_grid(folder / f"{coefficient}0.csv", table, grid)
    _drag_above_zero(folder / "CD0.csv", base["CD"])
    surfaces, notes = {}, []
    for kind, members in SURFACE_FILES.items():
        tables = _increments(folder, kind, grid)
        if tables:
            surfaces |= _surfaces(members, tables)
            lacking = [c for c in LATERAL if c not in tables] if len(members) == 2 else []
            if lacking:
                notes.append(f"{', '.join(lacking)} of a single {kind.removeprefix('one_')} unknown, taken as zero")
    slopes = {}
    if (folder / SLOPES_FILE).exists():
        table = read_slopes(folder / SLOPES_FILE)
        slopes = _on_grid(folder / SLOPES_FILE, table, grid)
        if len(table.mach) == 1:
            where = f"Mach {table.mach[0]:g}, alpha {table.alpha_deg[0]:g} deg"
            notes.append(f"{', '.join(slopes)} known at {where} only and used everywhere")
    return AeroModel(
        name=name or folder.name,
        source="; ".join([source or f"tables in {folder}", *notes]),
        reference=reference,
        alpha=np.radians(grid.alpha_deg),
        mach=grid.mach,
        base={coefficient: table.values[0] for coefficient, table in base.items()},
        surfaces=surfaces,
        slopes=slopes,
        beta_limit=math.radians(beta_limit_deg),
    )


def _known_files(folder: Path) -> None:
    """A misspelt file name must not be a surface without effect."""
    known = [f"{coefficient}0.csv" for coefficient in BASE] + [SLOPES_FILE]
    known += [f"d{coefficient}_{kind}.csv" for kind in SURFACE_FILES for coefficient in FORCES_AND_MOMENTS]
    for path in sorted(folder.glob("*.csv")):
        if path.name not in known:
            raise InputError(f"{folder}: {unknown_name('table', path.name, known)}")


def _increments(folder: Path, kind: str, grid: Table) -> dict[str, Table]:
    """Tables of one kind of surface by coefficient, all with the same deflections."""
    tables: dict[str, Table] = {}
    for coefficient in FORCES_AND_MOMENTS:
        path = folder / f"d{coefficient}_{kind}.csv"
        if path.exists():
            tables[coefficient] = read_table(path)
            _same_grid(path, tables[coefficient], grid)
            first = next(iter(tables.values()))
            if not np.array_equal(tables[coefficient].deflection_deg, first.deflection_deg):
                raise InputError(f"{path}: its deflections differ from those of the other tables of {kind}")
    return tables


def _surfaces(members: Sequence[str], tables: Mapping[str, Table]) -> dict[str, SurfaceTable]:
    deflection = np.radians(next(iter(tables.values())).deflection_deg)
    return {
        surface: SurfaceTable(
            deflection,
            {c: table.values * (-1.0 if side and c in LATERAL else 1.0) for c, table in tables.items()},
        )
        for side, surface in enumerate(members)
    }


def _same_grid(path: Path, table: Table, grid: Table) -> None:
    for what in ("alpha_deg", "mach"):
        if not np.array_equal(getattr(table, what), getattr(grid, what)):
            raise InputError(f"{path}: its values of {what} differ from those of CL0.csv")


def _drag_above_zero(path: Path, table: Table) -> None:
    for alpha, line in zip(table.alpha_deg, table.values[0], strict=True):
        for mach, value in zip(table.mach, line, strict=True):
            if value <= 0.0:
                raise InputError(
                    f"{path}, row of alpha_deg {alpha:g}, column M{mach:g}: CD = {value:g}: must be above 0"
                )


def _on_grid(path: Path, table: SlopeTable, grid: Table) -> dict[str, np.ndarray]:
    """[alpha, mach] slopes on the grid of the base tables."""
    shape = (len(grid.alpha_deg), len(grid.mach))
    if len(table.mach) == 1:
        return {name: np.full(shape, values[0]) for name, values in table.values.items()}
    found = {name: np.full(shape, np.nan) for name in table.values}
    seen = np.zeros(shape, dtype=bool)
    for row, (mach, alpha) in enumerate(zip(table.mach, table.alpha_deg, strict=True)):
        node = (np.flatnonzero(grid.alpha_deg == alpha), np.flatnonzero(grid.mach == mach))
        if not (len(node[0]) and len(node[1])):
            raise InputError(f"{path}: Mach {mach:g}, alpha {alpha:g} deg: not on the grid of the base tables")
        if seen[node].any():
            raise InputError(f"{path}: Mach {mach:g}, alpha {alpha:g} deg: given twice")
        seen[node] = True
        for name, values in table.values.items():
            found[name][node] = values[row]
    return found


def _rows(path: Path) -> list[list[str]]:
    try:
        rows = [row for row in csv.reader(path.read_text(encoding="utf-8-sig").splitlines()) if row]
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read ({error})") from error
    if len(rows) < 2:
        raise InputError(f"{path}: needs a line of names and at least one row")
    return rows


def _body(path: Path, rows: Sequence[Sequence[str]], head: Sequence[str], required: int) -> np.ndarray:
    """[row, column] numbers; NaN for empty cells, which the first `required` columns may not have."""
    body = np.full((len(rows), len(head)), np.nan)
    for index, row in enumerate(rows):
        if len(row) != len(head):
            raise InputError(f"{path}, row {index + 2}: has {len(row)} cells, needed are {len(head)}")
        for column, cell in enumerate(row):
            if cell.strip() or column < required:
                body[index, column] = _number(path, index + 2, head[column], cell)
    return body


def _number(path: Path, row: int, name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError as error:
        raise InputError(f"{path}, row {row}: {name} = {text.strip()!r}: must be a number") from error
    if not math.isfinite(value):
        raise InputError(f"{path}, row {row}: {name} = {text.strip()}: must be finite")
    return value
