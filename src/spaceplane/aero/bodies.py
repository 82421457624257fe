"""The vehicle with given deflections in given free streams, and with one control surface after another moved."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from spaceplane.aero.derivatives import Move, by_symmetry, control_derivatives
from spaceplane.aero.increments.add import integrate_with
from spaceplane.aero.increments.settings import Air, IncrementSettings
from spaceplane.aero.integrate import wetted_area
from spaceplane.flow.compilation import begin
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import ConvergenceRecord, FlowConditions, Solution
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.resolution import require_resolved
from spaceplane.mesh.settings import MeshSettings
from spaceplane.mesh.sizing import Sizing
from spaceplane.progress import Progress, silent
from spaceplane.vehicle.build import build
from spaceplane.vehicle.controls import CONTROL_LIMITS_DEG, CONTROLS, ControlDeflections
from spaceplane.vehicle.presets import Vehicle
from spaceplane.vehicle.surface import Surface

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class SolvedBody:
    """One body and the flow around it.

    Attributes:
        surface: the body.
        solution: the flow, with its mesh.
        seconds: wall time, s, of "geometry", "mesh" and "flow".
    """

    surface: Surface
    solution: Solution
    seconds: dict[str, float]


@dataclass(frozen=True)
class ControlRun:
    """The base conditions on the vehicle with one surface moved.

    Attributes:
        surface: the control surface.
        step: how far it was moved, rad.
        deflections: of all surfaces.
        coefficients: see `integrate_with`; one condition per flight point.
        records: [flight point] how it converged.
        cells: of its mesh.
        force_scale: wetted over reference area, which takes the records' forces to the reference area.
        seconds: wall time, s, of "geometry", "mesh" and "flow".
    """

    surface: str
    step: float
    deflections: ControlDeflections
    coefficients: xr.Dataset
    records: tuple[ConvergenceRecord, ...]
    cells: int
    force_scale: float
    seconds: dict[str, float]

    @property
    def label(self) -> str:
        """Surface and step, such as elevon_left +5 deg."""
        return _label(self.surface, self.step)


def _label(surface: str, step: float) -> str:
    return f"{surface} {math.degrees(step):+.3g} deg"


def is_symmetric(deflections: ControlDeflections) -> bool:
    """Whether left and right surfaces are deflected alike (the shape itself always is its own mirror image)."""
    return deflections.elevon_left == deflections.elevon_right and deflections.rudder_left == deflections.rudder_right


def solve_vehicle(
    vehicle: Vehicle,
    deflections: ControlDeflections,
    conditions: FlowConditions,
    mesh_settings: MeshSettings,
    flow_settings: FlowSettings,
    progress: Progress | None = None,
    name: str = "body",
    sizing: Sizing | None = None,
    resolved: bool = False,
) -> SolvedBody:
    """Build, mesh and solve one body.

    Args:
        vehicle: shape.
        deflections: of all control surfaces.
        conditions: free streams.
        mesh_settings, flow_settings: how to mesh and solve.
        progress: called with (phase, done, total, text).
        name: stands before each phase told to `progress`, with a colon after it.
        sizing: cells wanted smaller than the settings make them.
        resolved: whether to refuse a mesh on which forces mean nothing, see `require_resolved`.

    Raises:
        InputError: a shape that cannot be built, or a mesh or condition that is not allowed.
    """

    def say(phase: str, done: int, total: int, text: str) -> None:
        (progress or silent)(f"{name}: {phase}", done, total, text)

    began = time.perf_counter()
    begin(flow_settings, conditions)
    say("geometry", 0, 1, "")
    surface = build(vehicle.shape, deflections)
    built = time.perf_counter()
    say("mesh", 0, 1, "")
    mesh = generate(surface, mesh_settings, say, sizing)
    if resolved:
        require_resolved(surface, mesh_settings, mesh, sizing is not None)
    meshed = time.perf_counter()
    solution = solve(mesh, conditions, flow_settings, say)
    seconds = {"geometry": built - began, "mesh": meshed - built, "flow": time.perf_counter() - meshed}
    return SolvedBody(surface, solution, seconds)


def control_runs(
    vehicle: Vehicle,
    deflections: ControlDeflections,
    step: float,
    conditions: FlowConditions,
    mesh_settings: MeshSettings,
    flow_settings: FlowSettings,
    two_step_sizes: bool = False,
    progress: Progress | None = None,
    increments: IncrementSettings | None = None,
    air: Air | None = None,
    sizing: Sizing | None = None,
) -> tuple[ControlRun, ...]:
    """Solve the conditions on bodies with one surface moved by `step`, rad, or by minus that where limits ask for it.

    Right-hand surfaces are left out where symmetry gives them. With `two_step_sizes` each surface is moved by half the
    step as well.

    Args:
        vehicle: shape and reference lengths.
        deflections: of the base body.
        step: rad.
        conditions: base condition of each flight point.
        mesh_settings, flow_settings, progress: as for `solve_vehicle`.
        two_step_sizes: two runs for each surface.
        increments: viscous increments; none when None.
        air: of each condition, for skin friction.
        sizing: cells wanted smaller than the settings make them, about every body.

    Raises:
        InputError: as `solve_vehicle`.
    """
    symmetric = is_symmetric(deflections) and not conditions.beta.any()
    runs = []
    for surface in CONTROLS:
        if symmetric and surface.endswith("_right"):
            continue
        upper = math.radians(CONTROL_LIMITS_DEG[surface][1])
        start = getattr(deflections, surface)
        full = step if start + step <= upper + 1e-12 else -step
        for size in (full, 0.5 * full) if two_step_sizes else (full,):
            moved = replace(deflections, **{surface: start + size})
            label = _label(surface, size)
            body = solve_vehicle(vehicle, moved, conditions, mesh_settings, flow_settings, progress, label, sizing)
            solution = body.solution
            runs.append(
                ControlRun(
                    surface,
                    size,
                    moved,
                    integrate_with(solution, vehicle.reference, increments or IncrementSettings(), air),
                    solution.records,
                    solution.mesh.cells,
                    wetted_area(solution.mesh) / vehicle.reference.area,
                    body.seconds,
                )
            )
    return tuple(runs)


def slopes_of(base: xr.Dataset, runs: Sequence[ControlRun], symmetric: bool) -> xr.Dataset:
    """Control derivatives of all five surfaces from `control_runs`, dims (point, part)."""
    moves: dict[str, list[Move]] = {}
    for run in runs:
        moves.setdefault(run.surface, []).append(Move(run.step, base, run.coefficients))
    complete = by_symmetry(moves) if symmetric else moves
    return control_derivatives({name: complete[name] for name in CONTROLS})
