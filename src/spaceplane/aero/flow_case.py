"""Any body in any list of free streams: coefficients as plain records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from spaceplane.aero.conditions import product
from spaceplane.aero.integrate import COEFFICIENTS, PRESSURES, TOTAL, Reference, integrate
from spaceplane.errors import InputError
from spaceplane.flow.freestream import velocity
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions, Solution
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings
from spaceplane.plain import degrees, finite
from spaceplane.progress import Progress
from spaceplane.vehicle.surface import Surface

ALONG = 1e-3
"""Share of the free stream's speed that may go through a plane of symmetry, flat to what its file rounds."""


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
    return _solved(mesh, conditions, reference, flow_settings, progress)


def run_on_mesh(
    mesh: Mesh,
    machs: Sequence[float],
    alphas: Sequence[float],
    betas: Sequence[float],
    reference: Reference,
    flow_settings: FlowSettings,
    progress: Progress | None = None,
) -> FlowCase:
    """Solve every combination of Mach number, angle of attack and sideslip on a mesh that is there already.

    Args:
        mesh: ours or an imported one; coefficients of half a body, cut at a plane of symmetry, are those of that half.
        machs: Mach numbers.
        alphas: angles of attack, rad.
        betas: sideslip angles, rad.
        reference: area, chord, span and moment centre, SI.
        flow_settings: how to solve.
        progress: passed on to the solver.

    Raises:
        InputError: a bad condition, or one whose free stream goes through a plane of symmetry.
    """
    conditions = product(list(machs), list(alphas), list(betas))
    _require_along_symmetry(mesh, conditions)
    return _solved(mesh, conditions, reference, flow_settings, progress)


def _solved(
    mesh: Mesh,
    conditions: FlowConditions,
    reference: Reference,
    flow_settings: FlowSettings,
    progress: Progress | None,
) -> FlowCase:
    solution = solve(mesh, conditions, flow_settings, progress)
    coefficients = integrate(solution, reference)
    return FlowCase(records(solution, coefficients), coefficients, mesh, solution)


def _require_along_symmetry(mesh: Mesh, conditions: FlowConditions) -> None:
    """Refuse free streams that go through a plane of symmetry."""
    area = mesh.wall_area[~mesh.body_wall]
    if not len(area):
        return
    normal = area / np.linalg.norm(area, axis=1)[:, None]
    wind = velocity(conditions.mach, conditions.alpha, conditions.beta) / np.asarray(conditions.mach)[:, None]
    through = np.abs(wind @ normal.T)
    bad = np.flatnonzero(through.max(axis=1) > ALONG)
    if len(bad):
        first, share = bad[0], through[bad[0]]
        x, y, z = normal[share.argmax()]
        raise InputError(
            f"alpha {degrees(conditions.alpha[first]):g} deg, beta {degrees(conditions.beta[first]):g} deg: this free "
            f"stream goes through {int((share > ALONG).sum())} of {len(area)} faces of symmetry (one has the normal "
            f"{x:.3g}, {y:.3g}, {z:.3g}); it must run along the plane of symmetry"
        )


def records(solution: Solution, coefficients: xr.Dataset) -> list[dict]:
    """One dict per condition: conditions, coefficients, and how they converged.

    Keys: mach, alpha_deg, beta_deg, COEFFICIENTS, PRESSURES, converged, verdict, residual_drop, iterations, seconds,
    cells, reason. `seconds` is the wall time of the whole ensemble divided by its conditions. Values of a
    failed condition are None.
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
            }
        )
    return result


def total_seconds(solution: Solution) -> float:
    """Wall time of the solver, s, all phases."""
    seconds = solution.statistics.get("seconds", {})
    return float(sum(seconds.values())) if isinstance(seconds, dict) else float(seconds)
