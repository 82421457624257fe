"""An aerodynamic model as a NetCDF file: every value with units, axes, positive sense and reference."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.integrate import DESCRIPTION
from spaceplane.aero.model.model import BASE, SLOPES, AeroModel, SurfaceTable
from spaceplane.errors import InputError
from spaceplane.vehicle.controls import CONTROL_POSITIVE, CONTROLS
from spaceplane.vehicle.properties import ReferenceLengths

if TYPE_CHECKING:
    import xarray as xr

SCHEMA = "spaceplane.aero_model"
SCHEMA_VERSION = 1
_RATES = {"p": "p b_ref/2V", "q": "q c_ref/2V", "r": "r b_ref/2V"}


def to_dataset(model: AeroModel) -> xr.Dataset:
    """The model as a Dataset.

    Returns:
        CL, CD, Cm and slopes (alpha, mach); `d<coefficient>_<surface>` (deflection_<surface>, alpha, mach), deflections
        and angles in rad.
    """
    grid = ("alpha", "mach")
    variables = {
        name: (grid, table, _attributes(name, f"{DESCRIPTION[name][0]} without deflection"))
        for name, table in model.base.items()
    }
    for name, table in model.slopes.items():
        coefficient, quantity = name.split("_")
        by = "sideslip" if quantity == "beta" else f"reduced rate {_RATES[quantity]}"
        units = "1/rad" if quantity == "beta" else "1"
        variables[name] = (grid, table, _attributes(coefficient, f"d {coefficient} / d {by}", units))
    coordinates = {
        "alpha": ("alpha", model.alpha, {"units": "rad", "positive": "nose up"}),
        "mach": ("mach", model.mach, {"units": "1"}),
    }
    for name, surface in model.surfaces.items():
        axis = f"deflection_{name}"
        coordinates[axis] = (axis, surface.deflection, {"units": "rad", "positive": CONTROL_POSITIVE[name]})
        for coefficient, table in surface.increments.items():
            text = f"increment of {coefficient} by {name}"
            variables[f"d{coefficient}_{name}"] = ((axis, *grid), table, _attributes(coefficient, text))
    reference = model.reference
    import xarray as xr

    return xr.Dataset(
        variables,
        coordinates,
        {
            "schema": SCHEMA,
            "schema_version": SCHEMA_VERSION,
            "name": model.name,
            "source": model.source,
            "unknown": ", ".join(model.unknown()),
            "reference_area_m2": reference.area,
            "c_ref_m": reference.chord,
            "b_ref_m": reference.span,
            "moment_center_m": list(reference.moment_center),
            "moment_center_axes": "geometry axes: x aft, y right, z up",
            "beta_limit_rad": model.beta_limit,
            "interpolation": "linear; nothing is known outside the tables and where a value is missing",
        },
    )


def from_dataset(data: xr.Dataset) -> AeroModel:
    """The model that `to_dataset` gave.

    Raises:
        InputError: another schema, or something missing.
    """
    found = (data.attrs.get("schema"), data.attrs.get("schema_version"))
    if found != (SCHEMA, SCHEMA_VERSION):
        raise InputError(f"schema {found[0]} version {found[1]}, not {SCHEMA} version {SCHEMA_VERSION}")
    surfaces = {}
    try:
        for name in CONTROLS:
            axis = f"deflection_{name}"
            if axis in data.coords:
                ending = f"_{name}"
                members = [str(v) for v in data.data_vars if str(v).startswith("d") and str(v).endswith(ending)]
                tables = {v[1:].removesuffix(ending): _values(data[v], axis) for v in members}
                surfaces[name] = SurfaceTable(data[axis].values, tables)
        return AeroModel(
            name=data.attrs["name"],
            source=data.attrs["source"],
            reference=ReferenceLengths(
                float(data.attrs["reference_area_m2"]),
                float(data.attrs["c_ref_m"]),
                float(data.attrs["b_ref_m"]),
                tuple(float(v) for v in np.atleast_1d(data.attrs["moment_center_m"])),  # type: ignore[arg-type]
            ),
            alpha=data["alpha"].values,
            mach=data["mach"].values,
            base={name: _values(data[name]) for name in BASE},
            surfaces=surfaces,
            slopes={name: _values(data[name]) for name in SLOPES if name in data},
            beta_limit=float(data.attrs.get("beta_limit_rad", math.radians(10.0))),
        )
    except KeyError as error:
        raise InputError(f"aerodynamic model: {error} is missing") from error


def save(model: AeroModel, path: Path | str) -> None:
    """Write NetCDF 4.

    Raises:
        InputError: the file cannot be written.
    """
    try:
        to_dataset(model).to_netcdf(path, engine="netcdf4")
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror or error})") from error


def load(path: Path | str) -> AeroModel:
    """Read what `save` wrote.

    Raises:
        InputError: not there, not NetCDF, of another schema, or incomplete.
    """
    import xarray as xr

    try:
        with xr.open_dataset(path, engine="netcdf4") as file:
            data = file.load()
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: not a readable NetCDF file ({error})") from error
    try:
        return from_dataset(data)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _values(variable: xr.DataArray, *first: str) -> np.ndarray:
    return variable.transpose(*first, "alpha", "mach").values


def _attributes(coefficient: str, long_name: str, units: str = "1") -> dict[str, str]:
    _, axes, positive, scale = DESCRIPTION[coefficient]
    return {"long_name": long_name, "units": units, "axes": axes, "positive": positive, "reference": scale}
