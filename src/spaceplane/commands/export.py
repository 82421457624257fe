"""`spaceplane export`: an analysis as tables for other tools."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from spaceplane.commands import options
from spaceplane.commands.arguments import writable_file, write_json
from spaceplane.errors import InputError
from spaceplane.files import writable_folder

EXAMPLE = "Example: spaceplane export csv out/horus-2b --out tables"
FORMATS = ("csv", "netcdf")


def export(
    form: Annotated[str, typer.Argument(metavar="csv|netcdf", help="What to write.")],
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that `spaceplane analyse` wrote.")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder to write into; DIR by default.")
    ] = None,
    json_file: options.JsonFile = None,
) -> int:
    """Coefficients, derivatives, modes and verdicts as CSV tables or one NetCDF file."""
    if form not in FORMATS:
        raise InputError(f"format {form!r}: allowed are {', '.join(FORMATS)}")
    from spaceplane.report.read import read_result
    from spaceplane.report.tables import write_csv, write_netcdf

    result = read_result(folder)
    target = writable_folder(out or folder, "--out")
    writable_file(json_file, "--json")
    files = write_csv(result, target) if form == "csv" else write_netcdf(result, target)
    write_json({"files": [str(path) for path in files]}, json_file)
    if str(json_file) != "-":
        for path in files:
            typer.echo(path)
    return 0
