"""Any body in any list of free streams: coefficients as plain records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
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

FASTEST_POINT = 0.5
"""Speed by rotation, on the flight speed, that a point of the body may have: far beyond any vehicle's manoeuvre."""


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
    rates: tuple[float, float, float] = (0.0, 0.0, 0.0),
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
        rates: steady roll, pitch and yaw rate about the moment centre in every condition, rad/s on the speed of sound
            in m/s, 1/m.
        increments: viscous increments; none when None.
        ambient: undisturbed air of every condition, for skin friction.

    Raises:
        InputError: a bad condition or body, rates that move some point of the body at more than half the flight
            speed, or skin friction without air.
    """
    conditions = product(list(machs), list(alphas), list(betas))
    conditions = replace(conditions, rates=np.tile(rates, (len(conditions), 1)), center=reference.moment_center)
    arm = np.linalg.norm(body.points - np.asarray(reference.moment_center), axis=1).max()
    share = float(np.linalg.norm(rates) * arm / conditions.mach.min())
    if share > FASTEST_POINT:
        raise InputError(
            f"rates: a point of the body would move at {share:.2g} of the flight speed, at most {FASTEST_POINT:g}"
        )
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

    Keys: mach, alpha_deg, beta_deg, p_hat, q_hat, r_hat (reduced rates), COEFFICIENTS, PRESSURES, converged,
    verdict, residual_drop, iterations, seconds, cells, reason. `seconds` is the wall time of the whole ensemble
    divided by its conditions. Values of a failed condition are None. With viscous increments, `by_source` holds what
    "inviscid", "friction" and "base" add to the coefficients.
    """
    totals = coefficients.sel(part=TOTAL)
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
            **_by_source(totals, i),
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
        **{name: float(one[name]) for name in ("p_hat", "q_hat", "r_hat")},
        **{name: finite(totals[name].item()) for name in (*COEFFICIENTS, *PRESSURES)},
        **found,
    }


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
