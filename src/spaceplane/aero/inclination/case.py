"""Any body in any list of free streams by local inclination: the same plain records as from the Euler solver."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from spaceplane.aero.conditions import product
from spaceplane.aero.inclination.compiled import CACHE
from spaceplane.aero.inclination.settings import method
from spaceplane.aero.inclination.solve import local_inclination
from spaceplane.aero.integrate import Reference
from spaceplane.aero.records import condition_record
from spaceplane.progress import Progress
from spaceplane.vehicle.surface import Surface

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class InclinationCase:
    """What `run_inclination` found.

    Attributes:
        records: one JSON-ready dict per condition, with the keys of `records.records`.
        coefficients: the same by part, see `integrate.coefficients`.
    """

    records: list[dict]
    coefficients: xr.Dataset


def run_inclination(
    body: Surface,
    machs: Sequence[float],
    alphas: Sequence[float],
    betas: Sequence[float],
    reference: Reference,
    name: str = "newtonian-expansion",
    progress: Progress | None = None,
) -> InclinationCase:
    """Every combination of Mach number, angle of attack and sideslip by one method of local inclination.

    In the records `cells` and `iterations` are 0 and `residual_drop` is None, for there is no mesh and nothing
    iterates; `converged` is true and `verdict` "inclination".

    Args:
        body: watertight surface.
        machs: Mach numbers, from `settings.LEAST_MACH` up.
        alphas: angles of attack, rad.
        betas: sideslip angles, rad.
        reference: area, chord, span and moment centre, SI.
        name: of the method, see `settings.METHODS`.
        progress: called with (phase, done, total, text) when kernels have to be compiled.

    Raises:
        InputError: a bad condition or an unknown method.
    """
    settings = method(name)
    conditions = product(list(machs), list(alphas), list(betas))
    cold = not CACHE.is_complete(name)
    if cold and progress:
        progress("compile", 0, 1, "compiling kernels (once, some seconds)")
    began = time.perf_counter()
    coefficients = local_inclination(body, conditions, reference, settings)
    seconds = (time.perf_counter() - began) / len(conditions)
    if cold:
        CACHE.mark_complete(name)
    records = [
        condition_record(
            coefficients,
            i,
            converged=True,
            verdict="inclination",
            residual_drop=None,
            iterations=0,
            seconds=round(seconds, 6),
            cells=0,
            reason="",
        )
        for i in range(len(conditions))
    ]
    return InclinationCase(records, coefficients)
