"""An analysis as flat tables: CSV files, or the aerodynamic tables of one NetCDF file."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np

from spaceplane.decks.tables import write_linear_csv, write_linear_netcdf
from spaceplane.dynamics.statespace import StateSpace
from spaceplane.environment.constants import EARTH_RADIUS
from spaceplane.files import renamed_when_done
from spaceplane.files import write_csv as write_rows

CONDITION_KEYS = (
    "mach",
    "altitude_m",
    "alpha_deg",
    "beta_deg",
    "gamma_deg",
    "bank_deg",
    "velocity_ms",
    "dynamic_pressure_Pa",
)


def coefficient_rows(result: dict) -> list[dict]:
    """A row for each flight point and part ("total" included), coefficients in columns.

    The total has columns such as CD_error besides, and with viscous increments such as CD_from_friction.
    """
    rows = []
    for p in result["flight_points"]:
        conditions = {"flight_point": p["name"], **{k: p.get(k) for k in CONDITION_KEYS}}
        rows.append(conditions | {"part": "total"} | (p.get("coefficients") or {}) | _errors(p) | _sources(p))
        rows += [conditions | {"part": part} | values for part, values in (p.get("coefficients_by_part") or {}).items()]
    return rows


def _errors(point: dict) -> dict:
    """Error of each coefficient, such as CD_error."""
    return {f"{name}_error": value for name, value in (point.get("coefficient_errors") or {}).items()}


def _sources(point: dict) -> dict:
    """What each source adds to each coefficient, such as CD_from_friction; none where all is inviscid."""
    sources = point.get("coefficients_by_source") or {}
    if len(sources) < 2:
        return {}
    return {f"{name}_from_{source}": v for source, values in sources.items() for name, v in values.items()}


def derivative_rows(result: dict) -> list[dict]:
    """A row for each flight point, derivative and part ("total" included)."""
    rows = []
    for p in result["flight_points"]:
        for name, record in (p.get("derivatives") or {}).items():
            common = {"flight_point": p["name"], "mach": p.get("mach"), "derivative": name}
            tail = {"unit": record.get("unit"), "step": record.get("step"), "step_unit": record.get("step_unit")}
            rows.append(common | {"part": "total", "value": record.get("value"), "error": record.get("error")} | tail)
            for part, value in (record.get("by_part") or {}).items():
                rows.append(common | {"part": part, "value": value, "error": None} | tail)
    return rows


def mode_rows(result: dict) -> list[dict]:
    """A row for each flight point and mode."""
    keys = ("period_s", "half_time_s", "double_time_s", "damping_ratio", "natural_frequency_rads", "oscillatory")
    return [
        {
            "flight_point": p["name"],
            "mode": m["name"],
            "real_1s": m["eigenvalue"][0],
            "imaginary_rads": m["eigenvalue"][1],
        }
        | {k: m.get(k) for k in keys}
        for p in result["flight_points"]
        for m in p.get("modes") or []
    ]


def verdict_rows(result: dict) -> list[dict]:
    """A row for each flight point and flying-quality verdict."""
    keys = (
        "mode",
        "criterion",
        "paragraph",
        "vehicle_class",
        "category",
        "value",
        "unit",
        "level",
        "margin",
        "applicable",
        "met",
        "probability_text",
        "note",
    )
    return [
        {"flight_point": p["name"]} | {k: v.get(k) for k in keys}
        for p in result["flight_points"]
        for v in (*(p.get("verdicts") or []), *(p.get("airframe_verdicts") or []))
    ]


TABLES: dict[str, Callable[[dict], list[dict]]] = {
    "coefficients": coefficient_rows,
    "derivatives": derivative_rows,
    "modes": mode_rows,
    "verdicts": verdict_rows,
}


def linear_models(result: dict) -> dict[str, StateSpace]:
    """The linear model of each flight point that has one, by its name."""
    return {
        p["name"]: StateSpace(
            np.array(p["A"], dtype=float),
            np.array(p["B"], dtype=float).reshape(len(p["states"]), len(p["inputs"])),
            tuple(p["states"]),
            tuple(p["inputs"]),
            p.get("form") or "given",
            _reference_state(p),
        )
        for p in result["flight_points"]
        if p.get("A")
    }


def _reference_state(point: dict) -> dict[str, float]:
    """Values of the states at a flight point, SI and rad; those that the record lacks are left out."""
    rates = point.get("equilibrium") or {}
    angles = {"gamma": "gamma_deg", "alpha": "alpha_deg", "beta": "beta_deg", "sigma": "bank_deg"}
    found = {"V": point.get("velocity_ms"), **{rate: rates.get(f"{rate}_rads") for rate in "pqr"}}
    found |= {state: None if point.get(key) is None else math.radians(point[key]) for state, key in angles.items()}
    if point.get("altitude_m") is not None:
        found["R"] = EARTH_RADIUS + point["altitude_m"]
    return {state: float(value) for state, value in found.items() if value is not None}


def write_csv(result: dict, folder: Path) -> list[Path]:
    """Write coefficients.csv, derivatives.csv, modes.csv, verdicts.csv and, where there are linear models,
    linear_models.csv (A and B); return their paths.

    Raises:
        OSError: the folder cannot be written.
    """
    paths = []
    for name, rows in TABLES.items():
        path = folder / f"{name}.csv"
        write_rows(rows(result), path)
        paths.append(path)
    systems = linear_models(result)
    return paths + (write_linear_csv(systems, folder) if systems else [])


def write_netcdf(result: dict, folder: Path) -> list[Path]:
    """Write tables.nc, coefficients and derivatives over flight point and part with errors beside, and, where there are
    linear models, linear_models.nc (A and B); return their paths.

    Raises:
        OSError: the folder cannot be written.
    """
    import xarray as xr

    points = [p["name"] for p in result["flight_points"]]
    parts = ["total", *dict.fromkeys(k for p in result["flight_points"] for k in p.get("coefficients_by_part") or {})]
    variables: dict[str, tuple] = {}

    def fill(rows: Iterable[dict], name_of: Callable[[dict], Iterable[tuple[str, float | None, str]]]) -> None:
        """Put rows into the variables that `name_of` gives them: (name, value, unit)."""
        for row in rows:
            for name, value, unit in name_of(row):
                empty = np.full((len(points), len(parts)), np.nan)
                data = variables.setdefault(name, (("flight_point", "part"), empty, {"units": unit}))[1]
                if row["part"] in parts and value is not None:
                    data[points.index(row["flight_point"]), parts.index(row["part"])] = value

    skip = {"flight_point", "part", *CONDITION_KEYS}
    fill(coefficient_rows(result), lambda row: [(k, v, "1") for k, v in row.items() if k not in skip])
    fill(
        derivative_rows(result),
        lambda row: [
            (row["derivative"], row["value"], row["unit"] or "1"),
            *([(f"{row['derivative']}_error", row["error"], row["unit"] or "1")] if row["part"] == "total" else []),
        ],
    )
    conditions = {
        key: (
            "flight_point",
            np.array([np.nan if p.get(key) is None else p[key] for p in result["flight_points"]], float),
        )
        for key in CONDITION_KEYS
    }
    attributes = {"source": f"spaceplane {result.get('version')}", "created": result.get("created") or ""}
    data = xr.Dataset(variables, {"flight_point": points, "part": parts, **conditions}, attributes)
    path = folder / "tables.nc"
    with renamed_when_done(path) as partial:
        data.to_netcdf(partial)
    systems = linear_models(result)
    return [path] + (write_linear_netcdf(systems, folder) if systems else [])
