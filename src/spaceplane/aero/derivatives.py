"""Stability and control derivatives as difference quotients, each with its step, error estimate and status.

Stability derivatives are central differences. With one step size h the error estimate is

    (s+ + s-) / 2h  +  |f+ - 2 f0 + f-| / 2h

where s is the spread of the coefficient in the solver's final window. The second term, the departure of either
one-sided slope from the central one, bounds the truncation from above on a smooth curve and shows a kink within the
step. On the lateral derivatives of a symmetric vehicle it is the asymmetry that is left at zero sideslip. With two
step sizes the value is Richardson's, (4 D(h/2) - D(h)) / 3, and the second term becomes |D(h/2) - D(h)| / 3.

Control derivatives are one-sided, from a second body with one surface moved: error (s0 + s1) / h, and with two step
sizes value 2 D(h/2) - D(h) with |D(h/2) - D(h)| added. The meshes of the two bodies differ; that part of the error
shows only with two step sizes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from spaceplane.aero.axes import FORCES_AND_MOMENTS
from spaceplane.aero.conditions import ConditionPlan, PointPlan, Variation
from spaceplane.aero.integrate import mirrored, mirrored_name

if TYPE_CHECKING:
    import xarray as xr

# Thesis Table 7.1, and damping; angles per rad, Mach per unit Mach, rates on p b/2V, q c/2V, r b/2V.
STABILITY = {
    f"{coefficient}_{suffix}": (coefficient, quantity)
    for suffix, quantity, coefficients in (
        ("alpha", "alpha", ("CD", "CL", "Cm")),
        ("beta", "beta", ("CY", "Cl", "Cn")),
        ("M", "mach", ("CD", "CL", "Cm")),
        ("p", "p", ("CY", "Cl", "Cn")),
        ("q", "q", ("CL", "Cm")),
        ("r", "r", ("CY", "Cl", "Cn")),
    )
    for coefficient in coefficients
}
UNITS = {"alpha": "rad", "beta": "rad", "deflection": "rad", "mach": "1", "p": "1", "q": "1", "r": "1"}
CONVERGED = "converged"
_SEVERITY = (CONVERGED, "oscillating", "failed")


@dataclass(frozen=True)
class Slope:
    """One derivative at one flight point.

    Attributes:
        value: [part] derivative, total first.
        error: error estimate of the total.
        step: full step, rad, Mach number or reduced rate.
        status: worst verdict of the conditions that it rests on.
    """

    value: np.ndarray
    error: float
    step: float
    status: str


def differentiate(coefficients: xr.Dataset, plan: ConditionPlan) -> xr.Dataset:
    """Derivatives of STABILITY at each flight point of a plan.

    Args:
        coefficients: what `integrate` gave for `plan.conditions`.
        plan: which condition is which step.

    Returns:
        Dataset with dims (point, part): per derivative `<name>` (point, part), and `<name>_error`, `<name>_step`,
        `<name>_status` (point). The status is the worst verdict of the conditions used; a derivative with a failed
        condition is NaN. Derivatives by quantities that the plan does not vary are left out.
    """
    varied = {v.quantity for point in plan.points for v in point.variations}
    names = {name: rule for name, rule in STABILITY.items() if rule[1] in varied}
    by_mirror = any(v.minus is None for point in plan.points for v in point.variations)
    flipped = mirrored(coefficients) if by_mirror else coefficients
    slopes = {
        name: [_central(coefficients, flipped, coefficient, point, quantity) for point in plan.points]
        for name, (coefficient, quantity) in names.items()
    }
    return _dataset(slopes, coefficients, {name: quantity for name, (_, quantity) in names.items()})


def worst(verdicts: Sequence[str]) -> str:
    """The worst of several verdicts: failed before oscillating before converged."""
    return max((str(v) for v in verdicts), key=_SEVERITY.index)


def _central(data: xr.Dataset, flipped: xr.Dataset, coefficient: str, point: PointPlan, quantity: str) -> Slope:
    variations = point.of(quantity)
    value, spread = data[coefficient].values, data[f"{coefficient}_spread"].values
    verdict = data.verdict.values
    used = [point.base]
    quotients, noises = [], []
    for v in variations:
        minus = flipped[coefficient].values[v.plus] if v.minus is None else value[v.minus]
        other = v.plus if v.minus is None else v.minus
        quotients.append((value[v.plus] - minus) / (2.0 * v.step))
        noises.append((spread[v.plus] + spread[other]) / (2.0 * v.step))
        used += [v.plus, other]
    status = worst(verdict[used])
    step = variations[0].step
    if len(variations) == 1:
        truncation = _curvature(value, flipped[coefficient].values, point, variations[0])
        return Slope(quotients[0], noises[0] + truncation, step, status)
    full, half = quotients
    error = abs(half[0] - full[0]) / 3.0 + (4.0 * noises[1] + noises[0]) / 3.0
    return Slope((4.0 * half - full) / 3.0, error, step, status)


def _curvature(value: np.ndarray, flipped: np.ndarray, point: PointPlan, variation: Variation) -> float:
    """Departure of the one-sided slopes of the total from the central one."""
    minus = flipped[variation.plus, 0] if variation.minus is None else value[variation.minus, 0]
    return abs(value[variation.plus, 0] - 2.0 * value[point.base, 0] + minus) / (2.0 * variation.step)


@dataclass(frozen=True)
class Move:
    """Coefficients of two bodies that differ in the deflection of one control surface.

    Attributes:
        step: difference in deflection, rad.
        base: coefficients of the base body, one condition per flight point.
        moved: coefficients at the same conditions with the surface moved by the step.
    """

    step: float
    base: xr.Dataset
    moved: xr.Dataset


def control_derivatives(moves: Mapping[str, Sequence[Move]]) -> xr.Dataset:
    """Derivatives with respect to each control surface, per rad, at each flight point.

    Args:
        moves: per control surface the move by the full step and then, if at all, that by the half one.

    Returns:
        Dataset like that of `differentiate`, with names such as Cm_elevon_left.
    """
    slopes = {}
    source = None
    for surface, runs in moves.items():
        source = runs[0].base
        for coefficient in FORCES_AND_MOMENTS:
            slopes[f"{coefficient}_{surface}"] = [
                _one_sided(runs, coefficient, point) for point in range(source.sizes["condition"])
            ]
    return _dataset(slopes, source, dict.fromkeys(slopes, "deflection"))


def _one_sided(runs: Sequence[Move], coefficient: str, point: int) -> Slope:
    spread = f"{coefficient}_spread"
    quotients = [(m.moved[coefficient].values[point] - m.base[coefficient].values[point]) / m.step for m in runs]
    noises = [float(m.moved[spread][point] + m.base[spread][point]) / abs(m.step) for m in runs]
    status = worst([data.verdict.values[point] for m in runs for data in (m.base, m.moved)])
    if len(runs) == 1:
        return Slope(quotients[0], noises[0], runs[0].step, status)
    full, half = quotients
    error = abs(half[0] - full[0]) + 2.0 * noises[1] + noises[0]
    return Slope(2.0 * half - full, error, runs[0].step, status)


def by_symmetry(moves: Mapping[str, Sequence[Move]]) -> dict[str, list[Move]]:
    """Moves of the surfaces on the other side as well, mirrored (symmetric base body, zero sideslip only)."""
    result = {}
    for surface, runs in moves.items():
        result[surface] = list(runs)
        other = mirrored_name(surface)
        if other not in moves:
            result[other] = [Move(m.step, mirrored(m.base), mirrored(m.moved)) for m in runs]
    return result


def _dataset(slopes: Mapping[str, list[Slope]], source: xr.Dataset, quantity: Mapping[str, str]) -> xr.Dataset:
    variables = {}
    for name, values in slopes.items():
        coefficient = name.split("_")[0]
        shared = {"reference": source[coefficient].attrs["reference"], "axes": source[coefficient].attrs["axes"]}
        step_units = UNITS[quantity[name]]
        units = "1" if step_units == "1" else f"1/{step_units}"
        positive = f"{source[coefficient].attrs['positive']} with growing {quantity[name]}"
        bad = [v.status == "failed" for v in values]
        error = np.where(bad, np.nan, [v.error for v in values])
        value = np.where(np.array(bad)[:, None], np.nan, [v.value for v in values])
        head = {"units": units, "positive": positive, **shared}
        variables[name] = (("point", "part"), value, {"long_name": f"d {coefficient} / d {quantity[name]}", **head})
        variables[f"{name}_error"] = (
            "point",
            error,
            {"long_name": f"error estimate of {name}", **head, "positive": "always"},
        )
        variables[f"{name}_step"] = ("point", [v.step for v in values], {"units": step_units})
        variables[f"{name}_status"] = ("point", np.array([v.status for v in values], dtype=str))
    import xarray as xr

    return xr.Dataset(variables, {"part": source.part.values})
