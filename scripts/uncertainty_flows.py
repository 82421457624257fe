"""Flows of scripts/check_uncertainty.py, solved once and kept in a folder, so that judging them anew solves nothing."""

from __future__ import annotations

import hashlib
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from spaceplane.aero.integrate import integrate
from spaceplane.flow.settings import FlowSettings
from spaceplane.flow.solution import FlowConditions
from spaceplane.flow.solve import solve
from spaceplane.mesh.generate import generate
from spaceplane.mesh.settings import MeshSettings
from spaceplane.vehicle.properties import ReferenceLengths
from spaceplane.vehicle.surface import Surface


@dataclass(frozen=True)
class Task:
    """A body on one mesh in all its conditions.

    Attributes:
        surface: the body.
        mesh: how to mesh.
        conditions: free streams.
        reference: lengths.
        flow: how to solve.
    """

    surface: Surface
    mesh: MeshSettings
    conditions: FlowConditions
    reference: ReferenceLengths
    flow: FlowSettings

    def fingerprint(self) -> str:
        """Of everything that the result depends on but the version of the solver."""
        streams = self.conditions
        numbers = (streams.mach, streams.alpha, streams.beta, streams.rates, self.surface.points)
        parts = [b"" if one is None else one.tobytes() for one in numbers]
        parts += [repr(one).encode() for one in (self.mesh, self.reference, self.flow)]
        return hashlib.sha256(b"|".join(parts)).hexdigest()[:16]


def kept(path: Path, task: Task) -> xr.Dataset:
    """Coefficients from the file, or solved now and kept there; a file of another task is solved anew.

    A file appears when its flow is complete: a run that was broken off goes on where it was.
    """
    if path.exists():
        found = xr.load_dataset(path)
        if found.attrs.get("task") == task.fingerprint():
            return found
    begin, used = time.perf_counter(), time.process_time()
    made = generate(task.surface, task.mesh)
    print(f"{path.stem}: {made.cells} cells, {len(task.conditions)} conditions", end="", file=sys.stderr, flush=True)
    solution = solve(made, task.conditions, task.flow)
    seconds = {"seconds": time.perf_counter() - begin, "processor_seconds": time.process_time() - used}
    good = sum(record.good for record in solution.records)
    print(f", {good} converged, {seconds['seconds']:.0f} s", file=sys.stderr, flush=True)
    found = integrate(solution, task.reference).assign_attrs(cells=made.cells, task=task.fingerprint(), **seconds)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    found.to_netcdf(part)
    part.replace(path)
    return found
