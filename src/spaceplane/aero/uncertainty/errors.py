"""Errors of coefficients and derivatives by where they come from, and together: the one place that adds them up."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.integrate import TOTAL, WITH_SPREAD
from spaceplane.aero.uncertainty.arms import Arms, arms_of, floors
from spaceplane.aero.uncertainty.grid import half_width
from spaceplane.aero.uncertainty.settings import ITERATION, MESH
from spaceplane.plain import finite

if TYPE_CHECKING:
    import xarray as xr

SCALES = {
    "lift": ("CL", "CN"),
    "drag": ("CD", "CA"),
    "shares": ("CA_forebody", "CA_base"),
    "side": ("CY",),
    "pitch": ("Cm",),
    "roll": ("Cl",),
    "yaw": ("Cn",),
}
"""Coefficients whose errors are of one size: forces with their shares. Rolling and yawing moments are not: the arms of
fins about the axis of a slender body are a fifth of those about its middle."""
WITH_ERROR = (*WITH_SPREAD, "CA_forebody", "CA_base")
"""Coefficients that have an error; the solver's final window tells the two shares of CA no more than of CA itself."""
OF_MESH = "_mesh_error"
OF_STEP = "_step_error"


def together(*errors: np.ndarray) -> np.ndarray:
    """Independent errors as one, in their own unit: the root of the sum of their squares; NaN where one is."""
    return np.sqrt(sum(np.asarray(e, dtype=float) ** 2 for e in errors))


def of_coefficients(data: xr.Dataset, companion: xr.Dataset | None, ratio: float) -> xr.Dataset:
    """Coefficients with their error, that of the mesh apart.

    Args:
        data: as `integrate` gives, whose `<name>_spread` is the error of the iteration.
        companion: the same conditions on the coarser mesh; None where there is none.
        ratio: its cell over that of the mesh.

    Returns:
        `data` with `<name>_error` (condition) for each name of WITH_ERROR, the half width of the interval that is
        meant to hold the exact inviscid value in 95 % of all cases; with a companion also `<name>_mesh_error`.
    """
    names = list(WITH_ERROR)
    found = {name: data[_spread_of(name)].values for name in names}
    changes = {}
    if companion is not None:
        groups = [_scale(name) for name in names]
        values = (_totals(d, names) for d in (data, companion))
        mach = data.mach.values
        mesh = half_width(*values, mach, groups, ratio, floors(groups, arms_of(data), mach))
        for name, error in zip(names, mesh, strict=True):
            head = data[name].attrs | {"long_name": f"uncertainty of {name} by the mesh, 95 %", "positive": "always"}
            changes[f"{name}{OF_MESH}"] = ("condition", error, head)
            found[name] = together(found[name], error)
    for name in names:
        head = data[name].attrs | {"long_name": f"uncertainty of {name}", "positive": "always"}
        changes[f"{name}_error"] = ("condition", found[name], head)
    return data.assign(changes)


def of_derivatives(
    data: xr.Dataset, companion: xr.Dataset | None, mach: np.ndarray, ratio: float, arms: Arms
) -> xr.Dataset:
    """Derivatives with the error of the mesh in their error.

    The derivatives on both meshes are compared, not the coefficients' uncertainties differenced: what the mesh does
    to a coefficient it does alike on both sides of a step, and it mostly cancels.

    Args:
        data: as `differentiate` and `control_derivatives` give, whose `<name>_error` is that of the difference
            quotient.
        companion: the same on the coarser mesh; None leaves `data` as it is.
        mach: [point] Mach number.
        ratio: its cell over that of the mesh.
        arms: of the body.

    Returns:
        `data` with `<name>_step_error` (what was `<name>_error`), `<name>_mesh_error` and both together as
        `<name>_error`, each (point).
    """
    if companion is None:
        return data
    names = [str(name) for name in data.data_vars if f"{name}_status" in data]
    groups = [_scale(name) for name in names]
    values = (_totals(d, names) for d in (data, companion))
    mesh = half_width(*values, mach, groups, ratio, floors(groups, arms, mach))
    changes = {}
    for name, error in zip(names, mesh, strict=True):
        step = data[f"{name}_error"]
        changes[f"{name}{OF_STEP}"] = step.assign_attrs(long_name=f"error of the difference quotient of {name}")
        text = step.attrs | {"long_name": f"uncertainty of {name} by the mesh, 95 %"}
        changes[f"{name}{OF_MESH}"] = ("point", error, text)
        text = step.attrs | {"long_name": f"uncertainty of {name}"}
        changes[f"{name}_error"] = ("point", together(step.values, error), text)
    return data.assign(changes)


def error_record(totals: xr.Dataset) -> dict:
    """Errors of the coefficients at one condition, for JSON: together and by source, null where unknown.

    Args:
        totals: what `of_coefficients` gives, at one condition.

    Returns:
        "coefficient_errors" (name to error) and "coefficient_errors_by_source" ("iteration" and, only with a companion,
        "mesh", each name to error).
    """
    sources = {ITERATION: {name: finite(totals[_spread_of(name)].item()) for name in WITH_ERROR}}
    if f"{WITH_ERROR[0]}{OF_MESH}" in totals:
        sources[MESH] = {name: finite(totals[f"{name}{OF_MESH}"].item()) for name in WITH_ERROR}
    errors = {name: finite(totals[f"{name}_error"].item()) for name in WITH_ERROR}
    lift, drag = (abs(totals[name].item()) for name in ("CL", "CD"))
    if lift and drag:
        # as if the two were independent; where they are not, their errors mostly share their sign
        share = together(totals.CL_error.item() / lift, totals.CD_error.item() / drag)
        errors["L_over_D"] = finite(float(share * lift / drag))
    return {"coefficient_errors": errors, "coefficient_errors_by_source": sources}


def _spread_of(name: str) -> str:
    return f"{name if name in WITH_SPREAD else 'CA'}_spread"


def _totals(data: xr.Dataset, names: list[str]) -> np.ndarray:
    """[name, condition or point] values of the whole vehicle."""
    return np.stack([data[name].sel(part=TOTAL).values for name in names])


def _scale(name: str) -> str:
    """What a coefficient, or a derivative by one quantity, shares the size of its errors with."""
    coefficient, _, quantity = (name, "", "") if name in WITH_ERROR else name.partition("_")
    return next(scale for scale, names in SCALES.items() if coefficient in names) + f" {quantity}"
