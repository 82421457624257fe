"""Any body in any list of free streams: coefficients as plain records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import xarray as xr

from spaceplane.aero.conditions import product
from spaceplane.aero.integrate import COEFFICIENTS, PRESSURES, TOTAL, Reference, integrate
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import Solution
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings
from spaceplane.plain import degrees, finite
from spaceplane.progress import Progress
from spaceplane.vehicle.surface import Surface


@dataclass(frozen=True)
class FlowCase:
    """What `run_flow` found.

    Attributes:
        records: one JSON-ready dict per condition, see `records`.
        coefficients: the same by part, see `integrate`.
        mesh: the mesh.
        solution: the flow.
    """

    records: list[dict]
    coefficients: xr.Dataset
    mesh: Mesh
    solution: Solution


def run_flow(
    body: Surface,
    machs: Sequence[float],
    alphas: Sequence[float],
    betas: Sequence[float],
    reference: Reference,
    mesh_settings: MeshSettings,
    flow_settings: FlowSettings,
    progress: Progress | None = None,
) -> FlowCase:
    """Mesh a body and solve every combination of Mach number, angle of attack and sideslip in one ensemble.

    Args:
        body: watertight surface.
        machs: Mach numbers.
        alphas: angles of attack, rad.
        betas: sideslip angles, rad.
        reference: area, chord, span and moment centre, SI.
        mesh_settings: how to mesh.
        flow_settings: how to solve.
        progress: passed on to the solver.

    Raises:
        InputError: a bad condition or body.
    """
    conditions = product(list(machs), list(alphas), list(betas))
    if progress:
        progress("mesh", 0, 1, "")
    mesh = generate(body, mesh_settings, progress)
    solution = solve(mesh, conditions, flow_settings, progress)
    coefficients = integrate(solution, reference)
    return FlowCase(records(solution, coefficients), coefficients, mesh, solution)


def records(solution: Solution, coefficients: xr.Dataset) -> list[dict]:
    """One dict per condition: conditions, coefficients, and how they converged.

    Keys: mach, alpha_deg, beta_deg, COEFFICIENTS, PRESSURES, converged, verdict, residual_drop, iterations, seconds,
    cells, reason. `seconds` is the wall time of the whole ensemble divided by its conditions. Values of a
    failed condition are None.
    """
    seconds = total_seconds(solution) / max(len(solution.conditions), 1)
    return [
        condition_record(
            coefficients,
            i,
            converged=record.good,
            verdict=record.verdict,
            residual_drop=finite(record.residual_drop),
            iterations=int(record.iterations),
            seconds=round(seconds, 3),
            cells=solution.mesh.cells,
            reason=record.reason,
        )
        for i, record in enumerate(solution.records)
    ]


def condition_record(coefficients: xr.Dataset, index: int, **found: object) -> dict:
    """Free stream and total coefficients of one condition, then what else was found, ready for JSON."""
    one = coefficients.isel(condition=index)
    totals = one.sel(part=TOTAL)
    return {
        "mach": float(one.mach),
        "alpha_deg": degrees(float(one.alpha)),
        "beta_deg": degrees(float(one.beta)),
        **{name: finite(totals[name].item()) for name in (*COEFFICIENTS, *PRESSURES)},
        **found,
    }


def total_seconds(solution: Solution) -> float:
    """Wall time of the solver, s, all phases."""
    seconds = solution.statistics.get("seconds", {})
    return float(sum(seconds.values())) if isinstance(seconds, dict) else float(seconds)
