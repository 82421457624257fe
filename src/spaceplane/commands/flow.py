"""`spaceplane flow`: any watertight body, or any mesh around one, in any list of free streams."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spaceplane.commands import options
from spaceplane.commands.arguments import (
    angles,
    existing_file,
    list_of_names,
    mach_numbers,
    numbers,
    positive,
    writable_file,
    write_json,
)
from spaceplane.commands.progress import progress_bar
from spaceplane.errors import InputError
from spaceplane.files import renamed_when_done

if TYPE_CHECKING:
    from spaceplane.aero.flow_case import FlowCase
    from spaceplane.mesh.imported import Imported
    from spaceplane.vehicle.surface import Surface

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
    rates: Annotated[
        str,
        typer.Option("--rates", metavar="p,q,r", help="Body rates, rad/s; this version solves 0,0,0 only."),
    ] = "0,0,0",
    cell: options.Cell = None,
    cells: options.Cells = None,
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
    precision: options.Precision = "fp32",
    json_file: options.JsonFile = None,
    vtu: Annotated[Path | None, typer.Option("--vtu", metavar="FILE", help="Write the flow for ParaView.")] = None,
    vtp: Annotated[
        Path | None, typer.Option("--vtp", metavar="FILE", help="Write the wall with its pressure for ParaView.")
    ] = None,
) -> int:
    """Inviscid flow about a body: every Mach number with every angle, all on one mesh in one run.

    Exit code 0 when every condition converged, 1 when one did not, 2 for bad input.
    """
    machs, alphas, betas = mach_numbers(mach), angles("--alpha", alpha), angles("--beta", beta)
    if any(numbers("--rates", rates, "rad/s", 3)):
        raise InputError(f"--rates: {rates}, this version allows 0,0,0 only (the body does not turn)")
    lengths = {
        "area": positive("--area", area, "m2"),
        "chord": positive("--length", length, "m"),
        "span": positive("--span", span, "m"),
    }
    center = tuple(numbers("--moment-center", moment_center, "m", 3))
    solver_precision = options.precision(precision)
    names = {"wall": wall, "far": far, "symmetry": symmetry}
    if mesh_file is None:
        _refuse_options({f"--{role}": text for role, text in names.items()}, "only allowed with --mesh")
        if body is None:
            raise InputError("BODY.stl: missing; give it, or a mesh with --mesh FILE")
        existing_file(body, "an STL file")
    else:
        given = {"BODY.stl": body, "--cell": cell, "--cells": cells, "--domain": domain}
        _refuse_options(given, "not allowed with --mesh, whose mesh is taken as it is")
        existing_file(mesh_file, "a .su2 or .msh file")
    chosen = {role: list_of_names(f"--{role}", text) for role, text in names.items()}
    writable_file(json_file, "--json")
    writable_file(vtu, "--vtu", (".vtu",))
    writable_file(vtp, "--vtp", (".vtp",))
    from spaceplane.flow.settings import FlowSettings
    from spaceplane.mesh.settings import MeshSettings
    from spaceplane.vehicle.properties import ReferenceLengths

    corners = None if domain is None else numbers("--domain", domain, "m", 6)
    default = MeshSettings(target_cells=200_000, domain=corners and (tuple(corners[:3]), tuple(corners[3:])))
    mesh = options.mesh_settings(cell, cells, default)
    settings = replace(FlowSettings(), precision=solver_precision)
    reference = ReferenceLengths(**lengths, moment_center=center)
    imported: Imported | None = None
    if mesh_file is None:
        from spaceplane.vehicle.stl import read_stl

        surface = read_stl(body)
        from spaceplane.aero.flow_case import run_flow  # the numerical stack: after all that can be refused without it

        with progress_bar() as tell:
            tell("mesh", 0, 1, "")
            case = run_flow(surface, machs, alphas, betas, reference, mesh, settings, tell)
    else:
        from spaceplane.mesh.imported import read_mesh

        imported = read_mesh(mesh_file, chosen)
        surface = imported.surface
        typer.echo(_roles(imported), err=True)
        from spaceplane.aero.flow_case import run_on_mesh

        with progress_bar() as tell:
            case = run_on_mesh(imported.mesh, machs, alphas, betas, reference, settings, tell)
    _write(case, surface, imported, vtu, vtp)
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
