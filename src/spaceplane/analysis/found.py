"""Everything that one analysis found, and the lines that a reader must know of."""

from __future__ import annotations

from dataclasses import dataclass

import xarray as xr

from spaceplane.aero.bodies import ControlRun, SolvedBody
from spaceplane.aero.conditions import ConditionPlan
from spaceplane.aero.database import AeroDatabase
from spaceplane.aero.derivatives import CONVERGED
from spaceplane.analysis.flight import PointAnalysis
from spaceplane.analysis.settings import AnalyseSettings
from spaceplane.dynamics.derivatives import DAMPING, STATIC
from spaceplane.vehicle.presets import Vehicle


@dataclass(frozen=True)
class Analysis:
    """Everything an analysis found.

    Attributes:
        vehicle: what was analysed.
        settings: how.
        body: the base body, its mesh and flow.
        plan: which condition of the ensemble is for what.
        coefficients: of the base ensemble, by part.
        control_runs: one per moved surface and step.
        derivatives: dims (point, part).
        points: one per flight point.
        database: every case and derivative.
        warnings: what a reader must know, one line each.
    """

    vehicle: Vehicle
    settings: AnalyseSettings
    body: SolvedBody
    plan: ConditionPlan
    coefficients: xr.Dataset
    control_runs: tuple[ControlRun, ...]
    derivatives: xr.Dataset
    points: tuple[PointAnalysis, ...]
    database: AeroDatabase
    warnings: tuple[str, ...]

    def seconds(self) -> dict[str, float]:
        """Wall time, s, by phase."""
        total = dict(self.body.seconds)
        for key in ("geometry", "mesh", "flow"):
            if self.control_runs:
                total[f"{key} (controls)"] = sum(run.seconds[key] for run in self.control_runs)
        return total


def remarks(
    vehicle: Vehicle,
    body: SolvedBody,
    plan: ConditionPlan,
    runs: tuple[ControlRun, ...],
    found: tuple[PointAnalysis, ...],
    derivatives: xr.Dataset,
) -> tuple[str, ...]:
    """What a reader must know of an analysis, one line each.

    Parameters outside their limits, warnings of the mesh, conditions that did not converge, flight points outside the
    validity of continuum and ideal gas, and modes that rest on conditions that did not converge.

    Args:
        vehicle, body, plan, runs, found, derivatives: as the fields of `Analysis`.
    """
    lines = [
        f"{name} = {getattr(vehicle.shape, name):g} lies outside its limits" for name in vehicle.shape.outside_limits()
    ]
    lines += [str(line) for line in body.solution.mesh.record.get("warnings", ())]
    judged = [(found[plan.point[i]].point.name, plan.labels[i], one) for i, one in enumerate(body.solution.records)]
    judged += [(at.point.name, run.label, one) for run in runs for at, one in zip(found, run.records, strict=True)]
    lines += [f"{name}, condition {label}: {one.verdict}: {one.reason}" for name, label, one in judged if not one.good]
    for index, point in enumerate(found):
        name = point.point.name
        lines += [f"{name}: {note}" for note in point.validity.notes]
        used = [n for n in (*STATIC, *DAMPING) if f"{n}_status" in derivatives]
        shaky = [n for n in used if str(derivatives[f"{n}_status"].values[index]) != CONVERGED]
        if point.reason:
            lines.append(f"{name}: {point.reason}")
        elif shaky:
            lines.append(f"{name}: modes and levels rest on {', '.join(shaky)}, of conditions that did not converge")
    return tuple(lines)
