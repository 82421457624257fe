"""`spaceplane modes`: flight dynamics and flying qualities from given derivatives, without flow."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from spaceplane.commands import options
from spaceplane.commands.arguments import existing_file, writable_file, write_json

EXAMPLE = "Example: spaceplane modes examples/horus_2b_taem.toml --json modes.json"


def modes(
    derivatives: Annotated[
        Path, typer.Argument(metavar="DERIVATIVES.toml", help="Flight point, vehicle and derivatives.")
    ],
    form: Annotated[
        str | None,
        typer.Option("--form", metavar="rigid-body|thesis", help="Form of the model, instead of the file's."),
    ] = None,
    vehicle_class: Annotated[
        str | None, typer.Option("--class", metavar="I..IV", help="Class of MIL-F-8785C, instead of the file's.")
    ] = None,
    category: Annotated[
        str | None, typer.Option("--category", metavar="A|B|C", help="Flight phase category, instead of the file's.")
    ] = None,
    json_file: options.JsonFile = None,
) -> int:
    """Eigenmodes and MIL-F-8785C levels from a table of derivatives."""
    existing_file(derivatives, "a TOML file of derivatives")
    writable_file(json_file, "--json")
    from spaceplane.dynamics import derivatives_file
    from spaceplane.qualities.modes_record import analyse_modes

    given = {"form": form, "vehicle_class": vehicle_class, "category": category}
    case = replace(derivatives_file.read(derivatives), **{name: value for name, value in given.items() if value})
    record = analyse_modes(case)
    write_json(record, json_file)
    if str(json_file) != "-":
        from spaceplane.report.summary import print_modes

        print_modes(record)
    return 0
