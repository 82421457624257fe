"""Options that several commands share, and the settings they become."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from spaceplane.commands.arguments import assignments, count, number, positive
from spaceplane.errors import InputError, unknown_name

if TYPE_CHECKING:
    from spaceplane.aero.increments.settings import IncrementSettings
    from spaceplane.mesh.settings import MeshSettings
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
Precision = Annotated[
    str, typer.Option("--precision", metavar="fp32|fp64", help="Floating-point precision of the flow solver.")
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


def mesh_settings(cell: str | None, cells: str | None, default: MeshSettings) -> MeshSettings:
    """Mesh settings with the wall cell or the number of cells asked for.

    Raises:
        InputError: both are given, or one has a value that is not allowed.
    """
    if cell is not None and cells is not None:
        raise InputError("--cell and --cells: give one of them, not both")
    if cell is not None:
        return replace(default, wall_cell=positive("--cell", cell, "m"), target_cells=None)
    if cells is not None:
        return replace(default, target_cells=count("--cells", cells, "cells"))
    return default


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
