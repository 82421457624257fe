"""Tables about another moment centre.

The centre goes from A to B, aft by x and up by z (geometry axes). Forces stay; moments gain the forces' arms,

    Cm_B = Cm_A + (CN x - CA z) / c_ref,   Cl_B = Cl_A - Cy z / b_ref,   Cn_B = Cn_A + Cy x / b_ref

with CN and CA the normal and axial force and Cy = CY - CD b the force along y at a small sideslip b. Pitching moments
are exact at the nodes. Rates act through the motion of A, which they are tables of: with V_A = V_B + w x (A - B), to
first order in the rates and without sideslip

    da   = -(2/c_ref) (x cos a + z sin a) q',   dV/V = (2/c_ref) (z cos a - x sin a) q',   db = (2/b_ref) (x r' - z p')

Drag by rates is not in the model and taken as zero about A, as is the change of CD by deflections in Cy. A slope that
needs an unknown one is unknown about B.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from spaceplane.errors import InputError
from spaceplane.vehicle.properties import ReferenceLengths


@dataclass(frozen=True)
class Arms:
    """How far the moment centre moves, over the reference lengths.

    Attributes:
        x, z: aft and up, over the chord.
        lateral_x, lateral_z: the same over the span.
    """

    x: float
    z: float
    lateral_x: float
    lateral_z: float


def arms_between(old: ReferenceLengths, new: ReferenceLengths) -> Arms:
    """Arms from one moment centre to another, both in geometry axes, m.

    Raises:
        InputError: the centre leaves the plane of symmetry.
    """
    x, y, z = (float(b) - float(a) for a, b in zip(old.moment_center, new.moment_center, strict=True))
    if y != 0.0:
        raise InputError(f"moment centre y = {new.moment_center[1]:g} m: must stay at {old.moment_center[1]:g} m")
    return Arms(x / old.chord, z / old.chord, x / old.span, z / old.span)


def base(alpha: np.ndarray, tables: Mapping[str, np.ndarray], arms: Arms) -> dict[str, np.ndarray]:
    """CL, CD and Cm [alpha, mach] about the new centre.

    Args:
        alpha: [alpha] rad.
        tables: CL, CD, Cm [alpha, mach] about the old one.
        arms: between the two.
    """
    return {**tables, "Cm": tables["Cm"] + _pitching(alpha, tables["CL"], tables["CD"], arms)}


def increments(alpha: np.ndarray, tables: Mapping[str, np.ndarray], arms: Arms) -> dict[str, np.ndarray]:
    """Increments [deflection, alpha, mach] of one surface about the new centre.

    A moment that is missing about the old centre stays missing.
    An unknown force counts as zero, as everywhere in the model.

    Args:
        alpha: [alpha] rad.
        tables: coefficient -> [deflection, alpha, mach] about the old centre.
        arms: between the two.
    """
    result = dict(tables)
    if "Cm" in tables:
        zero = np.zeros_like(tables["Cm"])
        result["Cm"] = tables["Cm"] + _pitching(alpha, tables.get("CL", zero), tables.get("CD", zero), arms)
    side = tables.get("CY", 0.0)
    if "Cl" in tables:
        result["Cl"] = tables["Cl"] - side * arms.lateral_z
    if "Cn" in tables:
        result["Cn"] = tables["Cn"] + side * arms.lateral_x
    return result


def slopes(
    alpha: np.ndarray, mach: np.ndarray, tables: Mapping[str, np.ndarray], known: Mapping[str, np.ndarray], arms: Arms
) -> dict[str, np.ndarray]:
    """Sideslip and rate slopes [alpha, mach] about the new centre.

    Args:
        alpha: [alpha] rad.
        mach: [mach].
        tables: CL, CD, Cm [alpha, mach] about the old centre.
        known: slopes [alpha, mach] about the old centre, per rad or per reduced rate.
        arms: between the two.
    """
    if arms == Arms(0.0, 0.0, 0.0, 0.0):
        return dict(known)
    moved = {"CY_beta": known["CY_beta"]} if "CY_beta" in known else {}
    side = {"beta": known["CY_beta"] - tables["CD"]} if "CY_beta" in known else {}
    # Sideslip at A per reduced rate.
    for rate, sideslip in (("p", -2.0 * arms.lateral_z), ("r", 2.0 * arms.lateral_x)):
        if f"CY_{rate}" in known and "beta" in side:
            side[rate] = moved[f"CY_{rate}"] = known[f"CY_{rate}"] + sideslip * side["beta"]
    turn = {"beta": 0.0, "p": -2.0 * arms.lateral_z, "r": 2.0 * arms.lateral_x}
    for name, arm in (("Cl", -arms.lateral_z), ("Cn", arms.lateral_x)):
        for quantity, force in side.items():
            if f"{name}_{quantity}" in known and f"{name}_beta" in known:
                flow = turn[quantity] * known[f"{name}_beta"]
                moved[f"{name}_{quantity}"] = known[f"{name}_{quantity}"] + flow + arm * force
    return moved | _pitching_rates(alpha, mach, tables, known, arms)


def _pitching_rates(
    alpha: np.ndarray, mach: np.ndarray, tables: Mapping[str, np.ndarray], known: Mapping[str, np.ndarray], arms: Arms
) -> dict[str, np.ndarray]:
    cos_a, sin_a = np.cos(alpha)[:, None], np.sin(alpha)[:, None]
    attack = -2.0 * (arms.x * cos_a + arms.z * sin_a)
    speed = 2.0 * (arms.z * cos_a - arms.x * sin_a)

    def by_flow(name: str) -> np.ndarray:
        table = tables[name]
        with_alpha = _along(0, alpha, table)
        return attack * with_alpha + speed * (2.0 * table + mach * _along(1, mach, table))

    if "CL_q" not in known:
        return {}
    # The wind axes of A are turned against those of B by the change in angle of attack.
    lift = known["CL_q"] + by_flow("CL") + attack * tables["CD"]
    drag = by_flow("CD") - attack * tables["CL"]
    moved = {"CL_q": lift}
    if "Cm_q" in known:
        moved["Cm_q"] = known["Cm_q"] + by_flow("Cm") + _pitching(alpha, lift, drag, arms)
    return moved


def _pitching(alpha: np.ndarray, CL: np.ndarray, CD: np.ndarray, arms: Arms) -> np.ndarray:
    """CN x - CA z; alpha runs along the last axis but one."""
    cos_a, sin_a = np.cos(alpha)[:, None], np.sin(alpha)[:, None]
    return (CL * cos_a + CD * sin_a) * arms.x - (CD * cos_a - CL * sin_a) * arms.z


def _along(dimension: int, axis: np.ndarray, table: np.ndarray) -> np.ndarray:
    """Slope at the nodes: mean of both sides, or that of the side that is known."""
    rows = np.moveaxis(table, dimension, 0)
    quotient: Callable = lambda values: np.diff(values, axis=0) / np.diff(axis)[:, None]  # noqa: E731
    edge = np.full_like(rows[:1], np.nan)
    left, right = np.concatenate([edge, quotient(rows)]), np.concatenate([quotient(rows), edge])
    both = np.where(np.isnan(left), right, np.where(np.isnan(right), left, 0.5 * (left + right)))
    return np.moveaxis(both, 0, dimension)
