"""Everything that one analysis found, and the lines that a reader must know of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from spaceplane.aero.bodies import ControlRun, SolvedBody
from spaceplane.aero.conditions import ConditionPlan
from spaceplane.aero.database import AeroDatabase
from spaceplane.aero.derivatives import CONVERGED
from spaceplane.aero.model.derivatives import DAMPING, STATIC
from spaceplane.analysis.aerodynamics import Aerodynamics
from spaceplane.analysis.flight import PointAnalysis
from spaceplane.analysis.settings import AnalyseSettings
from spaceplane.vehicle.presets import Vehicle

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Analysis:
    """Everything an analysis found.

    Attributes:
        vehicle: what was analysed.
        settings: how.
        plan: which condition of the ensemble is for what.
        aerodynamics: bodies and their flow, coefficients and derivatives.
        points: one per flight point.
        database: every case and derivative.
        warnings: what a reader must know, one line each.
    """

    vehicle: Vehicle
    settings: AnalyseSettings
    plan: ConditionPlan
    aerodynamics: Aerodynamics
    points: tuple[PointAnalysis, ...]
    database: AeroDatabase
    warnings: tuple[str, ...]

    @property
    def body(self) -> SolvedBody:
        """The base body, its mesh and flow."""
        return self.aerodynamics.body

    @property
    def coefficients(self) -> xr.Dataset:
        """Of the base ensemble, by part."""
        return self.aerodynamics.coefficients

    @property
    def control_runs(self) -> tuple[ControlRun, ...]:
        """One per moved surface and step."""
        return self.aerodynamics.control_runs

    @property
    def derivatives(self) -> xr.Dataset:
        """Dims (point, part), per rad or per unit Mach number."""
        return self.aerodynamics.derivatives

    def seconds(self) -> dict[str, float]:
        """Wall time, s, by phase."""
        total = dict(self.body.seconds)
        for key in ("geometry", "mesh", "flow"):
            if self.control_runs:
                total[f"{key} (controls)"] = sum(run.seconds[key] for run in self.control_runs)
        if self.aerodynamics.adapted is not None:
            total["flow (adaptation)"] = self.aerodynamics.adapted.seconds
        if self.aerodynamics.companion is not None:
            total |= {f"{key} (companion)": value for key, value in self.aerodynamics.companion.seconds.items()}
        return total


def remarks(
    vehicle: Vehicle, plan: ConditionPlan, aero: Aerodynamics, found: tuple[PointAnalysis, ...]
) -> tuple[str, ...]:
    """What a reader must know of an analysis, one line each.

    Parameters outside their limits, warnings of the mesh, conditions that did not converge, flight points outside the
    validity of continuum and ideal gas, and modes that rest on conditions that did not converge.

    Args:
        vehicle, plan, aero, found: as the fields of `Analysis`.
    """
    body, runs, derivatives = aero.body, aero.control_runs, aero.derivatives
    lines = [
        f"{name} = {getattr(vehicle.shape, name):g} lies outside its limits" for name in vehicle.shape.outside_limits()
    ]
    lines += [str(line) for line in body.solution.mesh.record.get("warnings", ())]
    lines += [] if aero.adapted is None else [str(line) for line in aero.adapted.missed]
    judged = [(found[plan.point[i]].point.name, plan.labels[i], one) for i, one in enumerate(body.solution.records)]
    judged += [(at.point.name, run.label, one) for run in runs for at, one in zip(found, run.records, strict=True)]
    lines += [f"{name}, condition {label}: {one.verdict}: {one.reason}" for name, label, one in judged if not one.good]
    astray = sum(not one.good for one in aero.companion.records) if aero.companion else 0
    if astray:
        lines.append(
            f"companion mesh: {astray} of {len(aero.companion.records)} conditions did not converge; errors that "
            "rest on them hold their wandering, or are missing where they failed"
        )
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
