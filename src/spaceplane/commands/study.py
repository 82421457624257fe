"""`spaceplane study`: many analyses of one vehicle."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from spaceplane.commands import options
from spaceplane.commands.arguments import existing_file, writable_file, write_json
from spaceplane.commands.progress import progress_bar
from spaceplane.errors import InputError
from spaceplane.files import writable_folder

EXAMPLE = "Example: spaceplane study sensitivity examples/sensitivity.yaml --out out/sensitivity --workers 2"

app = typer.Typer(help="Many analyses of one vehicle.", no_args_is_help=True)


@app.callback()
def _study() -> None:
    pass


@app.command("sensitivity", epilog=EXAMPLE)
def sensitivity(
    file: Annotated[
        Path | None, typer.Argument(metavar="[STUDY.yaml]", help="What to vary; the thesis's study by default.")
    ] = None,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for tables, plots and the store.")] = Path(
        "out/sensitivity"
    ),
    store: Annotated[
        Path | None, typer.Option("--store", metavar="FILE", help="Result store; DIR/store.sqlite by default.")
    ] = None,
    resume: Annotated[bool, typer.Option(help="Go on from the store; --no-resume refuses a store that exists.")] = True,
    workers: Annotated[
        int | None, typer.Option("--workers", metavar="N", help="Processes that compute at once.")
    ] = None,
    plots: Annotated[bool, typer.Option(help="Draw the plots.")] = True,
    json_file: options.JsonFile = None,
) -> int:
    """One shape parameter at a time: how derivatives, modes and levels answer.

    Finished cases stay in the store: after Ctrl-C or a crash, run the same command again to go on.
    """
    if file is not None:
        existing_file(file, "a study's YAML file")
    if workers is not None and workers < 1:
        raise InputError(f"--workers: {workers}, must be at least 1")
    writable_folder(out, "--out")
    writable_file(json_file, "--json")
    store_path = store or out / "store.sqlite"
    if not resume and store_path.exists():
        raise InputError(f"--no-resume: {store_path} exists; remove it or name another --store")
    from spaceplane.flow.compilation import compile_all
    from spaceplane.study import sensitivity as study
    from spaceplane.study.cases import load_study

    asked = load_study(file)
    with progress_bar() as tell:

        def on_change(p) -> None:
            left = "" if p.remaining_s is None else f", about {p.remaining_s / 60:.0f} min left"
            tell(f"{p.done} of {p.total} shapes ({p.reused} from the store){left}", p.fraction)

        compile_once = partial(compile_all, tell)  # here, not in every worker
        found = study.run(asked, store_path, out, on_change, workers, plots=plots, before=compile_once)
    if json_file is not None:
        import json

        write_json(json.loads(found.files["sensitivity.json"].read_text(encoding="utf-8")), json_file)
    if str(json_file) != "-":
        typer.echo(f"{found.computed} shapes computed, {found.reused} from the store, {found.seconds:.0f} s")
        for name, path in found.files.items():
            typer.echo(f"{name}: {path}")
    for warning in found.warnings:
        typer.echo(f"warning: {warning}", err=True)
    for failure in found.failures:
        typer.echo(f"not good: {failure.label}: {failure.reason}", err=True)
    flows_failed = any(row.flow == "failed" for row in found.rows)
    return 1 if found.failures or flows_failed else 0
