"""Coefficients of a list of conditions as plain records, ready for JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING

from spaceplane.aero.increments.add import WITH_SOURCES
from spaceplane.aero.integrate import BY_SOURCE, COEFFICIENTS, PRESSURES, TOTAL
from spaceplane.aero.uncertainty.errors import error_record
from spaceplane.flow.solution import Solution
from spaceplane.plain import degrees, finite

if TYPE_CHECKING:
    import xarray as xr


def records(solution: Solution, coefficients: xr.Dataset) -> list[dict]:
    """One dict per condition: conditions, coefficients, and how they converged.

    Keys: mach, alpha_deg, beta_deg, p_hat, q_hat, r_hat (reduced rates), COEFFICIENTS, PRESSURES, converged,
    verdict, residual_drop, iterations, seconds, cells, reason. `seconds` is the wall time of the whole ensemble
    divided by its conditions. Values of a failed condition are None. With viscous increments, `by_source` holds what
    "inviscid", "friction" and "base" add to the coefficients. With errors, `coefficient_errors` and
    `coefficient_errors_by_source` as of `error_record`; of what oscillates, "iteration" is the spread about the mean.
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
