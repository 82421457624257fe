"""Any body in any list of free streams: coefficients as plain records."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.conditions import in_air, product
from spaceplane.aero.increments.add import WITH_SOURCES, integrate_with
from spaceplane.aero.increments.settings import Air, IncrementSettings, require_no_friction
from spaceplane.aero.integrate import BY_SOURCE, COEFFICIENTS, PRESSURES, TOTAL, Reference
from spaceplane.aero.uncertainty.accuracy import Accuracy, Refined, Trial, at_wall_cell, refine, relative
from spaceplane.aero.uncertainty.companion import RATIO, Companion, coarser
from spaceplane.aero.uncertainty.errors import error_record, of_coefficients
from spaceplane.aero.uncertainty.settings import ITERATION, MESH
from spaceplane.environment.atmosphere import Ambient
from spaceplane.errors import InputError
from spaceplane.flow.adapt import follower, solve_adapted
from spaceplane.flow.compilation import begin
from spaceplane.flow.freestream import velocity
from spaceplane.flow.settings import FlowSettings, check
from spaceplane.flow.solution import PERFECT, FlowConditions, Solution
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.mesh import Mesh
from spaceplane.mesh.settings import MeshSettings
from spaceplane.mesh.sizing import sizes_of
from spaceplane.plain import degrees, finite
from spaceplane.progress import Progress, silent
from spaceplane.vehicle.surface import Surface

if TYPE_CHECKING:
    import xarray as xr

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
        companion: the same on a coarser mesh, for the errors of the mesh; None where there is none.
    """

    records: list[dict]
    coefficients: xr.Dataset
    mesh: Mesh
    solution: Solution
    companion: Companion | None = None


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
    uncertainty: str = ITERATION,
    adapt: int = 0,
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
        uncertainty: "mesh" solves everything again on a coarser companion mesh, and the records hold
            `coefficient_errors` with the uncertainty by the mesh; "iteration" leaves that out.
        adapt: passes that adapt the mesh to the flow, see `solve_adapted`; the companion then has cells twice as large
            as those of the last mesh everywhere.
        gas: name in `flow.solution.GASES`.

    Raises:
        InputError: a bad condition or body, adaptation without a number of cells, rates that move some point of the
            body at more than half the flight speed, skin friction or equilibrium air without air, or both together.
    """
    conditions = _turning(product(list(machs), list(alphas), list(betas)), rates, reference, body.points)
    conditions = _gas(conditions, gas, increments, ambient)
    viscous = _viscous(increments, ambient, len(conditions))
    solution = solve_adapted(body, mesh_settings, conditions, flow_settings, adapt, progress)
    case = _told(solution, reference, *viscous)
    if uncertainty != MESH:
        return case

    def say(phase: str, done: int, total: int, text: str) -> None:
        (progress or silent)(f"companion: {phase}", done, total, text)

    wall_cell = float(solution.mesh.record["wall_cell_m"])
    own = follower(mesh_settings, wall_cell) if adapt else mesh_settings
    twice = sizes_of(solution.mesh, RATIO) if adapt else None
    coarse = generate(body, coarser(own, wall_cell), say, twice)
    return _compared(case, _told(solve(coarse, conditions, flow_settings, say), reference, *viscous), RATIO)


def run_to_accuracy(
    body: Surface,
    machs: Sequence[float],
    alphas: Sequence[float],
    betas: Sequence[float],
    reference: Reference,
    mesh_settings: MeshSettings,
    flow_settings: FlowSettings,
    accuracy: Accuracy,
    progress: Progress | None = None,
    rates: tuple[float, float, float] = (0.0, 0.0, 0.0),
    increments: IncrementSettings | None = None,
    ambient: Ambient | None = None,
    gas: str = PERFECT,
    tell: Callable[[Trial], None] | None = None,
) -> tuple[FlowCase, Refined]:
    """As `run_flow`, on meshes made finer until the coefficients are as certain as asked; the last mesh's flow.

    Args:
        body, machs, alphas, betas, reference, flow_settings: as for `run_flow`.
        progress, rates, increments, ambient, gas: as for `run_flow`.
        mesh_settings: how to mesh; the wall cell is chosen here.
        accuracy: what is asked, and the most cells; see `refine`.
        tell: called with each mesh once it is solved.

    Returns:
        The case, whose records hold `coefficient_errors` and `accuracy` ("target", "reached", "met" of the condition),
        and the way there.

    Raises:
        InputError: as `run_flow`, or fewer cells allowed than two meshes of this body have.
    """
    conditions = _turning(product(list(machs), list(alphas), list(betas)), rates, reference, body.points)
    conditions = _gas(conditions, gas, increments, ambient)
    viscous = _viscous(increments, ambient, len(conditions))
    last: FlowCase | None = None
    number = 1
    begin(flow_settings, conditions)

    def say(phase: str, done: int, total: int, text: str) -> None:
        (progress or silent)(f"mesh {number}: {phase}", done, total, text)

    def make(cell: float | None) -> Mesh:
        return generate(body, at_wall_cell(mesh_settings, cell), say)

    def solved(mesh: Mesh) -> xr.Dataset:
        nonlocal last, number
        last = None  # its state is as large as the next one's
        last = _told(solve(mesh, conditions, flow_settings, say), reference, *viscous)
        number += 1
        return last.coefficients

    found = refine(make, solved, accuracy, tell)
    case = last
    rows = records(case.solution, found.coefficients)
    for row, reached in zip(rows, relative(found.coefficients), strict=True):
        met = bool(reached <= accuracy.target)
        row["accuracy"] = {"target": accuracy.target, "reached": finite(reached), "met": met}
    return replace(case, records=rows, coefficients=found.coefficients), found


def _compared(case: FlowCase, coarse: FlowCase, ratio: float) -> FlowCase:
    """The case with the errors that a coarser mesh, of cells `ratio` times as large, shows."""
    coefficients = of_coefficients(case.coefficients, coarse.coefficients, ratio)
    companion = Companion(
        coarse.coefficients,
        coarse.solution.records,
        ratio,
        float(coarse.mesh.record["wall_cell_m"]),
        coarse.mesh.cells,
        {"flow": total_seconds(coarse.solution)},
    )
    return replace(case, records=records(case.solution, coefficients), coefficients=coefficients, companion=companion)


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
    return _told(solve(mesh, conditions, flow_settings, progress), reference, *viscous)


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


def _told(solution: Solution, reference: Reference, increments: IncrementSettings, air: Air | None) -> FlowCase:
    coefficients = integrate_with(solution, reference, increments, air)
    return FlowCase(records(solution, coefficients), coefficients, solution.mesh, solution)


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
    "inviscid", "friction" and "base" add to the coefficients. With errors, `coefficient_errors` and
    `coefficient_errors_by_source` as of `error_record`.
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
            **(error_record(totals.isel(condition=i)) if "CL_error" in totals else {}),
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
