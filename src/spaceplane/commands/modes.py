"""`spaceplane modes`: flight dynamics and flying qualities from given derivatives, without flow."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from spaceplane.commands import options
from spaceplane.commands.arguments import existing_file, writable_file, write_json

EXAMPLE = "Example: spaceplane modes examples/horus_table_6_1.toml --json modes.json"


def modes(
    derivatives: Annotated[
        Path, typer.Argument(metavar="DERIVATIVES.toml", help="Flight point, vehicle and derivatives.")
    ],
    vehicle_class: Annotated[
        str, typer.Option("--class", metavar="I..IV", help="Vehicle class of MIL-F-8785C.")
    ] = "III",
    category: Annotated[
        str, typer.Option("--category", metavar="A|B|C", help="Flight phase category of MIL-F-8785C.")
    ] = "B",
    json_file: options.JsonFile = None,
) -> int:
    """Eigenmodes and MIL-F-8785C levels from a table of derivatives."""
    existing_file(derivatives, "a TOML file of derivatives")
    writable_file(json_file, "--json")
    from spaceplane.dynamics import derivatives_file
    from spaceplane.qualities.analyse_modes import analyse_modes

    record = analyse_modes(derivatives_file.read(derivatives), vehicle_class, category)
    write_json(record, json_file)
    if str(json_file) != "-":
        from spaceplane.report.summary import print_modes

        print_modes(record)
    return 0
