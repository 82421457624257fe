"""`spaceplane analyse`: from a vehicle to its flying qualities."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spaceplane.commands import options
from spaceplane.commands.arguments import mach_numbers, numbers, warn_beyond_verified, writable_file, write_json
from spaceplane.commands.progress import progress_bar
from spaceplane.errors import InputError
from spaceplane.files import writable_folder

if TYPE_CHECKING:
    from spaceplane.pipeline import AnalyseSettings

EXAMPLE = (
    "Example: spaceplane analyse horus-2b --set wing_width_m=3.9 --deflect body_flap=-10 --mach 0.8,1.5,2.5 "
    "--out out/wide"
)


def analyse(
    vehicle: options.VehicleName,
    changes: options.Changes = None,
    deflect: options.Deflections = None,
    mach: Annotated[
        str, typer.Option("--mach", metavar="M[,M...]", help="Flight points by Mach number.")
    ] = "0.8,1.5,2.5",
    alpha: Annotated[
        str | None,
        typer.Option(
            "--alpha", metavar="DEG[,DEG...]", help="Angle of attack of each flight point; one value serves all."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder to write into; out/VEHICLE by default.")
    ] = None,
    cell: options.Cell = None,
    cells: options.Cells = None,
    edges: options.Edges = None,
    refine_box: options.RefineBox = None,
    refine_parts: options.RefineParts = None,
    adapt: options.Adapt = "0",
    uncertainty: options.Uncertainty = "mesh",
    accuracy: options.AccuracyText = None,
    precision: options.Precision = "fp32",
    form: Annotated[
        str, typer.Option("--form", metavar="rigid-body|thesis", help="Form of the linear model.")
    ] = "rigid-body",
    vehicle_class: Annotated[
        str, typer.Option("--class", metavar="I..IV", help="Vehicle class of MIL-F-8785C.")
    ] = "III",
    category: Annotated[
        str, typer.Option("--category", metavar="A|B|C", help="Flight phase category of MIL-F-8785C.")
    ] = "B",
    controls: Annotated[
        bool, typer.Option(help="Derivatives of the control surfaces (a body and mesh more for each).")
    ] = True,
    two_steps: Annotated[bool, typer.Option("--two-steps", help="Two step sizes for each derivative.")] = False,
    friction: options.Friction = "turbulent",
    base: options.Base = "correlation",
    wall_temperature: options.WallTemperature = None,
    emissivity: options.Emissivity = None,
    transition_reynolds: options.TransitionReynolds = None,
    gas: options.Gas = "perfect",
    allow_outside_limits: options.AllowOutside = False,
    json_file: options.JsonFile = None,
) -> int:
    """Geometry, flow, derivatives, modes, flying-quality levels and a report of one vehicle.

    Writes result.json, aero.nc, geometry.stl, surface.vtp and report.html into --out. Exit code 0 when every flow
    condition converged (and the accuracy asked for was reached), 1 when not, 2 for bad input.
    """
    machs = mach_numbers(mach)
    folder = out or Path("out") / re.sub(r"[^\w.-]+", "-", Path(vehicle).stem if "/" in vehicle else vehicle)
    subject = options.load_vehicle(vehicle, changes, allow_outside_limits)
    increments = options.increment_settings(friction, base, wall_temperature, emissivity, transition_reynolds)
    asked = options.accuracy(accuracy, cell, cells, uncertainty)
    stated = options.uncertainty(uncertainty)
    for option, text in {"--edges": edges, **options.refinement(refine_box, refine_parts)}.items():
        if text is not None and adapt != "0":
            raise InputError(f"{option}: {text}, not allowed with --adapt {adapt}: it finds out where to refine")
    settings = _settings(machs, alpha, deflect, allow_outside_limits, precision)
    mesh = options.mesh_settings(cell, cells, edges, settings.mesh, refine_box, refine_parts)
    steps = replace(settings.steps, two_step_sizes=True) if two_steps else settings.steps
    settings = replace(
        settings,
        mesh=mesh,
        adapt=options.adapt_passes(adapt, mesh),
        form=form,
        vehicle_class=vehicle_class,
        category=category,
        controls=controls,
        steps=steps,
        increments=increments,
        uncertainty=stated,
        accuracy=asked,
        gas=options.gas_name(gas),
    )
    writable_folder(folder, "--out")
    writable_file(json_file, "--json")
    from spaceplane import pipeline
    from spaceplane.report.read import read_result
    from spaceplane.report.summary import complain, print_summary, shortcomings

    with progress_bar(_bodies(settings)) as tell:
        pipeline.run(subject, settings, folder, tell)
    warn_beyond_verified(machs)
    result = read_result(folder)
    write_json(result, json_file)
    if str(json_file) != "-":
        print_summary(result, folder / "report.html")
    return complain(shortcomings(result))


def _bodies(settings: AnalyseSettings) -> int:
    """How many bodies an analysis meshes: the base, one for each moved control surface, and their companions."""
    from spaceplane.aero.bodies import is_symmetric

    surfaces = 3 if is_symmetric(settings.deflections) else 5
    moved = surfaces * (2 if settings.steps.two_step_sizes else 1) if settings.controls else 0
    return (1 + moved) * (2 if settings.uncertainty == "mesh" else 1) + (settings.accuracy is not None) + settings.adapt


def _settings(
    machs: list[float],
    alpha: str | None,
    deflect: list[str] | None,
    allow_outside_limits: bool,
    precision: str,
) -> AnalyseSettings:
    """Settings of these options."""
    solver_precision = options.precision(precision)
    alphas = None if alpha is None else numbers("--alpha", alpha, "degrees")
    if alphas is not None and len(alphas) not in (1, len(machs)):
        raise InputError(f"--alpha: {len(alphas)} values for {len(machs)} Mach numbers; give one, or one for each")
    from spaceplane.pipeline import AnalyseSettings

    default = AnalyseSettings()
    return replace(
        default,
        mach=tuple(machs),
        alpha_deg=None if alphas is None else tuple(alphas * len(machs) if len(alphas) == 1 else alphas),
        deflections=options.load_deflections(deflect, allow_outside_limits, default.deflections.to_degrees()),
        flow=replace(default.flow, precision=solver_precision),
    )
