"""Any body in any list of free streams: coefficients as plain records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import xarray as xr

from spaceplane.aero.conditions import product
from spaceplane.aero.increments.add import WITH_SOURCES, integrate_with
from spaceplane.aero.increments.settings import Air, IncrementSettings
from spaceplane.aero.integrate import BY_SOURCE, COEFFICIENTS, PRESSURES, TOTAL, Reference
from spaceplane.environment.atmosphere import Ambient
from spaceplane.errors import InputError
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
        coefficients: the same by part, see `integrate_with`.
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
    increments: IncrementSettings | None = None,
    ambient: Ambient | None = None,
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
        increments: viscous increments; none when None.
        ambient: undisturbed air of every condition, for skin friction.

    Raises:
        InputError: a bad condition or body, or skin friction without air.
    """
    conditions = product(list(machs), list(alphas), list(betas))
    air = None if ambient is None else Air.of([ambient] * len(conditions))
    increments = increments or IncrementSettings()
    if increments.friction != "off" and air is None:
        raise InputError(f"friction = {increments.friction!r}: needs the altitude")
    if progress:
        progress("mesh", 0, 1, "")
    mesh = generate(body, mesh_settings, progress)
    solution = solve(mesh, conditions, flow_settings, progress)
    coefficients = integrate_with(solution, reference, increments, air)
    return FlowCase(records(solution, coefficients), coefficients, mesh, solution)


def records(solution: Solution, coefficients: xr.Dataset) -> list[dict]:
    """One dict per condition: conditions, coefficients, and how they converged.

    Keys: mach, alpha_deg, beta_deg, COEFFICIENTS, PRESSURES, converged, verdict, residual_drop, iterations, seconds,
    cells, reason. `seconds` is the wall time of the whole ensemble divided by its conditions. Values of a
    failed condition are None. With viscous increments, `by_source` holds what "inviscid", "friction" and "base"
    add to the coefficients.
    """
    c = solution.conditions
    seconds = total_seconds(solution) / max(len(c), 1)
    totals = coefficients.sel(part=TOTAL)
    result = []
    for i, record in enumerate(solution.records):
        values = {name: finite(totals[name].values[i]) for name in (*COEFFICIENTS, *PRESSURES)}
        result.append(
            {
                "mach": float(c.mach[i]),
                "alpha_deg": degrees(c.alpha[i]),
                "beta_deg": degrees(c.beta[i]),
                **values,
                "converged": record.good,
                "verdict": record.verdict,
                "residual_drop": finite(record.residual_drop),
                "iterations": int(record.iterations),
                "seconds": round(seconds, 3),
                "cells": solution.mesh.cells,
                "reason": record.reason,
                **_by_source(totals, i),
            }
        )
    return result


def _by_source(totals: xr.Dataset, condition: int) -> dict:
    if "source" not in totals.coords:
        return {}
    shares = {
        str(source): {name: finite(totals[f"{name}{BY_SOURCE}"].values[condition, column]) for name in WITH_SOURCES}
        for column, source in enumerate(totals.source.values)
    }
    return {"by_source": shares}


def total_seconds(solution: Solution) -> float:
    """Wall time of the solver, s, all phases."""
    seconds = solution.statistics.get("seconds", {})
    return float(sum(seconds.values())) if isinstance(seconds, dict) else float(seconds)
