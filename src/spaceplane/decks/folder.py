"""The folder of an aerodynamic database: the model, and a record of the vehicle that it is of."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from spaceplane import __version__
from spaceplane.aero.model import netcdf
from spaceplane.aero.model.model import AeroModel
from spaceplane.errors import InputError
from spaceplane.files import json_text, renamed_when_done, write_text
from spaceplane.plain import plain
from spaceplane.vehicle.presets import Vehicle
from spaceplane.vehicle.properties import MassProperties

SCHEMA, SCHEMA_VERSION = "spaceplane.database", 1
MODEL_FILE, RECORD_FILE = "model.nc", "database.json"


def is_database(folder: Path | str) -> bool:
    """Whether a folder is one that `write` made."""
    return (Path(folder) / RECORD_FILE).is_file() and (Path(folder) / MODEL_FILE).is_file()


def write(model: AeroModel, vehicle: Vehicle, found: dict[str, Any], folder: Path) -> list[Path]:
    """Write model.nc and then database.json.

    Args:
        model: tables.
        vehicle: whose mass, reference lengths and shape are kept.
        found: what else the record shall hold, JSON values.
        folder: exists.

    Raises:
        InputError: model.nc cannot be written.
        OSError: database.json cannot be written.
    """
    with renamed_when_done(folder / MODEL_FILE) as partial:
        netcdf.save(model, partial)
    write_text(json_text(record_of(model, vehicle, found)), folder / RECORD_FILE)
    return [folder / MODEL_FILE, folder / RECORD_FILE]


def record_of(model: AeroModel, vehicle: Vehicle, found: dict[str, Any]) -> dict:
    """What database.json holds; arguments as for `write`."""
    return {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "version": __version__,
        "name": model.name,
        "source": model.source,
        "unknown": list(model.unknown()),
        "vehicle": {
            "name": vehicle.name,
            "mass_kg": vehicle.mass.mass,
            **{f"{name}_kgm2": getattr(vehicle.mass, name) for name in ("Ixx", "Iyy", "Izz", "Ixz")},
            "reference_area_m2": vehicle.reference.area,
            "c_ref_m": vehicle.reference.chord,
            "b_ref_m": vehicle.reference.span,
            "moment_center_m": plain(vehicle.reference.moment_center),
            "shape": vehicle.shape.as_dict(),
        },
        **found,
    }


def read(folder: Path | str) -> tuple[AeroModel, MassProperties]:
    """The model, and the mass of its vehicle in kg and kg m2.

    Raises:
        InputError: a file is missing, damaged, or of another schema.
    """
    path = Path(folder) / RECORD_FILE
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read ({error})") from error
    found = (record.get("schema"), record.get("schema_version")) if isinstance(record, dict) else (None, None)
    if found != (SCHEMA, SCHEMA_VERSION):
        raise InputError(f"{path}: schema {found[0]} version {found[1]}, not {SCHEMA} version {SCHEMA_VERSION}")
    try:
        values = [record["vehicle"][name] for name in ("mass_kg", "Ixx_kgm2", "Iyy_kgm2", "Izz_kgm2")]
        values.append(record["vehicle"].get("Ixz_kgm2", 0.0))
    except (KeyError, TypeError) as error:
        raise InputError(f"{path}: vehicle: {error} is missing") from error
    try:
        return netcdf.load(Path(folder) / MODEL_FILE), MassProperties(*values)
    except InputError as error:
        text = str(error)
        raise InputError(text if str(folder) in text else f"{path}: {text}") from error
