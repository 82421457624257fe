"""`spaceplane compare`: two analyses beside each other."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from spaceplane.commands import options
from spaceplane.commands.arguments import count, writable_file, write_json
from spaceplane.commands.progress import progress_bar
from spaceplane.errors import InputError
from spaceplane.files import writable_folder

EXAMPLE = "Example: spaceplane compare out/default/result.json out/wide/result.json --json compare.json"


def compare(
    first: Annotated[Path | None, typer.Argument(metavar="A.json", help="result.json of the reference.")] = None,
    second: Annotated[Path | None, typer.Argument(metavar="B.json", help="result.json to compare with it.")] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Write the comparison as JSON, Markdown and HTML here.")
    ] = None,
    cells: options.Cells = None,
    workers: Annotated[int, typer.Option("--workers", metavar="N", help="Processes, when shapes are computed.")] = 1,
    json_file: options.JsonFile = None,
) -> int:
    """Derivatives, modes and levels of two analyses, flight point by flight point.

    Without files: HORUS-2B against the thesis's optimised shape at Mach 0.8, 1.5, 2.5, 5 and 10, computed and kept in
    the store of --out (out/compare by default).
    """
    if (first is None) != (second is None):
        raise InputError("compare: two result.json files are needed, or none for default against optimised shape")
    if first is not None and cells is not None:
        raise InputError("--cells: says how shapes are computed; two result.json files are compared as they are")
    if workers < 1:
        raise InputError(f"--workers: {workers}, must be at least 1")
    writable_file(json_file, "--json")
    folder = Path("out/compare") if first is None and out is None else out
    if folder is not None:
        writable_folder(folder, "--out")
    comparison = _computed(folder, cells, workers) if first is None else _read(first, second)
    from spaceplane.study import compare_page

    write_json(comparison, json_file)
    files = compare_page.write(comparison, folder) if folder is not None else {}
    if str(json_file) != "-":
        typer.echo(compare_page.as_text(comparison))
        for path in files.values():
            typer.echo(path)
    from spaceplane.report.summary import complain

    flows = [(point["mach"], verdict) for point in comparison["flight_points"] for verdict in point["flow"]]
    return complain([f"Mach {mach:g}: flow {verdict}" for mach, verdict in flows if verdict != "converged"])


def _read(first: Path, second: Path) -> dict:
    from spaceplane.report.read import read_result
    from spaceplane.study.compare import compare as side_by_side

    return side_by_side(read_result(first), read_result(second))


def _computed(folder: Path, cells: str | None, workers: int) -> dict:
    settings = {} if cells is None else {"mesh": {"target_cells": count("--cells", cells, "cells")}}
    from spaceplane.flow.compilation import compile_all
    from spaceplane.study.compare import default_against_optimised

    with progress_bar() as tell:

        def on_change(p) -> None:
            tell(f"{p.done} of {p.total} shapes: {', '.join(p.running)}", p.fraction)

        compile_once = partial(compile_all, tell)  # here, not in every worker
        return default_against_optimised(folder / "store.sqlite", on_change, workers, settings, before=compile_once)
