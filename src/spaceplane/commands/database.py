"""`spaceplane database`: aerodynamic tables of a vehicle over Mach number and angle of attack, from its own flow."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spaceplane.commands import options
from spaceplane.commands.arguments import number, numbers, warn_beyond_verified, writable_file, write_json
from spaceplane.commands.progress import progress_bar
from spaceplane.errors import InputError, unknown_name
from spaceplane.files import writable_folder

if TYPE_CHECKING:
    from spaceplane.analysis.tables.settings import TableSettings
    from spaceplane.study.database import Database
    from spaceplane.vehicle.presets import Vehicle

EXAMPLE = "Example: spaceplane database horus-2b --tier fast --out out/fast, then: spaceplane fly out/fast"
LISTED = 10
"""Conditions named on the terminal; all of them are on the page and in database.json."""
NONE = "none"


def database(
    vehicle: options.VehicleName,
    changes: options.Changes = None,
    tier: Annotated[
        str,
        typer.Option(
            "--tier",
            metavar="euler|fast",
            help="Euler solver (minutes), or local inclination, from Mach 2 up.",
        ),
    ] = "euler",
    mach: Annotated[
        str | None, typer.Option("--mach", metavar="M,M[,M...]", help="Increasing Mach numbers; the tier's by default.")
    ] = None,
    alpha: Annotated[
        str | None,
        typer.Option("--alpha", metavar="DEG,DEG[,...]", help="Increasing angles of attack; the tier's by default."),
    ] = None,
    elevon: Annotated[
        str | None, typer.Option("--elevon", metavar="DEG,...|none", help="Deflections of one elevon.")
    ] = None,
    rudder: Annotated[
        str | None, typer.Option("--rudder", metavar="DEG,...|none", help="Deflections of one rudder.")
    ] = None,
    body_flap: Annotated[
        str | None, typer.Option("--body-flap", metavar="DEG,...|none", help="Deflections of the body flap.")
    ] = None,
    damping: Annotated[bool, typer.Option(help="Slopes with roll, pitch and yaw rate.")] = True,
    method: Annotated[
        str | None, typer.Option("--method", metavar="NAME", help="Of the fast tier, as for `flow`.")
    ] = None,
    cell: options.Cell = None,
    cells: options.Cells = None,
    precision: options.Precision = "fp32",
    friction: options.Friction = "turbulent",
    base: options.Base = "correlation",
    wall_temperature: options.WallTemperature = None,
    emissivity: options.Emissivity = None,
    transition_reynolds: options.TransitionReynolds = None,
    altitude: Annotated[
        str | None,
        typer.Option("--altitude", metavar="M", help="Of the air, for friction; by default the descent's."),
    ] = None,
    allow_outside_limits: options.AllowOutside = False,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder to write into; out/VEHICLE-TIER by default.")
    ] = None,
    store: Annotated[
        Path | None, typer.Option("--store", metavar="FILE", help="Result store; DIR/store.sqlite by default.")
    ] = None,
    workers: Annotated[int, typer.Option("--workers", metavar="N", help="Processes that compute at once.")] = 1,
    json_file: options.JsonFile = None,
) -> int:
    """Aerodynamic tables over Mach number and angle of attack for `fly` and `export`.

    Lift, drag and pitching moment, what each control surface adds, and the slopes with sideslip and rates.
    Finished parts stay in the store: after Ctrl-C or a crash, run the same command again to go on.

    Exit code 0 when every flow condition converged, 1 when not, 2 for bad input.
    """
    subject = options.load_vehicle(vehicle, changes, allow_outside_limits)
    increments = (friction, base, wall_temperature, emissivity, transition_reynolds)
    given = {"--cell": cell, "--cells": cells, "--altitude": altitude}
    if workers < 1:
        raise InputError(f"--workers: {workers}, must be at least 1")
    settings = _settings(
        tier,
        {"machs": mach, "alphas": alpha},
        {"elevon_left": elevon, "rudder_left": rudder, "body_flap": body_flap},
        damping,
        method,
        given,
        options.precision(precision),
        increments,
    )
    folder = out or Path("out") / re.sub(r"[^\w.-]+", "-", f"{subject.name}-{tier}")
    writable_folder(folder, "--out")
    writable_file(json_file, "--json")
    found = _computed(subject, settings, store or folder / "store.sqlite", workers)
    if tier == "euler":
        warn_beyond_verified(settings.machs)
    from spaceplane.report import database as report

    files = report.write(found, folder)
    write_json(report.record(found), json_file)
    if str(json_file) != "-":
        typer.echo(f"{len(found.blocks)} blocks, {found.reused} from the store; {found.seconds:.0f} s")
        typer.echo(f"report: {files['html']}")
    for remark in found.remarks[:LISTED]:
        typer.echo(f"not good: {remark.line}", err=True)
    if len(found.remarks) > LISTED:
        typer.echo(f"not good: {len(found.remarks) - LISTED} more, see {files['json']}", err=True)
    return 1 if found.remarks else 0


def _settings(
    tier: str,
    grid: dict[str, str | None],
    deflections: dict[str, str | None],
    damping: bool,
    method: str | None,
    given: dict[str, str | None],
    precision: str,
    increments: tuple[str, str, str | None, str | None, str | None],
) -> TableSettings:
    """The settings that the options ask for.

    Raises:
        InputError: a value that is not allowed, or an option of the other tier.
    """
    from dataclasses import replace

    from spaceplane.aero.conditions import DerivativeSteps
    from spaceplane.analysis.tables.settings import COARSE_MESH, EULER, TIERS, default_settings
    from spaceplane.flow.settings import FlowSettings

    if tier not in TIERS:
        raise InputError("--tier: " + unknown_name("tier", tier, TIERS))
    fields: dict = {} if damping else {"steps": DerivativeSteps(rate=0.0)}
    if grid["machs"] is not None:
        fields["machs"] = tuple(numbers("--mach", grid["machs"]))
    if grid["alphas"] is not None:
        fields["alphas"] = tuple(math.radians(a) for a in numbers("--alpha", grid["alphas"], "degrees"))
    if tier == EULER:
        if method is not None:
            raise InputError(f"--method: {method}, goes with --tier fast only")
        fields["increments"] = options.increment_settings(*increments)
        fields["mesh"] = options.mesh_settings(given["--cell"], given["--cells"], None, COARSE_MESH)
        fields["flow"] = FlowSettings(precision=precision)
        if given["--altitude"] is not None:
            fields["altitude_m"] = number("--altitude", given["--altitude"], "m")
    else:
        _refuse_euler_options(given, increments, precision)
        fields |= {} if method is None else {"method": method}
    settings = default_settings(tier, **fields)
    moved = dict(settings.deflections)
    for name, text in deflections.items():
        option = f"--{name.removesuffix('_left').replace('_', '-')}"
        if text is not None and text.strip() == NONE:
            del moved[name]
        elif text is not None:
            moved[name] = tuple(math.radians(d) for d in numbers(option, text, "degrees"))
    return replace(settings, deflections=moved)


def _refuse_euler_options(given: dict[str, str | None], increments: tuple, precision: str) -> None:
    """Local inclination has no mesh and, here, no viscous increments: an option that asks for them is a mistake."""
    names = ("--friction", "--base", "--wall-temperature", "--emissivity", "--transition-reynolds", "--precision")
    usual = ("turbulent", "correlation", None, None, None, "single")
    asked = {n: v for n, v, u in zip(names, (*increments, precision), usual, strict=True) if v != u}
    for option, value in {**given, **asked}.items():
        if value is not None:
            raise InputError(f"{option}: {value}, goes with --tier euler only")


def _computed(subject: Vehicle, settings: TableSettings, store: Path, workers: int) -> Database:
    """Compute with a progress bar; kernels are compiled here, not in every worker."""
    from spaceplane.analysis.tables.settings import EULER
    from spaceplane.flow.compilation import compile_all
    from spaceplane.study import database as study

    with progress_bar() as tell:

        def on_change(p) -> None:
            left = "" if p.remaining_s is None else f", about {p.remaining_s / 60:.0f} min left"
            tell(f"{settings.tier} flow: {p.done} of {p.total} blocks ({p.reused} from the store){left}", p.fraction)

        before = (lambda: compile_all(tell)) if settings.tier == EULER else None
        return study.run(subject, settings, store, on_change, workers, before=before)
