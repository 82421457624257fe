"""What a deck states in words: axes, units, positive senses, reference lengths and point, limits, and the unknown."""

from __future__ import annotations

import math

from spaceplane import __version__
from spaceplane.aero.model.model import LAG, AeroModel
from spaceplane.vehicle.controls import CONTROL_POSITIVE, CONTROLS

AXES = (
    "CL, CD, CY in wind axes: CL up in the plane of symmetry, CD downstream, CY to the right",
    "Cl, Cm, Cn in body axes (x forward, y right, z down): Cl right wing down, Cm nose up, Cn nose right",
    "alpha, angle of attack, positive nose up; beta, sideslip, positive with the wind from the right (nose left)",
    "p, q, r right-handed about body x, y, z; reduced rates p b_ref/2V, q c_ref/2V, r b_ref/2V",
)
"""Axes and positive senses of every aerodynamic model of this package."""


def title(model: AeroModel) -> str:
    """One line: what it is and who wrote it."""
    return f"{model.name}, written by spaceplane {__version__}"


def reference_lines(model: AeroModel) -> list[str]:
    """Reference area, lengths and point."""
    r = model.reference
    x, y, z = r.moment_center
    center = f"the point {x:.10g} m behind the nose, {y:.10g} m to the right and {z:.10g} m above the reference axis"
    if not model.center_known:
        center = "the centre of mass; where it lies in the vehicle is not known"
    return [
        f"reference area {r.area:.10g} m2 (all coefficients), chord c_ref {r.chord:.10g} m (Cm and q), "
        f"span b_ref {r.span:.10g} m (Cl, Cn, p and r)",
        f"moments about {center}",
    ]


def deflection_lines(model: AeroModel) -> list[str]:
    """Positive sense of each control surface of the model."""
    return [f"{name} positive {CONTROL_POSITIVE[name]}" for name in CONTROLS if name in model.surfaces]


def limits(model: AeroModel) -> list[dict]:
    """Validity limits: rows of `quantity`, `lower`, `upper` and `unit` (deg, or 1 for the Mach number)."""
    ranges = {"alpha": (model.alpha[0], model.alpha[-1]), "beta": (-model.beta_limit, model.beta_limit)}
    ranges |= {name: model.surfaces[name].limits for name in CONTROLS if name in model.surfaces}
    rows = [{"quantity": "mach", "lower": float(model.mach[0]), "upper": float(model.mach[-1]), "unit": "1"}]
    for name, (lower, upper) in ranges.items():
        low, high = (round(math.degrees(x), 9) for x in (lower, upper))
        rows.append({"quantity": name, "lower": low, "upper": high, "unit": "deg"})
    return rows


def limit_lines(model: AeroModel) -> list[str]:
    """The limits in words."""
    return [
        f"{row['quantity']} {row['lower']:.10g} to {row['upper']:.10g}{'' if row['unit'] == '1' else ' deg'}"
        for row in limits(model)
    ]


def unknown_line(model: AeroModel) -> str:
    """What the model does not know and counts as zero."""
    missing = [name for name in CONTROLS if name not in model.surfaces]
    unknown = [name for name in model.unknown() if not name.endswith(tuple(f"_{surface}" for surface in missing))]
    unknown += [f"all of {surface}" for surface in missing]
    return "unknown and counted as zero: " + (", ".join(unknown) if unknown else "nothing")


def lag_line(model: AeroModel) -> str:
    """Derivatives with the rate of alpha, which no deck has; empty text without any."""
    known = [f"{name} = {value:.10g}" for name, value in zip(LAG, model.lag, strict=True) if value]
    return f"known, but not in these files (on dalpha/dt c_ref/2V): {', '.join(known)}" if known else ""


def cut_line(model: AeroModel, full: AeroModel) -> str:
    """What a deck leaves out of a model with empty cells; empty text where it leaves out nothing.

    Args:
        model: as given.
        full: the part of it that the deck holds.
    """
    if (len(full.alpha), len(full.mach)) == (len(model.alpha), len(model.mach)):
        return ""
    alpha, mach = [math.degrees(x) for x in model.alpha], model.mach
    return (
        f"left out, since tables have empty cells there: the rest of alpha {alpha[0]:.6g} to {alpha[-1]:.6g} deg, "
        f"Mach {mach[0]:.6g} to {mach[-1]:.6g}"
    )
