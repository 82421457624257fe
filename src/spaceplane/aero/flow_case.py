"""Any body in any list of free streams: coefficients as plain records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from spaceplane.aero.conditions import in_air, product
from spaceplane.aero.increments.add import WITH_SOURCES, integrate_with
from spaceplane.aero.increments.settings import Air, IncrementSettings, require_no_friction
from spaceplane.aero.integrate import BY_SOURCE, COEFFICIENTS, PRESSURES, TOTAL, Reference
from spaceplane.environment.atmosphere import Ambient
from spaceplane.errors import InputError
from spaceplane.flow.freestream import velocity
from spaceplane.flow.settings import FlowSettings, check
from spaceplane.flow.solution import PERFECT, FlowConditions, Solution
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings
from spaceplane.plain import degrees, finite
from spaceplane.progress import Progress
from spaceplane.vehicle.surface import Surface

FASTEST_POINT = 0.5
"""Speed by rotation, on the flight speed, that a point of the body may have: far beyond any vehicle's manoeuvre."""
ALONG = 1e-3
"""Share of the free stream's speed that may go through a plane of symmetry, flat to what its file rounds."""


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
    gas: str = PERFECT,
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
        ambient: undisturbed air of every condition, for skin friction and equilibrium air.
        gas: name in `flow.solution.GASES`.

    Raises:
        InputError: a bad condition or body, rates that move some point of the body at more than half the flight
            speed, skin friction or equilibrium air without air, or both together.
    """
    conditions = _turning(product(list(machs), list(alphas), list(betas)), rates, reference, body.points)
    conditions = _gas(conditions, gas, increments, ambient)
    viscous = _viscous(increments, ambient, len(conditions))
    if progress:
        progress("mesh", 0, 1, "")
    mesh = generate(body, mesh_settings, progress)
    return _solved(mesh, conditions, reference, flow_settings, progress, *viscous)


def run_on_mesh(
    mesh: Mesh,
    machs: Sequence[float],
    alphas: Sequence[float],
    betas: Sequence[float],
    reference: Reference,
    flow_settings: FlowSettings,
    progress: Progress | None = None,
    rates: tuple[float, float, float] = (0.0, 0.0, 0.0),
    increments: IncrementSettings | None = None,
    ambient: Ambient | None = None,
    gas: str = PERFECT,
) -> FlowCase:
    """Solve every combination of Mach number, angle of attack and sideslip on a mesh that is there already.

    Args:
        mesh: ours or an imported one; coefficients of half a body, cut at a plane of symmetry, are those of that half.
        machs: Mach numbers.
        alphas: angles of attack, rad.
        betas: sideslip angles, rad.
        reference: area, chord, span and moment centre, SI.
        flow_settings: how to solve.
        progress, rates, increments, ambient, gas: as for `run_flow`.

    Raises:
        InputError: as `run_flow`, or a free stream that goes through a plane of symmetry, or rates beside one.
    """
    walls = mesh.wall_center[mesh.body_wall]
    conditions = _turning(product(list(machs), list(alphas), list(betas)), rates, reference, walls)
    if any(rates) and not mesh.body_wall.all():
        raise InputError(f"rates: {rates}, not allowed on a mesh with planes of symmetry")
    _require_along_symmetry(mesh, conditions)
    conditions = _gas(conditions, gas, increments, ambient)
    viscous = _viscous(increments, ambient, len(conditions))
    return _solved(mesh, conditions, reference, flow_settings, progress, *viscous)


def _turning(
    conditions: FlowConditions, rates: tuple[float, float, float], reference: Reference, points: np.ndarray
) -> FlowConditions:
    """The conditions with `rates`, 1/m, about the moment centre of a body with these points [point, xyz]."""
    arm = np.linalg.norm(points - np.asarray(reference.moment_center), axis=1).max()
    share = float(np.linalg.norm(rates) * arm / conditions.mach.min())
    if share > FASTEST_POINT:
        raise InputError(
            f"rates: a point of the body would move at {share:.2g} of the flight speed, at most {FASTEST_POINT:g}"
        )
    return replace(conditions, rates=np.tile(rates, (len(conditions), 1)), center=reference.moment_center)


def _gas(
    conditions: FlowConditions, gas: str, increments: IncrementSettings | None, ambient: Ambient | None
) -> FlowConditions:
    """The conditions in `gas`, refused here where the solver would refuse them after the mesh is made."""
    if gas == PERFECT:
        return conditions
    require_no_friction(gas, increments)
    if ambient is None:
        raise InputError(f"gas = {gas!r}: needs the altitude")
    return check(in_air(conditions, gas, [ambient] * len(conditions)))


def _viscous(
    increments: IncrementSettings | None, ambient: Ambient | None, count: int
) -> tuple[IncrementSettings, Air | None]:
    """Increments, none when None, and the air of `count` conditions that friction needs."""
    increments = increments or IncrementSettings()
    if increments.friction != "off" and ambient is None:
        raise InputError(f"friction = {increments.friction!r}: needs the altitude")
    return increments, None if ambient is None else Air.of([ambient] * count)


def _solved(
    mesh: Mesh,
    conditions: FlowConditions,
    reference: Reference,
    flow_settings: FlowSettings,
    progress: Progress | None,
    increments: IncrementSettings,
    air: Air | None,
) -> FlowCase:
    solution = solve(mesh, conditions, flow_settings, progress)
    coefficients = integrate_with(solution, reference, increments, air)
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
