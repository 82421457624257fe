"""`spaceplane validate`: published and exact cases beside our numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from spaceplane.commands import options
from spaceplane.commands.arguments import writable_file, write_json
from spaceplane.commands.progress import progress_bar
from spaceplane.files import writable_folder

EXAMPLE = "Example: spaceplane validate cones sphere --out out/validation"


def validate(
    cases: Annotated[
        list[str] | None, typer.Argument(metavar="[CASE ...]", help="Cases to run; all of them by default.")
    ] = None,
    coarse: Annotated[
        bool, typer.Option("--coarse", help="Coarse meshes: seconds instead of minutes, wider of the mark.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Write validation.json and the page with pictures here.")
    ] = None,
    json_file: options.JsonFile = None,
) -> int:
    """Run validation cases; exit code 1 when a gating value lies outside its band."""
    if out is not None:
        writable_folder(out, "--out")
    writable_file(json_file, "--json")
    from spaceplane import validation
    from spaceplane.validation.records import as_dict

    with progress_bar() as tell:
        records = validation.run(tuple(cases or ()), tell, fine=not coarse)
    if out is not None:
        validation.write(records, out)
    write_json([as_dict(record) for record in records], json_file)
    if str(json_file) != "-":
        from spaceplane.validation.terminal import print_table

        print_table(records)
    return 0 if validation.passed(records) else 1
