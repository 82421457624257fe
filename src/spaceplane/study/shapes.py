"""Studies and the pipeline: a parameter's range, a case's resolved inputs, and its computation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

from spaceplane.aero.uncertainty.settings import ITERATION
from spaceplane.errors import InputError
from spaceplane.vehicle.shape import PARAMETERS

_HISTORIES = ("residual_history", "force_history")


@dataclass(frozen=True)
class ParameterRange:
    """What a study may do with one shape parameter.

    Attributes:
        default: value of the vehicle, in `unit`.
        lower, upper: limits, in `unit`.
        unit: m, deg or 1.
    """

    default: float
    lower: float
    upper: float
    unit: str


def parameter_ranges(vehicle: str, changes: Mapping[str, float]) -> dict[str, ParameterRange]:
    """Return name -> range of every shape parameter.

    Args:
        vehicle: name of a preset, or a vehicle's YAML file.
        changes: values, m or deg, that are part of the default.

    Raises:
        InputError: an unknown vehicle or parameter.
    """
    from spaceplane.vehicle import presets

    shape = presets.load(vehicle, dict(changes), allow_outside=True).shape.as_dict()
    return {info.name: ParameterRange(shape[info.name], info.lower, info.upper, info.unit) for info in PARAMETERS}


def case_inputs(
    vehicle: str,
    changes: Mapping[str, float],
    mach: Sequence[float],
    settings: Mapping,
    allow_outside_limits: bool = False,
) -> dict:
    """Return everything that determines the analysis of one shape, resolved, as JSON values.

    Args:
        vehicle: name of a preset, or a vehicle's YAML file.
        changes: shape parameters that differ from it, m or deg.
        mach: flight points.
        settings: settings of the pipeline, as `AnalyseSettings.from_mapping` takes them; control derivatives and the
            companion mesh are off unless asked for.
        allow_outside_limits: accept parameters beyond their limits.

    Raises:
        InputError: an unknown name or a value that is not allowed.
    """
    from spaceplane.pipeline import AnalyseSettings
    from spaceplane.vehicle import presets

    if "mach" in settings:
        raise InputError("settings: mach is a field of the study itself; take it out of settings")
    subject = presets.load(vehicle, dict(changes), allow_outside=allow_outside_limits)
    default = {"controls": False, "uncertainty": ITERATION}
    resolved = AnalyseSettings.from_mapping({**default, **settings, "mach": tuple(mach)})
    return {"vehicle": asdict(subject), "settings": resolved.as_dict()}


def with_one_wall_cell(
    vehicle: str, changes: Mapping[str, float], settings: Mapping, allow_outside_limits: bool = False
) -> dict:
    """Return settings with the wall cell, m, that a target number of cells gives the default shape.

    Shapes are then compared on meshes of one fineness: a number of cells would give each shape a cell of its own, and
    part of the difference between two would be the mesh's. Settings without a target, or with a mesh that follows the
    flow about each shape, come back as they are.

    Args:
        vehicle, changes, settings, allow_outside_limits: as `case_inputs`.
    """
    from spaceplane.mesh.generate import generate
    from spaceplane.pipeline import AnalyseSettings
    from spaceplane.vehicle import presets
    from spaceplane.vehicle.build import build

    resolved = AnalyseSettings.from_mapping(settings)
    if resolved.mesh.target_cells is None or resolved.adapt:
        return dict(settings)
    shape = presets.load(vehicle, dict(changes), allow_outside=allow_outside_limits).shape
    mesh = generate(build(shape, resolved.deflections), resolved.mesh)
    fixed = {"wall_cell": float(mesh.record["wall_cell_m"]), "target_cells": None}
    return {**settings, "mesh": {**settings.get("mesh", {}), **fixed}}


def shifted(inputs: dict, shift: tuple[float, float]) -> dict:
    """Return a case's inputs with the body moved in the mesh by a fraction of a wall cell along x and z."""
    mesh = inputs["settings"]["mesh"]
    offset = [(start + step) % 1.0 for start, step in zip(mesh["offset"], shift, strict=True)]
    return {**inputs, "settings": {**inputs["settings"], "mesh": {**mesh, "offset": offset}}}


def evaluate(inputs: dict) -> dict:
    """Run the pipeline on the inputs of `case_inputs`; return what result.json would hold, histories left out."""
    from spaceplane.pipeline import AnalyseSettings, analyse
    from spaceplane.report import record
    from spaceplane.vehicle.presets import Vehicle
    from spaceplane.vehicle.properties import MassProperties, ReferenceLengths
    from spaceplane.vehicle.shape import ShapeParameters

    fields = dict(inputs["vehicle"])
    fields["shape"] = ShapeParameters(**fields["shape"])
    fields["mass"] = MassProperties(**fields["mass"])
    fields["reference"] = ReferenceLengths(**fields["reference"])
    result = record.result(analyse(Vehicle(**fields), AnalyseSettings.from_mapping(inputs["settings"])))
    return without_histories(result)


def without_histories(result: dict) -> dict:
    """Return a result without its histories of convergence and motion, which would be most of its size."""
    points = []
    for point in result["flight_points"]:
        convergence = [
            {name: value for name, value in row.items() if name not in _HISTORIES} for row in point["convergence"]
        ]
        control = point.get("control")
        control = control and {name: value for name, value in control.items() if name != "responses"}
        points.append(point | {"convergence": convergence, "control": control})
    return result | {"flight_points": points}
