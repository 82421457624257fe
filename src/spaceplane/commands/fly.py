"""`spaceplane fly`: trim, modes and flying qualities along a descent from aerodynamic tables, without flow."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from spaceplane.commands import feedback, options
from spaceplane.commands.arguments import mach_numbers, number, writable_file, write_json
from spaceplane.commands.progress import progress_bar
from spaceplane.errors import InputError
from spaceplane.files import writable_folder

EXAMPLE = "Example: spaceplane fly horus-2b-published --out out/fly"


def fly(
    source: Annotated[
        str,
        typer.Argument(
            metavar="SOURCE", help="Aerodynamic model: horus-2b-published, a .nc file or a folder of tables."
        ),
    ],
    mach: Annotated[
        str | None, typer.Option("--mach", metavar="M[,M...]", help="Mach numbers; 1.5 to 20 by default.")
    ] = None,
    gamma: Annotated[str | None, typer.Option("--gamma", metavar="DEG", help="Path angle; -8.4 by default.")] = None,
    bank: Annotated[str | None, typer.Option("--bank", metavar="DEG", help="Bank angle; 55 by default.")] = None,
    body_flap: Annotated[
        str | None,
        typer.Option(
            "--body-flap",
            metavar="DEG",
            help="Held everywhere; else a schedule, or the elevator's largest margin.",
        ),
    ] = None,
    form: Annotated[
        str, typer.Option("--form", metavar="rigid-body|thesis", help="Form of the linear model.")
    ] = "rigid-body",
    vehicle_class: Annotated[str, typer.Option("--class", metavar="I..IV", help="Class of MIL-F-8785C.")] = "III",
    category: Annotated[str, typer.Option("--category", metavar="A|B|C", help="Flight phase category.")] = "B",
    vehicle: Annotated[
        str | None,
        typer.Option("--vehicle", metavar="VEHICLE", help="Preset or YAML file with mass and reference lengths."),
    ] = None,
    control: feedback.Control = True,
    gust: feedback.Gust = None,
    offset: feedback.Offset = None,
    decay: feedback.Decay = None,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder to write into.")] = Path("out/fly"),
    json_file: options.JsonFile = None,
) -> int:
    """Trim map, trimmed flight points, modes followed along the Mach number, levels, control and a page of it all.

    Exit code 1 when no flight point could be trimmed, 2 for bad input.
    """
    machs = None if mach is None else mach_numbers(mach)
    angles = {"gamma_deg": ("--gamma", gamma), "bank_deg": ("--bank", bank)}
    given: dict = {name: number(option, text, "deg") for name, (option, text) in angles.items() if text is not None}
    given |= {"form": form, "vehicle_class": vehicle_class, "category": category}
    given |= {} if machs is None else {"machs": tuple(machs)}
    given |= {} if body_flap is None else {"body_flap": math.radians(number("--body-flap", body_flap, "deg"))}
    given["feedback"] = feedback.settings(control, gust, offset, decay)
    writable_file(json_file, "--json")
    from spaceplane.analysis.descent import DescentSettings, descend
    from spaceplane.decks.source import PUBLISHED, read_source
    from spaceplane.dynamics.trim.longitudinal import HORUS_2B_BODY_FLAP

    if source == PUBLISHED:
        given.setdefault("body_flap", HORUS_2B_BODY_FLAP)
    settings = DescentSettings(**given)
    found = read_source(source, vehicle)
    if found.mass is None:
        raise InputError("--vehicle: needed, for the mass that the tables do not give")
    folder = writable_folder(out, "--out")
    with progress_bar() as tell:
        descent = descend(found.model, found.mass, settings, tell)
    from spaceplane.report import descent as report

    files = report.write(descent, folder)
    write_json(report.record(descent), json_file)
    trimmed = [one for one in descent.points if one.trim is not None]
    if str(json_file) != "-":
        for one in descent.points:
            if one.trim is None:
                typer.echo(f"Mach {one.point.mach:g}: no trim: {one.reason}", err=True)
        typer.echo(f"{len(trimmed)} of {len(descent.points)} flight points trimmed")
        typer.echo(f"report: {files['html']}")
    return 0 if trimmed else 1
