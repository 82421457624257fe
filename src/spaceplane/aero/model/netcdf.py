"""An aerodynamic model as a NetCDF file: every value with units, axes, positive sense and reference."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.aero.integrate import DESCRIPTION
from spaceplane.aero.model.model import BASE, LAG, SLOPES, AeroModel, SurfaceTable
from spaceplane.errors import InputError, unknown_name
from spaceplane.vehicle.controls import CONTROL_POSITIVE, CONTROLS
from spaceplane.vehicle.properties import ReferenceLengths

if TYPE_CHECKING:
    import xarray as xr

SCHEMA = "spaceplane.aero_model"
SCHEMA_VERSION = 1
_UNKNOWN_CENTER = "not known: moments are about the centre of mass, which stands at the origin here"
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
            "moment_center_axes": "geometry axes: x aft, y right, z up" if model.center_known else _UNKNOWN_CENTER,
            "moment_center_known": int(model.center_known),
            **{name: value for name, value in zip(LAG, model.lag, strict=True) if value},
            "beta_limit_rad": model.beta_limit,
            "interpolation": "linear; nothing is known outside the tables and where a value is missing",
        },
    )


def from_dataset(data: xr.Dataset) -> AeroModel:
    """The model that `to_dataset` gave.

    Raises:
        InputError: another schema, something missing or unknown, other units or dimensions, or what is no number.
    """
    found = (data.attrs.get("schema"), data.attrs.get("schema_version"))
    if found != (SCHEMA, SCHEMA_VERSION):
        raise InputError(f"schema {found[0]} version {found[1]}, not {SCHEMA} version {SCHEMA_VERSION}")
    _check(data)
    surfaces = {}
    for name in CONTROLS:
        axis = f"deflection_{name}"
        if axis in data.coords:
            members = {c: f"d{c}_{name}" for c in FORCES_AND_MOMENTS if f"d{c}_{name}" in data}
            surfaces[name] = SurfaceTable(data[axis].values, {c: _values(data[v], axis) for c, v in members.items()})
    return AeroModel(
        name=str(_attribute(data, "name")),
        source=str(_attribute(data, "source")),
        reference=ReferenceLengths(
            _size(data, "reference_area_m2"), _size(data, "c_ref_m"), _size(data, "b_ref_m"), _center(data)
        ),
        alpha=data["alpha"].values,
        mach=data["mach"].values,
        base={name: _values(data[name]) for name in BASE},
        surfaces=surfaces,
        slopes={name: _values(data[name]) for name in SLOPES if name in data},
        beta_limit=_number(data, "beta_limit_rad", math.radians(10.0)),
        lag=(_number(data, LAG[0], 0.0), _number(data, LAG[1], 0.0)),
        center_known=_number(data, "moment_center_known", 1.0) != 0.0,
    )


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
        InputError: not there, not NetCDF, or refused by `from_dataset`.
    """
    import xarray as xr

    try:
        with xr.open_dataset(path, engine="netcdf4", decode_times=False) as file:  # units are read here, not by xarray
            data = file.load()
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: not a readable NetCDF file ({error})") from error
    try:
        return from_dataset(data)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _expected() -> dict[str, tuple[tuple[str, ...], str]]:
    """Every variable that a file may hold -> its dimensions and unit."""
    grid = ("alpha", "mach")
    known = {"alpha": (("alpha",), "rad"), "mach": (("mach",), "1")} | {name: (grid, "1") for name in BASE}
    known |= {name: (grid, "1/rad" if name.endswith("_beta") else "1") for name in SLOPES}
    for name in CONTROLS:
        axis = f"deflection_{name}"
        known[axis] = ((axis,), "rad")
        known |= {f"d{coefficient}_{name}": ((axis, *grid), "1") for coefficient in FORCES_AND_MOMENTS}
    return known


def _check(data: xr.Dataset) -> None:
    """Names, dimensions, units and kinds: angles in degrees or a misspelt slope would be read as another vehicle's."""
    known = _expected()
    names = [str(name) for name in data.variables]
    for name in names:
        if name not in known:
            raise InputError(unknown_name("variable", name, known))
    for name in names:
        (dims, unit), variable = known[name], data[name]
        if set(variable.dims) != set(dims):
            found = ", ".join(map(str, variable.dims)) or "none"
            raise InputError(f"{name}: its dimensions are {found}; needed are {', '.join(dims)}")
        if "units" not in variable.attrs and unit != "1":
            raise InputError(f"{name}: has no units; needed is {unit!r}")
        if variable.attrs.get("units", unit) != unit:
            raise InputError(f"{name}: units are {variable.attrs['units']!r}; needed are {unit!r}")
        if variable.dtype.kind not in "fiu":
            raise InputError(f"{name}: holds {variable.dtype}; numbers are needed")
    needed = {*BASE, *(str(dim) for dim in data.dims), "alpha", "mach"}
    for name in (name for name in known if name in needed):
        if name not in data.variables:
            raise InputError(f"{name} is missing")


def _attribute(data: xr.Dataset, name: str) -> object:
    if name not in data.attrs:
        raise InputError(f"attribute {name} is missing")
    return data.attrs[name]


def _number(data: xr.Dataset, name: str, default: float | None = None) -> float:
    if default is not None and name not in data.attrs:
        return default
    value = np.asarray(_attribute(data, name))
    if value.size != 1 or value.dtype.kind not in "fiu" or not np.isfinite(value).all():
        raise InputError(f"attribute {name} = {value.tolist()!r}: must be a finite number")
    return float(value.item())


def _size(data: xr.Dataset, name: str) -> float:
    value = _number(data, name)
    if value <= 0.0:
        raise InputError(f"attribute {name} = {value:g}: must be above 0")
    return value


def _center(data: xr.Dataset) -> tuple[float, float, float]:
    name = "moment_center_m"
    value = np.asarray(_attribute(data, name))
    if value.shape != (3,) or value.dtype.kind not in "fiu" or not np.isfinite(value).all():
        raise InputError(f"attribute {name} = {value.tolist()!r}: must be three finite numbers")
    x, y, z = (float(v) for v in value)
    return x, y, z


def _values(variable: xr.DataArray, *first: str) -> np.ndarray:
    return variable.transpose(*first, "alpha", "mach").values


def _attributes(coefficient: str, long_name: str, units: str = "1") -> dict[str, str]:
    _, axes, positive, scale = DESCRIPTION[coefficient]
    return {"long_name": long_name, "units": units, "axes": axes, "positive": positive, "reference": scale}
