"""`spaceplane flow`: any watertight body, or any mesh around one, in any list of free streams."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spaceplane.commands import options
from spaceplane.commands.arguments import (
    angles,
    count,
    existing_file,
    list_of_names,
    mach_numbers,
    number,
    numbers,
    positive,
    writable_file,
    write_json,
)
from spaceplane.commands.progress import progress_bar
from spaceplane.errors import InputError, unknown_name
from spaceplane.files import renamed_when_done

if TYPE_CHECKING:
    from spaceplane.aero.flow_case import FlowCase
    from spaceplane.environment.atmosphere import Ambient
    from spaceplane.mesh.imported import Imported
    from spaceplane.vehicle.properties import ReferenceLengths
    from spaceplane.vehicle.surface import Surface

EULER, PERFECT = "euler", "perfect"
LIKELY_MESHES = 4  # on the way to an accuracy, for the progress bar
EXAMPLE = (
    "Example: spaceplane flow cone.stl --mach 1.5,3 --alpha 0,5 --area 1 --length 2 --span 1 --moment-center 0,0,0 "
    "--cell 0.05 --json cone.json"
)


def flow(
    body: Annotated[
        Path | None, typer.Argument(metavar="[BODY.stl]", help="Watertight body, metres; x aft, y right, z up.")
    ] = None,
    *,
    mach: Annotated[str, typer.Option("--mach", metavar="M[,M...]", help="Mach numbers.")],
    area: Annotated[str, typer.Option("--area", metavar="M2", help="Reference area.")],
    length: Annotated[str, typer.Option("--length", metavar="M", help="Reference length of the pitching moment.")],
    span: Annotated[str, typer.Option("--span", metavar="M", help="Reference length of rolling and yawing moment.")],
    moment_center: Annotated[
        str, typer.Option("--moment-center", metavar="x,y,z", help="Moment reference point, metres.")
    ],
    alpha: Annotated[str, typer.Option("--alpha", metavar="DEG[,DEG...]", help="Angles of attack, degrees.")] = "0",
    beta: Annotated[
        str, typer.Option("--beta", metavar="DEG[,DEG...]", help="Sideslip, degrees, wind from the right positive.")
    ] = "0",
    method: Annotated[
        str,
        typer.Option(
            "--method",
            metavar="NAME",
            help="euler, or local inclination on the body's triangles (no mesh, from Mach 2): newtonian-expansion, "
            "newtonian, tangent, tangent-cone, tangent-wedge.",
        ),
    ] = EULER,
    rates: Annotated[
        str,
        typer.Option("--rates", metavar="p,q,r", help="Steady roll, pitch and yaw rate about the moment point, rad/s."),
    ] = "0,0,0",
    cell: options.Cell = None,
    cells: options.Cells = None,
    adapt: options.Adapt = "0",
    domain: Annotated[
        str | None,
        typer.Option("--domain", metavar="x,y,z,x,y,z", help="Lower and upper corner of the air to mesh, metres."),
    ] = None,
    mesh_file: Annotated[
        Path | None,
        typer.Option(
            "--mesh",
            metavar="FILE",
            help="Body-fitted mesh (.su2 or .msh) instead of BODY.stl, metres; x aft, y right, z up. Coefficients are "
            "those of the walls in it: of half a body where it holds half.",
        ),
    ] = None,
    wall: Annotated[
        str | None, typer.Option("--wall", metavar="NAME[,NAME...]", help="Markers of --mesh that are walls.")
    ] = None,
    far: Annotated[
        str | None, typer.Option("--far", metavar="NAME[,NAME...]", help="Markers of --mesh that are far field.")
    ] = None,
    symmetry: Annotated[
        str | None,
        typer.Option("--symmetry", metavar="NAME[,NAME...]", help="Markers of --mesh that are planes of symmetry."),
    ] = None,
    uncertainty: options.Uncertainty = None,
    accuracy: options.AccuracyText = None,
    precision: options.Precision = "fp32",
    friction: options.Friction = "off",
    base: options.Base = "inviscid",
    wall_temperature: options.WallTemperature = None,
    emissivity: options.Emissivity = None,
    transition_reynolds: options.TransitionReynolds = None,
    altitude: Annotated[
        str | None, typer.Option("--altitude", metavar="M", help="Altitude of the air, for friction, rates and --gas.")
    ] = None,
    gas: options.Gas = PERFECT,
    json_file: options.JsonFile = None,
    vtu: Annotated[Path | None, typer.Option("--vtu", metavar="FILE", help="Write the flow for ParaView.")] = None,
    vtp: Annotated[
        Path | None, typer.Option("--vtp", metavar="FILE", help="Write the wall with its pressure for ParaView.")
    ] = None,
) -> int:
    """Inviscid flow about a body: every Mach number with every angle, all on one mesh in one run.

    With a --method other than euler: local inclination, without a mesh.
    Skin friction and base pressure are added if asked for.

    Exit code 0 when every condition converged (and the accuracy asked for was reached), 1 when not, 2 for bad input.
    """
    machs, alphas, betas = mach_numbers(mach), angles("--alpha", alpha), angles("--beta", beta)
    turning = numbers("--rates", rates, "rad/s", 3)
    lengths = {
        "area": positive("--area", area, "m2"),
        "chord": positive("--length", length, "m"),
        "span": positive("--span", span, "m"),
    }
    center = tuple(numbers("--moment-center", moment_center, "m", 3))
    solver_precision = options.precision(precision)
    increments = options.increment_settings(friction, base, wall_temperature, emissivity, transition_reynolds)
    gas = options.gas_name(gas)
    ambient = _ambient(altitude, friction, any(turning), gas)
    roles = {"wall": wall, "far": far, "symmetry": symmetry}
    mesh_options = {"--cell": cell, "--cells": cells, "--domain": domain, "--accuracy": accuracy}
    mesh_options["--uncertainty"] = uncertainty if uncertainty == "mesh" else None
    mesh_options["--adapt"] = None if adapt == "0" else adapt
    if mesh_file is None:
        _check_body(body, roles)
    else:
        _check_mesh_file(mesh_file, {"BODY.stl": body, **mesh_options}, method)
    asked = options.accuracy(accuracy, cell, cells, uncertainty)
    stated = options.uncertainty("iteration" if uncertainty is None else uncertainty)
    chosen = {role: list_of_names(f"--{role}", text) for role, text in roles.items()}
    writable_file(json_file, "--json")
    writable_file(vtu, "--vtu", (".vtu",))
    writable_file(vtp, "--vtp", (".vtp",))
    from spaceplane.vehicle.properties import ReferenceLengths

    reference = ReferenceLengths(**lengths, moment_center=center)
    if method != EULER:
        given = {**mesh_options, "--vtu": vtu, "--vtp": vtp}
        given["--rates"] = rates if any(turning) else None
        given["--friction"] = friction if friction != "off" else None
        given["--base"] = base if base != "inviscid" else None
        given["--gas"] = gas if gas != PERFECT else None
        given["--precision"] = precision if solver_precision != "single" else None
        _refuse_options(given, f"allowed with --method {EULER} only")
        return _inclination(body, method, (machs, alphas, betas), reference, json_file)
    from spaceplane.flow.settings import FlowSettings
    from spaceplane.mesh.settings import MeshSettings

    corners = None if domain is None else numbers("--domain", domain, "m", 6)
    default = MeshSettings(target_cells=200_000, domain=corners and (tuple(corners[:3]), tuple(corners[3:])))
    mesh = options.mesh_settings(cell, cells, default)
    settings = replace(FlowSettings(), precision=solver_precision)
    on_sound = tuple(rate / ambient.speed_of_sound for rate in turning)
    passes = options.adapt_passes(adapt, mesh)
    if passes:
        _refuse_options({"--accuracy": accuracy}, f"not allowed with --adapt {passes}: it refines the whole mesh")
    extra = {"rates": on_sound, "increments": increments, "ambient": ambient, "gas": gas}
    imported: Imported | None = None
    if mesh_file is None:
        from spaceplane.vehicle.stl import read_stl

        surface = read_stl(body)
        args = surface, machs, alphas, betas, reference, mesh, settings
        if asked is not None:
            return _to_accuracy(asked, cells, args, extra, json_file, vtu, vtp)
        from spaceplane.aero.flow_case import run_flow  # the numerical stack: after all that can be refused without it

        with progress_bar((2 if stated == "mesh" else 1) + passes) as tell:
            tell("mesh", 0, 1, "")
            case = run_flow(*args, tell, **extra, uncertainty=stated, adapt=passes)
    else:
        from spaceplane.mesh.imported import read_mesh

        imported = read_mesh(mesh_file, chosen)
        surface = imported.surface
        typer.echo(_roles(imported), err=True)
        from spaceplane.aero.flow_case import run_on_mesh

        with progress_bar() as tell:
            case = run_on_mesh(imported.mesh, machs, alphas, betas, reference, settings, tell, **extra)
    _write(case, surface, imported, vtu, vtp)
    return _tell(case, json_file)


def _to_accuracy(
    asked: float,
    cells: str | None,
    args: tuple,
    extra: dict,
    json_file: Path | None,
    vtu: Path | None,
    vtp: Path | None,
) -> int:
    """Refine until the accuracy is reached, write and tell what was; return the exit code."""
    from spaceplane.aero.flow_case import run_to_accuracy
    from spaceplane.aero.uncertainty.accuracy import Accuracy, Trial, cells_in_memory
    from spaceplane.report.summary import accuracy_line, trial_line

    wanted = Accuracy(asked, cells_in_memory() if cells is None else count("--cells", cells, "cells"))

    def say(trial: Trial) -> None:
        typer.echo(trial_line(trial), err=True)

    with progress_bar(LIKELY_MESHES) as tell:
        case, found = run_to_accuracy(*args, wanted, tell, **extra, tell=say)
    _write(case, args[0], None, vtu, vtp)
    code = _tell(case, json_file)
    typer.echo(accuracy_line(wanted, found), err=True)
    return code if found.met else 1


def _tell(case: FlowCase, json_file: Path | None) -> int:
    """Write the records, print them with what is wrong, and return the exit code."""
    write_json(case.records, json_file)
    for warning in case.mesh.record.get("warnings") or ():
        typer.echo(f"warning: {warning}", err=True)
    if str(json_file) != "-":
        from spaceplane.report.summary import print_flow

        print_flow(case.records)
    bad = [r for r in case.records if not r["converged"]]
    for r in bad:
        where = f"Mach {r['mach']:g}, alpha {r['alpha_deg']:g} deg, beta {r['beta_deg']:g} deg"
        typer.echo(f"not good: {where}: {r['verdict']}: {r['reason']}", err=True)
    return 1 if bad else 0


def _check_body(body: Path | None, roles: dict[str, str | None]) -> None:
    """Refuse a missing body, and markers (by role) where there is no mesh that has any."""
    _refuse_options({f"--{role}": text for role, text in roles.items()}, "only allowed with --mesh")
    if body is None:
        raise InputError("BODY.stl: missing; give it, or a mesh with --mesh FILE")
    existing_file(body, "an STL file")


def _check_mesh_file(mesh_file: Path, given: dict[str, object], method: str) -> None:
    """Refuse a missing mesh, and what does not go with one."""
    if method != EULER:
        raise InputError(f"--method: {method}, not allowed with --mesh: local inclination takes a surface")
    _refuse_options(given, "not allowed with --mesh, whose mesh is taken as it is")
    existing_file(mesh_file, "a .su2 or .msh file")


def _ambient(altitude: str | None, friction: str, turns: bool, gas: str) -> Ambient:
    """The air at the altitude, which friction, rates and equilibrium air need and nothing else does.

    Sea level for rates without one.
    """
    for option, value, off in (("--friction", friction, "off"), ("--gas", gas, PERFECT)):
        if altitude is None and value != off:
            raise InputError(f"--altitude: missing, {option} {value} needs it")
    if altitude is not None and friction == "off" and gas == PERFECT and not turns:
        raise InputError(f"--altitude: {altitude}, goes with --friction, --rates or --gas equilibrium")
    from spaceplane.environment.atmosphere import us1976

    return us1976(0.0 if altitude is None else number("--altitude", altitude, "m"))


def _inclination(
    body: Path, name: str, grid: tuple[list[float], ...], reference: ReferenceLengths, json_file: Path | None
) -> int:
    from spaceplane.aero.inclination.settings import METHODS, require_mach

    if name not in METHODS:
        raise InputError("--method: " + unknown_name("method", name, (EULER, *METHODS)))
    require_mach(grid[0])
    from spaceplane.aero.inclination.case import run_inclination
    from spaceplane.vehicle.stl import read_stl

    surface = read_stl(body)
    with progress_bar() as tell:
        records = run_inclination(surface, *grid, reference, name, tell).records
    write_json(records, json_file)
    if str(json_file) != "-":
        from spaceplane.report.summary import print_flow

        print_flow(records)
    return 0


def _refuse_options(values: dict[str, object], why: str) -> None:
    for option, value in values.items():
        if value is not None:
            raise InputError(f"{option}: {value}, {why}")


def _roles(imported: Imported) -> str:
    """One line: how many cells, and which markers were taken as what."""
    titles = {"wall": "wall", "far": "far field", "symmetry": "symmetry"}
    groups = {title: [n for n, r in imported.roles.items() if r == role] for role, title in titles.items()}
    listed = "; ".join(f"{title}: {', '.join(names)}" for title, names in groups.items() if names)
    return f"mesh: {imported.mesh.cells} cells; {listed}"


def _write(case: FlowCase, surface: Surface, imported: Imported | None, vtu: Path | None, vtp: Path | None) -> None:
    from spaceplane.flow import export

    if vtu is not None:
        with renamed_when_done(vtu) as partial:
            export.write_vtu(case.solution, partial, elements=imported and imported.elements)
    if vtp is not None:
        with renamed_when_done(vtp) as partial:
            export.write_vtp(surface, case.solution, partial)
