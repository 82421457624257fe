"""Trim in pitch over Mach number and angle of attack: with what deflections, or why there is none."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.model.model import AeroModel
from spaceplane.dynamics.trim.effects import Limits, check_limits
from spaceplane.dynamics.trim.longitudinal import schedule_at, trim_elevator
from spaceplane.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

_QUANTITIES = {
    "elevator": ("rad", "both elevons, that with the largest margin", "trailing edge down"),
    "body_flap": ("rad", "body flap", "trailing edge down"),
    "margin": ("rad", "distance of the elevator to its nearer limit", "always"),
    "CL": ("1", "trimmed lift coefficient", "up"),
    "CD": ("1", "trimmed drag coefficient", "downstream"),
    "lift_to_drag": ("1", "trimmed lift over drag", "up"),
    "Cm_alpha": ("1/rad", "slope of the pitching moment, deflections held", "nose up with growing alpha"),
    "static_margin": ("1", "neutral point aft of the moment centre, over c_ref", "stable"),
    "neutral_point": ("m", "neutral point", "aft of the nose"),
    "elevator_needed": ("rad", "elevator beyond its limit, by the slope there", "trailing edge down"),
}


def trim_map(
    model: AeroModel,
    mach: Sequence[float],
    alpha: Sequence[float],
    body_flap: float | Mapping[float, float] | None = None,
    moment: float = 0.0,
    limits: Limits | None = None,
) -> xr.Dataset:
    """Trim at every pair of Mach number and angle of attack.

    Args:
        model: aerodynamics about the centre of mass.
        mach: [mach] Mach numbers, increasing.
        alpha: [alpha] rad, increasing.
        body_flap: rad everywhere; a schedule Mach number -> rad, linear in between; None, and where the schedule
            ends, chooses the flap that leaves the elevator the largest margin.
        moment: coefficient of other pitching moments, on q S c_ref.
        limits: narrower than those of the tables, rad.

    Returns:
        Dataset (mach, alpha): `trimmable`, the quantities of the best trim (NaN where there is none), `trims` (how many
        there are) and `reason` (empty where there is one); each with units and positive sense.

    Raises:
        InputError: an axis that does not increase or is not finite, or what `trim_elevator` refuses.
    """
    machs, alphas = (_axis(name, values) for name, values in (("mach", mach), ("alpha", alpha)))
    check_limits(model, limits)
    shape = (len(machs), len(alphas))
    values = {name: np.full(shape, np.nan) for name in _QUANTITIES}
    count, reason = np.zeros(shape, dtype=int), np.full(shape, "", dtype=object)
    for i, one_mach in enumerate(machs.tolist()):
        flap = schedule_at(body_flap, one_mach) if isinstance(body_flap, Mapping) else body_flap
        for j, one_alpha in enumerate(alphas.tolist()):
            found = trim_elevator(model, one_mach, one_alpha, flap, moment, limits)
            count[i, j], reason[i, j] = len(found.trims), found.reason
            if found.needed is not None:
                values["elevator_needed"][i, j] = found.needed
            best = found.best
            if best is not None:
                for name in ("elevator", "body_flap", "margin", "CL", "CD", "lift_to_drag"):
                    values[name][i, j] = getattr(best, name)
                values["Cm_alpha"][i, j] = best.static.Cm_alpha
                values["static_margin"][i, j] = best.static.margin
                values["neutral_point"][i, j] = best.static.neutral_point
    import xarray as xr

    grid = ("mach", "alpha")
    variables: dict = {
        name: (grid, table, dict(zip(("units", "long_name", "positive"), _QUANTITIES[name], strict=True)))
        for name, table in values.items()
    }
    variables["trimmable"] = (grid, count > 0, {"units": "1", "long_name": "a trim exists within limits"})
    variables["trims"] = (grid, count, {"units": "1", "long_name": "number of trims"})
    variables["reason"] = (grid, reason.astype(str), {"units": "none", "long_name": "why there is no trim"})
    coordinates = {"mach": ("mach", machs, {"units": "1"}), "alpha": ("alpha", alphas, {"units": "rad"})}
    reference = model.reference
    return xr.Dataset(
        variables,
        coordinates,
        {
            "model": model.name,
            "source": model.source,
            "unknown": ", ".join(model.unknown()),
            "body_flap": _described(body_flap),
            "moment": moment,
            "reference_area_m2": reference.area,
            "c_ref_m": reference.chord,
            "b_ref_m": reference.span,
            "moment_center_m": list(reference.moment_center),
        },
    )


def _described(body_flap: float | Mapping[float, float] | None) -> str:
    if body_flap is None:
        return "largest margin of the elevator"
    if not isinstance(body_flap, Mapping):
        return f"{math.degrees(body_flap):g} deg"
    points = ", ".join(f"Mach {m:g}: {math.degrees(body_flap[m]):g} deg" for m in sorted(body_flap))
    return f"{points}; elsewhere largest margin of the elevator"


def _axis(name: str, values: Sequence[float]) -> np.ndarray:
    axis = np.array(values, dtype=float)
    if axis.ndim != 1 or not len(axis) or not np.all(np.isfinite(axis)) or not np.all(np.diff(axis) > 0.0):
        raise InputError(f"{name}: must be finite, increasing values")
    return axis
