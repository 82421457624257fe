"""What a deck is made from: an aerodynamic model by name or from a file or folder, with the mass of its vehicle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from spaceplane.aero.model import netcdf
from spaceplane.aero.model.model import AeroModel
from spaceplane.aero.model.published import horus_2b_published
from spaceplane.aero.model.table_set import read_table_set
from spaceplane.decks import folder
from spaceplane.dynamics import derivatives_file
from spaceplane.dynamics.flightpoint import FlightPoint
from spaceplane.dynamics.given_errors import GivenError, by_surface
from spaceplane.errors import InputError, unknown_name
from spaceplane.vehicle import presets
from spaceplane.vehicle.properties import MassProperties

PUBLISHED = "horus-2b-published"
NAMES = (PUBLISHED,)
TABLE_SET_FILE = "CL0.csv"


@dataclass(frozen=True)
class Source:
    """An aerodynamic model and, where it is known, the mass of its vehicle.

    Attributes:
        model: tables.
        mass: kg, kg m2; None if the source does not say and no vehicle was named.
        errors: of derivatives, as the source states them: a derivatives file or an analysis.
        correlation: of these errors, pairs of names to coefficient.
        point: flight point that a model is linear about; None for tables.
    """

    model: AeroModel
    mass: MassProperties | None
    errors: Mapping[str, GivenError] = field(default_factory=dict)
    correlation: Mapping[tuple[str, str], float] = field(default_factory=dict)
    point: FlightPoint | None = None


def is_model(source: str) -> bool:
    """Whether a source is a model: by its name, a `.nc` or `.toml` file, a database or tables, not an analysis."""
    return (
        source in NAMES
        or source.lower().endswith((".nc", ".toml"))
        or is_table_set(source)
        or folder.is_database(source)
        or is_vehicle(source)
    )


def is_vehicle(source: str) -> bool:
    """Whether a source is a vehicle, a preset or a YAML file, which has no aerodynamic model before its flow."""
    return (source in presets.PRESETS and not Path(source).is_dir()) or source.lower().endswith((".yaml", ".yml"))


def is_table_set(source: str) -> bool:
    """Whether a source is a folder in the layout of `aero.model.table_set`."""
    return (Path(source) / TABLE_SET_FILE).is_file()


def read_source(source: str, vehicle: str | None = None) -> Source:
    """An aerodynamic model by name, from a file or from a folder of tables.

    Args:
        source: a name of `NAMES`, a `.nc` file that `aero.model.netcdf.save` wrote, a `.toml` file of derivatives
            (`dynamics.derivatives_file`; linear about its flight point), a folder that `spaceplane database` wrote, or
            one in the layout of `aero.model.table_set`.
        vehicle: preset or YAML file that the mass and, for a folder of tables, the reference lengths are of; HORUS-2B
            for its published tables by default, and its own vehicle for a database.

    Raises:
        InputError: no such source, one that cannot be read, a vehicle, or a folder of tables without a vehicle.
    """
    if is_vehicle(source):
        raise InputError(
            f"{source}: a vehicle has no aerodynamic model yet; run `spaceplane database {source} --out DIR` first and "
            "give DIR"
        )
    if source.lower().endswith(".toml"):
        if vehicle is not None:
            raise InputError(f"--vehicle: {source} has its own vehicle")
        case = derivatives_file.read(source)
        stated = by_surface(case.uncertainty, case.correlation)
        return Source(derivatives_file.aero_model(case, Path(source).stem), case.mass, *stated, case.point)
    named = presets.load(vehicle) if vehicle else None
    if source == PUBLISHED:
        return Source(horus_2b_published(), (named or presets.horus_2b()).mass)
    path = Path(source)
    if not path.exists():
        raise InputError(f"{unknown_name('source', source, NAMES)} (or give a .nc or .toml file or a folder of tables)")
    mass = named.mass if named else None
    if path.is_file() and path.suffix.lower() == ".nc":
        return Source(netcdf.load(path), mass)
    if folder.is_database(path):
        model, own = folder.read(path)
        return Source(model, mass or own)
    if not is_table_set(source):
        raise InputError(
            f"{source}: no aerodynamic tables over Mach number and angle of attack; needed is {' or '.join(NAMES)}, a "
            f".nc file of an aerodynamic model, a .toml file of derivatives, a folder of `spaceplane database` or one "
            f"with {TABLE_SET_FILE}"
        )
    if named is None:
        raise InputError(f"--vehicle: needed, for the reference lengths that the tables in {source} are made with")
    return Source(read_table_set(path, named.reference), mass)
