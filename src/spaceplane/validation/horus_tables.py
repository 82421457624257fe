"""The published static coefficients of HORUS-2B.

Source: E. Mooij, "The HORUS-2B reference vehicle", memorandum M-692, TU Delft (1995), after an MBB study of 1988.
Wind axes for C_L and C_D, pitching moment nose up positive on 23 m, reference area 110 m2.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np
from scipy.interpolate import RegularGridInterpolator

COEFFICIENTS = ("CL", "CD", "Cm")
SURFACES = ("bodyflap", "one_elevon")
SOURCE = "Mooij, memorandum M-692, TU Delft (1995)"

LATERAL_POINT = {"CY_beta": -0.01725, "Cl_beta": -0.00139, "Cn_beta": -0.00048}
"""Per degree at Mach 2.5, alpha 16.6 deg (thesis Table 6.1, after Mooij). The side force is printed as C_S_beta."""


@dataclass(frozen=True)
class Table:
    """A coefficient on a regular grid.

    Attributes:
        deflection_deg: [deflection] deg, positive trailing edge down; a single 0 for the clean vehicle.
        alpha_deg: [alpha] angle of attack, deg.
        mach: [mach] Mach number.
        values: [deflection, alpha, mach] the coefficient or its increment; NaN where none was published.
    """

    deflection_deg: np.ndarray
    alpha_deg: np.ndarray
    mach: np.ndarray
    values: np.ndarray

    def at(self, mach: float, alpha_deg: float, deflection_deg: float = 0.0) -> float:
        """Interpolate linearly in Mach number, angle of attack (deg) and deflection (deg); no extrapolation."""
        if len(self.deflection_deg) == 1:
            grid, point = (self.alpha_deg, self.mach), (alpha_deg, mach)
            return RegularGridInterpolator(grid, self.values[0])(point).item()
        grid = (self.deflection_deg, self.alpha_deg, self.mach)
        return RegularGridInterpolator(grid, self.values)((deflection_deg, alpha_deg, mach)).item()


@cache
def base(coefficient: str) -> Table:
    """The clean, untrimmed vehicle's `CL`, `CD` or `Cm`."""
    return _read(f"{coefficient}0.csv")


@cache
def increment(coefficient: str, surface: str) -> Table:
    """Increment of `CL`, `CD` or `Cm` by `bodyflap` or by `one_elevon` (one side; double it for the pair)."""
    return _read(f"d{coefficient}_{surface}.csv")


def _read(name: str) -> Table:
    text = files("spaceplane.validation").joinpath("data", "horus_2b", name).read_text(encoding="utf-8")
    rows = list(csv.reader(text.splitlines()))
    head, body = rows[0], np.array([[float(cell) if cell else np.nan for cell in row] for row in rows[1:]])
    mach = np.array([float(column.removeprefix("M")) for column in head if column.startswith("M")])
    if head[0] != "delta_deg":
        return Table(np.zeros(1), body[:, 0], mach, body[None, :, 1:])
    deflection, alpha = np.unique(body[:, 0]), np.unique(body[:, 1])
    order = np.lexsort((body[:, 1], body[:, 0]))
    return Table(deflection, alpha, mach, body[order, 2:].reshape(len(deflection), len(alpha), len(mach)))
