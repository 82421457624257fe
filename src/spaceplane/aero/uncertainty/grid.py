"""Uncertainty of values on a mesh, from how far those on a coarser mesh lie from them.

The form is that of the grid convergence index of Roache (J. Fluids Eng. 116, 1994): a value whose error falls with the
power `ORDER` of the cell, and which differs by e from that on cells r times as large, is uncertain by

    U = F |e| / (r^ORDER - 1).

With two meshes the order is assumed, not observed: 0.8, which is what HORUS-2B's coefficients show on average from
wall cells of 0.5 to 0.08 m, with the shocks, edges and cut cells that a scheme of second order meets there. The factor
of safety is 4 near and below the speed of sound, where shocks stand on the wall and two meshes that misplace them alike
agree better with each other than with the exact flow, and at hypersonic Mach numbers, where few cells lie between wall
and shock. Between, where errors fall faster, it is calibrated as Xing and Stern (J. Fluids Eng. 132, 2010) do: by 2.5,
93 % or more of HORUS-2B's longitudinal and of its lateral coefficients and derivatives are held, by 2.25 only 91 %
(Roache's own for two grids is 3; docs/uncertainty.md has what others hold, and on other bodies).

One difference may be small by chance while the error is not, so e is not taken alone. It is at least the root mean
square of the differences at neighbouring Mach numbers, of the same quantity and, with less weight, of those that share
its scale; and that of a force at least that of the moments that it makes, see `arms`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

ORDER = 0.8
SAFETY, SAFETY_SUPERSONIC = 4.0, 2.5
TRANSONIC = 0.3
"""Largest distance of a transonic Mach number from one."""
HYPERSONIC = 5.0
"""Least hypersonic Mach number."""
LEVEL = 0.95
"""Share of the intervals value +- U that are meant to hold the exact value."""
MACH_WIDTH = 0.3
"""Standard width, in log Mach number, within which flows are alike enough to tell of each other's errors."""
SIBLINGS = 0.1
"""Weight of the mean square of the quantities of one scale beside that of the quantity itself."""
NOTHING = 1e-4
"""Values below this share of the largest on their scale, on both meshes, are zero by symmetry: no sample of errors."""


def half_width(
    fine: np.ndarray,
    coarse: np.ndarray,
    mach: np.ndarray,
    group: Sequence[str],
    ratio: float,
    at_least: Mapping[str, Sequence[tuple[str, np.ndarray]]] | None = None,
) -> np.ndarray:
    """Half width of the 95 % interval about values on a mesh, as far as the mesh goes, in the values' own unit.

    Args:
        fine: [quantity, condition] on the mesh.
        coarse: [quantity, condition] on its companion.
        mach: [condition] Mach number.
        group: [quantity] name of the scale: quantities of one name, such as forces, are errors of one size.
        ratio: cell of the companion over that of the mesh, above 1.
        at_least: group to others and the share [condition] of the mean error of each that is the least of its own.

    Returns:
        [quantity, condition]; NaN where either value is.
    """
    fine, coarse, mach = (np.asarray(v, dtype=float) for v in (fine, coarse, mach))
    square = (coarse - fine) ** 2
    there = np.isfinite(square) & ~_nothing(fine, coarse, group)
    near = np.exp(-0.5 * (np.log(mach[:, None] / mach[None, :]) / MACH_WIDTH) ** 2)
    own = _mean(square, there, near)
    least = own.copy()
    rows_of = {name: [k for k, other in enumerate(group) if other == name] for name in group}
    shared = {
        name: np.where(there[rows], own[rows], 0.0).sum(axis=0) / np.maximum(there[rows].sum(axis=0), 1)
        for name, rows in rows_of.items()
    }
    for name, rows in rows_of.items():
        least[rows] = (own[rows] + SIBLINGS * shared[name]) / (1.0 + SIBLINGS)
        for other, share in (at_least or {}).get(name, ()):
            if other in shared:
                least[rows] = np.maximum(least[rows], share**2 * shared[other])
    size = np.sqrt(np.where(there, np.maximum(square, least), square))
    return safety(mach) / (ratio**ORDER - 1.0) * size


def transonic(mach: np.ndarray) -> np.ndarray:
    """Whether shocks may stand on the wall at these Mach numbers."""
    return np.abs(np.asarray(mach, dtype=float) - 1.0) < TRANSONIC


def safety(mach: np.ndarray) -> np.ndarray:
    """Factor of safety at these Mach numbers."""
    mach = np.asarray(mach, dtype=float)
    supersonic = (mach > 1.0) & ~transonic(mach) & (mach < HYPERSONIC)
    return np.where(supersonic, SAFETY_SUPERSONIC, SAFETY)


def _nothing(fine: np.ndarray, coarse: np.ndarray, group: Sequence[str]) -> np.ndarray:
    """[quantity, condition] whether symmetry makes the value zero."""
    size = np.maximum(np.abs(fine), np.abs(coarse))
    small = np.zeros(size.shape, dtype=bool)
    for name in dict.fromkeys(group):
        rows = [k for k, other in enumerate(group) if other == name]
        small[rows] = size[rows] < NOTHING * np.nan_to_num(size[rows]).max(initial=0.0)
    return small


def _mean(square: np.ndarray, there: np.ndarray, near: np.ndarray) -> np.ndarray:
    """[quantity, condition] mean of the squares that are there, weighted by nearness [condition, condition]."""
    weight = there.astype(float) @ near
    total = np.where(there, square, 0.0) @ near
    return np.where(weight > 0.0, total / np.where(weight > 0.0, weight, 1.0), 0.0)
