"""CSV and NetCDF of an aerodynamic model and of linear models, each value with its unit."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.model import netcdf
from spaceplane.aero.model.model import AeroModel
from spaceplane.decks import statement
from spaceplane.dynamics.statespace import MOMENT_INPUTS, STATE_UNITS, StateSpace
from spaceplane.errors import InputError
from spaceplane.files import renamed_when_done, write_csv, write_text
from spaceplane.vehicle.controls import CONTROL_POSITIVE, CONTROLS

if TYPE_CHECKING:
    import xarray as xr

LINEAR_AXES = "p, q, r and moments about body axes: x forward, y right, z down"
STATE_POSITIVE = {
    "V": "forward",
    "gamma": "climbing",
    "R": "away from the Earth's centre",
    "p": "right wing down",
    "q": "nose up",
    "r": "nose right",
    "alpha": "nose up",
    "beta": "wind from the right",
    "sigma": "right wing down",
}


def write_model_csv(model: AeroModel, folder: Path | str) -> list[Path]:
    """Write an aerodynamic model as CSV, angles in deg where the column's name says so; empty cells are unknown.

    base.csv (mach, alpha_deg, CL, CD, Cm), slopes.csv (per rad of sideslip or per reduced rate), one `SURFACE.csv` for
    each control surface (deflection_deg besides), limits.csv, and README.txt with axes, senses and reference.

    Args:
        model: to write.
        folder: made if missing.

    Raises:
        OSError: the folder cannot be written.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    tables = {"base.csv": _rows(model, model.base)}
    if model.slopes:
        tables["slopes.csv"] = _rows(model, model.slopes)
    for name in (name for name in CONTROLS if name in model.surfaces):
        surface = model.surfaces[name]
        tables[f"{name}.csv"] = [
            {"deflection_deg": _degrees(deflection)} | row
            for k, deflection in enumerate(surface.deflection)
            for row in _rows(model, {c: t[k] for c, t in surface.increments.items()})
        ]
    tables["limits.csv"] = statement.limits(model)
    for name, rows in tables.items():
        write_csv(rows, target / name)
    write_text(_readme(model, tuple(tables)), target / "README.txt")
    return [target / name for name in (*tables, "README.txt")]


def write_model_netcdf(model: AeroModel, folder: Path | str) -> list[Path]:
    """Write aero_model.nc, which `aero.model.netcdf.load` reads; every value with units, axes, positive and reference.

    Args:
        model: to write.
        folder: made if missing.

    Raises:
        InputError: the file cannot be written.
    """
    path = Path(folder) / "aero_model.nc"
    path.parent.mkdir(parents=True, exist_ok=True)
    with renamed_when_done(path) as partial:
        netcdf.save(model, partial)
    return [path]


def _degrees(angle: float) -> float:
    return round(math.degrees(angle), 12)


def _rows(model: AeroModel, tables: Mapping[str, np.ndarray]) -> list[dict]:
    """Rows over Mach number and alpha of tables [alpha, mach]; NaN becomes an empty cell."""
    return [
        {"mach": float(mach), "alpha_deg": _degrees(alpha)}
        | {name: None if np.isnan(table[i, j]) else float(table[i, j]) for name, table in tables.items()}
        for j, mach in enumerate(model.mach)
        for i, alpha in enumerate(model.alpha)
    ]


def _readme(model: AeroModel, files: tuple[str, ...]) -> str:
    lines = [
        statement.title(model) + ": aerodynamic tables",
        "",
        f"Source: {model.source}",
        f"Files: {', '.join(files)}",
        "",
        "base.csv holds the coefficients without deflection, sideslip and rates; the file of a control surface what",
        "it adds; slopes.csv the slopes with sideslip (per rad) and reduced rates (no unit). Linear between the rows.",
        "Empty cells are unknown. Coefficients have no unit; angles are in deg where the column's name ends in _deg.",
        "",
        "Axes and positive senses",
        *(f"  {line}" for line in statement.AXES),
        *(f"  deflection of {line}" for line in statement.deflection_lines(model)),
        "",
        "Reference",
        *(f"  {line}" for line in statement.reference_lines(model)),
        "",
        "Limits (limits.csv): nothing is known outside",
        *(f"  {line}" for line in statement.limit_lines(model)),
        "",
        statement.unknown_line(model),
        *filter(None, [statement.lag_line(model)]),
    ]
    return "\n".join(lines) + "\n"


def unit_of(name: str) -> str:
    """Unit of a state or input of the linear model.

    Raises:
        InputError: it is none of them.
    """
    if name in STATE_UNITS:
        return STATE_UNITS[name]
    if name in MOMENT_INPUTS:
        return "N m"
    if name in CONTROLS or name in ("aileron", "elevator", "rudder"):
        return "rad"
    raise InputError(f"{name}: not a state or input of the linear model")


def linear_rows(systems: Mapping[str, StateSpace]) -> list[dict]:
    """A row for each element of A and B of named linear models, with its unit.

    Columns: flight_point, matrix, of (the state whose rate it is), with (the state or input), value, unit.
    """
    return [
        {
            "flight_point": label,
            "matrix": matrix,
            "of": state,
            "with": column,
            "value": float(values[i, j]),
            "unit": f"({unit_of(state)})/s per {unit_of(column)}",
        }
        for label, system in systems.items()
        for matrix, values, columns in (("A", system.A, system.states), ("B", system.B, system.inputs))
        for i, state in enumerate(system.states)
        for j, column in enumerate(columns)
    ]


def write_linear_csv(systems: Mapping[str, StateSpace], folder: Path | str) -> list[Path]:
    """Write linear_models.csv, the rows of `linear_rows`.

    Args:
        systems: name of the flight point -> linear model.
        folder: made if missing.

    Raises:
        InputError: a state or input without a unit.
        OSError: the folder cannot be written.
    """
    path = Path(folder) / "linear_models.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_csv(linear_rows(systems), path)
    return [path]


def linear_dataset(systems: Mapping[str, StateSpace]) -> xr.Dataset:
    """A (flight_point, state, with_state) and B (flight_point, state, input), with names, units and positive senses.

    `reference_state` (flight_point, state) are the values at the flight points. Inputs that a point lacks are NaN.

    Raises:
        InputError: no system, different states, or a state or input without a unit.
    """
    import xarray as xr

    if not systems:
        raise InputError("linear models: there are none")
    states = next(iter(systems.values())).states
    if any(system.states != states for system in systems.values()):
        raise InputError("linear models: their states differ")
    inputs = list(dict.fromkeys(name for system in systems.values() for name in system.inputs))
    A = np.array([system.A for system in systems.values()])
    B = np.full((len(systems), len(states), len(inputs)), np.nan)
    reference = np.full((len(systems), len(states)), np.nan)
    for k, system in enumerate(systems.values()):
        for j, name in enumerate(system.inputs):
            B[k, :, inputs.index(name)] = system.B[:, j]
        reference[k] = [system.reference.get(state, np.nan) for state in states]
    rate = "(unit of state)/s per "
    return xr.Dataset(
        {
            "A": (("flight_point", "state", "with_state"), A, {"units": rate + "(unit of with_state)"}),
            "B": (("flight_point", "state", "input"), B, {"units": rate + "(unit of input)"}),
            "reference_state": (("flight_point", "state"), reference, {"units": "unit of state"}),
        },
        {
            "flight_point": list(systems),
            "state": list(states),
            "with_state": list(states),
            "input": inputs,
            "state_unit": ("state", [unit_of(name) for name in states]),
            "state_positive": ("state", [STATE_POSITIVE.get(name, "") for name in states]),
            "input_unit": ("input", [unit_of(name) for name in inputs]),
            "input_positive": ("input", [_input_positive(name) for name in inputs]),
            "form": ("flight_point", [system.form for system in systems.values()]),
        },
        {
            "equation": "d(state)/dt = A state + B input, perturbations about reference_state",
            "axes": LINEAR_AXES,
            "valid": "small perturbations about each flight point",
        },
    )


def _input_positive(name: str) -> str:
    combined = {
        "aileron": "half of left less right elevon, each trailing edge down",
        "elevator": "mean of the elevons, trailing edge down",
        "rudder": "half of left less right rudder, each outboard",
        "moment_x": "right wing down",
        "moment_y": "nose up",
        "moment_z": "nose right",
    }
    return CONTROL_POSITIVE.get(name) or combined[name]


def write_linear_netcdf(systems: Mapping[str, StateSpace], folder: Path | str) -> list[Path]:
    """Write linear_models.nc, the Dataset of `linear_dataset`; arguments and errors as for `write_linear_csv`."""
    path = Path(folder) / "linear_models.nc"
    path.parent.mkdir(parents=True, exist_ok=True)
    data = linear_dataset(systems)
    with renamed_when_done(path) as partial:
        data.to_netcdf(partial)
    return [path]
