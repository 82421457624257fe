"""`spaceplane export`: an analysis or an aerodynamic model for other tools."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from spaceplane.commands import options, sources
from spaceplane.commands.arguments import numbers, writable_file, write_json
from spaceplane.errors import InputError
from spaceplane.files import writable_folder

EXAMPLE = "Example: spaceplane export jsbsim horus-2b-published --out aircraft"
FORMATS = ("jsbsim", "tudat", "csv", "netcdf")
TABLES = ("csv", "netcdf")
"""Formats that an analysis has as well as a model."""


def export(
    form: Annotated[str, typer.Argument(metavar="|".join(FORMATS), help="What to write.")],
    source: Annotated[
        str,
        typer.Argument(
            metavar="SOURCE",
            help="Aerodynamic model: horus-2b-published, a folder of `spaceplane database`, a .nc file, a .toml file "
            "of derivatives (of `modes`; linear), a folder of tables, or one of `spaceplane analyse` (jsbsim and "
            "tudat: linear about one flight point).",
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Folder to write into; that of an analysis by default."),
    ] = None,
    vehicle: Annotated[
        str | None,
        typer.Option(
            "--vehicle",
            metavar="VEHICLE",
            help="Preset or YAML file with mass (jsbsim) and reference lengths (folder of tables) of the vehicle.",
        ),
    ] = None,
    center_of_mass: Annotated[
        str | None,
        typer.Option(
            "--center-of-mass",
            metavar="x,y,z",
            help="jsbsim: centre of mass, metres aft of the nose, to the right, up; the moment centre by default.",
        ),
    ] = None,
    name: Annotated[
        str | None, typer.Option("--name", metavar="NAME", help="jsbsim: name of the aircraft; the model's by default.")
    ] = None,
    point: sources.Point = None,
    json_file: options.JsonFile = None,
) -> int:
    """Aerodynamic models for JSBSim and Tudat; models and analyses as CSV tables or NetCDF files.

    Each deck states its axes, units, reference point and limits.
    """
    if form not in FORMATS:
        raise InputError(f"format {form!r}: allowed are {', '.join(FORMATS)}")
    for option, value in (("--center-of-mass", center_of_mass), ("--name", name)):
        if value is not None and form != "jsbsim":
            raise InputError(f"{option}: only the jsbsim format takes it")
    center = None if center_of_mass is None else numbers("--center-of-mass", center_of_mass, "m", 3)
    from spaceplane.decks.source import is_model

    if form in TABLES and not is_model(source):
        if vehicle is not None:
            raise InputError("--vehicle: an analysis has its own vehicle")
        if point is not None:
            raise InputError(f"--point: {point}, has no effect: {form} holds all flight points of an analysis")
        files = _of_analysis(form, source, out, json_file)
    else:
        files = _of_model(form, source, out, (vehicle, point), center, name, json_file)
    write_json({"files": [str(path) for path in files]}, json_file)
    if str(json_file) != "-":
        for path in files:
            typer.echo(path)
    return 0


def _of_analysis(form: str, source: str, out: Path | None, json_file: Path | None) -> list[Path]:
    from spaceplane.report.read import read_result
    from spaceplane.report.tables import write_csv, write_netcdf

    result = read_result(Path(source))
    target = writable_folder(out or Path(source), "--out")
    writable_file(json_file, "--json")
    return write_csv(result, target) if form == "csv" else write_netcdf(result, target)


def _of_model(
    form: str,
    source: str,
    out: Path | None,
    which: tuple[str | None, str | None],
    center: list[float] | None,
    name: str | None,
    json_file: Path | None,
) -> list[Path]:
    from spaceplane.decks import jsbsim, tables, tudat
    from spaceplane.decks.source import is_table_set

    vehicle, point = which
    found = sources.read(source, vehicle, point)
    sources.check_center(found.model, center)
    if vehicle is not None and form != "jsbsim" and not is_table_set(source):
        raise InputError(f"--vehicle: has no effect on {form} of {source}")
    if form == "jsbsim":
        if found.mass is None:
            raise InputError(f"--vehicle: needed, {source} does not say what the vehicle's mass is")
        jsbsim.xml(found.model, found.mass, name, center)  # refuses what cannot be before a folder is made
    if out is None:
        raise InputError("--out: needed, the folder to write into")
    target = writable_folder(out, "--out")
    writable_file(json_file, "--json")
    if form == "jsbsim":
        return jsbsim.write(found.model, found.mass, target, name, center)  # type: ignore[arg-type]
    write = {"tudat": tudat.write, "csv": tables.write_model_csv, "netcdf": tables.write_model_netcdf}[form]
    return write(found.model, target)
