"""`spaceplane fly`: trim, modes and flying qualities along a descent from aerodynamic tables, without flow."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spaceplane.commands import feedback, options, sources
from spaceplane.commands.arguments import count, mach_numbers, number, numbers, writable_file, write_json
from spaceplane.commands.progress import progress_bar
from spaceplane.errors import InputError
from spaceplane.files import writable_folder

if TYPE_CHECKING:
    from spaceplane.analysis.descent import Descent
    from spaceplane.dynamics.flightpoint import FlightPoint

EXAMPLE = "Example: spaceplane fly horus-2b-published --out out/fly"


def fly(
    source: Annotated[
        str,
        typer.Argument(
            metavar="SOURCE",
            help="Aerodynamic model: horus-2b-published, a folder of `spaceplane database`, a .nc file, a folder of "
            "tables, a .toml file of derivatives (of `modes`) or a folder of `spaceplane analyse` (both linear about "
            "one flight point).",
        ),
    ],
    mach: Annotated[
        str | None,
        typer.Option(
            "--mach",
            metavar="M[,M...]",
            help="Mach numbers; 1.5 to 20 by default, or that of the flight point that the model is linear about.",
        ),
    ] = None,
    alpha: Annotated[
        str | None,
        typer.Option(
            "--alpha",
            metavar="DEG[,DEG...]",
            help="Angle of attack, one or one for each Mach number, as the next three; a schedule by default.",
        ),
    ] = None,
    altitude: Annotated[
        str | None,
        typer.Option("--altitude", metavar="M[,M...]", help="Altitude; that of the descent by default."),
    ] = None,
    gamma: Annotated[
        str | None,
        typer.Option(
            "--gamma",
            metavar="DEG[,DEG...]",
            help="Path angle; by default the glide's, on which drag slows down as fast as the altitudes ask.",
        ),
    ] = None,
    bank: Annotated[
        str | None,
        typer.Option(
            "--bank",
            metavar="DEG[,DEG...]",
            help="Bank angle; by default the glide's, which turns sideways what lift is left over.",
        ),
    ] = None,
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
    point: sources.Point = None,
    center_of_mass: Annotated[
        str | None,
        typer.Option(
            "--center-of-mass",
            metavar="x,y,z",
            help="Metres aft of the nose, to the right, up; the moment centre of the model by default.",
        ),
    ] = None,
    uncertainty: Annotated[
        str | None,
        typer.Option(
            "--uncertainty",
            metavar="NAME=ERROR[,...]",
            help="Half widths of 95 % intervals of derivatives (per rad), CL and CD: Cm_alpha=10%,Cn_beta=0.01 or "
            "all=10%. Levels then come with probabilities. A derivatives file's own are the default.",
        ),
    ] = None,
    samples: Annotated[
        str | None, typer.Option("--samples", metavar="N", help="Draws for them at each flight point; 1000 by default.")
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
    asked = {"alpha_deg": alpha, "altitude_m": altitude, "gamma_deg": gamma, "bank_deg": bank}
    flown = {name: _each(name, text) for name, text in asked.items() if text is not None}
    given: dict = {"form": form, "vehicle_class": vehicle_class, "category": category}
    given |= {} if body_flap is None else {"body_flap": math.radians(number("--body-flap", body_flap, "deg"))}
    center = None if center_of_mass is None else numbers("--center-of-mass", center_of_mass, "m", 3)
    if samples is not None:
        given["samples"] = count("--samples", samples, "draws")
    given["feedback"] = feedback.settings(control, gust, offset, decay)
    writable_file(json_file, "--json")
    from spaceplane.analysis.descent import MACHS, DescentSettings, descend
    from spaceplane.decks.source import PUBLISHED
    from spaceplane.dynamics.given_errors import read_errors
    from spaceplane.dynamics.trim.longitudinal import HORUS_2B_BODY_FLAP

    if uncertainty is not None:
        given["uncertainty"] = read_errors("--uncertainty", uncertainty)
    if source == PUBLISHED:
        given.setdefault("body_flap", HORUS_2B_BODY_FLAP)
    found = sources.read(source, vehicle, point)
    if machs is None and found.point is not None:
        machs = [found.point.mach]
        flown = _of(found.point) | flown
    given["machs"] = tuple(machs or MACHS)
    given |= {name: values * len(given["machs"]) if len(values) == 1 else values for name, values in flown.items()}
    if uncertainty is None and center is None:
        given |= {"uncertainty": found.errors, "correlation": found.correlation}
    elif uncertainty is None and found.errors:
        typer.echo(
            "errors of the source hold about its own moment centre and are left out; see --uncertainty", err=True
        )
    if samples is not None and not given.get("uncertainty"):
        raise InputError("--samples: goes with --uncertainty")
    settings = DescentSettings(**given)
    if found.mass is None:
        raise InputError("--vehicle: needed, for the mass that the tables do not give")
    sources.check_center(found.model, center)
    model = found.model if center is None else found.model.moved((center[0], center[1], center[2]))
    folder = writable_folder(out, "--out")
    with progress_bar() as tell:
        descent = descend(model, found.mass, settings, tell)
    from spaceplane.report import descent as report
    from spaceplane.report import descent_likelihood
    from spaceplane.report.descent_summary import print_descent

    files = report.write(descent, folder)
    write_json(report.record(descent), json_file)
    trimmed = [one for one in descent.points if one.trim is not None]
    if str(json_file) != "-":
        for one in descent.points:
            if one.trim is None:
                typer.echo(f"Mach {one.point.mach:g}: no trim: {one.reason}", err=True)
        print_descent(descent)
        descent_likelihood.print_levels(descent)
        typer.echo(f"{len(trimmed)} of {len(descent.points)} flight points trimmed{_elsewhere(descent)}")
        typer.echo(f"report: {files['html']}")
    return 0 if trimmed else 1


def _elsewhere(descent: Descent) -> str:
    """Where the centre of mass would have to be, if half of the flight points have no trim about it."""
    from spaceplane.analysis.trimming_center import trimming_center

    trimmed = sum(one.trim is not None for one in descent.points)
    if 2 * trimmed > len(descent.points):
        return ""
    found, x = trimming_center(descent.model, descent.settings), descent.model.reference.moment_center[0]
    if found is None:
        return ""
    if found.count <= trimmed:
        return f" about x = {x:.2f} m"
    where = f"{found.lower:.2f} to {found.upper:.2f} m" if found.upper > found.lower else f"{found.lower:.2f} m"
    return f" about x = {x:.2f} m; about {where} {found.count} would be (--center-of-mass)"


def _each(name: str, text: str) -> tuple[float, ...]:
    """Values of `--alpha`, `--altitude`, `--gamma` or `--bank`."""
    quantity, unit = name.split("_")
    return tuple(numbers(f"--{quantity}", text, unit))


def _of(point: FlightPoint) -> dict[str, tuple[float, ...]]:
    """The attitude and altitude of a flight point, as settings of a descent."""
    angles = {f"{name}_deg": (math.degrees(getattr(point, name)),) for name in ("alpha", "gamma", "bank")}
    return angles | {"altitude_m": (point.altitude,)}
