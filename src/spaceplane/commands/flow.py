"""`spaceplane flow`: any watertight body, or any mesh around one, in any list of free streams."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from spaceplane.commands import flow_options as opt
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
    warn_beyond_verified,
    writable_file,
    write_json,
)
from spaceplane.commands.progress import progress_bar
from spaceplane.errors import InputError, unknown_name
from spaceplane.files import renamed_when_done

if TYPE_CHECKING:
    from spaceplane.aero.flow_case import FlowCase
    from spaceplane.aero.free_streams import FreeStreams
    from spaceplane.environment.atmosphere import Ambient
    from spaceplane.flow.settings import FlowSettings
    from spaceplane.mesh.imported import Imported
    from spaceplane.vehicle.properties import ReferenceLengths
    from spaceplane.vehicle.surface import Surface

EULER, PERFECT = "euler", "perfect"
LIKELY_MESHES = 4  # on the way to an accuracy, for the progress bar
EXAMPLE = (
    "Example: spaceplane flow cone.stl --mach 1.5,3 --alpha 0,5 --area 1 --length 2 --span 1 --moment-center 0,0,0 "
    "--cell 0.05 --json cone.json"
)


@dataclass(frozen=True)
class Files:
    """Where results go; None for nowhere."""

    json: Path | None
    vtu: Path | None
    vtp: Path | None


def flow(
    body: opt.Body = None,
    *,
    mach: opt.Mach,
    area: opt.Area,
    length: opt.Length,
    span: opt.Span,
    moment_center: opt.MomentCenter,
    alpha: opt.Alpha = "0",
    beta: opt.Beta = "0",
    method: opt.Method = EULER,
    rates: opt.Rates = "0,0,0",
    cell: options.Cell = None,
    cells: options.Cells = None,
    edges: options.Edges = None,
    refine_box: options.RefineBox = None,
    refine_parts: options.RefineParts = None,
    adapt: options.Adapt = "0",
    domain: opt.Domain = None,
    mesh_file: opt.MeshFile = None,
    wall: opt.Wall = None,
    far: opt.Far = None,
    symmetry: opt.Symmetry = None,
    uncertainty: options.Uncertainty = None,
    accuracy: options.AccuracyText = None,
    precision: options.Precision = "fp32",
    decades: options.Decades = "3",
    friction: options.Friction = "off",
    base: options.Base = "inviscid",
    wall_temperature: options.WallTemperature = None,
    emissivity: options.Emissivity = None,
    transition_reynolds: options.TransitionReynolds = None,
    altitude: opt.Altitude = None,
    gas: options.Gas = PERFECT,
    json_file: options.JsonFile = None,
    vtu: opt.Vtu = None,
    vtp: opt.Vtp = None,
) -> int:
    """Inviscid flow about a body: every Mach number with every angle, all on one mesh in one run.

    With a --method other than euler: local inclination, without a mesh.
    Skin friction and base pressure are added if asked for.

    Exit code 0 when every condition converged (and the accuracy and decades asked for were reached), 1 when not, 2 for
    bad input.
    """
    grid = mach_numbers(mach), angles("--alpha", alpha), angles("--beta", beta)
    turning = numbers("--rates", rates, "rad/s", 3)
    sizes = positive("--area", area, "m2"), positive("--length", length, "m"), positive("--span", span, "m")
    center = tuple(numbers("--moment-center", moment_center, "m", 3))
    solver_precision, fall = options.precision(precision), options.decades(decades)
    increments = options.increment_settings(friction, base, wall_temperature, emissivity, transition_reynolds)
    gas = options.gas_name(gas)
    ambient = _ambient(altitude, friction, any(turning), gas)
    roles = {"wall": wall, "far": far, "symmetry": symmetry}
    mesh_options = {"--cell": cell, "--cells": cells, "--domain": domain, "--accuracy": accuracy}
    refining = {"--edges": edges, **options.refinement(refine_box, refine_parts)}
    mesh_options |= refining
    mesh_options["--uncertainty"] = uncertainty if uncertainty == "mesh" else None
    mesh_options["--adapt"] = None if adapt == "0" else adapt
    if mesh_file is None:
        _check_body(body, roles)
    else:
        _check_mesh_file(mesh_file, {"BODY.stl": body, **mesh_options}, method)
    asked = options.accuracy(accuracy, cell, cells, uncertainty)
    stated = options.uncertainty("mesh" if uncertainty is None else uncertainty)
    chosen = {role: list_of_names(f"--{role}", text) for role, text in roles.items()}
    files = _files(json_file, vtu, vtp)
    from spaceplane.vehicle.properties import ReferenceLengths

    reference = ReferenceLengths(*sizes, center)
    if method != EULER:
        given = {**mesh_options, "--vtu": vtu, "--vtp": vtp}
        given["--rates"] = rates if any(turning) else None
        given["--friction"] = friction if friction != "off" else None
        given["--base"] = base if base != "inviscid" else None
        given["--gas"] = gas if gas != PERFECT else None
        given["--precision"] = precision if solver_precision != "single" else None
        given["--decades"] = decades if decades != "3" else None
        _refuse_options(given, f"allowed with --method {EULER} only")
        return _inclination(body, method, grid, reference, json_file)
    from spaceplane.mesh.settings import MeshSettings

    corners = None if domain is None else numbers("--domain", domain, "m", 6)
    corners = corners and (tuple(corners[:3]), tuple(corners[3:]))
    default = MeshSettings(target_cells=200_000, domain=corners, fine_edges=True)
    mesh = options.mesh_settings(cell, cells, edges, default, refine_box, refine_parts)
    passes = options.adapt_passes(adapt, mesh)
    if passes:
        _refuse_options({"--accuracy": accuracy}, f"not allowed with --adapt {passes}: it refines the whole mesh")
        _refuse_options(refining, f"not allowed with --adapt {passes}: it finds out where to refine")
    # The numerical stack is loaded after all that can be refused without it.
    from spaceplane.aero.free_streams import FreeStreams
    from spaceplane.flow.settings import FlowSettings

    settings = FlowSettings(precision=solver_precision).falling(fall)
    on_sound = tuple(rate / ambient.speed_of_sound for rate in turning)
    streams = FreeStreams(*grid, on_sound, increments, ambient, gas)
    if mesh_file is not None:
        return _on_mesh(mesh_file, chosen, streams, reference, settings, files)
    from spaceplane.vehicle.stl import read_stl

    args = read_stl(body, by_solid=bool(refine_parts)), streams, reference, mesh, settings
    if asked is not None:
        return _to_accuracy(asked, cells, args, files)
    return _on_body(args, stated, passes, files)


def _on_body(args: tuple, uncertainty: str, passes: int, files: Files) -> int:
    """Mesh, solve, write and tell what was found; return the exit code. `args` begin those of `run_flow`."""
    from spaceplane.aero.flow_case import run_flow

    with progress_bar((2 if uncertainty == "mesh" else 1) + passes) as tell:
        tell("mesh", 0, 1, "")
        case = run_flow(*args, tell, uncertainty, passes)
    return _done(case, args[0], None, args[-1], files)


def _on_mesh(
    path: Path,
    roles: dict[str, list[str] | None],
    streams: FreeStreams,
    reference: ReferenceLengths,
    settings: FlowSettings,
    files: Files,
) -> int:
    """Solve on the mesh in a file, whose markers have these `roles`; otherwise as `_on_body`."""
    from spaceplane.aero.flow_case import run_on_mesh
    from spaceplane.mesh.imported import read_mesh

    imported = read_mesh(path, roles)
    typer.echo(_roles(imported), err=True)
    with progress_bar() as tell:
        case = run_on_mesh(imported.mesh, streams, reference, settings, tell)
    return _done(case, imported.surface, imported, settings, files)


def _to_accuracy(asked: float, cells: str | None, args: tuple, files: Files) -> int:
    """Refine until the accuracy is reached; otherwise as `_on_body`."""
    from spaceplane.aero.flow_case import run_to_accuracy
    from spaceplane.aero.uncertainty.accuracy import Accuracy, Trial, cells_in_memory
    from spaceplane.report.summary import accuracy_line, trial_line

    wanted = Accuracy(asked, cells_in_memory() if cells is None else count("--cells", cells, "cells"))

    def say(trial: Trial) -> None:
        typer.echo(trial_line(trial), err=True)

    with progress_bar(LIKELY_MESHES) as tell:
        case, found = run_to_accuracy(*args, wanted, tell, say)
    code = _done(case, args[0], None, args[-1], files)
    typer.echo(accuracy_line(wanted, found), err=True)
    return code if found.met else 1


def _done(case: FlowCase, surface: Surface, imported: Imported | None, settings: FlowSettings, files: Files) -> int:
    """Write the flow and the records, print them with what is wrong, and return the exit code."""
    from spaceplane.flow import export

    if files.vtu is not None:
        with renamed_when_done(files.vtu) as partial:
            export.write_vtu(case.solution, partial, elements=imported and imported.elements)
    if files.vtp is not None:
        with renamed_when_done(files.vtp) as partial:
            export.write_vtp(surface, case.solution, partial)
    for warning in case.mesh.record.get("warnings") or ():
        typer.echo(f"warning: {warning}", err=True)
    warn_beyond_verified([r["mach"] for r in case.records])
    _print(case.records, files.json)
    bad = [r for r in case.records if not r["converged"]]
    for r in bad:
        where = f"Mach {r['mach']:g}, alpha {r['alpha_deg']:g} deg, beta {r['beta_deg']:g} deg"
        typer.echo(f"not good: {where}: {r['verdict']}: {r['reason']}", err=True)
    return 1 if _short_of(case, settings) or bad else 0


def _short_of(case: FlowCase, settings: FlowSettings) -> bool:
    """Whether residuals of good conditions fell less than decades were asked for beyond the usual; tells how many."""
    asked = settings.residual_drop
    short = [r["residual_drop"] for r in case.records if r["converged"] and r["residual_drop"] < asked]
    if asked <= type(settings)().residual_drop or not short:
        return False
    hint = "; single precision ends at 4 to 5: --precision fp64" if settings.precision == "single" else ""
    typer.echo(
        f"decades: {asked:g} NOT reached by {len(short)} of {len(case.records)}, least {min(short):.1f}{hint}", err=True
    )
    return True


def _print(records: list[dict], json_file: Path | None) -> None:
    """Write the records as JSON, and print them where that is not what goes to standard output."""
    write_json(records, json_file)
    if str(json_file) != "-":
        from spaceplane.report.summary import print_flow

        print_flow(records)


def _files(json_file: Path | None, vtu: Path | None, vtp: Path | None) -> Files:
    """Where results go, refused where nothing can be written."""
    writable_file(json_file, "--json")
    writable_file(vtu, "--vtu", (".vtu",))
    writable_file(vtp, "--vtp", (".vtp",))
    return Files(json_file, vtu, vtp)


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
    _print(records, json_file)
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
