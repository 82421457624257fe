"""`spaceplane compare`: two analyses beside each other."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from spaceplane.commands import options
from spaceplane.commands.arguments import existing_file, writable_file, write_json

EXAMPLE = "Example: spaceplane compare out/default/result.json out/optimised/result.json --json compare.json"


def compare(
    first: Annotated[Path, typer.Argument(metavar="A.json", help="result.json of the reference.")],
    second: Annotated[Path, typer.Argument(metavar="B.json", help="result.json to compare with it.")],
    json_file: options.JsonFile = None,
) -> int:
    """Derivatives, modes and levels of two analyses, flight point by flight point."""
    existing_file(first, "a result.json")
    existing_file(second, "a result.json")
    writable_file(json_file, "--json")
    from spaceplane.study import compare as comparison

    found = comparison.compare(first, second)
    write_json(found.as_dict(), json_file)
    if str(json_file) != "-":
        typer.echo(found.text())
    return 0
