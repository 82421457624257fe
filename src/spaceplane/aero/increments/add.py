"""Inviscid coefficients with viscous increments added, each source kept apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.aero.increments.base_pressure import base_forces
from spaceplane.aero.increments.running_length import neighbours
from spaceplane.aero.increments.settings import Air, IncrementSettings
from spaceplane.aero.increments.skin_friction import friction_forces
from spaceplane.aero.integrate import BY_SOURCE, integrate
from spaceplane.aero.loads import Reference, by_part, coefficients_of
from spaceplane.errors import InputError
from spaceplane.flow.solution import Solution

if TYPE_CHECKING:
    import xarray as xr

INVISCID = "inviscid"
WITH_SOURCES = (*FORCES_AND_MOMENTS, "CA", "CN")
"""Coefficients that are listed by source."""


def integrate_with(
    solution: Solution, reference: Reference, settings: IncrementSettings, air: Air | None = None
) -> xr.Dataset:
    """Coefficients of every condition with the increments asked for.

    Args:
        solution: flow of every condition on one mesh.
        reference: area, chord, span and moment centre, SI.
        settings: which increments.
        air: of each condition; needed for friction.

    Returns:
        What `integrate` gives. With increments, each coefficient of WITH_SOURCES is the sum over the sources, and
        `<name>_by_source` (condition, part, source) holds "inviscid" and each increment, with the same axes, sign
        and reference. CA_base has the base increment in it; friction is in neither CA_forebody nor CA_base, which are
        pressure forces. Cp_max, Cp_min and the spreads are the inviscid flow's.

    Raises:
        InputError: friction without air, or air of another number of conditions.
    """
    data = integrate(solution, reference)
    if not settings.sources:
        return data
    found = _increments(solution, reference, settings, air)
    names = [INVISCID, *found]
    changed = {}
    for name in WITH_SOURCES:
        values = np.stack([data[name].values, *(one[name] for one in found.values())], axis=-1)
        head = data[name].attrs
        changed[name] = data[name].copy(data=values.sum(axis=-1))
        text = head | {"long_name": f"{head['long_name']} by source"}
        changed[f"{name}{BY_SOURCE}"] = (("condition", "part", "source"), values, text)
    if "base" in found:
        changed["CA_base"] = data.CA_base.copy(data=data.CA_base.values + found["base"]["CA"])
    return data.assign(changed).assign_coords(source=names)


def _increments(
    solution: Solution, reference: Reference, settings: IncrementSettings, air: Air | None
) -> dict[str, dict[str, np.ndarray]]:
    """Source to coefficient to [condition, part]; NaN in conditions that failed."""
    mesh, count = solution.mesh, len(solution.conditions)
    if settings.friction != "off":
        if air is None:
            raise InputError(f"friction = {settings.friction!r}: needs the air's temperature and Reynolds number")
        if len(air.temperature) != count:
            raise InputError(f"air: {len(air.temperature)} conditions for {count} free streams")
    center = np.asarray(reference.moment_center, dtype=float)
    pairs = neighbours(mesh) if settings.friction != "off" else None
    shape = (count, len(mesh.part_names) + 1, 3)
    loads = {source: (np.full(shape, np.nan), np.full(shape, np.nan)) for source in settings.sources}
    for condition, record in enumerate(solution.records):
        if record.verdict == "failed":
            continue
        for source, (force, moment) in loads.items():
            if source == "friction":
                pieces = friction_forces(solution, condition, settings, air, pairs)
            else:
                pieces = base_forces(solution, condition)
            force[condition], moment[condition] = by_part(mesh, pieces, center)
    pressure = 0.5 * np.asarray(solution.conditions.mach, dtype=float)[:, None, None] ** 2
    return {
        source: coefficients_of(force / pressure, moment / pressure, solution.conditions, reference)
        for source, (force, moment) in loads.items()
    }
