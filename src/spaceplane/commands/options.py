"""Options that several commands share, and the settings they become."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spaceplane.commands.arguments import assignments, count, fraction, list_of_names, number, numbers, positive
from spaceplane.errors import InputError, unknown_name

if TYPE_CHECKING:
    from spaceplane.aero.increments.settings import IncrementSettings
    from spaceplane.mesh.settings import MeshSettings, RefinementBox
    from spaceplane.vehicle.controls import ControlDeflections
    from spaceplane.vehicle.presets import Vehicle

VehicleName = Annotated[
    str, typer.Argument(metavar="VEHICLE", help="Name of a preset (horus-2b) or a vehicle's YAML file.")
]
Changes = Annotated[
    list[str] | None, typer.Option("--set", metavar="NAME=VALUE...", help="Change shape parameters (m, deg).")
]
Deflections = Annotated[
    list[str] | None,
    typer.Option(
        "--deflect",
        metavar="NAME=DEG...",
        help="Deflect control surfaces, degrees: elevon_left, elevon_right and body_flap positive trailing edge down, "
        "rudder_left and rudder_right positive outboard.",
    ),
]
AllowOutside = Annotated[bool, typer.Option("--allow-outside-limits", help="Accept values outside their limits.")]
Cell = Annotated[str | None, typer.Option("--cell", metavar="METRES", help="Edge of the cells at the wall.")]
Cells = Annotated[
    str | None,
    typer.Option("--cells", metavar="N", help="About how many cells the mesh has, such as 300k, instead of --cell."),
]
Edges = Annotated[
    str | None,
    typer.Option(
        "--edges",
        metavar="N[,CELLS]",
        help="Halve cells N times (0 to 5) towards sharp edges, by default 1 (flow) or 3 (analyse); with N of 2 or "
        "more so that CELLS of them fit into the thickness of a plate with square edges.",
    ),
]
RefineBox = Annotated[
    list[str] | None,
    typer.Option(
        "--refine-box",
        metavar="X0,Y0,Z0,X1,Y1,Z1,CELL",
        help="Cells no larger than CELL between a lower and an upper corner, metres; may be given several times.",
    ),
]
RefineParts = Annotated[
    list[str] | None,
    typer.Option(
        "--refine-parts",
        metavar="NAME[,NAME...]",
        help="Wall cells half as large on these parts: of HORUS-2B nose, fuselage, wing, winglet, elevon, rudder, "
        "body_flap; of an ASCII STL its solids.",
    ),
]
Adapt = Annotated[
    str,
    typer.Option(
        "--adapt",
        metavar="N",
        help="Adapt the mesh to the flow in N passes (0 to 3), up to the number of cells that --cells gives.",
    ),
]
Precision = Annotated[
    str, typer.Option("--precision", metavar="fp32|fp64", help="Floating-point precision of the flow solver.")
]
Decades = Annotated[
    str,
    typer.Option(
        "--decades",
        metavar="D",
        help="Decades (2 to 10) that each residual must fall; rounding ends fp32 at 4 to 5.",
    ),
]
Gas = Annotated[
    str,
    typer.Option(
        "--gas",
        metavar="perfect|equilibrium",
        help="Constant specific heats, or air in chemical equilibrium (hypersonic).",
    ),
]
JsonFile = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", help="Write the result as JSON; - for standard output.")
]

Uncertainty = Annotated[
    str | None,
    typer.Option(
        "--uncertainty",
        metavar="mesh|iteration",
        help="What the ± of coefficients and derivatives holds: with mesh, a coarser companion mesh is solved too.",
    ),
]
AccuracyText = Annotated[
    str | None,
    typer.Option(
        "--accuracy",
        metavar="1%",
        help="Refine the mesh until the uncertainty of C_L, C_D and C_m is below this share of the force coefficient; "
        "--cells is then the most cells to use.",
    ),
]

Friction = Annotated[
    str, typer.Option("--friction", metavar="off|laminar|turbulent", help="Add skin friction to the coefficients.")
]
Base = Annotated[
    str,
    typer.Option("--base", metavar="inviscid|correlation", help="Pressure of blunt bases: computed, or correlated."),
]
WallTemperature = Annotated[
    str | None,
    typer.Option("--wall-temperature", metavar="K", help="Wall temperature for the friction; adiabatic by default."),
]
Emissivity = Annotated[
    str | None,
    typer.Option(
        "--emissivity", metavar="E", help="Wall that radiates the heat of friction away, instead of adiabatic."
    ),
]
TransitionReynolds = Annotated[
    str | None,
    typer.Option("--transition-reynolds", metavar="RE", help="With turbulent friction: laminar below this number."),
]

SHALLOWEST, DEEPEST = 2.0, 10.0
"""Decades that residuals may be asked to fall."""

PRECISIONS = {"fp32": "single", "single": "single", "fp64": "double", "double": "double"}


def gas_name(gas: str) -> str:
    """The gas of this name.

    Raises:
        InputError: an unknown name.
    """
    from spaceplane.flow.solution import GASES

    if gas not in GASES:
        raise InputError("--gas: " + unknown_name("gas", gas, GASES))
    return gas


def load_vehicle(vehicle: str, changes: list[str] | None, allow_outside_limits: bool) -> Vehicle:
    """The vehicle with its changed shape parameters.

    Raises:
        InputError: unknown vehicle or parameter, or a value out of limits.
    """
    overrides = assignments("--set", changes)
    from spaceplane.vehicle import presets

    return presets.load(vehicle, overrides, allow_outside_limits)


def load_deflections(
    texts: list[str] | None, allow_outside_limits: bool, base: dict[str, float] | None = None
) -> ControlDeflections:
    """Deflections from `name=degrees` texts on top of `base` (degrees).

    Raises:
        InputError: unknown surface, not a number, or out of limits.
    """
    given = assignments("--deflect", texts)
    from spaceplane.vehicle.controls import ControlDeflections

    return ControlDeflections.from_degrees((base or {}) | given, allow_outside_limits)


def mesh_settings(
    cell: str | None,
    cells: str | None,
    edges: str | None,
    default: MeshSettings,
    refine_box: Sequence[str] | None = None,
    refine_parts: Sequence[str] | None = None,
) -> MeshSettings:
    """Mesh settings with the wall cell or the number of cells asked for, and finer cells at edges, in boxes, on parts.

    Raises:
        InputError: both a cell and a number of cells, or a value that is not allowed.
    """
    if cell is not None and cells is not None:
        raise InputError("--cell and --cells: give one of them, not both")
    if edges is not None:
        default = _with_edges(edges, default)
    if refine_box:
        default = replace(default, boxes=default.boxes + tuple(_box(text) for text in refine_box))
    if refine_parts:
        parts = tuple(name for text in refine_parts for name in list_of_names("--refine-parts", text) or ())
        default = replace(default, fine_parts=default.fine_parts + parts)
    if cell is not None:
        return replace(default, wall_cell=positive("--cell", cell, "m"), target_cells=None)
    if cells is not None:
        return replace(default, target_cells=count("--cells", cells, "cells"))
    return default


def _box(text: str) -> RefinementBox:
    """The box that `--refine-box` asks for."""
    from spaceplane.mesh.settings import RefinementBox

    *corners, cell = numbers("--refine-box", text, "m", 7)
    if cell <= 0:
        raise InputError(f"--refine-box: {text.strip()!r}, CELL must be above 0 m")
    if any(high <= low for low, high in zip(corners[:3], corners[3:], strict=True)):
        raise InputError(f"--refine-box: {text.strip()!r}, X1,Y1,Z1 must lie above X0,Y0,Z0")
    return RefinementBox(tuple(corners[:3]), tuple(corners[3:]), cell)


def refinement(refine_box: Sequence[str] | None, refine_parts: Sequence[str] | None) -> dict[str, str | None]:
    """What was given of `--refine-box` and `--refine-parts` as text, by option; None for nothing."""
    return {
        option: " ".join(texts) if texts else None
        for option, texts in (("--refine-box", refine_box), ("--refine-parts", refine_parts))
    }


def _with_edges(text: str, settings: MeshSettings) -> MeshSettings:
    """Mesh settings with the halvings at edges, and the cells across square ones, that `--edges` asks for."""
    from spaceplane.mesh.settings import MOST_EDGE_CELLS, MOST_EDGE_LEVELS

    halvings, *across = text.split(",")
    times, most = number("--edges", halvings), MOST_EDGE_LEVELS + 1
    if times != int(times) or not 0 <= times <= most or len(across) > 1:
        raise InputError(f"--edges: {text!r}, allowed N or N,CELLS with N a whole number from 0 to {most}")
    thickness = number("--edges", across[0]) if across else 0.0
    if across and (times < 2 or not 0.0 < thickness <= MOST_EDGE_CELLS):
        raise InputError(f"--edges: {text!r}, CELLS above 0 up to {MOST_EDGE_CELLS:g} go with N of at least 2")
    levels = max(int(times) - 1, 0)
    return replace(settings, fine_edges=times > 0, edge_levels=levels, edge_cells=thickness)


def uncertainty(text: str) -> str:
    """What the stated uncertainty shall hold.

    Raises:
        InputError: unknown.
    """
    from spaceplane.aero.uncertainty.settings import SOURCES

    if text not in SOURCES:
        raise InputError("--uncertainty: " + unknown_name("uncertainty", text, SOURCES))
    return text


def accuracy(text: str | None, cell: str | None, cells: str | None, uncertainty: str | None) -> float | None:
    """The accuracy asked for, as a fraction.

    Args:
        text: of --accuracy.
        cell: of --cell, which does not go with it.
        cells: of --cells, the most to use.
        uncertainty: of --uncertainty; "iteration" does not go with it.

    Raises:
        InputError: not a number, out of range, or beside what it excludes.
    """
    if text is None:
        return None
    value = fraction("--accuracy", text)
    if cell is not None:
        raise InputError(f"--accuracy: {text}, not allowed with --cell, which it chooses; --cells is the most to use")
    if uncertainty == "iteration":
        raise InputError(
            f"--accuracy: {text}, not allowed with --uncertainty iteration: it is the mesh that is refined"
        )
    from spaceplane.aero.uncertainty.settings import FIRST_CELLS, LOOSEST, TIGHTEST

    if cells is not None and count("--cells", cells, "cells") < FIRST_CELLS:
        raise InputError(f"--cells: {cells}, at least {FIRST_CELLS} with --accuracy")
    if not TIGHTEST <= value <= LOOSEST:
        raise InputError(f"--accuracy: {text}, allowed {100 * TIGHTEST:g}% to {100 * LOOSEST:g}%")
    return value


def adapt_passes(text: str, mesh: MeshSettings) -> int:
    """How many passes adapt the mesh.

    Raises:
        InputError: not a whole number from 0 to 3, or passes where a wall cell is given instead of a number of cells.
    """
    value = number("--adapt", text)
    if value != int(value):
        raise InputError(f"--adapt: {text.strip()!r} is not a whole number")
    if value and mesh.target_cells is None:
        raise InputError(f"--adapt: {text.strip()}, goes with --cells, the number of cells of the last mesh")
    from spaceplane.mesh.settings import check_passes

    return check_passes("--adapt", int(value))


def increment_settings(
    friction: str, base: str, wall_temperature: str | None, emissivity: str | None, transition_reynolds: str | None
) -> IncrementSettings:
    """Settings of the viscous increments.

    Raises:
        InputError: an unknown word, a number that is not positive, or one that goes with nothing else given.
    """
    kelvin = None if wall_temperature is None else positive("--wall-temperature", wall_temperature, "K")
    reynolds = None if transition_reynolds is None else number("--transition-reynolds", transition_reynolds)
    radiating = None if emissivity is None else number("--emissivity", emissivity)
    from spaceplane.aero.increments.settings import IncrementSettings

    return IncrementSettings(friction, base, kelvin, radiating, reynolds)


def precision(text: str) -> str:
    """The solver's name of a precision.

    Raises:
        InputError: unknown.
    """
    if text not in PRECISIONS:
        raise InputError(f"--precision: {text!r}, allowed are fp32 and fp64")
    return PRECISIONS[text]


def decades(text: str) -> float:
    """Decades that residuals must fall.

    Raises:
        InputError: not a number from 2 to 10.
    """
    value = number("--decades", text)
    if not SHALLOWEST <= value <= DEEPEST:
        raise InputError(f"--decades: {text.strip()}, allowed are {SHALLOWEST:g} to {DEEPEST:g}")
    return value
