"""`spaceplane report`: write the HTML report of an analysis again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from spaceplane.commands import options
from spaceplane.commands.arguments import writable_file, write_json
from spaceplane.files import writable_folder

EXAMPLE = "Example: spaceplane report out/horus-2b"


def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that `spaceplane analyse` wrote.")],
    json_file: options.JsonFile = None,
) -> int:
    """Write report.html from the result.json and surface.vtp in a folder.

    Exit code 1, with the report written, when a flow condition in it did not converge.
    """
    from spaceplane.report import write_report
    from spaceplane.report.read import read_result
    from spaceplane.report.summary import complain, print_summary, shortcomings

    result = read_result(folder)
    writable_folder(folder, "DIR")
    writable_file(json_file, "--json")
    path = write_report(folder)
    write_json({"report": str(path)}, json_file)
    if str(json_file) != "-":
        print_summary(result, path)
    return complain(shortcomings(result))
